"""The effect of a mode that swings after arrival on what is recorded of a robot.

To the torques of all joints, which together hold the root of what swings: one joint sees it best,
another not at all. And to an accelerometer at the tip.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.learn.tip_modes import TipModes
from quietarm.models import JointMotion, Plant
from quietarm.models.robot import RobotOnPath

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]


class SeenModes(TipModes):
    """The modes of a robot at a place of its path, by what they do to what is recorded.

    Parameters
    ----------
    plant : Plant
        What moves.
    place : float
        Where it rests on its path.
    signal : str
        What is recorded: "torques" or "acceleration".
    """

    def __init__(self, plant: Plant, place: float, signal: str) -> None:
        super().__init__(plant, place)
        self._plant = plant
        self._place = place
        self._signal = signal

    def rows_at(self, values: ComplexArray) -> ComplexArray:
        """Return each mode's effect on each signal, by its tip's displacement (signals, modes).

        The modes have their shapes and these eigenvalues: a machine's differ from the plant's.
        """
        if self._signal == "acceleration":
            return self.tips * values**2
        by_amplitudes, by_rates, by_accelerations = self._by_modes
        shapes = self._shapes[: self._plant.modes]
        rows: ComplexArray = (
            by_amplitudes @ shapes
            + (by_rates @ shapes) * values
            + (by_accelerations @ shapes) * values**2
        )
        return rows

    @property
    def tip_by_torques(self) -> Array:
        """Acceleration of the tip by torques that accelerate the joints (3, joints).

        Of a robot at rest at the place, whose springs are stiff; none of other plants.
        """
        plant = self._plant
        if not isinstance(plant, RobotOnPath):
            return np.zeros((3, len(plant.joint_names)))
        robot = plant.robot
        q = np.asarray(plant.path(self._place), float).ravel()
        kinematics = robot.kinematics(robot.tip)
        _, slopes = kinematics.offset(q, kinematics.pose(q))
        dynamics = robot.dynamics
        masses = dynamics.masses(np.append(q, np.zeros(dynamics.sprung)))[: len(q), : len(q)]
        by_torques: Array = slopes[:3] @ np.linalg.inv(masses)
        return by_torques

    @cached_property
    def _by_modes(self) -> tuple[Array, Array, Array]:
        """Torques by amplitudes, rates and accelerations of the plant's own coordinates."""
        size = self._plant.modes
        zero = [0.0] * size
        joint = JointMotion(self._place, 0.0, 0.0)

        def torques(*states: list[float]) -> Array:
            return np.array([float(t) for t in self._plant.torques(joint, *states)])

        rest = torques(zero, zero, zero)
        units = np.eye(size).tolist()
        return (
            np.stack([torques(unit, zero, zero) - rest for unit in units], axis=1),
            np.stack([torques(zero, unit, zero) - rest for unit in units], axis=1),
            np.stack([torques(zero, zero, unit) - rest for unit in units], axis=1),
        )
