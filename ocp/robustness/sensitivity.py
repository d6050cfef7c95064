"""What a motion costs and leaves more when a parameter of the plant is a little wrong."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.candidate import Candidate
from quietarm.ocp.interrupts import one_at_a_time
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.free_vibration import after_arrival
from quietarm.ocp.simulation.grid import default_steps
from quietarm.ocp.solvers.batch import batch
from quietarm.ocp.task import PointToPoint
from quietarm.ocp.uncertainty import DAMPING, FREQUENCY

_STEP = 1e-4
"""Relative error to either side: of what follows 1e-8 is curvature, and 1e-6 the integrator's."""


@dataclass(frozen=True)
class Sensitivity:
    """What changes with a parameter of the plant, the joint moving as planned.

    Attributes
    ----------
    parameter : str
        Its name; ``"frequency"`` and ``"damping"`` are those of all modes alike.
    energy : float
        Derivative of F2 by the parameter's relative error [J].
    residual : float
        Vibration that a small relative error adds, over that error [m]: the largest displacement of
        a tip after arrival by the change of the state on arrival.
    """

    parameter: str
    energy: float
    residual: float


@one_at_a_time
def sensitivities(
    task: PointToPoint, profile: JointProfile, coefficients: Sequence[float]
) -> tuple[Sensitivity, ...]:
    """The derivatives of a motion's energy and arrival by every parameter of its plant but zeros.

    By central differences of CVODES, which follows each motion with a parameter a little larger and
    a little smaller. The one that adds most vibration comes first.
    """
    candidate = Candidate.of_profile(task.certain, profile, coefficients)
    vibration = after_arrival(task)[0]

    def of(name: str) -> Sensitivity:
        above, below = (candidate.perturbed({name: sign * _STEP}) for sign in (1, -1))
        arrival = (above.arrival[0] - below.arrival[0]) / (2 * _STEP)
        energy = (above.energy - below.energy) / (2 * _STEP)
        return Sensitivity(name, energy, float(vibration.peak(arrival)))

    known = [name for name, value in task.plant.measured.items() if value]
    names = dict.fromkeys([FREQUENCY, DAMPING, *known])
    return tuple(sorted(map(of, names), key=lambda one: -one.residual))


OF_MODES = (FREQUENCY, DAMPING)


@one_at_a_time
def sensitivities_of_moves(
    tasks: Sequence[PointToPoint], profile: JointProfile, coefficients: NDArray[np.float64]
) -> dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """What `sensitivities` gives of frequency and damping, for many moves at once by fixed steps.

    Of each of the two the energies [J] and residuals [m], an entry a move of one plant.
    """
    steps, energy = max(map(default_steps, tasks)), tasks[0].energy
    wrong = batch(tasks[0].plant, profile, steps, errors=OF_MODES, energy=energy)
    moves = np.array([task.row for task in tasks])
    vibrations = [after_arrival(task)[0] for task in tasks]

    def slopes(errors: list[float]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        above, below = (
            wrong.values(coefficients, moves, np.tile(errors, (len(tasks), 1)) * step)
            for step in (_STEP, -_STEP)
        )
        arrival = (above.arrival - below.arrival) / (2 * _STEP)
        left = [of.peak(one) for of, one in zip(vibrations, arrival, strict=True)]
        return (above.energy - below.energy) / (2 * _STEP), np.array(left)

    return {FREQUENCY: slopes([1.0, 0.0]), DAMPING: slopes([0.0, 1.0])}
