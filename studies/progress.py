"""Progress of long work: a bar on a terminal, plain lines elsewhere, nothing when quiet."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Protocol

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

_PLAIN_SECONDS = 2.0
_COLUMNS = (
    BarColumn(),
    MofNCompleteColumn(),
    TimeRemainingColumn(),
    TextColumn("{task.description}", markup=False),
)


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
        with Progress(*_COLUMNS, console=console, transient=True) as bar:
            task = bar.add_task("", total=total)
            begun = 0

            def advance(name: str) -> None:
                nonlocal begun
                bar.update(task, completed=begun, description=name)
                begun += 1

            yield advance


@contextmanager
def count(
    total: int, what: str, console: Console, *, quiet: bool = False
) -> Iterator[Callable[[int, int], None]]:
    """Show how many of many small pieces are done.

    Parameters
    ----------
    total : int
        Number of pieces.
    what : str
        What they are, in the plural.
    console : rich.console.Console
        Where to show it, usually standard error.
    quiet : bool
        Show nothing.

    Yields
    ------
    callable
        To be called with the number of pieces done and of all; on no terminal that is a line every
        two seconds.
    """
    if quiet:
        yield lambda done, total: None
    elif not console.is_terminal:
        said = time.monotonic()

        def line(done: int, total: int) -> None:
            nonlocal said
            if done == total or time.monotonic() - said >= _PLAIN_SECONDS:
                said = time.monotonic()
                console.print(f"{done} of {total} {what}", highlight=False, soft_wrap=True)

        yield line
    else:
        with Progress(*_COLUMNS, console=console, transient=True) as bar:
            task = bar.add_task(what, total=total)
            yield lambda done, total: bar.update(task, completed=done, total=total)
