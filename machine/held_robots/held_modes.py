"""The modes of a robot whose joints are held, by what each does to what is recorded."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.models.compiled import Compiled
from quietarm.models.robot import Robot
from quietarm.models.robot.dynamics.measured_fit import damping_ratios
from quietarm.models.robot.dynamics.modes import modes_at, sag_at

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
_LEAST_DAMPING = 1e-3
"""From which a search of the damping begins, where the robot's file has none."""


class HeldModes:
    """The slowest modes of a robot at a posture.

    Parameters
    ----------
    robot : Robot
        What swings.
    posture : array
        Positions of its driven joints [rad or m].
    signal : str
        What is recorded: "torques" of the driven joints, "acceleration" or "tip".
    axes : sequence of int
        Axes of the tip's frame that are recorded, 0 for x; not used with torques.
    count : int
        How many modes.

    Attributes
    ----------
    values : array of complex, shape (modes,)
        Eigenvalues above the real axis [rad/s].
    """

    def __init__(
        self, robot: Robot, posture: Array, signal: str, axes: Sequence[int], count: int
    ) -> None:
        self._robot = robot
        self._q = posture
        self._p = sag_at(robot.dynamics, posture)
        self._signal = signal
        self._axes = [*axes]
        frequencies, shapes = modes_at(robot.dynamics, posture, self._p)
        dampings = np.clip(damping_ratios(robot.dynamics, posture), _LEAST_DAMPING, 0.9)
        values = frequencies * (-dampings + 1j * np.sqrt(1 - dampings**2))
        self.values: ComplexArray = values[:count]
        self._shapes = shapes[:, :count]

    @property
    def frequencies(self) -> Array:
        """Frequencies of the modes [Hz]."""
        return np.abs(self.values) / (2 * np.pi)

    @property
    def tip_by_torques(self) -> Array:
        """Acceleration of the tip by torques, of which held joints show none (3, signals)."""
        by_joints = self._signal == "torques"
        return np.zeros((3, len(self._q) if by_joints else len(self._axes)))

    def rows_at(self, values: ComplexArray) -> ComplexArray:
        """Return each mode's effect on each signal (signals, modes), with these eigenvalues."""
        by_angles, by_accelerations = self._by_springs
        rows: ComplexArray = (
            by_angles @ self._shapes + (by_accelerations @ self._shapes) * values**2
        )
        return rows

    @cached_property
    def _by_springs(self) -> tuple[Array, Array]:
        """The signals by the springs' angles, and by their accelerations."""
        if self._signal == "torques":
            return self._torques_by_springs
        angles, way = self._tip_by_springs
        nothing = np.zeros_like(way)
        return (way, nothing) if self._signal == "tip" else (angles, way)

    @cached_property
    def _torques_by_springs(self) -> tuple[Array, Array]:
        dynamics = self._robot.dynamics
        driven = dynamics.driven
        x = np.concatenate([self._q, self._p])
        _, slopes = dynamics.at_rest(x)
        return slopes[:driven], dynamics.masses(x)[:driven, driven:]

    @cached_property
    def _tip_by_springs(self) -> tuple[Array, Array]:
        """Slopes by the springs' angles: of gravity as the tip feels it, and of the tip's way."""
        dynamics = self._robot.dynamics
        x = ca.SX.sym("x", dynamics.size)
        rotation, origin = dynamics.place(self._robot.tip_place, x)
        gravity = ca.DM(np.array(self._robot.gravity))
        felt = ca.jacobian(-rotation.T @ gravity, x)[self._axes, dynamics.driven :]
        way = (rotation.T @ ca.jacobian(origin, x))[self._axes, dynamics.driven :]
        outputs = [ca.densify(felt), ca.densify(way)]
        slopes = Compiled(lambda: ca.Function("tip_slopes", [x], outputs))
        of_gravity, of_way = slopes(np.concatenate([self._q, self._p]))
        return of_gravity, of_way
