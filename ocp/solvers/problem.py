"""The program that a solver is given, a task on its steps, and its solution."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Generic, Self, TypeVar

import daqp
import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.errors import SolveStatus
from quietarm.ocp.figures import ENERGY
from quietarm.ocp.limits import RESIDUAL, Limit
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import Setting
from quietarm.ocp.simulation.evaluator import Evaluation, Evaluator, RowValues
from quietarm.ocp.simulation.mesh import default_steps
from quietarm.ocp.solvers.batch import Batch, Derivatives, batch_of
from quietarm.ocp.task import PointToPoint

Array = NDArray[np.float64]
MOST_SOLVER_STEPS = 3200
"""The solver's steps are doubled up to this many."""
LEAST_ENERGY = {ENERGY: 1.0}
T = TypeVar("T")


class _OfSteps(Generic[T]):
    """A value of a program that follows from its task, profile and steps: computed once for all.

    Programs that differ in what they ask for alone share it.
    """

    def __init__(self, compute: Callable[[Program], T]) -> None:
        self._compute = compute
        self.__doc__ = compute.__doc__

    def __get__(self, program: Program, owner: type[Program] | None = None) -> T:
        known = program.computed
        name = self._compute.__name__
        if name not in known:
            known[name] = self._compute(program)
        return known[name]


@dataclass(frozen=True, eq=False)
class Program:
    """A nonlinear program over a profile's coefficients: a task on its steps, and what is asked.

    One objective is made of energy, residual and peaks; the residual and quantities are limited.

    Attributes
    ----------
    task, profile, steps
        What moves and where, how, and in how many steps.
    limits : tuple of Limit
        Of the residual, 0 for rest on arrival, and of quantities.
    bound : float or None
        Largest absolute coefficient, as the profile's `box` takes it.
    minimise : mapping of str to float
        Weights of the energy [1/J] and of at most one peak [1/m, ...], whose sum is minimised.
    offset : ndarray, shape (scenarios, 2 * modes), or 0
        Added to the state on arrival of every scenario [m, m/s]: what the steps miss of it.
    computed : dict
        What follows from task, profile and steps; shared by programs that have these in common.
    """

    task: PointToPoint
    profile: JointProfile
    steps: int
    limits: tuple[Limit, ...] = ()
    bound: float | None = None
    minimise: Mapping[str, float] = field(default_factory=lambda: LEAST_ENERGY)
    offset: NDArray[np.float64] | float = 0.0
    computed: dict[str, Any] = field(default_factory=dict, repr=False)

    @classmethod
    def of(cls, task: PointToPoint, profile: JointProfile, steps: int | None = None) -> Self:
        """Make the program on a number of steps, by default the usual one of task and profile."""
        return cls(task, profile, steps or first_steps(task, profile))

    def asking(self, **changes: Any) -> Self:
        """Return this program with other limits, bound, objective or offset, on the same steps."""
        return replace(self, **changes)

    def within(
        self,
        residual_limit: float = np.inf,
        bound: float | None = None,
        minimise: Mapping[str, float] = LEAST_ENERGY,
    ) -> Self:
        """Return the program of least energy, or another sum, within the task's limits.

        The residual [m] has a limit as well.
        """
        limits = Limit.of_residual(residual_limit, self.task.plant.tip_unit), *self.task.limits
        return self.asking(limits=limits, bound=bound, minimise=minimise, offset=0.0)

    def on_steps_of(self, other: Program) -> Self:
        """Return this program's question about the task of another program, on that one's steps."""
        return replace(
            self,
            task=other.task,
            profile=other.profile,
            steps=other.steps,
            computed=other.computed,
        )

    @_OfSteps
    def evaluator(self) -> Evaluator:
        """Evaluates candidates by these steps."""
        return Evaluator(self.task, self.profile, self.steps)

    @_OfSteps
    def batch(self) -> Batch:
        """The motions with derivatives that this program is evaluated by, in any scenario."""
        return batch_of(self.evaluator.simulation)

    @_OfSteps
    def errors(self) -> Array:
        """The plant's errors, shape (scenarios, ranges), the nominal one first."""
        return self.evaluator.scenarios

    @_OfSteps
    def wanted(self) -> Array:
        """The state that is wanted on arrival, shape (2 * modes,)."""
        return np.array(self.task.final_state)

    @_OfSteps
    def limits_of_task(self) -> dict[str, Limit]:
        """The task's limits by name; and one of the residual, which may have any size."""
        residual = Limit.of_residual(np.inf, self.task.plant.tip_unit)
        return {limit.name: limit for limit in (*self.task.limits, residual)}

    @property
    def tip_rows(self) -> list[Array]:
        """Rows that give tip displacements from the state on arrival, for each scenario."""
        return self.evaluator.tip_rows

    @_OfSteps
    def plain(self) -> Derivatives:
        """The plain motion, in all scenarios."""
        return self.evaluate(self.profile.plain)

    @_OfSteps
    def arrival_scale(self) -> Array:
        """Scale of the state on arrival, shape (2 * modes,)."""
        scale = np.abs(self.plain.arrival_jacobian).max(axis=(0, 2))
        scale[scale == 0] = 1.0
        return scale

    @_OfSteps
    def energy_scale(self) -> float:
        """Energy of the plain motion [J]."""
        return float(self.plain.energy[0]) or 1.0

    def scale_of(self, name: str) -> float:
        """Scale of the residual or of a limited quantity."""
        if name == RESIDUAL:
            return max(float(np.abs(r * self.arrival_scale).max()) for r in self.tip_rows) or 1.0
        return float(self.measure(self.plain).limited_peaks[name][0]) or 1.0

    @property
    def plain_residual(self) -> float:
        """Residual of the plain motion [m]."""
        return float(self.measure(self.plain).peaks[RESIDUAL][0])

    def evaluate(self, coefficients: Array) -> Derivatives:
        """One candidate in all scenarios."""
        return evaluate([self], coefficients[None])[0]

    def measure(self, values: RowValues, offset: Array | float = 0.0) -> Evaluation:
        """Evaluate a candidate's values in all scenarios, with an offset added to arrivals."""
        return self.evaluator.of_values(values, offset)

    @property
    def peak(self) -> str | None:
        """The residual or quantity whose peak is minimised."""
        return next((name for name in self.minimise if name != ENERGY), None)

    def weights(self, energy_scale: float, peak_scale: float) -> tuple[float, float]:
        """Weights of the scaled energy and of the scaled peak, the larger of them 1."""
        of_energy = self.minimise.get(ENERGY, 0.0) * energy_scale
        of_peak = self.minimise[self.peak] * peak_scale if self.peak else 0.0
        largest = max(of_energy, of_peak)
        return of_energy / largest, of_peak / largest

    @property
    def residual_limit(self) -> float:
        """Largest residual [m]; infinite where it is not limited."""
        return max((limit.size for limit in self.limits if limit.name == RESIDUAL), default=np.inf)

    @property
    def at_rest(self) -> bool:
        """Return whether the state on arrival has to be the wanted one."""
        return self.residual_limit == 0 and self.peak != RESIDUAL

    @property
    def bounds_residual(self) -> bool:
        """Return whether the residual stands in an inequality."""
        return self.peak == RESIDUAL or (np.isfinite(self.residual_limit) and not self.at_rest)


def first_steps(task: PointToPoint, profile: JointProfile) -> int:
    """Steps of the solver to begin with; ValueError where the move is too long for it."""
    # 8 for each term, since the power then changes sign more often, within 48 and 80; with limits
    # 80, since these hold only at the nodes.
    fewest = 80 if task.limits else 48
    of_profile = 8 * (profile.size - 2)
    least = min(max(fewest, of_profile), 80)
    at_once = task.plant.steps_at_once
    steps = at_once * math.ceil(default_steps(task, least=least) / at_once)
    if steps > MOST_SOLVER_STEPS:
        raise ValueError(
            f"duration is {task.duration:g} s, {steps / 2:.0f} radians of the plant's fastest "
            f"mode; the solver resolves up to {MOST_SOLVER_STEPS // 2}: give a shorter duration"
        )
    return steps


def evaluate(programs: Sequence[Program], coefficients: Array) -> list[Derivatives]:
    """A candidate of each of several programs of one batch, in all its scenarios.

    Coefficients have shape (programs, profile.size); all have as many scenarios.
    """
    derivatives = programs[0].batch.in_scenarios(
        coefficients,
        np.array([program.task.row for program in programs]),
        np.array([program.errors for program in programs]),
    )
    return [derivatives.take(i) for i in range(len(programs))]


def programs_of(tasks: Sequence[PointToPoint], profile: JointProfile, steps: int) -> list[Program]:
    """Many tasks of one plant, whose plain motions are evaluated in one call."""
    programs = [Program(task, profile, steps) for task in tasks]
    plain = np.repeat(profile.plain[None], len(programs), axis=0)
    for program, motion in zip(programs, evaluate(programs, plain)):
        program.computed["plain"] = motion
    return programs


@dataclass(frozen=True)
class Solution:
    """The solution that a solver finds from one start, in SI units and by its own steps.

    Attributes
    ----------
    coefficients : ndarray, shape (profile.size,)
        The profile's coefficients.
    energy : float
        Energy [J].
    peaks : mapping of str to float
        Residual [m] and each limited quantity [SI units] by name, as of `Limit.peak`, at the nodes.
    status : SolveStatus
        How it ended.
    iterations : int
        Iterations of the solver; `best_of_starts` adds those of the other starts.
    arrival : ndarray, shape (scenarios, 2 * modes)
        W [m] and then W' [m/s] on arrival in every scenario, with the program's offset.
    shadow_prices : mapping of str to float
        By how much the least energy falls if a limit is widened [J by the limit's unit]; of the
        residual, too, where rest on arrival is asked for.
    reason : str
        How it ended, in the solver's own words.
    solved_by : mapping of str to str, bool, int, float or None
        The solver that found it, with its options, as a record states them. It stays when the
        solution is corrected for what its steps miss.
    """

    coefficients: NDArray[np.float64]
    energy: float
    peaks: Mapping[str, float]
    status: SolveStatus
    iterations: int
    arrival: NDArray[np.float64]
    shadow_prices: Mapping[str, float] = field(default_factory=dict)
    reason: str = ""
    solved_by: Mapping[str, Setting] = field(default_factory=dict)

    @property
    def residual(self) -> float:
        """Residual [m] at the sampled times of the residual window."""
        return self.peaks[RESIDUAL]

    @property
    def slope(self) -> float:
        """Change of the least energy with the residual limit [J/m], at most 0."""
        return -self.shadow_prices.get(RESIDUAL, 0.0)


def shadow_prices(
    program: Program,
    of_energy: float,
    bounded: Mapping[str, NDArray[np.float64]],
    of_arrival: NDArray[np.float64],
    tips: NDArray[np.float64],
) -> dict[str, float]:
    """Return the decrease of the least energy per unit of each widened limit [J by its unit].

    Those of what is bounded, by name, and of the arrival are of SI units, and of an objective with
    the factor `of_energy` of the energy [1/J]. The tips are rows as of `price_of_rest`.
    """
    if of_energy == 0:
        return {}
    prices = {
        limit.name: limit.price(bounded[limit.name]) / of_energy
        for limit in program.limits
        if limit.name in bounded and limit.name != program.peak
    }
    if program.at_rest:
        prices[RESIDUAL] = price_of_rest(of_arrival, tips) / of_energy
    return prices


def price_of_rest(multipliers: NDArray[np.float64], rows: NDArray[np.float64]) -> float:
    """The most that the objective falls by for a residual of 1 m, from the arrival's multipliers.

    The largest product of the multipliers, shape (2 * modes,), and a state on arrival whose
    residual is 1 m by the rows, shape (rows, 2 * modes): a linear program, with a little curvature
    for the solver of quadratic ones.
    """
    scale = np.abs(rows).max(axis=0)
    slope = multipliers / scale
    table = rows / scale
    limit = np.ones(len(table))
    steepest = np.abs(slope).max() or 1.0
    # Curvature that makes a linear program a quadratic one.
    little = 1e-8
    state, *_ = daqp.solve(
        little * np.eye(len(slope)),
        -slope / steepest,
        table,
        limit,
        -limit,
    )
    return float(slope @ np.asarray(state))
