"""A move as a pymoo problem that ends a search when its evaluations are spent."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics.objective.population import UNUSABLE
from quietarm.metaheuristics.problems.function import MoveFunction
from quietarm.metaheuristics.problems.pymoo_problem import MoveProblem
from quietarm.metaheuristics.record import Record


class BudgetSpentError(Exception):
    """Every evaluation is spent: the search is over, wherever it was."""


class CountedProblem(MoveProblem):
    """A move whose candidates are recorded; the last generation is cut short to the budget."""

    def __init__(self, function: MoveFunction, record: Record, budget: float) -> None:
        super().__init__(function)
        self.record, self.budget = record, budget

    def _evaluate(self, x: NDArray[np.float64], out: dict[str, Any], *args: Any, **kwargs: Any):
        left = self.budget - self.record.evaluations
        afforded = x if len(x) <= left else x[: int(left)]
        if len(afforded):
            super()._evaluate(afforded, out, *args, **kwargs)
            usable = (out["F"] < UNUSABLE).all(axis=1)
            if self.n_ieq_constr:
                usable &= (out["G"] <= 0).all(axis=1)
            self.record.add(afforded, out["F"], usable)
        if len(afforded) < len(x):
            raise BudgetSpentError
