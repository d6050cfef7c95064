"""Progress of long work: a bar on a terminal, plain lines elsewhere, nothing when quiet."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from typing import Protocol, TypeVar

from quietarm.studies.display.words import print_lines
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

Display = TypeVar("Display")

SILENT_SECONDS = 2.0
"""Seconds of work without output before the first line; pauses then grow to `_LONGEST_PAUSE`."""
_LONGEST_PAUSE = 60.0
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
    """Choose how work is shown."""
    if quiet:
        yield nothing
    elif not console.is_terminal:
        yield lines
    else:
        with Progress(*columns, console=console, transient=True) as bars:
            yield bar(bars)


def pauses() -> Iterator[float]:
    """Pauses between lines of output [s]: longer and longer, up to a minute."""
    pause = SILENT_SECONDS
    while True:
        yield pause
        pause = min(2 * pause, _LONGEST_PAUSE)


@contextmanager
def ticking(console: Console, words: Callable[[], str]) -> Iterator[None]:
    """Print the words, if any, and the elapsed time every so often while the work goes on."""
    began, over = time.perf_counter(), threading.Event()

    def tick() -> None:
        for pause in pauses():
            if over.wait(pause):
                return
            if said := words():
                print_lines(console, f"{said}, {time.perf_counter() - began:.0f} s so far")

    ticker = threading.Thread(target=tick, daemon=True)
    ticker.start()
    try:
        yield
    finally:
        over.set()
        ticker.join()


@contextmanager
def working(what: str, console: Console, *, quiet: bool = False) -> Iterator[None]:
    """Show that work goes on that has no measure of progress."""
    if quiet:
        yield
    elif console.is_terminal:
        columns = (SpinnerColumn(), TextColumn(what, markup=False), TimeElapsedColumn())
        with Progress(*columns, console=console, transient=True) as bars:
            bars.add_task("", total=None)
            yield
    else:
        with ticking(console, lambda: what):
            yield


@contextmanager
def progress(total: int, console: Console, *, quiet: bool = False) -> Iterator[Advance]:
    """Show how far a piece of work is."""
    begun, piece = 0, ""

    def line(name: str) -> None:
        nonlocal begun, piece
        begun += 1
        piece = f"[{begun}/{total}] {name}"
        print_lines(console, piece)

    def bar(bars: Progress) -> Advance:
        task = bars.add_task("", total=total)

        def advance(name: str) -> None:
            nonlocal begun
            bars.update(task, completed=begun, description=name)
            begun += 1

        return advance

    nothing = quiet or console.is_terminal
    with (
        nullcontext() if nothing else ticking(console, lambda: piece or "beginning"),
        shown(console, quiet, _COLUMNS, lambda name: None, line, bar) as advance,
    ):
        yield advance


@contextmanager
def count(
    total: int, what: str, console: Console, *, quiet: bool = False
) -> Iterator[Callable[[int, int], None]]:
    """Show how many of many small pieces are done."""
    said, now, of = time.monotonic(), 0, total

    def line(done: int, total: int) -> None:
        nonlocal said, now, of
        now, of = done, total
        if done == total or time.monotonic() - said >= PLAIN_SECONDS:
            said = time.monotonic()
            print_lines(console, f"{done} of {total} {what}")

    def bar(bars: Progress) -> Callable[[int, int], None]:
        task = bars.add_task(what, total=total)
        return lambda done, total: bars.update(task, completed=done, total=total)

    nothing = quiet or console.is_terminal
    with (
        nullcontext() if nothing else ticking(console, lambda: f"{now} of {of} {what}"),
        shown(console, quiet, _COLUMNS, lambda done, total: None, line, bar) as report,
    ):
        yield report
