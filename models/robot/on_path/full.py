"""A robot on its path by its whole equations: every spring, nonlinear, without tables and modes."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from quietarm.models.joint_motion import Array, JointMotion
from quietarm.models.robot.dynamics.coulomb_friction import coulomb_torques
from quietarm.models.robot.dynamics.modes import sag_at
from quietarm.models.robot.dynamics.moving_robot import MovingRobot
from quietarm.models.robot.on_path.path_tables import modes_on
from quietarm.models.robot.on_path.reduction import Reduction
from quietarm.models.robot.path.geometric_path import GeometricPath
from quietarm.models.robot.path.piecewise import Place


class FullRobot:
    """The equations of a robot on its path, in symbols, that a plan of it is verified by.

    The state is the springs' angles [rad, or m] and their rates.

    Parameters
    ----------
    robot : Robot
        What moves; its tables are not used.
    path : GeometricPath
        Where its joints go.
    stiffness, payload : float
        Multiples of the robot's.
    """

    def __init__(
        self, robot: MovingRobot, path: GeometricPath, stiffness: float, payload: float
    ) -> None:
        self._robot = robot
        self._whole_path = path
        self._path = path.extended
        self._dynamics = robot.dynamics_with(stiffness, payload)
        self._tip = robot.tip_place
        self.springs = self._dynamics.sprung
        """How many there are."""

    def at_rest(self, place: float) -> Array:
        """Angles of the springs at rest at a place of the path, shape (springs,)."""
        return sag_at(self._dynamics, self._path([place])[0])

    def joints(self, path: JointMotion) -> list[JointMotion]:
        """Motion of every driven joint by the path itself, without jerk."""
        terms = max(self._path.coefficients.shape[1], 1)
        place = Place(self._path.knots, path.angle, terms)
        square = path.speed * path.speed
        orders = [self._path, self._path.derivative(), self._path.derivative(2)]
        values = [place.values(_padded(order.coefficients, terms)) for order in orders]
        return [
            JointMotion(at, slope * path.speed, slope * path.acceleration + bend * square)
            for at, slope, bend in zip(*values)
        ]

    def accelerations(self, path: JointMotion, angles: ca.SX, rates: ca.SX) -> ca.SX:
        """Of the springs' angles."""
        unknown = ca.SX.sym("acceleration", self.springs)
        torques = self._torques(path, angles, rates, unknown)[self._dynamics.driven :]
        masses = ca.jacobian(torques, unknown)
        forces = ca.substitute(torques, unknown, ca.SX.zeros(self.springs))
        mechanism = self._dynamics.mechanism
        forces = forces + ca.DM(mechanism.stiffness) * angles + ca.DM(mechanism.damping) * rates
        return -ca.ldl_solve(forces, *ca.ldl(masses))

    def torques(self, path: JointMotion, angles: ca.SX, rates: ca.SX) -> ca.SX:
        """Of the driven joints."""
        accelerations = self.accelerations(path, angles, rates)
        torques = self._torques(path, angles, rates, accelerations)[: self._dynamics.driven]
        return torques + ca.vertcat(*coulomb_torques(self._robot, self.joints(path)))

    def tip(self, path: JointMotion, angles: ca.SX) -> ca.SX:
        """Where the tip is, seen from the ground [m]."""
        positions = ca.vertcat(*(joint.angle for joint in self.joints(path)), angles)
        _, origin = self._dynamics.place(self._tip, positions)
        return origin

    def modal_state(self, place: float, state: Array) -> Array:
        """W [m], then W' [m/s] of the modes that are followed, by the masses at a place.

        Parameters
        ----------
        place : float
            On the path, where the driven joints rest.
        state : ndarray, shape (2 * springs,)
            Angles of the springs [rad, or m], and their rates.
        """
        numbers = modes_on(self._robot, self._whole_path)
        reduction = Reduction(self._robot.dynamics, self._tip, self._whole_path, numbers)
        shapes = reduction.shapes
        sag = self.at_rest(place)
        positions = np.concatenate([self._path([place])[0], sag])
        driven = self._dynamics.driven
        masses = self._dynamics.masses(positions)[driven:, driven:]
        along = shapes.T @ masses
        angles, rates = np.split(state, 2)
        moving = np.column_stack([angles - sag, rates])
        return np.asarray(np.linalg.solve(along @ shapes, along @ moving).T, float).ravel()

    def _torques(
        self, path: JointMotion, angles: ca.SX, rates: ca.SX, accelerations: ca.SX
    ) -> ca.SX:
        """Of all joints, by inverse dynamics."""
        joints = self.joints(path)
        return self._dynamics.torques(
            ca.vertcat(*(joint.angle for joint in joints), angles),
            ca.vertcat(*(joint.speed for joint in joints), rates),
            ca.vertcat(*(joint.acceleration for joint in joints), accelerations),
        )


def _padded(table: Array, terms: int) -> Array:
    """With zeros for terms that a derivative has no more."""
    missing: Sequence[tuple[int, int]] = [(0, 0), (0, terms - table.shape[1]), (0, 0)]
    return np.pad(table, missing)
