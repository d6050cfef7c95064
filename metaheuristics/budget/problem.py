"""A move as a pymoo problem that ends the search when its budget of evaluations is spent."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics.budget.record import Record, Scale
from quietarm.metaheuristics.objective.population import UNUSABLE, PopulationObjective
from quietarm.metaheuristics.objective.problem import MoveProblem


class BudgetSpentError(Exception):
    """Every evaluation is spent: the search is over, wherever it was."""


class BudgetProblem(MoveProblem):
    """A move whose candidates are counted, and kept where no other dominates them.

    The last generation is cut short where the budget does not suffice for it, so that every search
    has exactly as many evaluations as any other.
    """

    def __init__(
        self, objective: PopulationObjective, bound: float, budget: int, scale: Scale
    ) -> None:
        super().__init__(objective, bound)
        self.record = Record(budget, scale, self.n_var)
        self._began, self._recording = time.thread_time(), 0.0

    @property
    def seconds(self) -> float:
        """Processor time of the search until now, without that of the record [s]."""
        return time.thread_time() - self._began - self._recording

    def spend(self, evaluations: int) -> None:
        """Count work that is no candidate of this problem, as iterations of a solver."""
        record, seconds = self.record, self.seconds
        until = record.spent + evaluations
        while record.left and record.spent < until:
            record.move_on(min(record.until_mark, until - record.spent), seconds)
        if record.spent < until:
            raise BudgetSpentError

    def _evaluate(self, x: NDArray[np.float64], out: dict[str, Any], *args: Any, **kwargs: Any):
        afforded = x[: self.record.left]
        if len(afforded):
            super()._evaluate(afforded, out, *args, **kwargs)
            seconds = self.seconds
            usable = (out["F"] < UNUSABLE).all(axis=1)
            if self.n_ieq_constr:
                usable &= (out["G"] <= 0).all(axis=1)
            began = time.thread_time()
            self.record.add(afforded, out["F"], usable, seconds)
            self._recording += time.thread_time() - began
        if len(afforded) < len(x):
            raise BudgetSpentError
