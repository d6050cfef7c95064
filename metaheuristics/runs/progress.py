"""Where a search is."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class SearchProgress:
    """Where a search is, after a generation.

    Attributes
    ----------
    generation, generations : int
        Generations done and asked for.
    residual, energy : float
        Least residual [m] and least energy [J] found, of different candidates as a rule.
    hypervolume : float
        Share of the reference box that is dominated.
    evaluations : int
        Candidates evaluated.
    seconds : float
        Time since the start of the run.
    failed, infeasible : int
        Candidates among them that were not finite, and that broke a limit of the task.
    """

    generation: int
    generations: int
    residual: float
    energy: float
    hypervolume: float
    evaluations: int
    seconds: float
    failed: int = 0
    infeasible: int = 0


Report = Callable[[SearchProgress], None]
_SHARE = 0.05


def now_and_then(report: Report, shortest: float, longest: float, begin: float) -> Report:
    """Report from so many seconds on, pausing so that it takes a small share of the time.

    The pauses are no shorter and no longer than these seconds: the first report may take long, as
    casadi builds what it needs.
    """
    due = time.perf_counter() + begin

    def after_generation(progress: SearchProgress) -> None:
        nonlocal due
        began = time.perf_counter()
        if began >= due:
            report(progress)
            ended = time.perf_counter()
            due = ended + min(max((ended - began) / _SHARE, shortest), longest)

    return after_generation
