"""Straight lines of a link in space, by inverse kinematics of the robot that does not bend."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import chebyshev

from quietarm.models.joint_motion import Array
from quietarm.models.number_checks import quoted
from quietarm.models.robot.dynamics.kinematics import Kinematics, Pose
from quietarm.models.robot.frames import rotation_about

LEAST_LENGTH = 1e-6
"""Of a line [m], or least turn [rad]."""


def straight_positions(
    kinematics: Kinematics, start: Array, end: Pose, turns: bool = True
) -> Callable[[float], Array]:
    """(share of a line) -> positions of the joints, along the line from where `start` is to a pose.

    The link's origin goes straight, its rotation turns about one axis, or is free without `turns`.
    A first walk finds where the joints go; a polynomial of it is then the guess from which Newton's
    steps, the shortest that there are, come to the line: so the positions are as smooth as the
    robot lets them be.

    Raises
    ------
    ValueError
        When the line has no length, leaves the robot's reach or meets a singular posture.
    """
    line = _Line(kinematics.pose(start), end)
    if line.length < LEAST_LENGTH and (line.angle < LEAST_LENGTH or not turns):
        raise ValueError(
            f"the line has a length of {line.length:.3g} m; give an end elsewhere than where "
            f"{kinematics.link} is at its start"
        )
    shares = np.linspace(0.0, 1.0, _STEPS + 1)
    walked = [start]
    for share in shares[1:]:
        solution = _newton(kinematics, walked[-1], line.pose(share), turns)
        if solution is None or np.abs(solution - walked[-1]).max() > _MOST_STEP:
            raise ValueError(
                f"{kinematics.link} cannot follow the line beyond {share * line.length:.3g} m of "
                f"its {line.length:.3g} m: "
                + _what_stops(kinematics, walked[-2:], solution, line, share, turns)
            )
        walked.append(solution)
    guess = chebyshev.chebfit(2 * shares - 1, np.array(walked), _DEGREE)

    def positions(share: float) -> Array:
        begin = np.asarray(chebyshev.chebval(2 * share - 1, guess), float)
        solution = _newton(kinematics, begin, line.pose(share), turns)
        if solution is None:
            raise ValueError(
                f"{kinematics.link} cannot follow the line at {share * line.length:.3g} m of its "
                f"{line.length:.3g} m: {_fastest_words(kinematics, walked)}; give "
                "another start, or waypoints"
            )
        return solution

    return positions


def _what_stops(
    kinematics: Kinematics,
    walked: list[Array],
    jumped: Array | None,
    line: _Line,
    share: float,
    turns: bool,
) -> str:
    """Words on what stops a line at a share of it: the place, the orientation or a joint.

    Of what was walked it takes the last; where a step jumped, it is where to.
    """
    if jumped is not None:
        return f"{_fastest_words(kinematics, [walked[-1], jumped])}; {_ELSEWHERE}"
    pose = line.pose(share)
    by_place = _newton(kinematics, walked[-1], pose, turns=False)
    if by_place is None:
        return (
            "the place is out of reach, the link comes no nearer than "
            f"{1e3 * _beyond(kinematics, walked[-1], pose):.2g} mm; give a nearer end or another "
            "start"
        )
    if not turns or _newton(kinematics, by_place, pose) is not None:
        return f"{_fastest_words(kinematics, walked)}; {_ELSEWHERE}"
    axis, _ = _turn(pose.rotation.T @ kinematics.pose(by_place).rotation)
    about = "xyz"[int(np.abs(axis).argmax())]
    held = "keeps" if line.angle < LEAST_LENGTH else "turns"
    joints = len(by_place)
    few = f", for which {joints} joints are few" if joints < _OF_A_POSE else ""
    return (
        f"the place is within reach, but not with the orientation that a line {held}{few}: it "
        f"would turn about {about} of the link; leave it free by --free-orientation (turns=False), "
        "or give waypoints, by --path or GeometricPath.through"
    )


_ELSEWHERE = "give another start, a nearer end, or waypoints"


def _beyond(kinematics: Kinematics, begin: Array, pose: Pose) -> float:
    """Return how near Newton's damped steps come to the place of a pose [m]."""
    q = begin
    for _ in range(_MOST_NEWTON):
        offset, slopes = kinematics.offset(q, pose)
        squared = slopes[:3].T @ slopes[:3] + _DAMPED * np.eye(len(q))
        q = q - np.linalg.solve(squared, slopes[:3].T @ offset[:3])
    offset, _ = kinematics.offset(q, pose)
    return float(np.linalg.norm(offset[:3]))


_DAMPED = 1e-4
"""Of a step's square [m^2]: beyond its reach a robot steps no farther than it is precise."""


def _fastest_words(kinematics: Kinematics, walked: list[Array]) -> str:
    """Words on the joint that goes farthest in one of the steps that were walked."""
    steps = np.abs(np.diff(walked, axis=0)).max(axis=0) if len(walked) > 1 else np.zeros(1)
    mechanism = kinematics.dynamics.mechanism
    fastest = int(steps.argmax())
    body = mechanism.bodies[mechanism.driven[fastest]]
    unit = "m" if body.slides else "rad"
    return (
        f"joint {quoted(body.joint)} swings over, by {steps[fastest]:.2g} {unit} in a two "
        "hundredth of the line"
    )


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


def _newton(kinematics: Kinematics, begin: Array, pose: Pose, turns: bool = True) -> Array | None:
    """Positions near some at which the link stands in a pose, or at its place; None without any."""
    rows = _ROWS if turns else _ROWS[:3]
    q = begin
    for _ in range(_MOST_NEWTON):
        offset, slopes = kinematics.offset(q, pose)
        step, *_ = np.linalg.lstsq(slopes[rows], offset[rows], rcond=_RANK)
        q = q - step
        if np.abs(step).max() < _SETTLED:
            offset, _ = kinematics.offset(q, pose)
            return q if np.abs(offset[rows]).max() < _ON_LINE else None
    return None


_ROWS = [0, 1, 2, 3, 4, 5]
"""Of an offset: place and turn."""
_OF_A_POSE = 6
"""Joints that can put a link anywhere, in any orientation."""
_MOST_NEWTON = 30
_SETTLED = 1e-13
"""Of the last step [rad or m]."""
_ON_LINE = 1e-10
"""Offset [m, rad] that counts as none: of a robot with fewer than six joints some pose has more."""
_RANK = 1e-9
"""Of the slopes: directions in which a robot cannot move its link, as a SCARA its tilt."""
