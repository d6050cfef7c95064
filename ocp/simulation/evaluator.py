"""Candidates in every scenario by fixed steps: what each costs, leaves, and asks of the joint.

One evaluation serves the searches, the plans' verification, robustness and grids.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import Self

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.interrupts import interruptible
from quietarm.models.compiled import RECENT
from quietarm.models.one_thread import on_one_thread
from quietarm.ocp.checks import instance, numbers, table_of, takes, whole
from quietarm.ocp.cost import COST
from quietarm.ocp.limits import RESIDUAL, Limit, Quantity
from quietarm.ocp.profiles.check_profile import check_profile
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.collocation import NODES
from quietarm.ocp.simulation.free_vibration import FreeVibration, after_arrival
from quietarm.ocp.simulation.mesh import default_steps
from quietarm.ocp.simulation.rollout import Simulation, places_of
from quietarm.ocp.simulation.rows import RowFunction, copy_rows, join, widen
from quietarm.ocp.task import PointToPoint
from quietarm.ocp.uncertainty import perturb_plant

Array = NDArray[np.float64]
MOST_STEPS_OF_CSE = 48
"""Common terms are looked for up to these steps: that takes a tenth off a call, but doubles the
time to build it, and grows with the square of the steps."""


@dataclass(frozen=True)
class RowValues:
    """Simulated values of candidates: energy [J], state on arrival, limited quantities.

    Shapes are (rows,), (rows, 2 * modes) and (rows, values); `places_of` a simulation tells which
    value is of which quantity.
    """

    energy: Array
    arrival: Array
    limited: Array

    def take(self, row: int) -> Self:
        """One row, or of arrays by candidate and scenario one candidate."""
        return type(self)(**{name: part[row] for name, part in vars(self).items()})


class Evaluator:
    """Evaluates candidates of a task in scenarios, by fixed steps.

    Start, target, duration, initial state, limits and the residual window are parameters of the
    compiled function: another task with the same plant, profile and limited quantities is not
    compiled again.

    Parameters
    ----------
    task : PointToPoint or sequence of PointToPoint
        The move; or several of one plant, with the same limited quantities and ranges: a candidate
        is then evaluated for each.
    profile : JointProfile
        How the joint moves.
    steps : int, optional
        Number of steps; `default_steps` of the task by default.
    quantities : sequence of Quantity, optional
        Quantities whose ranges are evaluated; those that the task limits by default.
    error_names : sequence of str, optional
        Names of the errors that a scenario has; those of the task's uncertainty by default.
    threads : int
        Blocks of candidates that are evaluated at the same time.

    Attributes
    ----------
    tasks : tuple of PointToPoint
        The task, or the tasks.
    simulation : Simulation
        What all candidates have in common.

    Raises
    ------
    ValueError
        When a number is below 1, or the profile breaks its contract.
    """

    @takes(profile=JointProfile)
    def __init__(
        self,
        task: PointToPoint | Sequence[PointToPoint],
        profile: JointProfile,
        steps: int | None = None,
        *,
        quantities: Sequence[Quantity] | None = None,
        error_names: Sequence[str] | None = None,
        threads: int = 1,
    ) -> None:
        tasks = tuple(task) if isinstance(task, list | tuple) else (task,)
        self.tasks = tuple(instance("task", move, PointToPoint) for move in tasks)
        check_profile(profile)
        first = self.tasks[0]
        if steps is None:
            steps = max(map(default_steps, self.tasks))
        if quantities is None:
            quantities = [limit.quantity for limit in first.limits]
        if error_names is None:
            error_names = first.error_names
        self.threads = whole("threads", threads, 1)
        self.simulation = Simulation(
            first.plant,
            profile,
            whole("steps", steps, 1),
            tuple(quantities),
            tuple(error_names),
            first.energy,
            profile.breaks(first.duration),
        )

    @property
    def steps(self) -> int:
        """Number of steps that was asked for."""
        return self.simulation.steps

    @cached_property
    def rows(self) -> Array:
        """The parameters of the tasks, shape (tasks, 3 + 2 * modes)."""
        return np.array([task.row for task in self.tasks])

    @cached_property
    def wanted(self) -> Array:
        """States that are wanted on arrival, shape (tasks, 1, 2 * modes)."""
        return np.array([[task.final_state] for task in self.tasks])

    @cached_property
    def scenarios(self) -> Array:
        """The task's own scenarios, the nominal one first, shape (scenarios, errors)."""
        return np.array(self.tasks[0].scenarios, dtype=float)

    @cached_property
    def limits(self) -> Mapping[str, Sequence[Limit]]:
        """The limit of each task, by the name of what is limited."""
        rows = [task.limits for task in self.tasks]
        return {limits[0].name: limits for limits in zip(*rows)}

    @cached_property
    def vibrations(self) -> list[FreeVibration]:
        """After arrival, in each of the task's own scenarios; of several tasks all at once."""
        if len(self.tasks) == 1:
            return after_arrival(self.tasks[0])
        targets = [task.target for task in self.tasks]
        windows = [task.residual_window for task in self.tasks]
        plants = self.tasks[0].perturbed_plants
        return [FreeVibration(plant, targets, windows) for plant in plants]

    @cached_property
    def tip_rows(self) -> list[Array]:
        """Rows that give the residual of a state on arrival, to 5e-5, for each scenario."""
        return [vibration.rows for vibration in self.vibrations]

    @interruptible
    @on_one_thread
    def __call__(self, coefficients: ArrayLike, errors: ArrayLike | None = None) -> Evaluation:
        """Evaluate candidates.

        Parameters
        ----------
        coefficients : array_like, shape (candidates, profile.size)
            One candidate a row; of several tasks one for each.
        errors : array_like, shape (scenarios, errors), optional
            Relative errors of the plant; those of the task's own scenarios by default.

        Raises
        ------
        ValueError
            When they are no plain numbers, or their shape does not fit the profile.
        """
        table = table_of(coefficients, self.simulation.profile.size)
        scenarios = self.scenarios if errors is None else self._checked(errors)
        moves = self.rows
        if len(moves) == 1:
            moves = np.repeat(moves, len(table), axis=0)
        values = simulate(
            self.simulation,
            np.repeat(table, len(scenarios), axis=0),
            np.repeat(moves, len(scenarios), axis=0),
            np.tile(scenarios, (len(table), 1)),
            self.threads,
        )
        shape = len(table), len(scenarios)
        return Evaluation(
            self,
            values.energy.reshape(shape),
            values.arrival.reshape(*shape, values.arrival.shape[1]),
            values.limited.reshape(*shape, values.limited.shape[1]),
            errors=None if errors is None else scenarios,
        )

    @interruptible
    @on_one_thread
    def residuals(self, coefficients: ArrayLike, errors: ArrayLike) -> Array:
        """Return what candidates of one task leave with errors of the plant [m].

        It is the residual of an evaluation, without energy and quantities: a third of the time.

        Parameters
        ----------
        coefficients : array_like, shape (candidates, profile.size)
        errors : array_like, shape (scenarios, errors)

        Returns
        -------
        ndarray, shape (candidates, scenarios)
        """
        (task,) = self.tasks
        table = table_of(coefficients, self.simulation.profile.size)
        scenarios = self._checked(errors)
        count = len(scenarios)
        COST.candidates += len(table) * count
        function = _compiled_arrivals(self.simulation._replace(quantities=()))
        inputs = (
            np.repeat(table, count, axis=0),
            np.repeat(self.rows, len(table) * count, axis=0),
            np.tile(scenarios, (len(table), 1)),
        )
        (arrivals,) = function(inputs, copy_rows, self.threads)
        vibration = with_errors(task, self.simulation.errors, scenarios)
        missed = arrivals.reshape(len(table), count, -1) - self.wanted
        return np.array([vibration.peak(states) for states in missed])

    def _checked(self, errors: ArrayLike) -> Array:
        """Errors of the plant, a row for each scenario."""
        table = numbers("errors", errors, "a row of numbers for each scenario")
        count = len(self.simulation.errors)
        if table.ndim != 2 or table.shape[1] != count:
            raise ValueError(f"errors have shape {table.shape}; give (scenarios, {count})")
        return table

    @on_one_thread
    def of_values(self, values: RowValues, offset: ArrayLike = 0.0) -> Evaluation:
        """Evaluate one candidate's values in the task's scenarios, a row a scenario.

        The offset is added to the states on arrival [m, m/s].
        """
        by_candidate = values.energy[None], values.arrival[None], values.limited[None]
        return Evaluation(self, *by_candidate, offset=np.asarray(offset))


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Candidates in scenarios, by fixed steps; NaN where a candidate is not finite.

    Attributes
    ----------
    energy : ndarray, shape (candidates, scenarios)
        Energy [J].
    arrival : ndarray, shape (candidates, scenarios, 2 * modes)
        W [m] and then W' [m/s] on arrival.
    limited : ndarray, shape (candidates, scenarios, values)
        The evaluator's quantities at the nodes, at `places_of` its simulation.
    errors : ndarray, shape (scenarios, errors), or None
        Errors of the scenarios; None of the task's own.
    offset : ndarray
        What is added to the arrival before the residual is taken.
    """

    evaluator: Evaluator
    energy: Array
    arrival: Array
    limited: Array
    errors: Array | None = None
    offset: Array | float = 0.0

    @property
    def missed(self) -> Array:
        """States on arrival less the wanted ones."""
        return self.arrival - self.evaluator.wanted + self.offset

    @cached_property
    def residual(self) -> Array:
        """Residual [m], (candidates, scenarios), between the samples of the window as well."""
        missed = self.missed
        if self.errors is None:
            vibrations = self.evaluator.vibrations
            peaks = [vibration.peak(missed[:, i]) for i, vibration in enumerate(vibrations)]
            return np.stack(peaks, axis=1)
        return np.array([self._perturbed_vibrations.peak(states) for states in missed])

    @property
    def _perturbed_vibrations(self) -> FreeVibration:
        """One for each scenario."""
        assert self.errors is not None
        (task,) = self.evaluator.tasks
        return with_errors(task, self.evaluator.simulation.errors, self.errors)

    @cached_property
    def sampled_residual(self) -> Array:
        """Residual [m] at samples of the window, as optimisers see it: to 5e-5, much faster."""
        missed = self.missed
        peaks = [
            np.abs(missed[:, i] @ rows.T).max(axis=1)
            for i, rows in enumerate(self.evaluator.tip_rows)
        ]
        return np.stack(peaks, axis=1)

    @cached_property
    def ranges(self) -> Mapping[str, Array]:
        """Least and largest value of each quantity by name, (candidates, scenarios, 2) each."""
        places = places_of(self.evaluator.simulation)
        return {name: _ends(self.limited[..., place]) for name, place in places.items()}

    def largest(self, name: str) -> Array:
        """Largest absolute value of a quantity, shape (candidates, scenarios)."""
        return np.abs(self.ranges[name]).max(axis=-1)

    @cached_property
    def peaks(self) -> Mapping[str, Array]:
        """Residual and peak of each limited quantity, as of `Limit.peak`, (candidates,) each.

        The largest of the scenarios that count; the residual is the sampled one.
        """
        return {RESIDUAL: self.sampled_residual.max(axis=1), **self.limited_peaks}

    def peaks_of(self, candidate: int) -> dict[str, float]:
        """The peaks of one candidate."""
        return {name: float(values[candidate]) for name, values in self.peaks.items()}

    @cached_property
    def limited_peaks(self) -> Mapping[str, Array]:
        """Peaks of the limited quantities, without the residual."""
        peaks: dict[str, Array] = {}
        for name, limits in self.evaluator.limits.items():
            sides = [limit.sides for limit in limits]
            below, above = np.array(sides).T[..., None]
            least, largest = np.moveaxis(self.ranges[name], -1, 0)
            by_scenario = np.maximum(least / below, largest / above)
            nominal = by_scenario[:, 0]
            counts = limits[0].quantity.in_scenarios
            peaks[name] = by_scenario.max(axis=1) if counts else nominal
        return peaks

    @property
    def violations(self) -> Array:
        """Each limited peak over its limit, less 1, shape (candidates, limits)."""
        peaks = self.limited_peaks
        violations = np.empty((len(self.energy), len(peaks)))
        for i, (name, limits) in enumerate(self.evaluator.limits.items()):
            sizes = np.array([limit.size for limit in limits])
            violations[:, i] = peaks[name] / sizes - 1
        return violations


def with_errors(task: PointToPoint, names: Sequence[str], errors: Array) -> FreeVibration:
    """Return the vibration after arrival with each row of errors of the plant, by their names."""
    plant = perturb_plant(task.plant, dict(zip(names, map(ca.DM, errors.T))))
    return FreeVibration(plant, [task.target] * len(errors), task.residual_window)


def _ends(values: Array) -> Array:
    return np.stack([values.min(axis=-1), values.max(axis=-1)], axis=-1)


def simulate(
    simulation: Simulation, coefficients: Array, move: Array, errors: Array, threads: int = 1
) -> RowValues:
    """Values of rows that have coefficients, the `row` of a task and errors of their own."""
    COST.candidates += len(coefficients)
    function = _compiled_values(simulation)
    energy, arrival, limited = function(
        (coefficients, move, errors),
        copy_rows,
        threads,
    )
    return RowValues(energy[:, 0], arrival, limited)


@lru_cache(maxsize=RECENT)
def _compiled_values(simulation: Simulation) -> RowFunction:
    largest = 100 if simulation.plant.steps_at_once == 1 else 32  # see `Batch`
    return RowFunction(
        partial(_build_values, simulation), (1, 8, largest), simulation.kept_as("values")
    )


@lru_cache(maxsize=RECENT)
def _compiled_arrivals(simulation: Simulation) -> RowFunction:
    # one size where it takes long to build: a fifth of a second each for a robot
    sizes = (1, 8, 100) if simulation.plant.steps_at_once == 1 else (8,)
    return RowFunction(
        partial(_build_arrivals, simulation), sizes, simulation.kept_as("states on arrival")
    )


def _build_arrivals(simulation: Simulation, rows: int) -> ca.Function:
    """Build the function that gives the states on arrival of so many candidates."""
    inputs, columns = _inputs_at_nodes(simulation, rows)
    arrival = simulation.arrival(*columns, rows)
    return ca.Function("arrival", inputs, [ca.densify(arrival)])


def _inputs_at_nodes(
    simulation: Simulation, rows: int
) -> tuple[list[ca.MX], tuple[list[ca.MX], list[ca.MX], list[ca.MX]]]:
    """Coefficients, rows of tasks and errors of so many candidates; their columns at all nodes.

    The state before the move is there once a row.
    """
    counts = simulation.profile.size, 3 + 2 * simulation.plant.modes, len(simulation.errors)
    inputs = [ca.MX.sym("x", rows, count) for count in counts]
    nodes = NODES * len(simulation.mesh.lengths)
    a, row, errors = (widen(matrix, nodes) for matrix in inputs)
    initial = ca.horzsplit(inputs[1], 1)[3:]
    return inputs, (a, [*row[:3], *initial], errors)


def _build_values(simulation: Simulation, rows: int) -> ca.Function:
    """Build the function that gives the values of a number of candidates.

    (coefficients, rows of tasks, errors) -> energy, arrival, limited quantities; a row a candidate.
    """
    steps = len(simulation.mesh.lengths)
    inputs, columns = _inputs_at_nodes(simulation, rows)
    rollout = simulation.rollout(*columns, rows)
    limited = [x for quantity in simulation.quantities for x in rollout.values(quantity)]
    outputs = [[rollout.energy], [rollout.arrival], limited]
    options = {"cse": steps <= MOST_STEPS_OF_CSE}
    return ca.Function(
        "values",
        inputs,
        [join(columns, rows) for columns in outputs],
        options,
    )
