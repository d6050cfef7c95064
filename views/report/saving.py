"""Files that are asked for, and what writes each: pictures whole or not at all."""

from __future__ import annotations

import io
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, cast

from quietarm.ocp.escapes import printable
from quietarm.ocp.files import check_writable, write_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure

File = tuple[Path, Callable[[Path], object]]
"""A file that was asked for, and what writes it."""
STDOUT = Path("-")
"""Stands for standard output; a file of this name is given as ./-"""
SUFFIXES = (".png", ".pdf", ".svg")
"""Of pictures."""


def drawing(draw: Callable[[], Figure]) -> Callable[[Path], object]:
    """Return a function that draws a picture and writes it, and does nothing before."""
    return lambda path: save_figure(draw(), path)


def inside(folder: Path, writes: Mapping[str, Callable[[Path], object]]) -> list[File]:
    """Files of a folder by their names; the folder is made when the first is written."""

    def write_inside(write: Callable[[Path], object], path: Path) -> None:
        path.parent.mkdir(exist_ok=True)
        try:
            write(path)
        except ValueError:
            with suppress(OSError):  # it has other files, and stays
                path.parent.rmdir()
            raise

    return [(folder / name, partial(write_inside, write)) for name, write in writes.items()]


def check_figure(path: str | Path) -> Path:
    """Make sure that a picture can be written under this name; ValueError otherwise."""
    target = check_writable(path)
    if target.suffix.lower() not in SUFFIXES:
        raise ValueError(f"{target} is no picture; end its name in {', '.join(SUFFIXES)}")
    return target


def save_figure(figure: Figure, path: str | Path) -> None:
    """Write a picture whole or not at all."""
    target = check_figure(path)
    content = io.BytesIO()
    try:
        with as_written(figure):
            figure.savefig(content, format=target.suffix[1:].lower(), dpi=150)
    except (RuntimeError, ValueError, ImportError) as error:  # by the user's settings alone
        reason = (str(error).splitlines() or [type(error).__name__])[0]
        raise ValueError(
            f"{target} cannot be drawn ({reason}); check matplotlib's settings: matplotlibrc, "
            "MPLBACKEND, SOURCE_DATE_EPOCH"
        ) from error
    write_whole(target, content.getvalue())


@contextmanager
def as_written(figure: Figure) -> Iterator[None]:
    """Let the block draw names as they are: no formula at a dollar, a frame for unknown letters.

    What is not printed, as marks that turn the direction of writing round, is a question mark.
    """
    from matplotlib.text import Text

    for found in figure.findobj(Text):
        text = cast("Text", found)
        text.set_parse_math(False)
        text.set_text(printable(text.get_text()))
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from font")
        yield
