"""Straight lines of a link in space, by inverse kinematics of the robot that does not bend."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import chebyshev

from quietarm.models.joint_motion import Array
from quietarm.models.robot.dynamics.kinematics import Kinematics, Pose
from quietarm.models.robot.frames import rotation_about

LEAST_LENGTH = 1e-6
"""Of a line [m], or least turn [rad]."""


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


def off_straight(kinematics: Kinematics, path: Callable[[Array], Array]) -> float:
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


def tip_beside_lines(kinematics: Kinematics, positions: Array, nearest: Array) -> float:
    """Largest distance of a link [m] at positions from where it is at others, row by row."""
    step = max(1, len(positions) // _MOST_SAMPLES)
    return max(
        float(np.linalg.norm(kinematics.pose(here).origin - kinematics.pose(there).origin))
        for here, there in zip(positions[::step], nearest[::step])
    )


_MOST_SAMPLES = 500


class _Line:
    """A straight line from pose to pose that turns about one axis."""

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
    """Return whether the link comes to a place from positions nearby, however it turns."""
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
