"""A move as a pymoo problem that ends the search when its budget of evaluations is spent."""

from __future__ import annotations

import time
from typing import Any

import moocore
import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics.budget.record import Mark, Scale, Visits, marks_of
from quietarm.metaheuristics.objective.population import PopulationObjective
from quietarm.metaheuristics.objective.problem import UNUSABLE, MoveProblem

Array = NDArray[np.float64]


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
        self.budget, self.scale = budget, scale
        self.spent, self.marks, self.visits = 0, list[Mark](), Visits()
        self._ahead = list(marks_of(budget))[::-1]
        self._X, self._F = np.empty((0, self.n_var)), np.empty((0, 2))
        self._waiting: list[tuple[Array, Array]] = []
        self._began, self._recording = time.thread_time(), 0.0

    @property
    def seconds(self) -> float:
        """Processor time of the search until now, without that of the record [s]."""
        return time.thread_time() - self._began - self._recording

    @property
    def left(self) -> int:
        """Evaluations that are left."""
        return self.budget - self.spent

    def spend(self, evaluations: int) -> None:
        """Count work that is no candidate of this problem, as iterations of a solver."""
        nothing = np.empty((0, self.n_var)), np.empty((0, 2))
        while self._ahead and self.spent + evaluations >= self._ahead[-1]:
            evaluations -= self._ahead[-1] - self.spent
            self._move_on(*nothing, self._ahead[-1] - self.spent, self.seconds)
        self.spent += min(evaluations, self.left)
        if evaluations > 0 and self.left == 0:
            raise BudgetSpentError

    def non_dominated(self) -> tuple[Array, Array]:
        """Coefficients and objectives of all feasible candidates that no other dominates."""
        if self._waiting:
            X = np.vstack([self._X, *(part for part, _ in self._waiting)])
            F = np.vstack([self._F, *(part for _, part in self._waiting)])
            kept = np.flatnonzero(moocore.is_nondominated(F)) if len(F) else slice(0)
            self._X, self._F, self._waiting = X[kept], F[kept], []
        return self._X, self._F

    def _evaluate(self, x: NDArray[np.float64], out: dict[str, Any], *args: Any, **kwargs: Any):
        afforded = x[: self.left]
        if len(afforded):
            super()._evaluate(afforded, out, *args, **kwargs)
            seconds, first = self.seconds, 0
            usable = (out["F"] < UNUSABLE).all(axis=1)
            if self.n_ieq_constr:
                usable &= (out["G"] <= 0).all(axis=1)
            while first < len(afforded):
                until_mark = self._ahead[-1] - self.spent
                part = slice(first, first + until_mark)
                kept = usable[part]
                count = len(afforded[part])
                self._move_on(afforded[part][kept], out["F"][part][kept], count, seconds)
                first += count
        if len(afforded) < len(x):
            raise BudgetSpentError

    def _move_on(self, X: Array, F: Array, evaluations: int, seconds: float) -> None:
        """Count evaluations, up to the next mark at most, with what they gave."""
        began = time.thread_time()
        self.spent += evaluations
        if len(X):
            self._waiting.append((X.copy(), F.copy()))
            self.visits += Visits.of(self.scale.scaled(F))
        if self.spent == self._ahead[-1]:
            volume = self.scale.hypervolume(self.non_dominated()[1])
            self.marks.append(Mark(self._ahead.pop(), seconds, volume))
        self._recording += time.thread_time() - began
