"""What several runs check before they begin: their files, their workers."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from rich.console import Console

from metaheuristics.objective.claims import check_figures
from ocp import Front
from ocp.base.workers import number_of_workers


def refuse_same_file(files: Iterable[tuple[str, Path | None]]) -> None:
    """Make sure that no two options name one file; ValueError names them."""
    names: dict[Path, str] = {}
    for name, path in files:
        if path is not None and names.setdefault(path.resolve(), name) != name:
            raise ValueError(f"{names[path.resolve()]} and {name} are both {path}; give two files")


def load_front(path: Path) -> Front:
    """The front of a file, of which motions were evaluated again: a file is a claim.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    Front
        The front.

    Raises
    ------
    FileFormatError
        When the file is no front.
    ValueError
        When its figures are not those of its motions.
    """
    front = Front.load(path)
    check_figures(front, str(path))
    return front


def warn_of_workers(console: Console, workers: int, pieces: int) -> None:
    """Warn where more workers start than there are cores; no more start than pieces of work."""
    cores, workers = os.cpu_count() or 1, min(number_of_workers(workers), pieces)
    if workers > cores:
        console.print(
            f"{workers} workers will share {cores} core{'s' * (cores > 1)}", highlight=False
        )
