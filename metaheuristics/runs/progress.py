"""Where a search is."""

from __future__ import annotations

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
