"""A motion sampled in time, and the equations that give what is sampled."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from quietarm.models import Expression, JointMotion, Plant
from quietarm.models.joint_motion import Modes
from quietarm.ocp.energy import power_of


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
