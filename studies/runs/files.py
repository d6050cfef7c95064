"""What several runs check before they begin: their files, their workers."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console


@dataclass(frozen=True)
class FrontFiles:
    """The files that a front is written to; None where one is not asked for."""

    output: Path | None
    csv: Path | None
    figure: Path | None

    def refuse_same(self, *read: tuple[str, Path]) -> None:
        """Make sure that no two are one file, nor one that is read; ValueError names both."""
        written = [("--output", self.output), ("--csv", self.csv), ("--figure", self.figure)]
        refuse_same_file([*read, *written])


def refuse_same_file(files: Iterable[tuple[str, Path | None]]) -> None:
    """Make sure that no two options name one file; ValueError names them."""
    names: dict[str, str] = {}
    for name, path in files:
        if path is None:
            continue
        place = os.path.realpath(path)  # of a link that goes in a circle, too
        if names.setdefault(place, name) != name:
            raise ValueError(f"{names[place]} and {name} are both {path}; give two files")


def warn_of_workers(console: Console, workers: int, pieces: int) -> None:
    """Warn where more workers start than there are cores; no more start than pieces of work."""
    from quietarm.metaheuristics.sharing.workers import (
        Workers,  # a plan by the gradient needs no workers
    )

    cores, workers = os.cpu_count() or 1, Workers(workers).local(pieces)
    if workers > cores:
        console.print(
            f"{workers} workers will share {cores} core{'s' * (cores > 1)}", highlight=False
        )
