"""A trajectory as it is timed: positions of joints by time, as a controller joins points."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from quietarm.interrupts import interruptible
from quietarm.models.joint_motion import Array
from quietarm.models.number_checks import how_named, listed, quoted
from quietarm.models.robot.path.joint_table import JointTable, read_joint_table


@dataclass(frozen=True, eq=False)
class TimedMotion:
    """Positions of joints, polynomials of fifth degree by time on every piece.

    Attributes
    ----------
    joints : tuple of str
        Their names; none where a file has none.
    times : ndarray, shape (pieces + 1,)
        From 0 to the duration [s].
    coefficients : ndarray, shape (pieces, joints, 6)
        By powers of the share of a piece [rad or m].
    points : ndarray, shape (points, joints)
        Positions that it passes, in their order.
    remarks : tuple of str
        How it was made of the points, and what it does not use.
    """

    joints: tuple[str, ...]
    times: Array
    coefficients: Array
    points: Array
    remarks: tuple[str, ...] = ()

    @classmethod
    @interruptible
    def load(cls, path: str | Path) -> TimedMotion:
        """The trajectory of a file, as `GeometricPath.load` reads it, with its times.

        Between points it is what a controller of ROS 2 makes of them: of fifth degree by positions,
        velocities and accelerations, of third without the last. By positions alone it is a cubic
        spline from rest to rest.

        Raises
        ------
        ValueError
            When it has no times, or they do not increase.
        """
        try:
            return cls.of_table(read_joint_table(path))
        except ValueError as error:
            words = str(error)
            raise ValueError(words if str(path) in words else f"path {path}: {words}") from None

    @classmethod
    def of_table(cls, table: JointTable) -> TimedMotion:
        """The motion through the points of a table; one that is there twice is one."""
        shortened = table.without_repeated
        remarks = list(shortened.remarks[len(table.remarks) :])
        table = shortened
        times = _checked(table)
        if table.times is not None and table.times[0] != 0:
            remarks.append(f"its first point is at {table.times[0]:.4g} s; the motion begins there")
        points = table.positions
        speeds, accelerations = table.velocities, table.accelerations
        if speeds is None:
            remarks.append("positions alone are followed as a cubic spline from rest to rest")
            speeds, accelerations = _of_spline(times, points)
        elif accelerations is None:
            coefficients = _cubic(times, points, speeds)
            remarks.append("without accelerations its points are joined by cubics")
            return cls(table.joints, times, coefficients, points, tuple(remarks))
        reach = _SAME * np.maximum(np.ptp(points, axis=0), 1e-3)
        fast = _OF_SPEEDS * _SAME * np.maximum(np.abs(speeds).max(axis=0), 1e-3)
        kept = fewest_points(times, points, speeds, accelerations, reach, fast)
        moving = [values[kept] for values in (points, speeds, accelerations)]
        return cls(
            table.joints, times[kept], _quintic(times[kept], *moving), points, tuple(remarks)
        )

    @property
    def duration(self) -> float:
        """Duration of the motion [s]."""
        return float(self.times[-1])

    @cached_property
    def lengths(self) -> Array:
        """Durations of the pieces [s]."""
        return np.diff(self.times)

    def of_joints(self, names: tuple[str, ...]) -> TimedMotion:
        """The motion of these joints, in their order; ValueError where it has not all."""
        if not self.joints:
            if self.points.shape[1] != len(names):
                raise ValueError(
                    f"the trajectory is of {self.points.shape[1]} joints, and the robot drives "
                    f"{len(names)}, {listed(names)}; give positions of these, in this order"
                )
            return TimedMotion(names, self.times, self.coefficients, self.points, self.remarks)
        if missing := [name for name in names if name not in self.joints]:
            others = [name for name in self.joints if name not in names]
            raise ValueError(
                f"the trajectory is of the joints {listed(self.joints)}, without "
                f"{listed(missing)}, which the robot drives; give a trajectory of these as well"
                f"{how_named(others, missing)}"
            )
        for name in self.joints:
            if self.joints.count(name) > 1:
                raise ValueError(f"the trajectory has joint {quoted(name)} twice; give each once")
        order = [self.joints.index(name) for name in names]
        remarks = self.remarks
        if others := [name for name in self.joints if name not in names]:
            remarks += (f"joints that the robot does not drive are left out: {listed(others)}",)
        return TimedMotion(
            names, self.times, self.coefficients[:, order], self.points[:, order], remarks
        )

    def at(self, shares: Array, order: int = 0) -> Array:
        """Values or derivatives by time at shares of pieces, shape (pieces, shares, joints)."""
        terms = self.coefficients
        for _ in range(order):
            terms = terms[..., 1:] * np.arange(1, terms.shape[-1]) / self.lengths[:, None, None]
        powers = np.asarray(shares)[:, None] ** np.arange(terms.shape[-1])
        return np.einsum("pjk,sk->psj", terms, powers)

    @property
    def steps(self) -> Array:
        """Return the jumps of acceleration where pieces meet, and from and to rest, by joint."""
        ends = self.at(np.array([0.0, 1.0]), 2)
        nothing = np.zeros((1, ends.shape[2]))
        return np.concatenate([ends[:, 0], nothing]) - np.concatenate([nothing, ends[:, 1]])


_MOST_PIECES = 3000
_SAME = 1e-7
"""Share of the range of a joint, and of its largest speed, by which pieces that are joined may miss
a point."""


def _checked(table: JointTable) -> Array:
    """The times of a table from 0 on, which increase."""
    times = table.times
    if times is None:
        raise ValueError(
            "has no times; give time_from_start at each point, or a column time, to judge it as "
            "it is timed"
        )
    if len(times) < 2:
        raise ValueError("has one point; give two or more")
    values = [table.positions, table.velocities, table.accelerations]
    if not all(np.all(np.isfinite(rows)) for rows in values if rows is not None):
        raise ValueError("has a value that is no finite number; give numbers")
    late = np.flatnonzero(~(np.diff(times) > 0))
    if len(late):
        at = late[0] + 1
        raise ValueError(
            f"is at {times[at]:g} s at point {at + 1} and at {times[at - 1]:g} s before; give "
            "times that increase"
        )
    check_rates(table)
    return times - times[0]


def check_rates(table: JointTable) -> None:
    """Refuse speeds and accelerations of a table far beyond what they are rates of.

    Sums of all pieces are compared, so that a stop, a jerk or few points are no fault.
    """
    if table.times is None or table.velocities is None:
        return
    lengths = np.diff(table.times)[:, None]
    rates = [("velocities", table.velocities, table.positions, "positions", "rad/s", _FASTER)]
    if table.accelerations is not None:
        rates.append((
            "accelerations", table.accelerations, table.velocities, "velocities", "rad/s^2",
            _STEEPER,
        ))  # fmt: skip
    for name, rate, values, of_values, unit, most in rates:
        ways = np.abs(lengths * (rate[:-1] + rate[1:]) / 2).sum(axis=0)
        stated = np.abs(np.diff(values, axis=0)).sum(axis=0)
        noticed = ways > max(_LEAST_WAY, _NOTICED * ways.max())
        times_it = np.where(noticed, ways / np.maximum(stated, 1e-9), 0.0)
        joint = int(times_it.argmax())
        ratio = float(times_it[joint])
        if ratio > most:
            whose = table.joints[joint] if table.joints else f"joint {joint + 1}"
            raise ValueError(
                f"has {name} of {whose} that are {ratio:.3g} times what its {of_values} and times "
                f"make; {_unit_words(ratio, name, unit)} or leave them out"
            )


def _unit_words(ratio: float, name: str, unit: str) -> str:
    """Ask for the unit in which rates are so many times too large."""
    if 0.7 * _DEGREES < ratio < 1.4 * _DEGREES:
        return f"{name} are in {unit}, were degrees meant? give {unit},"
    if 0.7e3 < ratio < 1.4e3:
        unit = unit.replace("rad", "m")
        return f"{name} are in {unit}, were millimetres meant? give {unit},"
    return f"give {name} of the same motion,"


_DEGREES = math.degrees(1.0)
_FASTER = 5.0
_STEEPER = 20.0
"""So many times what is stated make other units of speeds, and of accelerations: of these a time
parametrisation switches between bounds within a piece."""
_NOTICED = 0.05
"""Share of the largest way of a joint from which on another one's is compared."""
_LEAST_WAY = 1e-3
"""The same as a way [rad or m], or a speed."""


def _of_spline(times: Array, points: Array) -> tuple[Array, Array]:
    """Speeds and accelerations of a cubic spline from rest to rest."""
    from scipy.interpolate import CubicSpline  # takes a quarter of a second to load

    spline = CubicSpline(times, points, bc_type="clamped")
    return spline(times, 1), spline(times, 2)


def _cubic(times: Array, points: Array, speeds: Array) -> Array:
    """Polynomials of third degree between positions and speeds."""
    lengths = np.diff(times)[:, None]
    begins, way = points[:-1], np.diff(points, axis=0)
    before, after = speeds[:-1] * lengths, speeds[1:] * lengths
    nothing = 0 * way
    terms = [begins, before, 3 * way - 2 * before - after, before + after - 2 * way]
    return np.stack([*terms, nothing, nothing], axis=-1)


def _quintic(times: Array, points: Array, speeds: Array, accelerations: Array) -> Array:
    """Polynomials of fifth degree between positions, speeds and accelerations."""
    lengths = np.diff(times)[:, None]
    begins, way = points[:-1], np.diff(points, axis=0)
    before, after = speeds[:-1] * lengths, speeds[1:] * lengths
    bends, bent = accelerations[:-1] * lengths**2, accelerations[1:] * lengths**2
    rest = way - before - bends / 2
    slope = after - before - bends
    bend = bent - bends
    return np.stack([
        begins, before, bends / 2,
        10 * rest - 4 * slope + bend / 2,
        -15 * rest + 7 * slope - bend,
        6 * rest - 3 * slope + bend / 2,
    ], axis=-1)  # fmt: skip


def fewest_points(
    times: Array,
    points: Array,
    speeds: Array,
    accelerations: Array,
    reach: float | Array,
    fast: float | Array = np.inf,
) -> list[int]:
    """Numbers of the points between which quintics pass all others, as few as do.

    They may miss positions and speeds by so much.
    """

    def passes(begin: int, end: int) -> bool:
        ends = [begin, end]
        piece = _quintic(times[ends], points[ends], speeds[ends], accelerations[ends])[0]
        length = times[end] - times[begin]
        shares = (times[begin + 1 : end] - times[begin]) / length
        powers = shares[:, None] ** np.arange(6)
        slopes = piece[:, 1:] * np.arange(1, 6) / length
        off = np.abs(powers @ piece.T - points[begin + 1 : end])
        faster = np.abs(powers[:, :5] @ slopes.T - speeds[begin + 1 : end])
        return bool(np.all(off <= reach) and np.all(faster <= fast))

    kept = [0]
    last = len(times) - 1
    while kept[-1] < last:
        begin = kept[-1]
        step = 1
        while begin + 2 * step <= last and passes(begin, begin + 2 * step):
            step *= 2
        more = step // 2
        while more:
            if begin + step + more <= last and passes(begin, begin + step + more):
                step += more
            more //= 2
        kept.append(begin + step)
        if len(kept) > _MOST_PIECES:
            raise ValueError(
                f"has over {_MOST_PIECES} points that no smooth motion passes; give fewer, as it "
                "was before noise or rounding"
            )
    return kept


_OF_SPEEDS = 100
"""Speeds of a file are coarser than its positions."""
