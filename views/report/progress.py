"""Progress of long work and of searches: bars on a terminal, plain lines elsewhere."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from math import isnan

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

from quietarm.metaheuristics import SearchProgress
from quietarm.ocp import Front
from quietarm.ocp.escapes import one_line
from quietarm.views.report.terminal import LEAST_WIDTH, print_lines, wrapped
from quietarm.views.report.words import corner_words
from quietarm.views.tips import tip_scale, tip_words

STILL = 1e-6
"""Residual [m or rad] below which progress says no number."""
PLAIN_SECONDS = 2.0
"""Seconds between plain lines, where the pieces are too many for one line each."""
SILENT_SECONDS = 30.0
"""Seconds without a word where there is no terminal: most work is done by then."""
WORDS = TextColumn("{task.description}", markup=False)


@contextmanager
def bars(console: Console, *columns: ProgressColumn) -> Iterator[Progress]:
    """Bars that are shown on a terminal alone."""
    hidden = console.quiet or not console.is_terminal
    with Progress(*columns, console=console, transient=True, disable=hidden) as shown:
        yield shown


@contextmanager
def _said_after_a_while(what: str, console: Console) -> Iterator[None]:
    """Say where there is no terminal that work goes on, after `SILENT_SECONDS`, twice that, ..."""
    if console.quiet or console.is_terminal:
        yield
        return
    ended = threading.Event()
    begun = time.monotonic()

    def say() -> None:
        pause = SILENT_SECONDS
        with suppress(OSError):  # nobody reads any more
            while not ended.wait(pause):
                print_lines(console, f"still {what} after {time.monotonic() - begun:.0f} s")
                pause *= 2

    thread = threading.Thread(target=say, daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


@contextmanager
def working(what: str, console: Console) -> Iterator[None]:
    """Show that work goes on that has no measure of progress."""
    columns = SpinnerColumn(), TextColumn(what, markup=False), TimeElapsedColumn()
    with bars(console, *columns) as shown, _said_after_a_while(what, console):
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
            shown.update(task, completed=begun, description=one_line(name))
            begun += 1
            if not console.is_terminal:
                print_lines(console, f"[{begun}/{total}] {name}")

        yield begin


@contextmanager
def count(total: int, what: str, console: Console) -> Iterator[Callable[[int, int], None]]:
    """Show how many of many small pieces are done; a total of 0 is known with the first."""
    lines = Lines(console)
    columns = BarColumn(), MofNCompleteColumn(), TimeRemainingColumn(), WORDS
    working_on = f"working on {total or ''} {what}".replace("  ", " ")
    with bars(console, *columns) as shown, _said_after_a_while(working_on, console):
        task = shown.add_task(what, total=total or None)

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
            print_lines(self.console, *wrapped(line, LEAST_WIDTH))


@contextmanager
def search_display(console: Console, *, of_function: bool = False) -> Iterator[SearchDisplay]:
    """Show a search's generation, best residual, least energy, hypervolume, speed and time left.

    Of a function the values stand in its own units, as in its answer.
    """
    columns = BarColumn(bar_width=12), TimeRemainingColumn(), WORDS
    with bars(console, *columns) as shown:
        yield SearchDisplay(shown, Lines(console), of_function=of_function)


class SearchDisplay:
    """Called with every generation of one search, and with every search that ends."""

    def __init__(self, shown: Progress, lines: Lines, *, of_function: bool = False) -> None:
        self._of_function = of_function
        self._bars = shown
        self._lines = lines
        self._task = shown.add_task("", visible=False)

    def __call__(self, progress: SearchProgress) -> None:
        """Show where the only search is."""
        done = progress.generation
        total = progress.generations
        self._bars.update(
            self._task, completed=done, total=total, visible=True,
            description=_brief(progress, self._first(progress, ".2g")),
        )  # fmt: skip
        self._lines.say(_figures(progress, self._first(progress)), last=done == total)

    def _first(self, progress: SearchProgress, form: str = "") -> str:
        """The least of the first objective: a residual in millimetres, or what a function gave."""
        if self._of_function:
            return f"{progress.residual:{form or '.4g'}} {progress.tip_unit}".rstrip()
        if form:
            shown, scale = tip_scale(progress.tip_unit)
            return f"{scale * progress.residual:{form}} {shown}"
        if 0 <= progress.residual < STILL:
            return f"below {tip_words(STILL, progress.tip_unit)}"
        return tip_words(progress.residual, progress.tip_unit)

    def finish(self, front: Front) -> None:
        """Show what a search found."""
        print_lines(self._lines.console, _found(front))


def _found(front: Front) -> str:
    if not front.points:
        return f"seed {front.record.seed} is done in {front.record.seconds:.1f} s: no point"
    from quietarm.metaheuristics.score import final_share_of_box  # loads moocore

    share = final_share_of_box(front)
    return (
        f"seed {front.record.seed} is done in {front.record.seconds:.1f} s: hypervolume "
        f"{share:.4f} of the area up to {corner_words(front)}"
    )


def _figures(progress: SearchProgress, least: str) -> str:
    done = progress.generation
    total = progress.generations
    seconds_left = progress.seconds * (total - done) / max(done, 1)
    share = progress.infeasible / max(progress.evaluations, 1)
    first, second = progress.names
    best = f"{first} {least}, {second} {progress.energy:.4g} {progress.energy_unit}".rstrip()
    best = "nothing found yet" if isnan(progress.residual) else best
    broken = f" ({share:.0%} break a limit)" if progress.infeasible else ""
    return (
        f"{progress.step} {done}/{total}, {best}, hypervolume {progress.hypervolume:.4f}, "
        f"{_speed(progress):.0f} candidates/s{broken}, {seconds_left:.0f} s left"
    )


def _brief(progress: SearchProgress, least: str) -> str:
    """Return the progress in a few words, for a bar, which has little room."""
    return (
        f"{progress.generation}/{progress.generations} {least} "
        f"{progress.energy:.3g} {progress.energy_unit} hv {progress.hypervolume:.3f} "
        f"{_speed(progress):.0f}/s"
    )


def _speed(progress: SearchProgress) -> float:
    return progress.evaluations / max(progress.seconds, 1e-9)
