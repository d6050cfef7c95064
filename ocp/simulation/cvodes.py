"""CVODES with its options, a plant's equations for it, and what happens after arrival.

Nothing here knows how the joint moves: `resimulation` drives it along a profile or a free motion.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.models import Expression, JointMotion, Plant
from quietarm.models.joint_motion import Modes
from quietarm.ocp.energy import power_of
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.interrupts import keep_interrupts, silent_errors
from quietarm.ocp.simulation.free_vibration import after_arrival
from quietarm.ocp.task import PointToPoint

CVODES = {
    "linear_multistep_method": "adams",  # order up to 12: a fifth of the steps of BDF's 5
    "reltol": 1e-11,
    "abstol": 1e-13,
}
"""Options of every run, but for its steps: see `options_for`."""
Errors = tuple[tuple[str, float], ...]
"""Relative errors of a plant by name, as `perturb_plant` takes them."""
_MOST_STEPS, _LEAST_A_SAMPLE = 3_000_000, 1_000
"""Steps in a run: it takes some seconds, in which CVODES hears no signal. Coefficients of 1000,
five hundred times those of any plan, take 700 from one of 3500 samples to the next."""
_RADIANS_A_SAMPLE = 0.003
"""Phase of the fastest mode between samples after arrival: these miss 1.2e-6 of a peak at most."""


@dataclass(frozen=True)
class Trajectory:
    """A motion sampled in time; rows are samples, arrays are read-only.

    Attributes
    ----------
    time : ndarray, shape (samples,)
        Times [s]; arrival is at the task's duration.
    joint : ndarray, shape (samples, 3)
        Angle, speed and acceleration of the joint [rad, rad/s, rad/s^2].
    modes : ndarray, shape (samples, modes)
        Modal amplitudes W [m].
    tips : ndarray, shape (samples, tips)
        Tip displacements [m].
    torque : ndarray, shape (samples,)
        Joint torque [N m]; after arrival, what holds the joint against the vibration.
    power : ndarray, shape (samples,)
        torque * speed [W].
    jerk : ndarray, shape (samples,)
        Rate of change of the joint's acceleration [rad/s^3]; between jumps of the acceleration.
    """

    time: NDArray[np.float64]
    joint: NDArray[np.float64]
    modes: NDArray[np.float64]
    tips: NDArray[np.float64]
    torque: NDArray[np.float64]
    power: NDArray[np.float64]
    jerk: NDArray[np.float64]

    def __post_init__(self) -> None:
        for array in vars(self).values():
            array.setflags(write=False)

    @classmethod
    def from_outputs(
        cls, plant: Plant, time: NDArray[np.float64], outputs: NDArray[np.float64]
    ) -> Trajectory:
        """Name the rows of `outputs_of`, whose columns are samples at these times [s]."""
        rows, m = outputs.T.copy(), 4 + plant.modes
        return cls(
            time=time.copy(),
            joint=rows[:, :3],
            modes=rows[:, 4:m],
            tips=rows[:, m:-1],
            torque=rows[:, -1],
            power=power_of(rows[:, -1], rows[:, 1]),
            jerk=rows[:, 3],
        )

    @property
    def motion(self) -> JointMotion:
        """Angle, speed, acceleration and jerk of the joint, each of shape (samples,)."""
        angle, speed, acceleration = self.joint.T
        return JointMotion(angle, speed, acceleration, self.jerk)


def outputs_of(plant: Plant, joint: JointMotion, states: Expression) -> Expression:
    """Rows angle, speed, acceleration, jerk, W, tips, torque of a trajectory; a column a sample.

    The states, (2 * modes, samples), are W [m] and then W' [m/s].
    """
    W, dW, ddW = _modes(plant, joint, states)
    rows = (*joint, *W, *plant.tip_displacements(W), plant.torque(joint, W, dW, ddW))
    return ca.vertcat(*(ca.DM.zeros(1, states.shape[1]) + row for row in rows))


def rates_of(plant: Plant, joint: JointMotion, states: Expression) -> Expression:
    """Time derivative of the states of `outputs_of`."""
    _, dW, ddW = _modes(plant, joint, states)
    return ca.vertcat(*dW, *ddW)


def _modes(plant: Plant, joint: JointMotion, states: Expression) -> tuple[Modes, Modes, Modes]:
    rows = ca.vertsplit(states)
    W, dW = rows[: plant.modes], rows[plant.modes :]
    return W, dW, plant.modal_accelerations(joint, W, dW)


@contextmanager
def cvodes_for(motion: str) -> Iterator[None]:
    """Let CVODES be called in this block; name the motion that it cannot follow."""
    try:
        with silent_errors():  # the error below is enough
            yield
    except RuntimeError as error:
        raise SolverFailedError(f"CVODES could not follow this motion{motion}") from error


def options_for(times: ArrayLike) -> dict[str, str | float | int]:
    """Options of a run that ends within some seconds, also where it cannot follow the motion.

    CVODES counts its steps from one sample to the next.
    """
    gaps = np.diff(np.asarray(times, dtype=float), prepend=0.0)
    share = float(gaps.max() / gaps.sum())
    return {**CVODES, "max_num_steps": max(_LEAST_A_SAMPLE, round(_MOST_STEPS * share))}


def rest_of(task: PointToPoint, arrival: ArrayLike) -> Trajectory:
    """What happens in the residual window, from W (m) and then W' (m/s) at arrival."""
    vibration = after_arrival(task)[0]
    window = task.residual_window
    samples = math.ceil(window * vibration.fastest / _RADIANS_A_SAMPLE) + 2
    later = np.linspace(0.0, window, samples)
    outputs = outputs_at_rest(task, vibration.states(arrival, later))
    return Trajectory.from_outputs(task.plant, task.duration + later, outputs)


@keep_interrupts()  # casadi loses a Ctrl-C
def outputs_at_rest(task: PointToPoint, states: NDArray[np.float64]) -> NDArray[np.float64]:
    """`outputs_of` the joint at rest at the target, from a row for each sample."""
    joint = JointMotion(task.target, 0.0, 0.0, 0.0)
    return outputs_of(task.plant, joint, ca.DM(states.T)).full()
