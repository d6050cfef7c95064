"""A robot by its whole equations: every spring, nonlinear, without tables and modes.

On a path a beam has other hinges than the one that the motion is planned with.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

import casadi as ca
import numpy as np

from quietarm.models.joint_motion import Array, JointMotion
from quietarm.models.robot.dynamics.coulomb_friction import coulomb_torques
from quietarm.models.robot.dynamics.modes import modes_at, sag_at
from quietarm.models.robot.dynamics.moving_robot import MovingRobot
from quietarm.models.robot.on_path.path_tables import modes_on
from quietarm.models.robot.on_path.reduction import Reduction
from quietarm.models.robot.path.geometric_path import GeometricPath
from quietarm.models.robot.path.piecewise import Place


class SprungRobot(ABC):
    """The whole equations of a robot, in symbols, whatever says how its joints move.

    The state is the springs' angles [rad, or m] and their rates.

    Parameters
    ----------
    robot : Robot
        What moves.
    stiffness, payload : float
        Multiples of the robot's.
    """

    def __init__(self, robot: MovingRobot, stiffness: float = 1.0, payload: float = 1.0) -> None:
        self.made_of: tuple[object, ...] = (robot, stiffness, payload)
        """All that it is."""
        self._robot = robot
        self._dynamics = robot.dynamics_with(stiffness, payload)
        self._tip = robot.tip_place
        self.springs = self._dynamics.sprung
        """How many there are."""

    def __hash__(self) -> int:
        return hash(self.made_of)

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and self.made_of == vars(other).get("made_of")

    @abstractmethod
    def joints(self, path: JointMotion) -> list[JointMotion]:
        """Motion of every driven joint by that on the path, without jerk."""

    def accelerations(self, path: JointMotion, angles: ca.SX, rates: ca.SX) -> ca.SX:
        """Return the accelerations of the springs' angles."""
        unknown = ca.SX.sym("acceleration", self.springs)
        torques = self._torques(path, angles, rates, unknown)[self._dynamics.driven :]
        masses = ca.jacobian(torques, unknown)
        forces = ca.substitute(torques, unknown, ca.SX.zeros(self.springs))
        mechanism = self._dynamics.mechanism
        forces = forces + ca.DM(mechanism.stiffness) * angles + ca.DM(mechanism.damping) * rates
        return -ca.ldl_solve(forces, *ca.ldl(masses))

    def torques(self, path: JointMotion, angles: ca.SX, rates: ca.SX) -> ca.SX:
        """Return the torques of the driven joints."""
        accelerations = self.accelerations(path, angles, rates)
        torques = self._torques(path, angles, rates, accelerations)[: self._dynamics.driven]
        return torques + ca.vertcat(*coulomb_torques(self._robot, self.joints(path)))

    def tip(self, path: JointMotion, angles: ca.SX) -> ca.SX:
        """Position of the tip, seen from the ground [m]."""
        positions = ca.vertcat(*(joint.angle for joint in self.joints(path)), angles)
        _, origin = self._dynamics.place(self._tip, positions)
        return origin

    def _torques(
        self, path: JointMotion, angles: ca.SX, rates: ca.SX, accelerations: ca.SX
    ) -> ca.SX:
        """Return the torques of all joints, by inverse dynamics."""
        joints = self.joints(path)
        return self._dynamics.torques(
            ca.vertcat(*(joint.angle for joint in joints), angles),
            ca.vertcat(*(joint.speed for joint in joints), rates),
            ca.vertcat(*(joint.acceleration for joint in joints), accelerations),
        )


class FullRobot(SprungRobot):
    """A robot on its path, by which a plan of it is verified.

    Parameters
    ----------
    planned : Robot
        Whose modes are planned with; its tables are not used.
    robot : Robot
        What moves: the same with its beam on other hinges.
    path : GeometricPath
        Where its joints go.
    stiffness, payload : float
        Multiples of the robot's.
    """

    def __init__(
        self,
        planned: MovingRobot,
        robot: MovingRobot,
        path: GeometricPath,
        stiffness: float,
        payload: float,
    ) -> None:
        super().__init__(robot, stiffness, payload)
        self.made_of = (planned, robot, path, stiffness, payload)
        self._planned = planned
        self._whole_path = path
        self._path = path.extended

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

    def modal_state(self, place: float, state: Array) -> Array:
        """W [m], then W' [m/s] of the modes that are followed, by the masses at a place.

        Parameters
        ----------
        place : float
            On the path, where the driven joints rest.
        state : ndarray, shape (2 * springs,)
            Angles of the springs [rad, or m], and their rates.
        """
        planned = self._planned
        numbers = modes_on(planned, self._whole_path)
        reduction = Reduction(planned.dynamics, planned.tip_place, self._whole_path, numbers)
        shapes = self._as_bent(planned) @ reduction.shapes
        sag = self.at_rest(place)
        positions = np.concatenate([self._path([place])[0], sag])
        driven = self._dynamics.driven
        masses = self._dynamics.masses(positions)[driven:, driven:]
        along = shapes.T @ masses
        angles, rates = np.split(state, 2)
        moving = np.column_stack([angles - sag, rates])
        return np.asarray(np.linalg.solve(along @ shapes, along @ moving).T, float).ravel()

    def _as_bent(self, planned: MovingRobot) -> Array:
        """Angles of this robot's springs by those of the one that is planned with.

        All but the hinges of a beam are the same; these bend it the same.
        """
        here, there = self._robot.beam, planned.beam
        if here is None or there is None:
            return np.eye(self.springs)
        of_beam = self._robot.mechanism.springs_of_beam
        of_planned = planned.mechanism.springs_of_beam
        angles = np.zeros((len(of_beam), len(of_planned)))
        angles[np.ix_(~of_beam, ~of_planned)] = np.eye(int(np.count_nonzero(~of_beam)))
        # about x and about y in turn
        angles[np.ix_(of_beam, of_planned)] = np.kron(there.angles_of(here), np.eye(2))
        return angles


class RobotInTime(SprungRobot):
    """A robot whose joints move as a trajectory has them: the path's angle is a column of theirs.

    Speeds and accelerations likewise.
    """

    def at_rest(self, place: Array) -> Array:
        """Angles of the springs at rest with the joints at a place, shape (springs,)."""
        return sag_at(self._dynamics, place)

    def joints(self, path: JointMotion) -> list[JointMotion]:
        """Motion of every driven joint."""
        count = self._dynamics.driven
        orders = (path.angle, path.speed, path.acceleration)
        columns = [order * ca.SX.ones(count) for order in orders]
        return [JointMotion(*(column[joint] for column in columns)) for joint in range(count)]

    def frequencies(self, place: Array) -> Array:
        """Return the frequencies of all modes with the joints at a place [rad/s], rising."""
        return modes_at(self._dynamics, place)[0]

    def swings(self, place: Array, state: Array) -> list[tuple[float, float]]:
        """Frequency [rad/s] of every mode, and how far the tip swings by it alone [m].

        Parameters
        ----------
        place : ndarray, shape (joints,)
            Where the joints rest.
        state : ndarray, shape (2 * springs,)
            Angles of the springs and their rates, from which they swing, undamped.
        """
        dynamics = self._dynamics
        sag = self.at_rest(place)
        frequencies, shapes = modes_at(dynamics, place, sag)
        masses = dynamics.masses(np.concatenate([place, sag]))
        along = shapes.T @ masses[dynamics.driven :, dynamics.driven :]
        angles, rates = np.split(state, 2)
        amplitudes = np.hypot(along @ (angles - sag), along @ rates / frequencies)
        x = ca.SX.sym("x", dynamics.size)
        _, origin = dynamics.place(self._tip, x)
        slopes = ca.Function("slopes", [x], [ca.densify(ca.jacobian(origin, x))])
        of_springs = slopes(np.concatenate([place, sag])).full()[:, dynamics.driven :]
        reaches = np.linalg.norm(of_springs @ shapes, axis=0) * amplitudes
        return list(zip(frequencies.tolist(), reaches.tolist()))


def _padded(table: Array, terms: int) -> Array:
    """Pad with zeros for terms that a derivative has no more."""
    missing: Sequence[tuple[int, int]] = [(0, 0), (0, terms - table.shape[1]), (0, 0)]
    return np.pad(table, missing)
