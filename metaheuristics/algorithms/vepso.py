"""Vector evaluated particle swarm optimisation (VEPSO), as a pymoo algorithm.

One swarm per objective: a particle judges its own best by its swarm's objective and is drawn to the
best of the NEXT swarm in a ring [1]_. An archive of the non-dominated candidates is the front. Its
middle is thin, because the swarms gather at the minima of the single objectives.

References
----------
.. [1] Parsopoulos and Vrahatis, ACM Symposium on Applied Computing, 2002, pp. 603-607.
.. [2] Eberhart and Shi, Congress on Evolutionary Computation, 2000, pp. 84-88.
"""

from __future__ import annotations

import inspect
import math
from dataclasses import asdict
from typing import Any

import moocore
import numpy as np
from pymoo.core.algorithm import Algorithm
from pymoo.core.initialization import Initialization
from pymoo.core.population import Population
from pymoo.operators.sampling.rnd import FloatRandomSampling
from pymoo.operators.survival.rank_and_crowding.metrics import calc_crowding_distance
from pymoo.util.display.multi import MultiObjectiveOutput

from quietarm.metaheuristics.algorithms.velocity import (
    BOUNDARIES,
    CONSTRICTION,
    Array,
    VelocityRule,
)
from quietarm.metaheuristics.evaluation.population import UNUSABLE
from quietarm.ocp.checks import positive, whole


def least_crowded(F: Array, size: int) -> Array:
    """Rows of F, shape (n, n_obj), left when the most crowded one goes until `size` are left.

    One at a time: dropping a whole cluster at once would leave a hole in the front.
    """
    rows = np.arange(len(F))
    while len(rows) > size:
        rows = np.delete(rows, np.argmin(calc_crowding_distance(F[rows])))
    return rows


class VEPSO(Algorithm):
    """VEPSO for any number of objectives.

    Every iteration, the first included, evaluates exactly n_obj * `particles` candidates. The best
    of two candidates is the one with the smaller constraint violation; then the one with the
    smaller objective of the swarm; then, so that a tie does not stop the swarm, of the next swarms
    in the ring. A candidate with a NaN or infinite objective or violation is never a best. The
    archive takes neither those nor any that violate a constraint. It is `opt` and the result; while
    it is empty, `opt` is the least infeasible particle, as usual in pymoo.

    Parameters
    ----------
    particles : int
        Particles in each swarm.
    rule : VelocityRule
        `CONSTRICTION`, `INERTIA_2002`, `PAPER_GROUP` or constants of your own.
    boundary : {"clip", "reflect"}
        What happens to a particle beyond the box.
    velocity_limit : float
        Largest velocity of a coordinate as a fraction of its box; Eberhart and Shi (2000) advise 1.
    archive_size : int, optional
        Most points in the archive; beyond it the most crowded are dropped. Unbounded by default.
    iterations : int, optional
        Number over which the inertia changes; by default taken from an "n_gen" termination.
    sampling : Sampling or Population or array, optional
        First positions, shape (n_obj * particles, n_var), swarm after swarm; uniform by default.
    **options : Any
        What all pymoo algorithms take: seed, termination, callback and so on.

    Raises
    ------
    ValueError
        When an argument is out of range; in `setup`, when a variable has no finite bounds, or the
        number of iterations over which the inertia changes is not known.
    """

    pop: Any  # for the type checker: pymoo declares these as optional
    opt: Any
    n_iter: Any
    random_state: Any
    termination: Any

    def __init__(
        self,
        particles: int = 100,
        rule: VelocityRule = CONSTRICTION,
        boundary: str = "clip",
        velocity_limit: float = 1.0,
        archive_size: int | None = None,
        iterations: int | None = None,
        sampling: Any = None,
        **options: Any,
    ) -> None:
        # pymoo would ignore a misspelt option without a word
        if unknown := options.keys() - inspect.signature(Algorithm).parameters.keys():
            raise TypeError(f"VEPSO has no option {', '.join(sorted(unknown))}")
        options.setdefault("output", MultiObjectiveOutput())
        super().__init__(**options)
        self.particles = whole("particles", particles, 2)
        self.archive_size = archive_size
        self.iterations = iterations
        if archive_size is not None:
            self.archive_size = whole("archive_size", archive_size, 2)
        if iterations is not None:
            self.iterations = whole("iterations", iterations, 1)
        self.rule = rule
        self.boundary = boundary
        self.velocity_limit = positive("velocity_limit", velocity_limit)
        self.sampling = FloatRandomSampling() if sampling is None else sampling
        if boundary not in tuple(BOUNDARIES):
            raise ValueError(f"boundary is {boundary!r}; give one of {', '.join(BOUNDARIES)}")

    def _setup(self, problem: Any, **kwargs: Any) -> None:
        if not (problem.has_bounds() and np.isfinite([problem.xl, problem.xu]).all()):
            raise ValueError("the problem has no finite bounds; give its xl and xu")
        self.lower = problem.xl
        self.upper = problem.xu
        self.limit = self.velocity_limit * (self.upper - self.lower)
        self.horizon = (
            self.iterations
            or getattr(
                self.termination,
                "n_max_gen",
                None,
            )
            or math.inf
        )
        if self.rule.inertia_start != self.rule.inertia_end and self.horizon == math.inf:
            raise ValueError(
                "the inertia changes until the last iteration, which is not known; give iterations "
                "or n_gen"
            )
        swarms = problem.n_obj
        self.shape = (swarms, self.particles, problem.n_var)
        # row s: swarm s, the next one in the ring, the one after it, ...
        self.ring = (np.arange(swarms)[:, None] + np.arange(swarms)) % swarms
        self.iteration = 0  # completed ones; unlike n_iter also right in a callback
        self.velocities = np.zeros(self.shape)
        self.best_X = np.zeros(self.shape)
        # violation, then the objectives in the order of the ring; infinite: none found yet
        self.best_merit = np.full((swarms, self.particles, 1 + swarms), np.inf)
        self.swarm_best = np.zeros(swarms, dtype=int)
        self.external_archive = Population.empty()
        self.archive_F = np.empty((0, swarms))

    def _initialize_infill(self) -> Population:
        rows = (self.shape[0] * self.particles, self.shape[2])
        sampling = Initialization(self.sampling)
        X = sampling.do(
            self.problem,
            rows[0],
            random_state=self.random_state,
        ).get("X")
        if X.shape != rows or not ((self.lower <= X) & (self.upper >= X)).all():
            raise ValueError(f"sampling gives shape {X.shape}; give {rows}, within the bounds")
        # halfway towards a second random point: moving, but not all out of the box at once
        goal = self.random_state.uniform(self.lower, self.upper, self.shape)
        self.moved = np.clip(
            0.5 * (goal - X.reshape(self.shape)),
            -self.limit,
            self.limit,
        )
        return Population.new(X=X.astype(float))  # new, so that none counts as evaluated already

    def _infill(self) -> Population:
        rule = self.rule
        x = self.pop.get("X").reshape(self.shape)
        passed = min((self.iteration - 1) / max(self.horizon - 2, 1), 1.0)
        inertia = rule.inertia_start + (rule.inertia_end - rule.inertia_start) * passed
        next_swarm = self.ring[:, 1 % len(self.ring)]
        best = (next_swarm, self.swarm_best[next_swarm])
        has_best = np.isfinite(self.best_merit[best][:, None, :1])  # else it draws nobody
        next_best = np.where(has_best, self.best_X[best][:, None], x)
        r1, r2 = self.random_state.random((2, *self.shape))
        pull = rule.cognitive * r1 * (self.best_X - x) + rule.social * r2 * (next_best - x)
        v = rule.constriction * (inertia * self.velocities + pull)
        v = v.clip(-self.limit, self.limit)
        x, self.moved = BOUNDARIES[self.boundary](x + v, v, self.lower, self.upper)
        return Population.new(X=x.reshape(-1, self.shape[2]))

    def _advance(self, infills: Any = None, **kwargs: Any) -> None:
        swarms, particles, _ = self.shape
        X, F = infills.get("X", "F")
        self.pop = infills
        self.velocities = self.moved
        violation = _violations(infills, F)
        merit = np.take_along_axis(
            F.reshape(swarms, particles, -1),
            self.ring[:, None],
            axis=2,
        )
        merit = np.concatenate(
            [
                violation.reshape(
                    swarms,
                    particles,
                    1,
                ),
                merit,
            ],
            axis=2,
        )
        merit[np.isinf(merit[..., 0])] = np.inf
        first_difference = (merit != self.best_merit).argmax(axis=2, keepdims=True)
        better = np.take_along_axis(
            merit < self.best_merit,
            first_difference,
            axis=2,
        )
        self.best_merit = np.where(better, merit, self.best_merit)
        # a particle that found nothing usable yet is its own best, which does not pull
        better |= np.isinf(self.best_merit[..., :1])
        self.best_X = np.where(better, X.reshape(self.shape), self.best_X)
        self.swarm_best = np.lexsort(np.moveaxis(self.best_merit, 2, 0)[::-1])[:, 0]
        front: Any = Population.merge(self.external_archive, infills[violation == 0])
        F = np.concatenate([self.archive_F, F[violation == 0]])
        rows = np.flatnonzero(moocore.is_nondominated(F))
        if self.archive_size is not None:
            rows = rows[least_crowded(F[rows], self.archive_size)]
        self.external_archive = front[rows]
        self.archive_F = F[rows]
        self.iteration += 1

    _initialize_advance = _advance

    def _set_optimum(self) -> None:
        self.opt = self.external_archive
        if len(self.opt) == 0:  # which pymoo's terminations and displays could not bear
            self.opt = self.pop[[np.argmin(self.pop.get("CV"))]]

    @property
    def settings(self) -> dict[str, Any]:
        """Settings of the swarms in plain numbers and words."""
        names = ("particles", "boundary", "velocity_limit", "archive_size", "iterations")
        return {**{name: getattr(self, name) for name in names}, **asdict(self.rule)}


def _violations(candidates: Any, F: Array) -> Array:
    """Constraint violations, shape (n,); infinite, with a huge CV, where F or CV is not finite."""
    CV = candidates.get("CV")[:, 0]
    violation = np.where(np.isfinite(F).all(axis=1) & np.isfinite(CV), CV, np.inf)
    for candidate in candidates[np.isinf(violation)]:
        candidate.CV = np.array([UNUSABLE])  # not infinite: pymoo subtracts and averages
    return np.maximum(violation, 0.0)
