"""Vector evaluated particle swarm optimisation (VEPSO), as a pymoo algorithm.

One swarm per objective: a particle judges its own best by its swarm's objective and is drawn to the
best of the NEXT swarm in a ring [1]_. An archive of the non-dominated candidates is the front. Its
middle is thin, because the swarms gather at the minima of the single objectives.

References
----------
.. [1] K. E. Parsopoulos and M. N. Vrahatis, "Particle swarm optimization method in multiobjective
   problems", ACM Symposium on Applied Computing, 2002, pp. 603-607.
.. [2] M. Clerc and J. Kennedy, "The particle swarm - explosion, stability, and convergence in a
   multidimensional complex space", IEEE Trans. Evolutionary Computation 6(1), 2002, pp. 58-73.
.. [3] R. C. Eberhart and Y. Shi, "Comparing inertia weights and constriction factors in particle
   swarm optimization", Congress on Evolutionary Computation, 2000, pp. 84-88.
"""

from __future__ import annotations

import inspect
import math
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import moocore
import numpy as np
from numpy.typing import NDArray
from pymoo.core.algorithm import Algorithm
from pymoo.core.initialization import Initialization
from pymoo.core.population import Population
from pymoo.core.problem import Problem
from pymoo.operators.sampling.rnd import FloatRandomSampling
from pymoo.termination.max_gen import MaximumGenerationTermination
from pymoo.util.display.multi import MultiObjectiveOutput

Array = NDArray[Any]

STATE_VERSION = 1
STATE_ARRAYS = ("velocities", "best_X", "best_merit", "swarm_best")

UNUSABLE = 1e300
"""CV of a candidate without finite objectives. Not infinite: pymoo subtracts and averages CV."""


@dataclass(frozen=True)
class VelocityRule:
    """Constants of the velocity, v <- chi*(w*v + c1*r1*(own best - x) + c2*r2*(next best - x)).

    Parameters
    ----------
    inertia_start, inertia_end : float
        w of the first and of the last move, linear in between.
    constriction, cognitive, social : float
        chi, c1 and c2.

    Raises
    ------
    ValueError
        When a constant is negative or not finite, or the constriction is zero.
    """

    inertia_start: float
    inertia_end: float
    constriction: float
    cognitive: float
    social: float

    def __post_init__(self) -> None:
        for name, value in asdict(self).items():
            if not 0 <= value < math.inf:
                raise ValueError(f"{name} is {value}; give a finite number that is not negative")
        if self.constriction == 0:
            raise ValueError("constriction is 0, so nothing would move; give 1 for none")


INERTIA_2002 = VelocityRule(1.0, 0.4, 1.0, 0.5, 0.5)
"""The inertia variant of [1]_; it needs to know the number of iterations."""

CONSTRICTION = VelocityRule(1.0, 1.0, 0.729, 2.05, 2.05)
"""The constriction variant of [2]_."""

PAPER_GROUP = VelocityRule(1.0, 1.0, 0.73, 2.05, 2.05)
"""What the group of the reproduced paper states elsewhere; the paper itself states nothing."""


def clip(x: Array, v: Array, lower: Array, upper: Array) -> tuple[Array, Array]:
    """Stop at the bound what leaves the box: position on it, velocity zero, per coordinate."""
    inside = np.clip(x, lower, upper)
    return inside, np.where(inside == x, v, 0.0)


def reflect(x: Array, v: Array, lower: Array, upper: Array) -> tuple[Array, Array]:
    """Mirror at the bounds what leaves the box, as often as it takes; each time v turns round."""
    width = upper - lower
    period = np.where(width > 0, 2 * width, 1.0)  # any will do for a fixed variable
    way = np.mod(x - lower, period)
    outside = (x < lower) | (x > upper)  # elsewhere mod would only add rounding
    back = outside & (way > width)
    mirrored = np.clip(lower + np.where(back, period - way, way), lower, upper)
    return np.where(outside, mirrored, x), np.where(back, -v, v)


BOUNDARIES = {"clip": clip, "reflect": reflect}


def least_crowded(F: Array, size: int) -> Array:
    """Rows of F, shape (n, n_obj), that are left when the most crowded goes until `size` are left.

    Crowding distance as in NSGA-II, but one point at a time: without a whole cluster at once there
    would be a hole in the front.
    """
    kept = np.arange(len(F))
    while len(kept) > size:
        distance = np.zeros(len(kept))
        for f in F[kept].T:
            order = np.argsort(f, kind="stable")
            distance[order[[0, -1]]] = np.inf
            extent = f[order[-1]] - f[order[0]]
            distance[order[1:-1]] += (f[order[2:]] - f[order[:-2]]) / (extent or 1.0)
        kept = np.delete(kept, np.argmin(distance))
    return kept


class VEPSO(Algorithm):
    """VEPSO for any number of objectives.

    Every iteration, the first included, evaluates exactly n_obj * `particles` candidates. Bests are
    compared feasible first, then by violation, then by the swarm's objective; a tie is broken by
    the next objectives of the ring, lest a swarm rests where only its own is minimal. What has a
    NaN or infinite objective or violation becomes no best, and as little as what violates a
    constraint does it enter the archive. The archive is `opt` and the result; while it is empty,
    `opt` is the least infeasible particle, as usual in pymoo.

    Parameters
    ----------
    particles : int
        Particles in each swarm.
    rule : VelocityRule
        `CONSTRICTION`, `INERTIA_2002`, `PAPER_GROUP` or constants of your own.
    boundary : {"clip", "reflect"}
        What happens to a particle that leaves the box.
    velocity_limit : float
        Largest velocity of a coordinate as a fraction of its box; [3]_ advises 1.
    archive_size : int, optional
        Most points in the archive, from which the most crowded go; unbounded by default.
    iterations : int, optional
        Over how many the inertia changes; by default taken from an "n_gen" termination.
    sampling : Sampling or Population or array, optional
        First positions, shape (n_obj * particles, n_var), swarm after swarm; uniform by default.
    **options : Any
        What all pymoo algorithms take: seed, termination, callback and so on.

    Raises
    ------
    ValueError
        When an argument is out of range. In `setup`: when a variable has no finite bounds, or the
        inertia changes and the number of iterations is unknown.
    """

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
        super().__init__(**{"output": MultiObjectiveOutput(), **options})
        self.particles, self.rule, self.boundary = particles, rule, boundary
        self.velocity_limit, self.archive_size = velocity_limit, archive_size
        self.iterations = iterations
        self.sampling = FloatRandomSampling() if sampling is None else sampling
        for name, least in (("particles", 2), ("archive_size", 2), ("iterations", 1)):
            count = getattr(self, name)
            if count is None and name != "particles":
                continue
            if not isinstance(count, int | np.integer) or count < least:
                raise ValueError(f"{name} is {count!r}; give a whole number of at least {least}")
        if not isinstance(rule, VelocityRule):  # pyright: ignore[reportUnnecessaryIsInstance]
            raise ValueError(f"rule is {rule!r}; give a VelocityRule, as CONSTRICTION")
        if boundary not in BOUNDARIES:
            raise ValueError(f"boundary is {boundary!r}; give one of {', '.join(BOUNDARIES)}")
        if not 0 < velocity_limit < math.inf:
            raise ValueError(f"velocity_limit is {velocity_limit}; give a positive finite number")

    def _setup(self, problem: Problem, **kwargs: Any) -> None:
        if not (problem.has_bounds() and np.isfinite([problem.xl, problem.xu]).all()):
            raise ValueError("the problem has no finite bounds; give its xl and xu")
        self.lower, self.upper = problem.xl, problem.xu
        self.limit = self.velocity_limit * (self.upper - self.lower)
        self.horizon = self.iterations
        if self.horizon is None and isinstance(self.termination, MaximumGenerationTermination):
            self.horizon = self.termination.n_max_gen
        start, end = self.rule.inertia_start, self.rule.inertia_end
        if start != end and not (self.horizon and self.horizon < math.inf):
            raise ValueError(
                f"the inertia goes from {start} to {end} over an unknown number of iterations; "
                "give iterations=... or terminate with ('n_gen', ...)"
            )
        swarms = problem.n_obj
        self.shape = (swarms, self.particles, problem.n_var)
        # row s: swarm s, the next one in the ring, the one after it, ...
        self.ring = (np.arange(swarms)[:, None] + np.arange(swarms)) % swarms
        self.iteration = 0  # completed; unlike n_iter also right within a callback
        self.velocities, self.best_X = np.zeros(self.shape), np.zeros(self.shape)
        # violation, then the objectives in the order of the ring; infinite: none found yet
        self.best_merit = np.full((swarms, self.particles, 1 + swarms), np.inf)
        self.swarm_best = np.zeros(swarms, dtype=int)
        self.external_archive, self.archive_F = Population.empty(), np.empty((0, swarms))
        self.random_before = None  # state of the generator before the candidates still out

    def _initialize_infill(self) -> Population:
        self.random_before = self.random_state.bit_generator.state
        rows = (self.shape[0] * self.shape[1], self.shape[2])
        sampling = Initialization(self.sampling)
        X = sampling.do(self.problem, rows[0], random_state=self.random_state).get("X")
        X = X.astype(float)
        if X.shape != rows or not ((self.lower <= X) & (X <= self.upper)).all():
            raise ValueError(f"sampling gives shape {X.shape}; give {rows} within the bounds")
        # halfway towards a second random point: moving, but not all out of the box at once
        goal = self.random_state.uniform(self.lower, self.upper, self.shape)
        self.moved = np.clip(0.5 * (goal - X.reshape(self.shape)), -self.limit, self.limit)
        return Population.new(X=X)  # new, so that none counts as evaluated already

    def _infill(self) -> Population:
        self.random_before = self.random_state.bit_generator.state
        rule, x = self.rule, self.pop.get("X").reshape(self.shape)
        passed = (self.iteration - 1) / max(self.horizon - 2, 1) if self.horizon else 0.0
        inertia = rule.inertia_start + (rule.inertia_end - rule.inertia_start) * min(passed, 1.0)
        next_swarm = self.ring[:, 1 % len(self.ring)]
        best = (next_swarm, self.swarm_best[next_swarm])
        found = np.isfinite(self.best_merit[best][:, None, :1])  # else it draws nobody
        next_best = np.where(found, self.best_X[best][:, None], x)
        r1, r2 = self.random_state.random((2, *self.shape))
        pull = rule.cognitive * r1 * (self.best_X - x) + rule.social * r2 * (next_best - x)
        v = rule.constriction * (inertia * self.velocities + pull)
        v = np.clip(v, -self.limit, self.limit)
        x, self.moved = BOUNDARIES[self.boundary](x + v, v, self.lower, self.upper)
        return Population.new(X=x.reshape(-1, self.shape[2]))

    def _initialize_advance(self, infills: Population | None = None, **kwargs: Any) -> None:
        self._advance(infills)

    def _advance(self, infills: Population | None = None, **kwargs: Any) -> None:
        swarms, particles, _ = self.shape
        told = None if infills is None else infills.get("F").shape
        if infills is None or self.random_before is None or told != (swarms * particles, swarms):
            raise ValueError(
                f"objectives of shape {told} were told; ask, evaluate and tell all of the "
                f"{swarms * particles} candidates, in their order"
            )
        self.pop, self.velocities, self.random_before = infills, self.moved, None
        X, F = infills.get("X", "F")
        violation = _violations(infills)
        merit = np.take_along_axis(F.reshape(swarms, particles, -1), self.ring[:, None], axis=2)
        merit = np.concatenate([violation.reshape(swarms, particles, 1), merit], axis=2)
        merit[np.isinf(merit[..., 0])] = np.inf
        first_difference = (merit != self.best_merit).argmax(axis=2, keepdims=True)
        better = np.take_along_axis(merit < self.best_merit, first_difference, axis=2)
        self.best_merit = np.where(better, merit, self.best_merit)
        # where nothing usable was found yet, the best goes with the particle and does not pull
        better |= np.isinf(self.best_merit[..., :1])
        self.best_X = np.where(better, X.reshape(self.shape), self.best_X)
        self.swarm_best = np.lexsort(np.moveaxis(self.best_merit, 2, 0)[::-1])[:, 0]
        self._archive(infills[violation == 0], F[violation == 0])
        self.iteration += 1

    def _archive(self, candidates: Population, F: Array) -> None:
        F = np.concatenate([self.archive_F, F])
        kept = np.flatnonzero(moocore.is_nondominated(F))
        if self.archive_size is not None:
            kept = kept[least_crowded(F[kept], self.archive_size)]
        self.external_archive = Population.merge(self.external_archive, candidates)[kept]
        self.archive_F = F[kept]

    def _set_optimum(self) -> None:
        # never empty, which pymoo's terminations and displays could not bear
        least_infeasible = self.pop[[np.argmin(self.pop.get("CV"))]]
        self.opt = self.external_archive if len(self.external_archive) else least_infeasible

    def state(self) -> dict[str, Any]:
        """All that the run needs to go on, as of its last complete iteration: a nested plain dict.

        It holds numbers, arrays and NumPy's state of the generator; `restore` takes it. The best of
        swarm s has row s, column `swarm_best[s]` of `best_X` and `best_merit`; the latter holds the
        violation, then the objectives from s on round the ring. Settings are not part of it.
        """
        if self.iteration == 0:
            raise RuntimeError("there is no state before the first iteration; tell it first")
        return {
            "version": STATE_VERSION,
            "iteration": self.iteration,
            "evaluations": self.evaluator.n_eval,
            **{name: getattr(self, name).copy() for name in STATE_ARRAYS},
            "particles": _columns(self.pop),
            "archive": _columns(self.external_archive),
            "random_state": self.random_before or self.random_state.bit_generator.state,
        }

    def restore(self, state: Mapping[str, Any]) -> None:
        """Go on from a `state`, bit for bit; call it after `setup` with the settings of that run.

        Terminations by generations and evaluations count on, others and pymoo's history begin anew.

        Raises
        ------
        ValueError
            When the state is of another version, or of other numbers of particles or variables.
        """
        if state["version"] != STATE_VERSION:
            raise ValueError(f"the state has version {state['version']}; give {STATE_VERSION}")
        for name in STATE_ARRAYS:
            now, then = getattr(self, name), np.array(state[name])
            if then.shape != now.shape:
                raise ValueError(
                    f"{name} of the state has shape {then.shape} instead of {now.shape}; set up "
                    "with the problem and the particles of that run"
                )
            setattr(self, name, then.astype(now.dtype))
        self.pop, self.external_archive = map(_population, (state["particles"], state["archive"]))
        _violations(self.pop)
        self.archive_F = self.external_archive.get("F").reshape(-1, self.shape[0])
        self.random_state.bit_generator.state = state["random_state"]
        self.start_time, self.is_initialized, self.random_before = time.time(), True, None
        self.iteration = self.n_iter = state["iteration"]
        self.evaluator.n_eval = state["evaluations"]
        self._set_optimum()
        self.termination.update(self)
        self.n_iter += 1


def _violations(candidates: Population) -> Array:
    """Constraint violations, shape (n,); infinite, with a huge CV, where F or CV is not finite."""
    F, CV = candidates.get("F", "CV")
    violation = np.maximum(CV[:, 0], 0.0)
    violation[~(np.isfinite(F).all(axis=1) & np.isfinite(violation))] = np.inf
    for candidate in candidates[np.isinf(violation)]:
        candidate.CV = np.array([UNUSABLE])
    return violation


def _columns(population: Population) -> dict[str, Array]:
    return {key: population.get(key) for key in ("X", "F", "G", "H")}


def _population(columns: Mapping[str, Any]) -> Population:
    population = Population.new(**{key: np.array(value) for key, value in columns.items()})
    population.apply(lambda candidate: candidate.evaluated.update(("F", "G", "H")))
    return population
