"""A joint motion that is a spline itself: it cruises, and turns its acceleration within a knot."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from quietarm.models import Expression, JointMotion
from quietarm.ocp.checks import finite, several
from quietarm.ocp.profiles.b_splines import spline
from quietarm.ocp.profiles.joint_profile import JointProfile, Values

DEGREE = 5
"""So that the acceleration, a cubic spline, has a continuous second derivative."""
_AT_REST = 3
"""Control points at either end that are the end itself: angle, speed and acceleration are at rest.
"""
MOST_KNOTS = 64
_LEAST_GAP = 1e-4
"""Share of the move that lies between two knots at least: within less no step has room."""


@dataclass(frozen=True)
class JointSpline(JointProfile):
    """The joint's angle as a quintic B-spline, at rest with no acceleration at both ends.

    theta = start + (target - start) sum_j (c_j + a_j) B_j(t/TE) on clamped knots: c_j are the
    plain cycloid at the B-splines' places (their Greville abscissae), a_j the coefficients, so that
    all 0 is close to the plain cycloid. The angle is linear in them, and near a knot it can do what
    a polynomial of the whole move cannot: cruise, and change its acceleration at once.

    Parameters
    ----------
    knots : sequence of float
        Fractions of the duration between 0 and 1 at which the pieces meet, rising; one coefficient
        each.

    Raises
    ------
    ValueError
        When there are no knots or too many, or they do not rise.
    """

    name: ClassVar[str] = "joint-spline"
    term: ClassVar[str] = "knot"
    default_bound: ClassVar[float | None] = 0.5
    steps_of_a_piece: ClassVar[int] = 2
    energy_agreement: ClassVar[float] = 1e-4

    knots: tuple[float, ...]

    def __post_init__(self) -> None:
        knots = tuple(
            finite("knot", knot)
            for knot in several("knots", self.knots, "fractions, as [0.3, 0.7]")
        )
        if not 1 <= len(knots) <= MOST_KNOTS:
            raise ValueError(f"got {len(knots)} knots; give 1 to {MOST_KNOTS}")
        gaps = [after - before for before, after in pairwise((0.0, *knots, 1.0))]
        if min(gaps) < _LEAST_GAP:
            raise ValueError(
                f"knots are {min(gaps):.2g} of the move apart; give fractions that rise from 0 to "
                f"1 by at least {_LEAST_GAP:g}"
            )
        object.__setattr__(self, "knots", knots)

    @property
    def size(self) -> int:
        """One coefficient for each knot."""
        return len(self.knots)

    @property
    def shortest_part(self) -> float:
        """Between two knots, or a knot and an end."""
        return float(np.diff([0.0, *self.knots, 1.0]).min())

    def breaks(self, duration: float) -> tuple[float, ...]:
        """The knots."""
        return self.knots

    @property
    def places(self) -> NDArray[np.float64]:
        """Where the B-splines of the coefficients act, as fractions of the duration: (size,)."""
        clamped = np.array([0.0] * DEGREE + [0.0, *self.knots, 1.0] + [1.0] * DEGREE)
        averages = np.convolve(clamped[1:-1], np.full(DEGREE, 1 / DEGREE), mode="valid")
        return averages[_AT_REST:-_AT_REST]

    def derivatives(self, coefficients: Values, fraction: Expression, *move: Expression) -> Values:
        """The spline, and its first two time derivatives."""
        return self.outer(self.inner(coefficients, fraction, *move), *move)[:3]

    def inner(self, coefficients: Values, fraction: Expression, *move: Expression) -> Values:
        """Share of the way, and its derivatives by the fraction: linear in the coefficients."""
        turn = 2 * math.pi
        plain = [at - math.sin(turn * at) / turn for at in self.places.tolist()]
        free = [height + a for height, a in zip(plain, coefficients)]
        points = [*[0.0] * _AT_REST, *free, *[1.0] * _AT_REST]
        return spline([0.0, *self.knots, 1.0], DEGREE, points, fraction)

    def outer(self, inner: Values, *move: Expression) -> JointMotion:
        """From shares of the way to the joint."""
        start, target, duration = move
        share, rate, bend = inner
        span = target - start
        return JointMotion(start + span * share, span * rate / duration, span * bend / duration**2)
