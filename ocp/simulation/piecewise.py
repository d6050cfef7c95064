"""A joint motion in smooth pieces: one of a profile, one for every interval of a free motion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.models import Expression, JointMotion
from quietarm.ocp.profiles.free_motion import FreeMotion, joint_after
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.task import PointToPoint

Law = Callable[..., JointMotion]
"""How the joint moves on a piece, by what it is given there and the fraction of the piece.

The last of the given numbers is the piece's length [s]; equal laws share a compiled CVODES.
"""


@dataclass(frozen=True)
class _AlongProfile:
    """The law of a profile, from its coefficients, start, target and duration."""

    profile: JointProfile

    def __call__(
        self, given: Sequence[Expression], fraction: Expression, *, jerk: bool
    ) -> JointMotion:
        return self.profile.motion(given[:-3], fraction, *given[-3:], jerk=jerk)


def _freely(given: Sequence[Expression], fraction: Expression, *, jerk: bool) -> JointMotion:
    """The law of a free motion, from the joint where an interval begins, and its length."""
    return joint_after(given[:-1], fraction * given[-1])


@dataclass(frozen=True, eq=False)
class PiecewiseMotion:
    """A joint motion in smooth pieces: its law, and what that is given, a column for each piece.

    The last row is how long they take [s]. Its acceleration is continuous if it `has_jerk`; it is
    `smooth` if no derivative breaks. The remedy ends the message where CVODES cannot follow it.
    """

    law: Law
    given: NDArray[np.float64]
    has_jerk: bool
    smooth: bool
    remedy: str

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
