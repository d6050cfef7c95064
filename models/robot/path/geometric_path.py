"""The path that the joints of a robot follow: positions by a share s of it, from 0 to 1."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from quietarm.interrupts import interruptible
from quietarm.models.joint_motion import Array
from quietarm.models.number_checks import listed, quoted
from quietarm.models.robot.dynamics.kinematics import Pose
from quietarm.models.robot.dynamics.moving_robot import MovingRobot
from quietarm.models.robot.path.piecewise import NoFitError, Piecewise, fit, interpolate
from quietarm.models.robot.path.straight_line import straight_positions
from quietarm.models.robot.text_files import read_text, read_yaml

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

BEYOND = 0.1
"""So much of a path is added at its ends, where a motion overshoots."""
_EXACT = 1e-12
"""Largest error of a path that a function gives [rad or m]."""
_LEAST_WAY = 1e-6
"""Of a path, and between two waypoints [rad or m]."""
_NEAR = 1e-4
"""Share of the way within which neighbours are one waypoint: a spline through both would follow
their rounding."""
_DEGREES = (3, 5)
_MOST_WAYPOINTS = 200
_BACK = -0.95
"""Cosine between two parts of a way, below which it turns back."""


class _NotSmoothError(ValueError):
    """A path has a jump, a corner or a jump of its curvature."""


@dataclass(frozen=True)
class GeometricPath:
    """Positions of the joints along a path, polynomials of s between knots.

    `line`, `cartesian_line`, `through`, `of` and `load` make one.

    Parameters
    ----------
    knots : sequence of float
        From 0 to 1.
    coefficients : sequence
        By piece, joint and Chebyshev polynomial of the share of the piece, from -1 to 1 [rad or m].
    joints : sequence of str, optional
        Names of the joints; the robot's, in its order, by default.
    remarks : sequence of str
        What was passed over when its waypoints were read, in one line each.

    Raises
    ------
    ValueError
        When it is no path: not from 0 to 1, of length 0, or with a corner.
    """

    example: ClassVar[str] = "a path, as GeometricPath.line(q0, q1)"

    knots: tuple[float, ...]
    coefficients: tuple[tuple[tuple[float, ...], ...], ...]
    joints: tuple[str, ...] = ()
    remarks: tuple[str, ...] = field(default=(), compare=False, metadata={"if_stated": True})

    def __post_init__(self) -> None:
        object.__setattr__(self, "knots", tuple(map(float, self.knots)))
        rows = tuple(
            tuple(tuple(map(float, terms)) for terms in joints) for joints in self.coefficients
        )
        object.__setattr__(self, "coefficients", rows)
        object.__setattr__(self, "joints", tuple(self.joints))
        object.__setattr__(self, "remarks", tuple(self.remarks))
        rising = bool(np.all(np.diff(self.knots) > 0))
        if len(self.knots) < 2 or (self.knots[0], self.knots[-1]) != (0.0, 1.0) or not rising:
            raise ValueError(
                f"knots of the path are {list(self.knots)}; give some that rise from 0 to 1"
            )
        shapes = {(len(joints), len(terms)) for joints in rows for terms in joints}
        if len(rows) != len(self.knots) - 1 or len(shapes) != 1:
            raise ValueError("coefficients of the path do not fit its knots; make it anew")
        if not np.all(np.isfinite(self.inner.coefficients)):
            raise ValueError("coefficients of the path are not finite; make it anew")
        for name in self.joints:
            if self.joints.count(name) > 1:
                raise ValueError(f"the path has joint {quoted(name)} twice; give each once")
        if self.joints and len(self.joints) != self.count:
            raise ValueError(
                f"the path has {self.count} joints and {len(self.joints)} names; give one of each"
            )
        self._check_way()
        self._check_corners()

    @classmethod
    def line(cls, start: ArrayLike, end: ArrayLike, joints: Sequence[str] = ()) -> GeometricPath:
        """Straight in joint space, from positions to positions [rad or m]."""
        ends = np.array([_row("start of the path", start), _row("end of the path", end)])
        middle = (ends[0] + ends[1]) / 2
        half = (ends[1] - ends[0]) / 2
        return cls((0.0, 1.0), (tuple(zip(middle, half)),), tuple(joints))

    @classmethod
    def cartesian_line(
        cls,
        robot: MovingRobot,
        start: ArrayLike,
        *,
        to: ArrayLike | None = None,
        by: ArrayLike | None = None,
        link: str | None = None,
    ) -> GeometricPath:
        """Straight in space for a link of the robot that does not bend, by inverse kinematics.

        The joints follow within 1e-12 rad. Springs do not count: the link of a robot that bends
        hangs by its sag below the line.

        Parameters
        ----------
        robot : Robot
            Whose link moves.
        start : array_like
            Positions of its joints at the start [rad or m]; they tell the elbow's side, too.
        to : array_like, optional
            Where the link goes, seen from the ground: x, y, z [m], or these and roll, pitch, yaw
            [rad], as in a URDF. Without these the link does not turn.
        by : array_like, optional
            In place of `to`: the way x, y, z [m], along the ground's axes; the link does not turn.
        link : str, optional
            By default the one that carries the beam, or else the tip.

        Raises
        ------
        ValueError
            When the line has no length, is out of reach or meets a singular posture.
        """
        positions = _row("start of the line", start)
        if len(positions) != len(robot.joints):
            raise ValueError(
                f"start of the line has {len(positions)} positions, and the robot drives "
                f"{len(robot.joints)} joints; give one of each"
            )
        if (to is None) == (by is None):
            raise ValueError("a line has to end somewhere; give either to=, a pose, or by=, a way")
        kinematics = robot.kinematics(link)
        before = kinematics.pose(positions)
        if by is not None:
            end = before.moved(_numbers("by", by, (3,), "x, y, z [m]"))
        else:
            pose = _numbers("to", to, (3, 6), "x, y, z [m], or these and roll, pitch, yaw [rad]")
            end = Pose.of(pose, before)
        return cls.of(straight_positions(kinematics, positions, end), joints=robot.joints)

    @classmethod
    def through(
        cls,
        waypoints: ArrayLike,
        *,
        at: Sequence[float] | None = None,
        degree: int = 5,
        joints: Sequence[str] = (),
    ) -> GeometricPath:
        """A natural spline through waypoints, shape (waypoints, joints) [rad or m].

        Neighbours that are nearer than a ten thousandth of the way, such as a point that a teach
        pendant repeats, are taken as one; `remarks` has which. `off_straight` says how far the
        spline leaves the straight lines between the waypoints.

        Parameters
        ----------
        at : sequence of float, optional
            Where on the path they are, from 0 to 1; by default by the way between them.
        degree : int
            5, with four continuous derivatives, or 3, with two: then the jerk jumps at waypoints.
        """
        points = _rows(waypoints)
        if degree not in _DEGREES:
            raise ValueError(
                f"degree of the path is {degree}; give 5 or 3: a robot can follow a path with "
                "corners only if it stops there, so plan a move to each"
            )
        remarks = tuple[str, ...]()
        if at is None:
            points, remarks = _without_repeated(points)
            _check_turns(points)
            ways = np.linalg.norm(np.diff(points, axis=0), axis=1)
            places = np.append(0.0, np.cumsum(ways)) / ways.sum()
            places[-1] = 1.0
        else:
            places = _row("at", at)
            if (
                len(places) != len(points)
                or np.any(np.diff(places) <= 0)
                or (places[0], places[-1]) != (0, 1)
            ):
                raise ValueError(
                    f"at is {places.tolist()}; give a share of the path for each waypoint, rising "
                    "from 0 to 1"
                )
        if len(points) == 2:
            return replace(cls.line(*points, joints=joints), remarks=remarks)
        try:
            path = cls._of_spline(_natural(places, points, degree), places, tuple(joints))
        except _NotSmoothError:
            nearest = int(np.diff(places).argmin()) + 1
            raise ValueError(
                f"waypoints {nearest} and {nearest + 1} are too near each other for a spline: "
                f"{np.diff(places).min():.2g} of the path; leave one of them out"
            ) from None
        return replace(path, remarks=remarks)

    @classmethod
    def of(
        cls, function: Callable[[float], ArrayLike], joints: Sequence[str] = ()
    ) -> GeometricPath:
        """Make a path by a function of s from 0 to 1 that gives the joints' positions [rad or m].

        It is approximated within 1e-12.
        """

        def values(places: Array) -> Array:
            return np.array([_row(f"path at s = {s:.4g}", function(float(s))) for s in places])

        try:
            found = fit(values, np.array([0.0, 1.0]), lambda _: np.array([_EXACT]))
        except NoFitError as error:
            raise ValueError(
                f"the path has a corner or a jump near s = {error.place:.4g}; give a smooth "
                "function, or waypoints for a spline"
            ) from None
        return cls(*_plain(found), tuple(joints))

    @classmethod
    @interruptible
    def load(cls, path: str | Path, *, degree: int = 5) -> GeometricPath:
        """Through the points of a file: csv, or a trajectory_msgs/JointTrajectory as YAML.

        A message that has a JointTrajectory within will do as well: RobotTrajectory,
        DisplayTrajectory, a goal of FollowJointTrajectory. A csv has the joints' names above its
        columns, or no names. Only positions are used; `remarks` names what else there is.
        """
        if Path(path).suffix.lower() in (".yaml", ".yml", ".json"):
            names, points, remarks = _trajectory_of(path)
        else:
            names, points, remarks = _table_of(path)
        try:
            through = cls.through(points, degree=degree, joints=names)
        except ValueError as error:
            raise ValueError(f"path {path}: {error}") from None
        return replace(through, remarks=(*remarks, *through.remarks))

    @classmethod
    def _of_spline(cls, spline: BSpline, knots: Array, joints: tuple[str, ...]) -> GeometricPath:
        found = Piecewise(knots, interpolate(spline, knots, spline.k + 1))
        return cls(*_plain(found), joints)

    @property
    def count(self) -> int:
        """Number of joints."""
        return len(self.coefficients[0])

    @cached_property
    def inner(self) -> Piecewise:
        """The path from 0 to 1."""
        rows = np.array(self.coefficients)
        return Piecewise(np.array(self.knots), rows.swapaxes(1, 2))

    @cached_property
    def extended(self) -> Piecewise:
        """The path and a part beyond either end, with the curvature of the end."""
        inner = self.inner
        terms = inner.coefficients.shape[1]
        if len(self.knots) == 2 and terms <= 3:  # goes on as it is
            knots = np.array([-BEYOND, 1 + BEYOND])
            return inner.on(knots)
        terms = max(3, terms)
        parts = list[Array]()
        for begin, end, place in ((-BEYOND, 0.0, 0.0), (1.0, 1 + BEYOND, 1.0)):
            value, slope, bend = (inner([place], order)[0] for order in range(3))
            nodes = begin + (end - begin) * (np.cos(np.pi * (np.arange(3) + 0.5) / 3) + 1) / 2
            way = (nodes - place)[:, None]
            rows = value + way * slope + way**2 / 2 * bend
            part = np.zeros((terms, self.count))
            part[:3] = np.polynomial.chebyshev.chebfit(
                np.cos(np.pi * (np.arange(3) + 0.5) / 3), rows, 2
            )
            parts.append(part)
        filled = np.zeros((len(inner.coefficients), terms, self.count))
        filled[:, : inner.coefficients.shape[1]] = inner.coefficients
        knots = np.array([-BEYOND, *self.knots, 1 + BEYOND])
        return Piecewise(knots, np.array([parts[0], *filled, parts[1]]))

    def of_joints(self, names: Sequence[str]) -> GeometricPath:
        """Return the path of these joints alone, in their order."""
        order = [self.joints.index(name) for name in names]
        rows = tuple(tuple(joints[i] for i in order) for joints in self.coefficients)
        left_out = [name for name in self.joints if name not in names]
        remarks = self.remarks
        if left_out:
            remarks += (f"joints that the robot does not drive are left out: {listed(left_out)}",)
        return GeometricPath(self.knots, rows, tuple(names), remarks)

    @cached_property
    def off_straight(self) -> Array:
        """Largest distance of a spline from straight lines between its waypoints [rad or m].

        0 of a line, and of a path that a function gives.
        """
        of_spline = len(self.knots) > 2 and len(self.coefficients[0][0]) <= max(_DEGREES) + 1
        if not of_spline:
            return np.zeros(self.count)
        shares = np.linspace(0.0, 1.0, 201)[1:-1, None]
        largest = np.zeros(self.count)
        for begin, end in pairwise(self.knots):
            ends = self.inner([begin, end])
            positions = self.inner(begin + (end - begin) * shares[:, 0])
            # the nearest point of the line: of several joints none is at fault for its timing
            way = ends[1] - ends[0]
            along = np.clip((positions - ends[0]) @ way / max(way @ way, 1e-300), 0.0, 1.0)
            off = np.abs(positions - ends[0] - along[:, None] * way)
            largest = np.maximum(largest, off.max(axis=0))
        return largest

    def __call__(self, s: ArrayLike, order: int = 0) -> Array:
        """Positions, or derivatives by s, shape (places, joints), or (joints,) of one place."""
        values = self.extended(np.atleast_1d(np.asarray(s, dtype=float)), order)
        return values[0] if np.ndim(s) == 0 else values

    def _check_way(self) -> None:
        places = np.linspace(0.0, 1.0, 201)
        way = float(np.abs(np.diff(self.inner(places), axis=0)).sum())
        if way < _LEAST_WAY:
            raise ValueError(f"the path has a length of {way:.3g}; give one that moves a joint")

    def _check_corners(self) -> None:
        """Positions, slopes and curvatures are continuous at the knots."""
        inner = self.inner
        for number, knot in enumerate(self.knots[1:-1]):
            before = Piecewise(
                inner.knots[number : number + 2], inner.coefficients[number : number + 1]
            )
            after = Piecewise(
                inner.knots[number + 1 : number + 3], inner.coefficients[number + 1 : number + 2]
            )
            for order, what in enumerate(("jump", "corner", "jump of its curvature")):
                scale = max(1.0, float(np.abs(inner(np.linspace(0, 1, 101), order)).max()))
                if np.abs(before([knot], order) - after([knot], order)).max() > _CONTINUOUS * scale:
                    raise _NotSmoothError(
                        f"the path has a {what} at s = {knot:.4g}; give waypoints, for a spline, "
                        "or plan a move to each corner"
                    )


_CONTINUOUS = 1e-6
"""Share of the largest value by which a path and its derivatives may jump."""


def _plain(found: Piecewise) -> tuple[Any, Any]:
    rows = found.coefficients.swapaxes(1, 2).tolist()
    return tuple(found.knots.tolist()), tuple(tuple(map(tuple, joints)) for joints in rows)


def _natural(places: Array, points: Array, degree: int) -> BSpline:
    """The spline whose higher derivatives are 0 at the ends: of all it bends least."""
    from scipy.interpolate import make_interp_spline  # takes a quarter of a second to load

    count = len(points)
    if degree == 5 and count == 3:  # a parabola has none
        degree = 2
        return make_interp_spline(places, points, k=degree)
    orders = range((degree + 1) // 2, degree)
    ends = [(order, np.zeros(points.shape[1])) for order in orders]
    return make_interp_spline(places, points, k=degree, bc_type=(ends, ends))


def _without_repeated(points: Array) -> tuple[Array, tuple[str, ...]]:
    """Waypoints without those that repeat the one before them, and words on which these are.

    Of the last two the last one is kept.
    """
    ways = np.linalg.norm(np.diff(points, axis=0), axis=1)
    near = max(_LEAST_WAY, _NEAR * float(ways.sum()))
    kept = [0]
    remarks = list[str]()
    for number in range(1, len(points)):
        way = float(np.linalg.norm(points[number] - points[kept[-1]]))
        if way >= near:
            kept.append(number)
            continue
        remarks.append(
            f"waypoints {kept[-1] + 1} and {number + 1} are {way:.2g} rad (or m) apart and taken "
            "as one"
        )
        if number == len(points) - 1 and kept[-1] > 0:
            kept[-1] = number
    if len(kept) < 2:
        raise ValueError(
            f"the path has a length of {ways.sum():.3g} and ends where it begins; give one that "
            "moves a joint"
        )
    return points[kept], tuple(remarks)


def _check_turns(points: Array) -> None:
    """Refuse a way that turns back where it came from."""
    steps = np.diff(points, axis=0)
    steps = steps / np.linalg.norm(steps, axis=1)[:, None]
    for number, cosine in enumerate((steps[1:] * steps[:-1]).sum(axis=1), start=2):
        if cosine < _BACK:
            raise ValueError(
                f"the path turns back at waypoint {number}, a corner; plan a move to it and "
                "another from there, or round the corner by a waypoint beside it"
            )


def _row(name: str, values: ArrayLike) -> Array:
    try:
        row = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        row = np.zeros((0, 0))
    if row.ndim != 1 or not len(row) or not np.all(np.isfinite(row)):
        raise ValueError(f"{name} is {quoted(values)}; give a finite number for each joint")
    return row


def _numbers(name: str, values: Any, counts: tuple[int, ...], wanted: str) -> Array:
    """A row of as many numbers as one of the counts."""
    row = _row(f"{name} of the line", values)
    if len(row) not in counts:
        raise ValueError(f"{name} of the line has {len(row)} numbers; give {wanted}")
    return row


def _rows(values: ArrayLike) -> Array:
    try:
        rows = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        rows = np.zeros(0)
    if rows.ndim != 2 or len(rows) < 2 or not rows.size or not np.all(np.isfinite(rows)):
        raise ValueError(
            "the waypoints are no table; give two rows or more, with a number for each joint"
        )
    if len(rows) > _MOST_WAYPOINTS:
        raise ValueError(
            f"the path has {len(rows)} waypoints; give at most {_MOST_WAYPOINTS}, those that matter"
        )
    return rows


def _trajectory_of(path: str | Path) -> tuple[tuple[str, ...], Array, list[str]]:
    """Names and positions of the JointTrajectory in a message, and what else there is in words."""
    messages = list(_trajectories_in(read_yaml(path, "path")))
    filled = [message for message in messages if message["joint_names"] or message["points"]]
    positioned = [message for message in filled if not _is_in_space(message)]
    if not positioned:
        raise ValueError(
            f"path {path} is no JointTrajectory; give one with joint_names and points, or a csv"
        )
    if len(positioned) > 1:
        raise ValueError(
            f"path {path} has {len(positioned)} trajectories; give a file of one of them"
        )
    (trajectory,) = positioned
    points = trajectory["points"]
    names = tuple(map(str, trajectory["joint_names"] or ()))
    try:
        positions = np.array([point["positions"] for point in points], dtype=float)
    except (TypeError, KeyError, ValueError):
        raise ValueError(
            f"path {path} has a point without positions of all joints; write it again"
        ) from None
    others = {entry for point in points for entry, value in point.items() if value}
    unused = [words for entry, words in _BESIDE_POSITIONS.items() if entry in others]
    remarks = [f"not used of the trajectory: {', '.join(unused)}"] if unused else []
    if len(filled) > 1:
        remarks.append("not used of the file: a trajectory of joints with several degrees")
    return names, positions, remarks


_BESIDE_POSITIONS = {
    "velocities": "velocities", "accelerations": "accelerations", "effort": "efforts",
    "time_from_start": "times",
}  # fmt: skip
"""Entries of a trajectory's point that a path has no use for."""


def _trajectories_in(document: object) -> Iterator[Mapping[str, Any]]:
    """Find the parts of a message that have joint_names and points, however deep."""
    if isinstance(document, Mapping):
        if "points" in document and "joint_names" in document:
            yield document
            return
        document = list(document.values())
    if isinstance(document, list):
        for entry in document:
            yield from _trajectories_in(entry)


def _is_in_space(trajectory: Mapping[str, Any]) -> bool:
    """Return whether a trajectory is a MultiDOFJointTrajectory, which holds whole poses."""
    points = trajectory["points"]
    first = points[0] if isinstance(points, list) and points else None
    return isinstance(first, Mapping) and "transforms" in first


def _table_of(path: str | Path) -> tuple[tuple[str, ...], Array, list[str]]:
    """Names, where they are above the columns, and positions of a csv; what is not used of it."""
    text = read_text(path, "path")
    lines = [
        line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")
    ]
    if not lines:
        raise ValueError(f"path {path} is empty; give a row for each waypoint")
    mark = next((mark for mark in ";\t," if mark in lines[0]), None)
    rows = (
        [line.split() for line in lines]
        if mark is None
        else list(csv.reader(io.StringIO("\n".join(lines)), delimiter=mark))
    )
    names = tuple[str, ...]()
    try:
        [float(cell) for cell in rows[0]]
    except ValueError:
        names = tuple(cell.strip() for cell in rows[0])
        rows = rows[1:]
    if len({len(row) for row in rows}) != 1:
        raise ValueError(
            f"path {path} has rows of different lengths, or none; give a number for each joint in "
            "each"
        )
    try:
        table = np.array([[float(cell) for cell in row] for row in rows])
    except ValueError as error:
        raise ValueError(
            f"path {path} has a row that is no row of numbers ({error}); give a number for each "
            "joint"
        ) from None
    times = [name.lower().split()[0].split("_")[0].split("(")[0] in ("t", "time") for name in names]
    kept = [number for number, is_time in enumerate(times) if not is_time] if names else slice(None)
    remarks = ["not used of the table: times"] if any(times) else []
    joints = tuple(name for name, is_time in zip(names, times) if not is_time)
    return joints, table[:, kept], remarks
