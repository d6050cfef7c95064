"""A move whose energy is a user's own function of the simulated samples, in NumPy or as one likes.

An `Energy` of a task is CasADi's: torque and speed at one time. For a search an energy may be any
function, which sees tips and modes as well, and all of the move at once.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.metaheuristics.evaluation.population import search_steps
from quietarm.metaheuristics.problems.function import MoveFunction
from quietarm.metaheuristics.problems.given_function import (
    FirstFailures,
    GivenFunction,
    failure_of,
    name_of,
)
from quietarm.metaheuristics.problems.problem_function import Rows
from quietarm.models.dimensions import TIP, WAY, Words
from quietarm.ocp import Front, JointProfile, PointToPoint
from quietarm.ocp.checks import numbers
from quietarm.ocp.front.points import Entries, FrontPoint
from quietarm.ocp.limits import QUANTITIES, Quantity
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY, with_peaks_measured
from quietarm.ocp.record import Record
from quietarm.ocp.simulation.collocation import GAUSS_WEIGHTS, NODES
from quietarm.ocp.simulation.evaluator import Evaluation, Evaluator
from quietarm.ocp.simulation.rollout import places_of

Array = NDArray[np.float64]
_SAMPLED = {
    "angle": Quantity(
        "sampled_angle", WAY, Words("angle"), lambda sample: [j.angle for j in sample.joints]
    ),
    "speed": QUANTITIES["speed"],
    "acceleration": QUANTITIES["acceleration"],
    "torque": QUANTITIES["torque"],
    "tips": QUANTITIES["deflection"],
    "W": Quantity("sampled_modes", TIP, Words("modes"), lambda sample: sample.W),
    "dW": Quantity("sampled_rates", TIP, Words("rates of modes"), lambda sample: sample.dW),
}
"""What an energy sees, by the attribute of `MoveSamples`."""


@dataclass(frozen=True, eq=False)
class MoveSamples:
    """Simulated moves at the nodes of their steps, of many candidates at once.

    Attributes
    ----------
    time, weights : ndarray, shape (times,)
        Times [s], and what a value there counts for in an integral over the move [s].
    angle, speed, acceleration, torque : ndarray, shape (candidates, joints, times)
        Of every joint [rad, rad/s, rad/s^2, N m], or of a linear one in m and N.
    tips : ndarray, shape (candidates, tips, times)
        Displacements of the tips [m].
    W, dW : ndarray, shape (candidates, modes, times)
        Modal amplitudes [m] and their rates [m/s].
    """

    time: Array
    weights: Array
    angle: Array
    speed: Array
    acceleration: Array
    torque: Array
    tips: Array
    W: Array
    dW: Array

    @property
    def power(self) -> Array:
        """Mechanical power of all joints together [W], shape (candidates, times)."""
        return (self.torque * self.speed).sum(axis=1)

    def integral(self, values: ArrayLike) -> Array:
        """Integral over the move of values at its times, the last axis."""
        return np.asarray(values, dtype=float) @ self.weights


OwnEnergy = Callable[[MoveSamples], ArrayLike]


class OwnEnergyFunction(MoveFunction):
    """A move's residual and violations, with a user's own energy of the simulated samples.

    Its fronts are of a function: no other integrator judges an energy that quietarm does not know.

    Parameters
    ----------
    task, profile, bound, objectives, threads
        As of a `MoveFunction`.
    energy : callable
        Of `MoveSamples` to the energies, shape (candidates,).
    """

    def __init__(
        self,
        task: PointToPoint,
        profile: JointProfile | None = None,
        *,
        energy: OwnEnergy,
        bound: float | None = None,
        objectives: Sequence[str] = RESIDUAL_AND_ENERGY,
        threads: int = 1,
    ) -> None:
        super().__init__(task, profile, bound=bound, objectives=objectives, threads=threads)
        if not callable(energy):
            raise TypeError(
                f"energy is {energy!r}; give a function of MoveSamples, or an Energy to the task"
            )
        self.move = task
        self.of_profile = self.profile
        self._energy = energy
        self._first_failures = FirstFailures()
        self._shown = GivenFunction(
            energy,
            lower=self.lower,
            upper=self.upper,
            objectives=self.objectives,
            units=self.units,
            constraints=self.constraints,
            name=f"{name_of(energy)} of {task.plant.name}",
        )
        self.task: Any = self._shown.searched
        self.profile: Any = self._shown.searched
        self.bound: Any = None
        measured = with_peaks_measured(task, self.peaks)
        limited = [limit.quantity for limit in measured.limits]
        names = [quantity.name for quantity in limited]
        seen = [quantity for quantity in _SAMPLED.values() if quantity.name not in names]
        steps = search_steps(task, self.of_profile)
        self._evaluator = Evaluator(
            measured, self.of_profile, steps, quantities=[*limited, *seen], threads=threads
        )

    @property
    def of_model(self) -> bool:
        """Return False: the model's gradient is not that of this energy."""
        return False

    def _figures(self, evaluation: Evaluation) -> tuple[Array, Array]:
        """Objectives with the user's energy, and violations."""
        objectives, violations = super()._figures(evaluation)
        if len(objectives):
            objectives[:, 1] = self._energies(evaluation)
        return objectives, violations

    def _energies(self, evaluation: Evaluation) -> Array:
        samples = samples_of(evaluation, self.move.duration)
        name = f"energy {name_of(self._energy)}"
        try:
            energies = self._energy(samples)
        except Exception as error:
            raise failure_of(name, self._energy, error) from error
        wanted = f"one energy for each of {len(evaluation.energy)} candidates"
        values = numbers(name, energies, wanted, infinite=True)
        if values.shape != (len(evaluation.energy),):
            raise ValueError(f"{name} has shape {values.shape}; give {wanted}")
        self._first_failures.note(name, ~np.isfinite(values))
        return values

    @property
    def corner(self) -> Any:
        """Return None: it follows from what is found."""
        return self._shown.corner

    def points_of(
        self, coefficients: Array, values: Array, bound: float | None
    ) -> tuple[FrontPoint, ...]:
        """The points of a front, with the values of the search's steps."""
        return self._shown.points_of(coefficients, values, bound)

    def entries_of(
        self, candidates: tuple[int, ...], coefficients: Rows, objectives: Rows, believed: Rows
    ) -> Entries:
        """Return the entries of a front, as of a function."""
        return self._shown.entries_of(candidates, coefficients, objectives, believed)

    def front_with(self, points: tuple[FrontPoint, ...], record: Record, **entries: Any) -> Front:
        """The front, as one of a function."""
        return self._shown.front_with(points, record, **entries)


def samples_of(evaluation: Evaluation, duration: float) -> MoveSamples:
    """Return what an energy sees of evaluated candidates: the nominal plant, in order of time."""
    simulation = evaluation.evaluator.simulation
    mesh = simulation.mesh
    weights = np.outer(GAUSS_WEIGHTS, mesh.lengths)
    places = places_of(simulation)
    steps = len(mesh.lengths)
    columns = dict[str, Array]()
    for name, quantity in _SAMPLED.items():
        values = evaluation.limited[:, 0, places[quantity.name]]
        by_node = values.reshape(len(values), -1, NODES, steps)
        columns[name] = by_node.swapaxes(2, 3).reshape(len(values), -1, NODES * steps)
    in_time = (mesh.nodes.T.ravel() * duration, weights.T.ravel() * duration)
    return MoveSamples(*in_time, **columns)
