"""An algorithm of pymoo whose population is arrays, so that a generation costs little."""

from __future__ import annotations

from typing import Any

import moocore
import numpy as np
from numpy.typing import NDArray
from pymoo.core.algorithm import Algorithm
from pymoo.core.population import Population
from pymoo.util.display.multi import MultiObjectiveOutput

Array = NDArray[np.float64]


class ArrayAlgorithm(Algorithm):
    """Proposes candidates as rows of an array, and learns from their values.

    Parameters
    ----------
    population : int
        Candidates of the first generation, uniform in the box.
    """

    # for the type checker: pymoo declares these as optional
    pop: Any
    opt: Any
    problem: Any
    random_state: Any

    def __init__(self, population: int) -> None:
        output: Any = MultiObjectiveOutput()  # for the type checker: pymoo declares a str
        super().__init__(output=output)
        self.population = population

    def propose(self) -> Array:
        """Candidates of the next generation, shape (candidates, variables), within the bounds."""
        raise NotImplementedError

    def learn(self, X: Array, F: Array, violation: Array) -> None:
        """Take the values of what was proposed; of the first generation, too.

        The violation is the sum of those of all constraints, shape (candidates,): 0 if feasible.
        """
        raise NotImplementedError

    @property
    def survivors(self) -> tuple[Array, Array, Array]:
        """Candidates, objectives and violations of the present population."""
        raise NotImplementedError

    def _setup(self, problem: Any, **options: Any) -> None:
        self.lower = problem.xl
        self.upper = problem.xu

    def _initialize_infill(self) -> Population:
        size = (self.population, self.problem.n_var)
        return Population.new(X=self.random_state.uniform(self.lower, self.upper, size))

    def _infill(self) -> Population:
        return Population.new(X=self.propose())

    def _advance(self, infills: Any = None, **options: Any) -> None:
        X, F, violation = infills.get("X", "F", "CV")
        self.learn(X, F, violation[:, 0])
        self.pop = infills

    _initialize_advance = _advance

    def _set_optimum(self) -> None:
        X, F, violation = self.survivors
        least = violation == violation.min()
        rows = np.flatnonzero(least)[moocore.is_nondominated(F[least])]
        self.opt = Population.new(X=X[rows], F=F[rows], CV=violation[rows][:, None])
