"""Progress of long work: a bar on a terminal, plain lines elsewhere, nothing when quiet."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Protocol, TypeVar

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    TextColumn,
    TimeRemainingColumn,
)

from studies.display.words import print_lines

Display = TypeVar("Display")

PLAIN_SECONDS = 2.0
"""Seconds between plain lines, where the pieces are too many for one line each."""
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
def shown(
    console: Console,
    quiet: bool,
    columns: Sequence[ProgressColumn],
    nothing: Display,
    lines: Display,
    bar: Callable[[Progress], Display],
) -> Iterator[Display]:
    """Choose how work is shown.

    Parameters
    ----------
    console : rich.console.Console
        Where to.
    quiet : bool
        Whether it is to be shown at all.
    columns : sequence of ProgressColumn
        Of the bars.
    nothing, lines : Display
        What shows nothing, and what prints plain lines where there is no terminal.
    bar : callable
        Takes the bars of a terminal and returns what draws in them.

    Yields
    ------
    Display
        One of the three.
    """
    if quiet:
        yield nothing
    elif not console.is_terminal:
        yield lines
    else:
        with Progress(*columns, console=console, transient=True) as bars:
            yield bar(bars)


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
    begun = 0

    def line(name: str) -> None:
        nonlocal begun
        begun += 1
        print_lines(console, f"[{begun}/{total}] {name}")

    def bar(bars: Progress) -> Advance:
        task = bars.add_task("", total=total)

        def advance(name: str) -> None:
            nonlocal begun
            bars.update(task, completed=begun, description=name)
            begun += 1

        return advance

    with shown(console, quiet, _COLUMNS, lambda name: None, line, bar) as advance:
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
        To be called with the number of pieces done and of all. Where there is no terminal, it
        prints a line every two seconds.
    """
    said = time.monotonic()

    def line(done: int, total: int) -> None:
        nonlocal said
        if done == total or time.monotonic() - said >= PLAIN_SECONDS:
            said = time.monotonic()
            print_lines(console, f"{done} of {total} {what}")

    def bar(bars: Progress) -> Callable[[int, int], None]:
        task = bars.add_task(what, total=total)
        return lambda done, total: bars.update(task, completed=done, total=total)

    with shown(console, quiet, _COLUMNS, lambda done, total: None, line, bar) as report:
        yield report
