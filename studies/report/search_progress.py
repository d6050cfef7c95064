"""Progress of searches: bars on a terminal, plain lines elsewhere."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from math import isnan

from quietarm.metaheuristics import SearchProgress
from quietarm.ocp import Front
from quietarm.studies.report.progress import Lines, bars
from quietarm.studies.report.words import millimetres, print_lines
from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn

_WIDE = 120
"""A terminal of this many columns shows every figure with its name."""


@contextmanager
def search_display(console: Console, *, quiet: bool = False) -> Iterator[SearchDisplay]:
    """Show a search's generation, best residual, least energy, hypervolume, speed and time left."""
    columns = BarColumn(bar_width=12), TextColumn("{task.description}", markup=False)
    with bars(console, quiet, *columns) as shown:
        yield SearchDisplay(shown, Lines(console, quiet))


class SearchDisplay:
    """Called with every generation, and with every search that ends: a bar or lines for each."""

    def __init__(self, shown: Progress, lines: Lines) -> None:
        self._bars, self._lines = shown, lines
        self._tasks: dict[int | None, TaskID] = {}
        self._words = _figures if shown.console.width >= _WIDE else _brief

    def __call__(self, progress: SearchProgress, seed: int | None = None) -> None:
        """Show where a search is; the seed tells one of several."""
        if seed not in self._tasks:
            self._tasks[seed] = self._bars.add_task("", total=progress.generations)
        words = self._words(progress, seed)
        self._bars.update(self._tasks[seed], completed=progress.generation, description=words)
        last = progress.generation == progress.generations
        self._lines.say(_figures(progress, seed), last=last, of=seed)

    def finish(self, front: Front) -> None:
        """Show what one of several searches found."""
        if front.seed in self._tasks:
            self._bars.remove_task(self._tasks.pop(front.seed))
        if not self._lines.quiet:
            print_lines(self._lines.console, _found(front))


def _found(front: Front) -> str:
    share = front.history[-1].hypervolume if front.history else 0.0
    return f"seed {front.seed} is done: hypervolume {share:.4f} in {front.seconds:.1f} s"


def _figures(progress: SearchProgress, seed: int | None) -> str:
    which = "" if seed is None else f"seed {seed}, "
    share = progress.infeasible / max(progress.evaluations, 1)
    best = f"residual {millimetres(progress.residual)}, energy {progress.energy:.4g} J"
    best = "nothing found yet" if isnan(progress.residual) else best
    broken = f" ({share:.0%} break a limit)" if progress.infeasible else ""
    return (
        f"{which}generation {progress.generation}/{progress.generations}, "
        f"{best}, hypervolume {progress.hypervolume:.4f}, {_speed(progress):.0f} candidates/s"
        f"{broken}, {_left(progress)} left"
    )


def _brief(progress: SearchProgress, seed: int | None) -> str:
    """The same for a narrow terminal."""
    which = "" if seed is None else f"seed {seed} "
    best = f"{progress.residual * 1e3:.2g} mm {progress.energy:.3g} J"
    best = "nothing yet" if isnan(progress.residual) else best
    return (
        f"{which}{progress.generation}/{progress.generations} {best} "
        f"hv {progress.hypervolume:.3f} {_speed(progress):.0f}/s "
        f"{_left(progress)} left"
    )


def _speed(progress: SearchProgress) -> float:
    return progress.evaluations / max(progress.seconds, 1e-9)


def _left(progress: SearchProgress) -> str:
    share = (progress.generations - progress.generation) / max(progress.generation, 1)
    seconds = share * progress.seconds
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min"
