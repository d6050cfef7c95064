"""Progress of long work: a bar on a terminal, plain lines elsewhere, nothing when quiet."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn


class Advance(Protocol):
    """Called when a piece of work begins, with its name."""

    def __call__(self, name: str) -> None:
        """Begin the piece of work of this name."""
        ...


@contextmanager
def progress(total: int, console: Console, *, quiet: bool = False) -> Iterator[Advance]:
    """Show how far a piece of work is.

    Parameters
    ----------
    total : int
        Number of pieces.
    console : rich.console.Console
        Where to show it, usually standard error.
    quiet : bool
        Show nothing.

    Yields
    ------
    Advance
        Call it with the name of every piece when the piece begins.
    """
    if quiet:
        yield lambda name: None
    elif not console.is_terminal:
        begun = 0

        def line(name: str) -> None:
            nonlocal begun
            begun += 1
            text = f"[{begun}/{total}] {name}"
            console.print(text, markup=False, highlight=False, soft_wrap=True)

        yield line
    else:
        columns = (
            BarColumn(),
            MofNCompleteColumn(),
            TimeRemainingColumn(),
            TextColumn("{task.description}", markup=False),
        )
        with Progress(*columns, console=console, transient=True) as bar:
            task = bar.add_task("", total=total)
            begun = 0

            def advance(name: str) -> None:
                nonlocal begun
                bar.update(task, completed=begun, description=name)
                begun += 1

            yield advance
