"""Files that are asked for, and what writes each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

File = tuple[Path, Callable[[Path], object]]
"""A file that was asked for, and what writes it."""
STDOUT = Path("-")
"""Stands for standard output; a file of this name is given as ./-"""


def drawing(draw: Callable[[], Figure]) -> Callable[[Path], object]:
    """A function that writes a picture, and imports the drawing library only then."""

    def write(path: Path) -> None:
        from quietarm.studies.report.pictures import save_figure

        save_figure(draw(), path)

    return write


def inside(folder: Path, writes: Mapping[str, Callable[[Path], object]]) -> list[File]:
    """Files of a folder by their names; the folder is made when the first is written."""

    def write_inside(write: Callable[[Path], object], path: Path) -> None:
        path.parent.mkdir(exist_ok=True)
        write(path)

    return [(folder / name, partial(write_inside, write)) for name, write in writes.items()]
