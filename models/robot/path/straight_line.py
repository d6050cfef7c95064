"""Straight lines of a link in space, by inverse kinematics of the robot that does not bend."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np
from numpy.polynomial import chebyshev

from quietarm.models.joint_motion import Array
from quietarm.models.number_checks import has_no
from quietarm.models.robot.frames import rotation_about, rotation_of

if TYPE_CHECKING:
    from quietarm.models.robot.path.geometric_path import GeometricPath
    from quietarm.models.robot.robot import Robot

LEAST_LENGTH = 1e-6
"""Of a line [m], or least turn [rad]."""


@dataclass(frozen=True, eq=False)
class Pose:
    """Where a link stands, seen from the ground: its rotation, shape (3, 3), and its origin [m]."""

    rotation: Array
    origin: Array

    @classmethod
    def of(cls, numbers: Array, before: Pose) -> Pose:
        """By x, y, z [m], the rotation as before; or with roll, pitch, yaw [rad], as in a URDF."""
        rotation = rotation_of(*numbers[3:]) if len(numbers) == 6 else before.rotation
        return cls(rotation, numbers[:3])

    def moved(self, way: Array) -> Pose:
        """By a way in the frame of the ground [m], its rotation as before."""
        return Pose(self.rotation, self.origin + way)


@dataclass(frozen=True)
class Kinematics:
    """Where a link of a robot stands by the positions of its driven joints."""

    robot: Robot
    link: str

    def pose(self, q: Array) -> Pose:
        """Where the link stands."""
        rotation, origin = (entry.full() for entry in self._place(q))
        return Pose(rotation, origin.ravel())

    def offset(self, q: Array, pose: Pose) -> tuple[Array, Array]:
        """How far the link is from a pose [m, rad], six numbers, and their slopes by q."""
        offset, slopes = self._offset(q, pose.rotation, pose.origin)
        return offset.full().ravel(), slopes.full()

    @cached_property
    def _place(self) -> ca.Function:
        q = ca.SX.sym("q", len(self.robot.joints))
        return ca.Function("place", [q], [*self._symbols(q)], {"cse": True})

    @cached_property
    def _offset(self) -> ca.Function:
        q = ca.SX.sym("q", len(self.robot.joints))
        wanted = ca.SX.sym("rotation", 3, 3)
        target = ca.SX.sym("origin", 3)
        rotation, origin = self._symbols(q)
        turned = wanted.T @ rotation
        turns = ca.vertcat(
            turned[2, 1] - turned[1, 2],
            turned[0, 2] - turned[2, 0],
            turned[1, 0] - turned[0, 1],
        )
        offset = ca.vertcat(origin - target, turns / 2)
        slopes = ca.densify(ca.jacobian(offset, q))
        return ca.Function("offset", [q, wanted, target], [offset, slopes], {"cse": True})

    def _symbols(self, q: ca.SX) -> tuple[ca.SX, ca.SX]:
        dynamics = self.robot.dynamics
        place = self.robot.mechanism.links[self.link]
        x = ca.vertcat(q, ca.SX(dynamics.sprung, 1))
        rotation, origin = dynamics.place(place, x)
        return ca.densify(rotation), ca.densify(origin)


def kinematics_of(robot: Robot, link: str | None) -> Kinematics:
    """Of a link; by default that which carries the beam, or else the tip."""
    if link is None:
        link = robot.beam.at if robot.beam is not None else robot.tip
    assert link is not None
    if link not in robot.mechanism.links:
        raise ValueError(has_no("the robot", "link, for a line,", link, robot.mechanism.links))
    return Kinematics(robot, link)


def straight_positions(kinematics: Kinematics, start: Array, end: Pose) -> Callable[[float], Array]:
    """(share of a line) -> positions of the joints, along the line from where `start` is to a pose.

    The link's origin goes straight, its rotation turns about one axis. A first walk finds where the
    joints go; a polynomial of it is then the guess from which Newton's steps, the shortest that
    there are, come to the line: so the positions are as smooth as the robot lets them be.

    Raises
    ------
    ValueError
        When the line has no length, leaves the robot's reach or meets a singular posture.
    """
    line = _Line(kinematics.pose(start), end)
    if line.length < LEAST_LENGTH and line.angle < LEAST_LENGTH:
        raise ValueError(
            f"the line has a length of {line.length:.3g} m; give an end elsewhere than where "
            f"{kinematics.link} is at its start"
        )
    shares = np.linspace(0.0, 1.0, _STEPS + 1)
    walked = [start]
    for share in shares[1:]:
        solution = _newton(kinematics, walked[-1], line.pose(share))
        if solution is None or np.abs(solution - walked[-1]).max() > _MOST_STEP:
            before = f"{kinematics.link} cannot follow the line beyond {share * line.length:.3g} m"
            turn = "keeps" if line.angle < LEAST_LENGTH else "turns"
            few = len(start) < _OF_A_POSE
            if few and _reaches(kinematics, walked[-1], line.pose(share).origin):
                raise ValueError(
                    f"{before} of its {line.length:.3g} m: the place is within reach, but a line "
                    f"{turn} the link's orientation as well, which {len(start)} joints cannot do "
                    "there; give waypoints, by --path or GeometricPath.through"
                )
            raise ValueError(
                f"{before} of its {line.length:.3g} m: it is out of reach with the orientation "
                f"that a line {turn}, or the joints swing over; give another start, a nearer end, "
                "or waypoints"
            )
        walked.append(solution)
    guess = chebyshev.chebfit(2 * shares - 1, np.array(walked), _DEGREE)

    def positions(share: float) -> Array:
        begin = np.asarray(chebyshev.chebval(2 * share - 1, guess), float)
        solution = _newton(kinematics, begin, line.pose(share))
        if solution is None:
            raise ValueError(
                f"{kinematics.link} cannot follow the line at {share * line.length:.3g} m of its "
                f"{line.length:.3g} m: the joints swing over; give another start, or waypoints"
            )
        return solution

    return positions


_STEPS = 200
"""Of the first walk along a line."""
_MOST_STEP = 0.2
"""Of a joint in one of them [rad or m]: in a singular posture it swings over."""
_DEGREE = 16
"""Of the guess."""


def off_straight(kinematics: Kinematics, path: GeometricPath) -> float:
    """Largest distance of a link on a path from the straight line between the path's ends [m]."""
    origins = np.array([kinematics.pose(q).origin for q in path(np.linspace(0.0, 1.0, 501))])
    way = origins[-1] - origins[0]
    length = float(np.linalg.norm(way))
    arms = origins - origins[0]
    if length < LEAST_LENGTH:
        return float(np.linalg.norm(arms, axis=1).max())
    along = way / length
    across = arms - np.outer(arms @ along, along)
    return float(np.linalg.norm(across, axis=1).max())


class _Line:
    """From pose to pose: straight, and turning about one axis."""

    def __init__(self, begin: Pose, end: Pose) -> None:
        self._begin = begin
        self._way = end.origin - begin.origin
        self._axis, self.angle = _turn(begin.rotation.T @ end.rotation)
        self.length = float(np.linalg.norm(self._way))

    def pose(self, share: float) -> Pose:
        turned = self._begin.rotation @ rotation_about(self._axis, share * self.angle)
        return Pose(turned, self._begin.origin + share * self._way)


def _turn(rotation: Array) -> tuple[Array, float]:
    """Axis and angle [rad] of a rotation."""
    from scipy.spatial.transform import Rotation  # takes a quarter of a second to load

    vector = Rotation.from_matrix(rotation).as_rotvec()
    angle = float(np.linalg.norm(vector))
    return (vector / angle, angle) if angle > 0 else (np.array([0.0, 0.0, 1.0]), 0.0)


def _newton(kinematics: Kinematics, begin: Array, pose: Pose) -> Array | None:
    """Positions near some at which the link stands in a pose; None without any."""
    q = begin
    for _ in range(_MOST_NEWTON):
        offset, slopes = kinematics.offset(q, pose)
        step, *_ = np.linalg.lstsq(slopes, offset, rcond=_RANK)
        q = q - step
        if np.abs(step).max() < _SETTLED:
            offset, _ = kinematics.offset(q, pose)
            return q if np.abs(offset).max() < _ON_LINE else None
    return None


def _reaches(kinematics: Kinematics, begin: Array, place: Array) -> bool:
    """Whether the link comes to a place from positions nearby, however it turns."""
    q = begin
    for _ in range(_MOST_NEWTON):
        offset, slopes = kinematics.offset(q, Pose(np.eye(3), place))
        step, *_ = np.linalg.lstsq(slopes[:3], offset[:3], rcond=_RANK)
        q = q - step
        if np.abs(offset[:3]).max() < _ON_LINE:
            return True
    return False


_OF_A_POSE = 6
"""Joints that can put a link anywhere, in any orientation."""
_MOST_NEWTON = 30
_SETTLED = 1e-13
"""Of the last step [rad or m]."""
_ON_LINE = 1e-10
"""Offset [m, rad] that counts as none: of a robot with fewer than six joints some pose has more."""
_RANK = 1e-9
"""Of the slopes: directions in which a robot cannot move its link, as a SCARA its tilt."""
