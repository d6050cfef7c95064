"""Candidates that a method asks for at once: what its time is on many cores.

An evaluation takes one unit of time on one core. So a call for `b` candidates takes the smallest
whole number of units that is at least `b / cores`, and a run the sum over its calls.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import quietarm as qa
from quietarm.metaheuristics import MoveFunction

from .moves import Move
from .plan import first_of_plants
from .problems import Case
from .tables import write_table

CORES = 100
MEASURED = (
    ("gde3", {}, 10_000),
    ("moead-de", {}, 10_000),
    ("nsga2", {}, 10_000),
    ("mo-cma-es", {}, 10_000),
    ("slsqp", {}, 10_000),
    ("slsqp", {"continuation": False}, 10_000),
    ("es", {}, 1_000),
)
"""Methods, settings and candidates; one seed on the first move of each plant."""


class CountedFunction:
    """A move as a function of many candidates that keeps how many each call had."""

    def __init__(self, case: Case) -> None:
        self.move = MoveFunction(case.task, case.profile, bound=case.bound)
        self.sizes = list[int]()

    def __call__(self, candidates: NDArray[np.float64]) -> NDArray[np.float64]:
        """Residual and energy of each candidate."""
        self.sizes.append(len(candidates))
        return self.move(candidates)[0]


def time_of(calls: Sequence[int], cores: int) -> int:
    """Evaluations that follow one another where calls for so many run on so many cores."""
    return sum(ceil(candidates / cores) for candidates in calls)


def write_batches(moves: Sequence[Move], path: Path) -> None:
    """Measure the calls of all methods, and write them as a table."""
    tested = [move for move in moves if not move.tuning]
    rows = list[dict[str, object]]()
    for move in first_of_plants(tested, 1):
        case = Case(move)
        for method, settings, budget in MEASURED:
            function = CountedFunction(case)
            qa.search(
                function,
                lower=function.move.lower,
                upper=function.move.upper,
                algorithm=method,
                settings=settings,
                evaluations=budget,
                vectorized=True,
            )
            rows.append(
                {
                    "problem": case.name,
                    "method": method,
                    "settings": " ".join(f"{name}={value}" for name, value in settings.items()),
                    "candidates": sum(function.sizes),
                    "calls": len(function.sizes),
                    "largest_call": max(function.sizes),
                    f"time_on_{CORES}_cores": time_of(function.sizes, CORES),
                }
            )
    write_table(pd.DataFrame(rows), path, 10)
