"""A memetic search: MOEA/D-DE some of whose candidates take steps of the gradient in between.

Every few generations some candidates of the present front, at even distances along it, start the
solver of `epsilon_front` for a few iterations: the least energy within the residual that each has.
The one of least residual is led to rest, the cheapest to the least energy of all. What comes of it
competes with all individuals, as offspring do. The solver ends on the limits of a move, and the
verification sees peaks between the steps of a search: it keeps the share `kept_free` of each free.

An evaluation with derivatives counts as many candidates as differences would have taken: one more
than there are coefficients. Its processor time is that of the search.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import moocore
import numpy as np
from numpy.typing import NDArray

from quietarm.metaheuristics.algorithms.array_algorithm import Array
from quietarm.metaheuristics.algorithms.moead_de import ScaledMOEAD
from quietarm.metaheuristics.evaluation.population import search_steps
from quietarm.metaheuristics.problems.recorded import RecordedFunction
from quietarm.ocp.cost import COST
from quietarm.ocp.front.tradeoff import Tradeoff
from quietarm.ocp.planning.request import Request
from quietarm.ocp.solvers.problem import Program
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp

Rows = NDArray[np.int64]


class MemeticMOEAD(ScaledMOEAD):
    """MOEA/D-DE with steps of the gradient.

    Parameters
    ----------
    ref_dirs : ndarray, shape (population, 2)
        As of `ScaledMOEAD`, whose settings it has as well.
    gradient_every : int
        Generations from one time to the next.
    gradient_points : int
        Candidates that are improved at a time.
    gradient_iterations : int
        Iterations of the solver for each.
    solver : Solver
        The solver, with its options but for these iterations.
    **settings : Any
        As of `ScaledMOEAD`.
    """

    def __init__(
        self,
        ref_dirs: Array,
        gradient_every: int = 10,
        gradient_points: int = 10,
        gradient_iterations: int = 5,
        solver: Solver = Sqp(),
        **settings: Any,
    ) -> None:
        super().__init__(ref_dirs, **settings)
        self.gradient_every = gradient_every
        self.gradient_points = gradient_points
        self.solver = replace(solver, iterations=gradient_iterations)

    def _setup(self, problem: Any, **options: Any) -> None:
        function = getattr(problem, "function", None)
        if (
            not isinstance(function, RecordedFunction)
            or not function.of_model
            or problem.n_obj != 2
        ):
            raise ValueError(
                "memetic takes derivatives of a move's residual and energy, and this problem has "
                "none, or more objectives; choose a method without derivatives, such as moead-de"
            )
        super()._setup(problem, **options)
        self._function = function
        steps = search_steps(function.task, function.profile)
        request = Request(
            function.task, function.profile, self.solver, function.bound, starts=1, steps=steps
        )
        self._tradeoff = Tradeoff.begin(request)

    def propose(self) -> Array:
        """The offspring, and after them what the gradient improves in this generation."""
        offspring = super().propose()
        generation: Any = self.n_iter
        if generation % self.gradient_every:
            return offspring
        improved = self._improved()
        of_all = np.zeros(len(improved), dtype=bool)
        self.among_neighbours = np.append(self.among_neighbours, of_all)
        return np.vstack([offspring, improved])

    def _improved(self) -> Array:
        """Some candidates of the front after steps of the gradient; none where none is feasible."""
        X, F, violation = self.survivors
        rows = np.flatnonzero(violation <= 0)
        if not len(rows):
            return X[:0]
        rows = rows[moocore.is_nondominated(F[rows])]
        rows = rows[spread(F[rows], self.gradient_points)]
        limits = F[rows, 0]
        limits[0] = 0.0
        limits[-1] = np.inf
        before = COST.copy()
        problems = [self._within(float(limit)) for limit in limits]
        solutions = self._tradeoff.solver.solve(problems, list(X[rows]), warm=True)
        spent = COST.since(before)
        of_gradient = 1 + X.shape[1]
        scenarios = len(self._tradeoff.program.errors)
        self._function.charge((spent.gradients * of_gradient + spent.candidates) // scenarios)
        improved = np.array([solution.coefficients for solution in solutions])
        improved = improved[np.isfinite(improved).all(axis=1)]
        return np.clip(improved, self.lower, self.upper)

    def _within(self, residual_limit: float) -> Program:
        """The program at a residual limit, with room in the limits of the task."""
        program = self._tradeoff.problem(residual_limit)
        residual, *limits = program.limits
        ratio = 1 / (1 - self._function.kept_free)
        return program.asking(limits=(residual, *(limit.tightened(ratio) for limit in limits)))


def spread(F: Array, count: int) -> Rows:
    """Rows of at most so many points at even distances along a front of two objectives.

    They are in the order of the first objective, from its least to its largest.
    """
    order = np.argsort(F[:, 0])
    span = np.ptp(F, axis=0)
    scaled = F[order] / np.where(span > 0, span, 1.0)
    along = np.append(0.0, np.cumsum(np.hypot(*np.diff(scaled, axis=0).T)))
    places = np.searchsorted(along, np.linspace(0.0, along[-1], count))
    return order[np.unique(places.clip(0, len(order) - 1))]
