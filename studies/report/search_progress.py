"""Progress of searches: bars on a terminal, plain lines elsewhere."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from math import isnan

from quietarm.metaheuristics import SearchProgress
from quietarm.ocp import Front
from quietarm.studies.report.progress import WORDS, Lines, bars
from quietarm.studies.report.words import millimetres, print_lines
from rich.console import Console
from rich.progress import BarColumn, Progress, TimeRemainingColumn


@contextmanager
def search_display(console: Console) -> Iterator[SearchDisplay]:
    """Show a search's generation, best residual, least energy, hypervolume, speed and time left."""
    columns = BarColumn(bar_width=12), TimeRemainingColumn(), WORDS
    with bars(console, *columns) as shown:
        yield SearchDisplay(shown, Lines(console))


class SearchDisplay:
    """Called with every generation of one search, and with every search that ends."""

    def __init__(self, shown: Progress, lines: Lines) -> None:
        self._bars, self._lines = shown, lines
        self._task = shown.add_task("", visible=False)

    def __call__(self, progress: SearchProgress) -> None:
        """Show where the only search is."""
        done, total = progress.generation, progress.generations
        self._bars.update(
            self._task, completed=done, total=total, description=_brief(progress), visible=True
        )
        self._lines.say(_figures(progress), last=done == total)

    def finish(self, front: Front) -> None:
        """Show what a search found."""
        print_lines(self._lines.console, _found(front))


def _found(front: Front) -> str:
    share = front.history[-1].hypervolume if front.history else 0.0
    return (
        f"seed {front.record.seed} is done: hypervolume {share:.4f} in {front.record.seconds:.1f} s"
    )


def _figures(progress: SearchProgress) -> str:
    done, total = progress.generation, progress.generations
    left = progress.seconds * (total - done) / max(done, 1)
    share = progress.infeasible / max(progress.evaluations, 1)
    best = f"residual {millimetres(progress.residual)}, energy {progress.energy:.4g} J"
    best = "nothing found yet" if isnan(progress.residual) else best
    broken = f" ({share:.0%} break a limit)" if progress.infeasible else ""
    return (
        f"generation {done}/{total}, {best}, hypervolume {progress.hypervolume:.4f}, "
        f"{_speed(progress):.0f} candidates/s{broken}, {left:.0f} s left"
    )


def _brief(progress: SearchProgress) -> str:
    """The same for a bar, which has little room."""
    return (
        f"{progress.generation}/{progress.generations} {progress.residual * 1e3:.2g} mm "
        f"{progress.energy:.3g} J hv {progress.hypervolume:.3f} {_speed(progress):.0f}/s"
    )


def _speed(progress: SearchProgress) -> float:
    return progress.evaluations / max(progress.seconds, 1e-9)
