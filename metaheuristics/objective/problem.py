"""A task as a pymoo problem, which counts the candidates that fail."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.core.problem import Problem
from quietarm.metaheuristics.objective.population import PopulationObjective, replace_failures


class MoveProblem(Problem):
    """A task as a pymoo problem: minimise residual [m] and energy [J] over a box.

    Parameters
    ----------
    objective : PopulationObjective
        What is minimised; the task's limits become inequality constraints.
    bound : float
        Largest absolute coefficient, as the profile's `box` takes it.

    Attributes
    ----------
    failed : int
        Candidates so far whose objectives or violations were not finite.
    infeasible : int
        Candidates so far that were finite and broke a limit.
    """

    def __init__(self, objective: PopulationObjective, bound: float) -> None:
        lower, upper = objective.profile.box(bound)
        super().__init__(
            n_var=objective.profile.size,
            n_obj=2,
            n_ieq_constr=len(objective.task.limits),
            xl=lower,
            xu=upper,
        )
        self.objective, self.failed, self.infeasible = objective, 0, 0

    def figures(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Residual [m], energy [J] and violations of candidates, a row each."""
        values = self.objective(x)
        return np.column_stack([values.residual, values.energy, values.violations])

    def _evaluate(self, x: NDArray[np.float64], out: dict[str, Any], *args: Any, **kwargs: Any):
        table = self.figures(x)
        failed = replace_failures(table)
        self.failed += int(failed.sum())
        self.infeasible += int((table[~failed, 2:] > 0).any(axis=1).sum())
        out["F"] = table[:, :2]
        if table.shape[1] > 2:
            out["G"] = table[:, 2:]
