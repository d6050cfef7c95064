"""The gradient as a part of a search, its work counted against the same budget."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics.budget.problem import BudgetProblem
from quietarm.ocp.front.curve import Curve
from quietarm.ocp.record import SolveSettings
from quietarm.ocp.solvers.problem import Solution

Array = NDArray[np.float64]
_BETWEEN = (0.25, 0.5, 0.75)
"""Residual limits of seeds between the ends, as shares of the cheapest motion's residual."""


class Gradient:
    """The gradient's solver on the move of a problem, every iteration counted.

    An iteration has the energy and the residual with their first and second derivatives. It counts
    as the evaluations that differences would take for these: 1 + n + n (n + 1) / 2 for n
    coefficients, 28 for six. What a solve gives is then evaluated like any candidate.
    """

    def __init__(self, problem: BudgetProblem, bound: float, seed: int) -> None:
        objective = problem.objective
        settings = SolveSettings(bound=bound, starts=1, seed=seed)
        self._curve = Curve.begin(objective.task, objective.profile, settings)
        self.iterations = 0
        self._problem, self._random = problem, np.random.default_rng(seed)
        self._lower, self._upper = objective.profile.box(bound)

    def solve(self, start: Array, residual_limit: float) -> Solution:
        """The least energy within a residual limit [m], from one start."""
        (found,) = self._curve.solver.solve([self._curve.problem(residual_limit)], [start])
        size = len(start)
        an_iteration = 1 + size + size * (size + 1) // 2
        self.iterations += found.iterations
        self._problem.spend(found.iterations * an_iteration)
        if found.status.solved:
            inside = np.clip(found.coefficients, self._lower, self._upper)
            self._problem.evaluate(inside[None, :])
        return found

    def random_start(self) -> Array:
        """Coefficients drawn evenly from the box."""
        return self._random.uniform(self._lower, self._upper)

    def seeds(self) -> Array:
        """Coefficients for a first population: both ends of the front and motions between.

        Each is found from a random start, so that nothing of the exact front is known beforehand.
        """
        cheapest = self.solve(self.random_start(), np.inf)
        reach = cheapest.residual if cheapest.status.solved else 0.0
        limits = [0.0, *(share * reach for share in _BETWEEN if reach > 0)]
        found = [cheapest, *(self.solve(self.random_start(), limit) for limit in limits)]
        rows = [one.coefficients for one in found if one.status.solved]
        return np.array(rows).reshape(-1, len(self._lower))

    def polish(self) -> None:
        """Improve what was found, each motion at its own residual, until the budget is spent.

        The motions are taken as far from each other as they can be: ends, middle, quarters, ...
        """
        X, F = self._problem.record.non_dominated()
        for i in _spread_out(np.argsort(F[:, 0]).tolist()):
            self.solve(X[i], float(F[i, 0]))

    def multistart(self) -> None:
        """Solve from random starts at random residual limits until the budget is spent."""
        reach = 0.0
        while True:
            limit = np.inf if reach == 0 else self._random.uniform(0.0, reach)
            found = self.solve(self.random_start(), limit)
            if found.status.solved:
                reach = max(reach, found.residual)
            if self._problem.record.left == 0:
                return


def _spread_out(ordered: list[int]) -> list[int]:
    """The same places, both ends first, then the middle, the quarters and so on."""
    last = len(ordered) - 1
    places = [0, last]
    step = 2
    while step <= 2 * max(last, 1):
        places += [round(last * odd / step) for odd in range(1, step, 2)]
        step *= 2
    return [ordered[place] for place in dict.fromkeys(places) if last >= 0]
