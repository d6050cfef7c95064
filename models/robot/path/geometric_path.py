"""The path that the joints of a robot follow: positions by a share s of it, from 0 to 1."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from quietarm.interrupts import interruptible
from quietarm.models.joint_motion import Array
from quietarm.models.number_checks import how_named, listed, positive, quoted
from quietarm.models.robot.dynamics.kinematics import Kinematics, Pose
from quietarm.models.robot.dynamics.moving_robot import MovingRobot
from quietarm.models.robot.path.joint_table import read_joint_table
from quietarm.models.robot.path.not_driven import moves_undriven
from quietarm.models.robot.path.piecewise import NoFitError, Piecewise, fit, interpolate
from quietarm.models.robot.path.straight_line import straight_positions
from quietarm.models.robot.path.straight_lines import (
    BACK,
    blends_within,
    fewest_within,
    nearest_on_lines,
    rounded_lines,
    vertices_within,
    with_round_corners,
    without_spurs,
)

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
_SAME = 1e-7
"""The same of points of which some are taken."""
_DEGREES = (3, 5)
MOST_WAYPOINTS = 200
"""Of a spline; of more some are taken."""
_FEW = 20
"""Waypoints that somebody chose, and all of which a spline passes if it may."""
MOST_POINTS = 20_000
"""Of which these may be taken."""
USUAL_TOLERANCE = 5e-4
"""Of a path through some of many points [rad or m], where none is given."""
_WITHIN = 0.9
"""Share of a tolerance that is aimed at."""
_SHARES = (0.02, 0.05, 0.1, 0.25)
"""Of a tolerance, by which the lines that are kept may be others than those of all points."""
_MOST_LINES = 400
_OF_A_POSE = 6
"""Numbers of a place and an orientation."""


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
    lines : sequence, optional
        Points between which it follows straight lines, more or less, by `within`.

    Raises
    ------
    ValueError
        When it is no path: not from 0 to 1, of length 0, or with a corner.
    """

    example: ClassVar[str] = "a path, such as GeometricPath.line(q0, q1)"

    knots: tuple[float, ...]
    coefficients: tuple[tuple[tuple[float, ...], ...], ...]
    joints: tuple[str, ...] = ()
    remarks: tuple[str, ...] = field(default=(), compare=False, metadata={"if_stated": True})
    lines: tuple[tuple[float, ...], ...] = field(
        default=(), compare=False, metadata={"if_stated": True}
    )

    def __post_init__(self) -> None:
        object.__setattr__(self, "knots", tuple(map(float, self.knots)))
        rows = tuple(
            tuple(tuple(map(float, terms)) for terms in joints) for joints in self.coefficients
        )
        object.__setattr__(self, "coefficients", rows)
        object.__setattr__(self, "joints", tuple(self.joints))
        object.__setattr__(self, "remarks", tuple(self.remarks))
        object.__setattr__(self, "lines", tuple(tuple(map(float, row)) for row in self.lines))
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
        """Make a path straight in joint space, from positions to positions [rad or m]."""
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
        turns: bool = True,
    ) -> GeometricPath:
        """Make a path along which a link that does not bend goes straight, by inverse kinematics.

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
        turns : bool
            False lets the link turn as it likes: the line is by its place alone, by the shortest
            steps of the joints.

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
            if len(pose) == _OF_A_POSE and not turns:
                raise ValueError(
                    "to of the line has roll, pitch and yaw, and its orientation is free; give x, "
                    "y, z alone"
                )
            end = Pose.of(pose, before)
        return cls.of(straight_positions(kinematics, positions, end, turns), joints=robot.joints)

    @classmethod
    def through(
        cls,
        waypoints: ArrayLike,
        *,
        at: Sequence[float] | None = None,
        degree: int = 5,
        joints: Sequence[str] = (),
        first: int = 1,
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
        first : int
            The number of the first waypoint in words, such as that in a file of more.
        """
        points = _rows(waypoints)
        numbers = [*range(first, first + len(points))]
        if degree not in _DEGREES:
            raise ValueError(
                f"degree of the path is {degree}; give 5 or 3: a robot can follow a path with "
                "corners only if it stops there, so plan a move to each"
            )
        remarks = tuple[str, ...]()
        if at is None:
            points, remarks, numbers = _without_repeated(points, first=first)
            _check_turns(points, numbers)
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
            nearest = int(np.diff(places).argmin())
            raise ValueError(
                f"waypoints {numbers[nearest]} and {numbers[nearest + 1]} are too near each other "
                f"for a spline: {np.diff(places).min():.2g} of the path; leave one of them out"
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
    def load(
        cls,
        path: str | Path,
        *,
        degree: int = 5,
        within: float | None = None,
        waypoints: tuple[int, int] | None = None,
    ) -> GeometricPath:
        """Read a path through a file's points: csv, or a trajectory_msgs/JointTrajectory as YAML.

        A message that has a JointTrajectory within will do as well: RobotTrajectory,
        DisplayTrajectory, a goal of FollowJointTrajectory. A csv has the joints' names above its
        columns, or no names. Only positions are used; `remarks` names what else there is. Of more
        than two hundred points those are taken that keep the path within 0.0005 rad (or m).

        Parameters
        ----------
        within : float, optional
            As of `within`: how far the path may be from straight lines between the points.
        waypoints : (int, int), optional
            The first and the last of the file's points that it takes, counted from 1.
        """
        table = read_joint_table(path)
        try:
            table = table.between(waypoints)
            first = 1 if waypoints is None else waypoints[0]
            if within is not None or len(table.positions) > MOST_WAYPOINTS:
                tolerance = within or USUAL_TOLERANCE
                through = cls.within(
                    table.positions, tolerance, degree=degree, joints=table.joints, first=first
                )
            else:
                through = cls.through(
                    table.positions, degree=degree, joints=table.joints, first=first
                )
        except ValueError as error:
            raise ValueError(f"path {path}: {error}") from None
        return replace(through, remarks=(*table.remarks, *through.remarks))

    @classmethod
    def within(
        cls,
        waypoints: ArrayLike,
        tolerance: float,
        *,
        degree: int = 5,
        joints: Sequence[str] = (),
        first: int = 1,
    ) -> GeometricPath:
        """Make a path within a tolerance of the straight lines between waypoints, maybe very many.

        Of up to twenty waypoints the spline of `through` where it is near enough; or else one
        through as few of the points as keep it so; or else the straight lines themselves, their
        corners rounded. Which of these it is, `remarks` says.

        Parameters
        ----------
        waypoints : array_like, shape (waypoints, joints)
            [rad or m].
        tolerance : float
            How far each joint may be from the nearest point of the lines [rad or m].
        first : int
            As of `through`.

        Raises
        ------
        ValueError
            When no such path has two hundred pieces or fewer.
        """
        tolerance = positive("tolerance of the path", tolerance, "rad or m")
        points = _rows(waypoints, most=MOST_POINTS)
        if len(points) <= _FEW:
            path = cls.through(points, degree=degree, joints=joints, first=first)
            if path.off_straight.max() <= tolerance:
                return path
        given = points
        points = _without_repeated(points, _SAME).points
        points, remarks = without_spurs(points, tolerance)
        try:
            path, words = cls._near(points, tolerance, degree, joints)
        except _TurnsBackError as error:
            at = int(np.abs(given - error.point).sum(axis=1).argmin())
            raise _TurnsBackError(first + at, error.point) from None
        near = f"within {tolerance:.3g} rad (or m) of the lines between all"
        words = f"{words.format(len(given))}, {near}"
        lines = tuple(map(tuple, _few_lines(points, tolerance).tolist()))
        return replace(path, lines=lines, remarks=(*remarks, words))

    @classmethod
    def blended(
        cls,
        robot: MovingRobot,
        waypoints: ArrayLike,
        radius: float | Sequence[float],
        *,
        joints: Sequence[str] = (),
        first: int = 1,
    ) -> GeometricPath:
        """Make a path straight between waypoints in joint space, round where the tip is near one.

        A corner is round from where the tip comes within the radius of its place at the waypoint to
        where it leaves that, or between the halves of the lines where these are nearer. Three
        derivatives are continuous. `remarks` has at what distance the tip passes each waypoint.

        Parameters
        ----------
        robot : Robot
            Whose tip is meant, without what bends.
        waypoints : array_like, shape (waypoints, joints)
            [rad or m].
        radius : float or sequence of float
            One for all waypoints but the first and the last, or one of each [m].
        joints : sequence of str, optional
            The joints of the waypoints; the robot's, in its order, by default.
        first : int
            As of `through`.

        Raises
        ------
        ValueError
            When there is no waypoint between two others, or the way turns back at one.
        """
        names = tuple(joints) or robot.joints
        points = _rows(waypoints)
        if points.shape[1] != len(names) or not {*robot.joints} <= {*names}:
            missing = [name for name in robot.joints if name not in names]
            hints = how_named([name for name in names if name not in robot.joints], missing)
            raise ValueError(
                f"the waypoints are of {listed(names)}, {points.shape[1]} numbers each, and the "
                f"robot drives {listed(robot.joints)}; give a position of each{hints}"
            )
        moving = [f"warning: {words}" for words in moves_undriven(robot, names, points)]
        order = [names.index(name) for name in robot.joints]
        points, remarks, numbers = _without_repeated(points[:, order], first=first)
        _check_turns(points, numbers)
        radii = _radii(radius, len(points) - 2)
        kinematics = robot.kinematics(robot.tip)
        halves, reached = blends_within(points, lambda q: kinematics.pose(q).origin, radii)
        rounded = with_round_corners(points, halves)
        path = cls(*_plain(rounded), robot.joints)
        passed = tuple(
            f"waypoint {number} is passed at {1e3 * distance:.2g} mm, blended within "
            f"{1e3 * within:.3g} mm{_half_of_line(within, radius_there)}"
            for number, distance, within, radius_there in zip(
                numbers[1:], _passed(rounded, kinematics, points, halves), reached, radii
            )
        )
        lines = tuple(map(tuple, points.tolist()))
        return replace(path, lines=lines, remarks=(*moving, *remarks, *passed))

    @classmethod
    def _near(
        cls, points: Array, tolerance: float, degree: int, joints: Sequence[str]
    ) -> tuple[GeometricPath, str]:
        """A line, a spline or lines with round corners that is near enough, and words on it."""
        corners = vertices_within(points, tolerance / 4)
        if len(corners) == 2:
            return cls.line(*corners, joints=joints), "a straight line in place of {} points"
        most = min(2 * len(corners), MOST_WAYPOINTS)
        spline = partial(_natural, degree=degree)
        kept, places = fewest_within(points, _WITHIN * tolerance, spline, most)
        if len(kept):
            path = cls.through(points[kept], at=places.tolist(), degree=degree, joints=joints)
            return path, f"through {len(kept)} of {{}} points"
        if 2 * len(corners) > MOST_WAYPOINTS:
            raise ValueError(
                f"{len(corners)} of its points are needed to stay within {tolerance:.3g} rad "
                f"(or m) of the lines between all; a path has {MOST_WAYPOINTS // 2} at most: "
                "give a larger tolerance, such as --path-tolerance 0.5deg, or a part of the path"
            )
        _check_turns(corners, range(len(corners)))
        left_out = np.linalg.norm(points - nearest_on_lines(points, corners), axis=1).max()
        rounded = rounded_lines(corners, _WITHIN * tolerance - left_out)
        path = cls(*_plain(rounded), tuple(joints))
        return path, f"straight between {len(corners)} of {{}} points, with round corners"

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
        lines = tuple(tuple(row[i] for i in order) for row in self.lines)
        return GeometricPath(self.knots, rows, tuple(names), remarks, lines)

    @cached_property
    def off_straight(self) -> Array:
        """Largest distance of a spline from straight lines between its waypoints [rad or m].

        0 of a line, and of a path that a function gives.
        """
        positions, nearest = self.beside_lines
        return np.abs(positions - nearest).max(axis=0)

    @property
    def _is_spline(self) -> bool:
        """Return whether its knots are waypoints, all or some of those that it was made of."""
        return len(self.knots) > 2 and len(self.coefficients[0][0]) <= max(_DEGREES) + 1

    @property
    def waypoints(self) -> Array:
        """Waypoints of a spline through all of them [rad or m]; no rows of other paths."""
        if not self._is_spline or self.lines:
            return np.zeros((0, self.count))
        return self.inner(np.array(self.knots))

    @cached_property
    def beside_lines(self) -> tuple[Array, Array]:
        """Positions along it, and the nearest points of the lines between its waypoints."""
        if not self._is_spline and not self.lines:
            return np.zeros((1, self.count)), np.zeros((1, self.count))
        knots = np.array(self.knots)
        samples = max(_SAMPLES_OF_PIECE, _SAMPLES // (len(knots) - 1))
        shares = np.linspace(0.0, 1.0, samples, endpoint=False)
        places = (knots[:-1, None] + np.diff(knots)[:, None] * shares).ravel()
        positions = self.inner(places)
        if self.lines:
            return positions, nearest_on_lines(positions, np.array(self.lines))
        ends = self.inner(knots)
        parts = np.split(positions, len(knots) - 1)
        nearest = [nearest_on_lines(part, ends[at : at + 2]) for at, part in enumerate(parts)]
        return positions, np.concatenate(nearest)

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


_SAMPLES = 2000
_SAMPLES_OF_PIECE = 20
"""Of a path, and of each of its pieces at least, between which it hardly leaves its lines."""
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


class _Kept(NamedTuple):
    """Waypoints that are kept, words on the others, and the numbers of those that are kept."""

    points: Array
    remarks: tuple[str, ...]
    numbers: list[int]


def _without_repeated(points: Array, share: float = _NEAR, first: int = 1) -> _Kept:
    """Waypoints without those that repeat the one before them, which words name.

    Of the last two the last one is kept. They are numbered from the first one's number.
    """
    ways = np.linalg.norm(np.diff(points, axis=0), axis=1)
    near = max(_LEAST_WAY, share * float(ways.sum()))
    kept = [0]
    remarks = list[str]()
    for number in range(1, len(points)):
        way = float(np.linalg.norm(points[number] - points[kept[-1]]))
        if way >= near:
            kept.append(number)
            continue
        remarks.append(
            f"waypoints {kept[-1] + first} and {number + first} are {way:.2g} rad (or m) apart and "
            "taken as one"
        )
        if number == len(points) - 1 and kept[-1] > 0:
            kept[-1] = number
    if len(kept) < 2:
        raise ValueError(
            f"the path has a length of {ways.sum():.3g} and ends where it begins; give one that "
            "moves a joint"
        )
    return _Kept(points[kept], tuple(remarks), [number + first for number in kept])


def _radii(radius: float | Sequence[float], corners: int) -> Array:
    """A radius of each waypoint between two others [m]."""
    if corners < 1:
        raise ValueError(
            "a blend is at a waypoint between two others, and there is none; give three waypoints "
            "or more"
        )
    several = [radius] * corners if np.ndim(radius) == 0 else list(radius)  # pyright: ignore[reportArgumentType]
    if len(several) != corners:
        raise ValueError(
            f"there are {len(several)} radii and {corners} waypoints between the first and the "
            "last; give one for all, or one of each"
        )
    return np.array([positive("radius of a blend", value, "m") for value in several])


def _half_of_line(within: float, radius: float) -> str:
    """Say that a corner is less round than its radius, as a line's half is nearer."""
    if within > 0.999 * radius:
        return ""
    return f" in place of {1e3 * radius:.3g} mm, as half of a line is nearer"


def _passed(path: Piecewise, kinematics: Kinematics, points: Array, halves: Array) -> list[float]:
    """Return how near the tip passes its place at each corner [m]."""
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    total = float(lengths.sum())
    distances = list[float]()
    for corner, at, half in zip(points[1:-1], np.cumsum(lengths), halves):
        places = (at + half * np.linspace(-1.0, 1.0, 41)) / total
        centre = kinematics.pose(corner).origin
        distances.append(
            min(float(np.linalg.norm(kinematics.pose(q).origin - centre)) for q in path(places))
        )
    return distances


class _TurnsBackError(ValueError):
    """A way turns back at a waypoint, which has a number in words."""

    def __init__(self, number: int, point: Array) -> None:
        super().__init__(
            f"the path turns back at waypoint {number}, a corner; plan a move to it and another "
            "from there, or round the corner by a waypoint beside it"
        )
        self.point = point


def _check_turns(points: Array, numbers: Sequence[int]) -> None:
    """Refuse a way that turns back where it came from; waypoints have numbers in words."""
    steps = np.diff(points, axis=0)
    steps = steps / np.linalg.norm(steps, axis=1)[:, None]
    cosines = (steps[1:] * steps[:-1]).sum(axis=1)
    for number, point, cosine in zip(numbers[1:], points[1:], cosines):
        if cosine < BACK:
            raise _TurnsBackError(number, point)


def _few_lines(points: Array, tolerance: float) -> Array:
    """Points whose lines are those of all, by a small share of a tolerance."""
    several = (vertices_within(points, share * tolerance) for share in _SHARES)
    few = next((lines for lines in several if len(lines) <= _MOST_LINES), None)
    return vertices_within(points, _SHARES[-1] * tolerance) if few is None else few


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


def _rows(values: ArrayLike, most: int = MOST_WAYPOINTS) -> Array:
    try:
        rows = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        rows = np.zeros(0)
    if rows.ndim != 2 or len(rows) < 2 or not rows.size:
        raise ValueError(
            "the waypoints are no table; give two rows or more, with a number for each joint"
        )
    unusable = np.argwhere(~np.isfinite(rows))
    if len(unusable):
        row, column = unusable[0]
        raise ValueError(
            f"waypoint {row + 1} has {rows[row, column]:g} for its joint {column + 1}; give a "
            "finite number, or leave the waypoint out"
        )
    if len(rows) > most:
        raise ValueError(
            f"the path has {len(rows)} waypoints; give at most {most}, those that matter"
        )
    return rows
