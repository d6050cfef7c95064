"""A problem as a pymoo problem, which knows its reference front."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.core.problem import Problem

from quietarm.metaheuristics.problems.problem_function import ProblemFunction
from quietarm.ocp.checks import whole


class PymooProblem(Problem):
    """A move, or another function, for any algorithm or indicator of pymoo.

    ``pareto_front()`` and ``pareto_set()`` give the reference front where one is known, else None.

    Parameters
    ----------
    function : ProblemFunction
        What is minimised.
    pareto_set : ndarray, shape (points, variables), optional
        Coefficients of the reference front.
    pareto_front : ndarray, shape (points, objectives), optional
        Its objectives.
    """

    def __init__(
        self,
        function: ProblemFunction,
        pareto_set: NDArray[np.float64] | None = None,
        pareto_front: NDArray[np.float64] | None = None,
    ) -> None:
        super().__init__(
            n_var=len(function.variables),
            n_obj=len(function.objectives),
            n_ieq_constr=len(function.constraints),
            xl=function.lower,
            xu=function.upper,
        )
        self.function = function
        self._set = pareto_set
        self._front = pareto_front

    def _evaluate(self, x: NDArray[np.float64], out: dict[str, Any], *args: Any, **kwargs: Any):
        out["F"], violations = self.function(x)
        if violations.shape[1]:
            out["G"] = violations

    # pymoo's own keep what they gave first, whatever number is asked for next

    def pareto_front(self, n_points: int | None = None) -> Any:
        """The reference front, all of its points or so many."""
        return _evenly(self._front, n_points)

    def pareto_set(self, n_points: int | None = None) -> Any:
        """Coefficients of the points of the reference front."""
        return _evenly(self._set, n_points)


def _evenly(rows: NDArray[np.float64] | None, count: int | None) -> NDArray[np.float64] | None:
    """So many rows at even distances in their order; all where no number is given."""
    if rows is None or count is None:
        return rows
    count = whole(
        "n_points",
        count,
        2,
        len(rows),
        "the reference front has no more",
    )
    return rows[np.linspace(0, len(rows) - 1, count).round().astype(int)]
