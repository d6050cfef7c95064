"""The cycloid through an input shaper, the usual remedy in practice."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import casadi as ca
from quietarm.models import Expression
from quietarm.ocp.checks import finite, positive
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.profiles.shapers import SHAPERS, Impulses, convolved

LEAST_SHARE = 0.05
"""Least share of the duration that is left for the cycloid: a shorter one would be a jolt between
the integrators' steps."""
MOST_IMPULSES = 243
"""Five modes of three impulses; the motion has a cycloid for every impulse."""


@dataclass(frozen=True)
class ShapedCycloid(JointProfile):
    """The plain cycloid convolved with an input shaper; it has no coefficients.

    Every impulse of the shaper begins a cycloid of its share of the move. The cycloids are shorter
    than the duration by the shaper's length, so that the whole takes the duration.

    Parameters
    ----------
    shaper : str
        ``"zv"``, ``"zvd"`` or ``"ei"``.
    frequencies : sequence of float
        Undamped angular frequencies of the modes to leave out [rad/s], one or more.
    damping_ratios : sequence of float
        Their damping ratios, between -1 and 1.

    Raises
    ------
    ValueError
        When the shaper is not known, a number is out of range, the numbers do not match, or the
        shaper would have a negative impulse.
    """

    name: ClassVar[str] = "shaped-cycloid"
    shaper: str
    frequencies: tuple[float, ...]
    damping_ratios: tuple[float, ...]

    def __post_init__(self) -> None:
        if self.shaper not in SHAPERS:
            raise ValueError(f"shaper is {self.shaper!r}; give {', '.join(SHAPERS)}")
        frequencies = tuple(positive("frequency", w, "rad/s") for w in self.frequencies)
        damping = tuple(finite("damping ratio", zeta) for zeta in self.damping_ratios)
        if not frequencies or len(frequencies) != len(damping):
            raise ValueError(
                f"got {len(frequencies)} frequencies and {len(damping)} damping ratios; give one "
                "of each for every mode"
            )
        for zeta in damping:
            if not -1 < zeta < 1:
                raise ValueError(
                    f"damping ratio is {zeta:g}; give one between -1 and 1: other modes do not "
                    "vibrate"
                )
        impulses = len(SHAPERS[self.shaper](1.0, 0.0).times) ** len(frequencies)
        if impulses > MOST_IMPULSES:
            raise ValueError(
                f"{self.shaper} for {len(frequencies)} modes has {impulses} impulses; quietarm "
                f"goes up to {MOST_IMPULSES}: give the slowest modes only"
            )
        object.__setattr__(self, "frequencies", frequencies)
        object.__setattr__(self, "damping_ratios", damping)
        _impulses(self.shaper, frequencies, damping)  # which refuses what the shaper is not for

    @property
    def impulses(self) -> Impulses:
        """One shaper for all modes."""
        return _impulses(self.shaper, self.frequencies, self.damping_ratios)

    @property
    def length(self) -> float:
        """From the shaper's first impulse to its last [s]."""
        return self.impulses.times[-1]

    @property
    def size(self) -> int:
        """None, as the shaper is known from the plant."""
        return 0

    @property
    def label(self) -> str:
        """The shaper and the frequencies that it is for."""
        frequencies = " and ".join(f"{frequency:.4g}" for frequency in self.frequencies)
        return f"{self.shaper} shaper for {frequencies} rad/s"

    @property
    def least_duration(self) -> float:
        """The shaper's length, and the least share of the duration for the cycloid [s]."""
        return self.length / (1 - LEAST_SHARE)

    def breaks(self, duration: float) -> tuple[float, ...]:
        """Where a cycloid begins or ends."""
        begins = self.impulses.times
        ends = (begin + duration - self.length for begin in begins)
        return tuple(sorted({at / duration for at in (*begins, *ends) if 0 < at < duration}))

    def derivatives(
        self,
        coefficients: Sequence[Expression],
        fraction: Expression,
        start: Expression,
        target: Expression,
        duration: Expression,
    ) -> tuple[Expression, ...]:
        """Sum of the cycloids, each at rest before it begins and after it ends."""
        del coefficients
        cycloid, turn = duration - self.length, 2 * math.pi
        angle = speed = acceleration = 0 * fraction
        for share, begin in zip(*self.impulses, strict=True):
            own = (fraction * duration - begin) / cycloid
            # Not fmin and fmax, whose derivative is halved where the move begins and ends.
            own = ca.if_else(ca.logic_and(own >= 0, own <= 1), own, own > 1)
            sine, cosine = ca.sin(turn * own), ca.cos(turn * own)
            angle += share * (own - sine / turn)
            speed += share * (1 - cosine) / cycloid
            acceleration += share * turn * sine / cycloid**2
        span = target - start
        return start + span * angle, span * speed, span * acceleration


@lru_cache(maxsize=64)
def _impulses(shaper: str, frequencies: Sequence[float], damping: Sequence[float]) -> Impulses:
    return convolved([SHAPERS[shaper](*mode) for mode in zip(frequencies, damping, strict=True)])
