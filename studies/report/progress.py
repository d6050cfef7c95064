"""Progress of long work: a bar on a terminal, plain lines elsewhere, nothing when quiet."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from quietarm.studies.report.words import print_lines
from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    SpinnerColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

PLAIN_SECONDS = 2.0
"""Seconds between plain lines, where the pieces are too many for one line each."""
WORDS = TextColumn("{task.description}", markup=False)


@contextmanager
def bars(console: Console, *columns: ProgressColumn) -> Iterator[Progress]:
    """Bars that are shown on a terminal alone."""
    hidden = console.quiet or not console.is_terminal
    with Progress(*columns, console=console, transient=True, disable=hidden) as shown:
        yield shown


@contextmanager
def working(what: str, console: Console) -> Iterator[None]:
    """Show that work goes on that has no measure of progress."""
    columns = SpinnerColumn(), TextColumn(what, markup=False), TimeElapsedColumn()
    with bars(console, *columns) as shown:
        shown.add_task("", total=None)
        yield


@contextmanager
def progress(total: int, console: Console) -> Iterator[Callable[[str], None]]:
    """Show which of a few pieces of work is done; yields what is called when one begins."""
    columns = BarColumn(), MofNCompleteColumn(), TimeRemainingColumn(), WORDS
    begun = 0
    with bars(console, *columns) as shown:
        task = shown.add_task("", total=total)

        def begin(name: str) -> None:
            nonlocal begun
            shown.update(task, completed=begun, description=name)
            begun += 1
            if not console.is_terminal:
                print_lines(console, f"[{begun}/{total}] {name}")

        yield begin


@contextmanager
def count(total: int, what: str, console: Console) -> Iterator[Callable[[int, int], None]]:
    """Show how many of many small pieces are done."""
    lines = Lines(console)
    columns = BarColumn(), MofNCompleteColumn(), TimeRemainingColumn(), WORDS
    with bars(console, *columns) as shown:
        task = shown.add_task(what, total=total)

        def report(done: int, total: int) -> None:
            shown.update(task, completed=done, total=total)
            lines.say(f"{done} of {total} {what}", last=done == total)

        yield report


@dataclass
class Lines:
    """Plain lines where there is no terminal, one every few seconds."""

    console: Console
    said: float = -PLAIN_SECONDS

    def say(self, line: str, *, last: bool = False) -> None:
        """Print a line if it is the last, or time for one."""
        now = time.monotonic()
        due = last or now - self.said >= PLAIN_SECONDS
        if due and not self.console.is_terminal:
            self.said = now
            print_lines(self.console, line)
