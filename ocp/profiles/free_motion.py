"""A joint motion of free acceleration on every interval of a grid; any motion in smooth pieces."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.models import Expression, JointMotion
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.task import PointToPoint


def joint_after(derivatives: Sequence[Expression], t: Expression) -> JointMotion:
    """The joint a time `t` [s] after these values, by a constant last derivative."""
    angle, speed, acceleration, *rest = derivatives
    jerk = rest[0] if rest else 0.0
    return JointMotion(
        angle + t * (speed + t * (acceleration / 2 + t * (jerk / 6))),
        speed + t * (acceleration + t * (jerk / 2)),
        acceleration + t * jerk,
        jerk,
    )


@dataclass(frozen=True, eq=False)
class FreeMotion:
    """A joint motion from rest, a polynomial on every interval of a grid; arrays are read-only.

    Attributes
    ----------
    times : ndarray, shape (steps + 1,)
        The grid, from 0 to the duration [s].
    acceleration, jerk : ndarray, shape (steps,)
        Joint acceleration when an interval begins [rad/s^2], and its rate of change [rad/s^3].
    """

    times: NDArray[np.float64]
    acceleration: NDArray[np.float64]
    jerk: NDArray[np.float64]

    def __post_init__(self) -> None:
        for name, values in vars(self).items():
            array = np.array(values, dtype=float)
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        fit = self.acceleration.shape == self.jerk.shape == (len(self.times) - 1,) != (0,)
        if not fit or self.times[0] != 0 or not np.all(np.diff(self.times) > 0):
            raise ValueError(
                "the times do not increase from 0, with an acceleration and a jerk on each interval"
            )

    def __eq__(self, other: object) -> bool:
        return isinstance(other, FreeMotion) and all(
            np.array_equal(a, vars(other)[name]) for name, a in vars(self).items()
        )

    def __hash__(self) -> int:
        return hash(tuple(array.tobytes() for array in vars(self).values()))

    @property
    def steps(self) -> int:
        """Number of intervals of the grid."""
        return len(self.acceleration)

    @property
    def smooth(self) -> bool:
        """Return whether the motion has a jerk; else its acceleration jumps between intervals."""
        return bool(np.any(self.jerk))

    @property
    def lengths(self) -> NDArray[np.float64]:
        """Lengths of the intervals [s]."""
        return np.diff(self.times)

    def boundaries(self, start: float) -> NDArray[np.float64]:
        """Angle [rad] and speed [rad/s] at the grid, shape (2, steps + 1), from rest at `start`."""
        h = self.lengths
        speed = np.append(0.0, np.cumsum(h * (self.acceleration + h * self.jerk / 2)))
        moved = h * (speed[:-1] + h * (self.acceleration / 2 + h * self.jerk / 6))
        return np.vstack([start + np.append(0.0, np.cumsum(moved)), speed])

    def intervals(self, start: float) -> NDArray[np.float64]:
        """Arguments of `joint_after` and length [s] of every interval, shape (5, steps)."""
        begins = self.boundaries(start)[:, :-1]
        return np.vstack([begins, self.acceleration, self.jerk, self.lengths])

    def split(self, parts: NDArray[np.int_]) -> FreeMotion:
        """Return this motion on a finer grid: interval k in `parts[k]` equal parts."""
        old = np.repeat(np.arange(self.steps), parts)
        part = np.concatenate([np.arange(count) for count in parts]) / parts[old]
        into = part * self.lengths[old]
        return FreeMotion(
            np.append(self.times[old] + into, self.times[-1]),
            self.acceleration[old] + self.jerk[old] * into,
            self.jerk[old],
        )


Law = Callable[..., JointMotion]
"""How the joint moves on a piece, by its arguments there and the fraction of the piece.

The last of the arguments is the piece's length [s]; equal laws share a compiled CVODES.
"""


@dataclass(frozen=True)
class _AlongProfile:
    """The law of a profile, from its coefficients, start, target and duration."""

    profile: JointProfile

    def __call__(
        self, numbers: Sequence[Expression], fraction: Expression, *, jerk: bool
    ) -> JointMotion:
        coefficients = numbers[:-3]
        move = numbers[-3:]
        return self.profile.motion(coefficients, fraction, *move, jerk=jerk)


def _freely(numbers: Sequence[Expression], fraction: Expression, *, jerk: bool) -> JointMotion:
    """The law of a free motion, from the joint where an interval begins, and its length."""
    return joint_after(numbers[:-1], fraction * numbers[-1])


@dataclass(frozen=True, eq=False)
class PiecewiseMotion:
    """A joint motion in smooth pieces: its law, and that law's arguments, a column for each piece.

    The last row is how long they take [s]. Its acceleration is continuous if it `has_jerk`; it is
    `smooth` if no derivative breaks. The remedy ends the message where CVODES cannot follow it.
    """

    law: Law
    arguments: NDArray[np.float64]
    has_jerk: bool
    smooth: bool
    remedy: str
    shortest_part: float = 1.0
    """Share of a piece within which the acceleration may turn."""

    @classmethod
    def of_profile(
        cls, task: PointToPoint, profile: JointProfile, coefficients: ArrayLike
    ) -> PiecewiseMotion:
        """A task's move along a profile; ValueError where coefficients or duration do not fit."""
        checked = profile.checked(coefficients, task.duration)
        return cls(
            _AlongProfile(profile),
            np.array([[*checked, *task.move]]).T,
            True,
            not (profile.sharp or profile.breaks(task.duration)),
            "; is a coefficient or a parameter of the plant far out of scale? (the largest "
            f"coefficient is {max(map(abs, checked), default=0.0):g})",
            profile.shortest_part,
        )

    @classmethod
    def of_free_motion(cls, task: PointToPoint, free: FreeMotion) -> PiecewiseMotion:
        """A free motion from a task's start."""
        largest = np.abs(free.acceleration).max()
        return cls(
            _freely,
            free.intervals(task.start),
            free.smooth,
            False,
            f", whose largest acceleration is {largest:g} rad/s^2; set an acceleration limit",
        )
