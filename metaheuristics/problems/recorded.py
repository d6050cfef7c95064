"""A problem's function that keeps what another library asks of it, as a job keeps its own."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.metaheuristics.objective.population import UNUSABLE
from quietarm.metaheuristics.problems.function import MoveFunction
from quietarm.metaheuristics.quality import measured
from quietarm.metaheuristics.record import Record
from quietarm.ocp import Front
from quietarm.ocp.checks import whole
from quietarm.ocp.front.points import table_of

if TYPE_CHECKING:
    from quietarm.metaheuristics.problems.catalogue import NamedProblem

Array = NDArray[np.float64]
_ROUNDING = 1e-9
"""Share of the box by which scaling from another may pass it."""


class RecordedFunction(MoveFunction):
    """A problem's function that records non-dominated candidates, and quality during the run.

    It has the accuracy of all searches.

    Parameters
    ----------
    problem : NamedProblem
        A problem with two objectives; ValueError when it has a third.
    """

    def __init__(self, problem: NamedProblem) -> None:
        super().__init__(problem.task, problem.profile, bound=problem.bound)
        self.problem = problem
        self.record = Record(self.task, len(self.variables), problem.reference())

    def __call__(self, candidates: ArrayLike) -> tuple[Array, Array]:
        """Evaluate candidates, as `MoveFunction` does, and keep them.

        ValueError also when a coefficient is beyond the box, or is no number.
        """
        table = table_of(candidates, len(self.variables))
        inside = np.clip(table, self.lower, self.upper)
        beyond = np.argwhere(~(np.abs(table - inside) <= _ROUNDING * (self.upper - self.lower)))
        if len(beyond):
            row, column = beyond[0]
            raise ValueError(
                f"{self.variables[column]} of candidate {self.record.evaluations + row + 1} is "
                f"{table[row, column]:.4g}, not from {self.lower[column]:.4g} to "
                f"{self.upper[column]:.4g}; clip candidates to the function's lower and upper"
            )
        found, violations = super().__call__(inside)
        usable: Any = np.concatenate([found < UNUSABLE, violations <= 0], axis=1).all(axis=1)
        self.record.add(inside, found, usable)
        return found, violations

    def front(self, method: str, seed: int | None = None) -> Front:
        """The candidates until now, as the front of a method; ValueError if there are none."""
        if not self.record.evaluations:
            raise ValueError("no candidate was asked for; let the library call the function first")
        seed = None if seed is None else whole("seed", seed, 0)
        settings: dict[str, Any] = {"bound": self.bound, "problem": self.problem.name}
        found = self.record.front(
            self.task, self.profile, method=method, settings=settings, seed=seed
        )
        return measured(found, self.problem.reference())

    def save(self, path: str | Path, method: str, seed: int | None = None) -> None:
        """Write the run as a file for ``quietarm bench --import``; arguments as for `front`."""
        self.front(method, seed).save(path)
