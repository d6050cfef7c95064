"""A joint motion that is a spline itself: it cruises, and turns its acceleration within a knot."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from quietarm.models import Expression
from quietarm.ocp.checks import finite, several
from quietarm.ocp.profiles.b_splines import spline
from quietarm.ocp.profiles.differentiate import Slopes
from quietarm.ocp.profiles.joint_profile import JointProfile, Values


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
    degree: ClassVar[int] = 5
    """So that the acceleration, a cubic spline, has a continuous second derivative."""
    points_at_rest: ClassVar[int] = 3
    """Control points at either end that are the end itself: there angle, speed and acceleration are
    at rest."""
    most_knots: ClassVar[int] = 64
    least_gap: ClassVar[float] = 1e-4
    """Share of the move that lies between two knots at least: within less no step has room."""

    knots: tuple[float, ...]

    def __post_init__(self) -> None:
        values = several("knots", self.knots, "fractions, such as [0.3, 0.7]")
        knots = tuple(finite("knot", knot) for knot in values)
        if not 1 <= len(knots) <= self.most_knots:
            raise ValueError(f"got {len(knots)} knots; give 1 to {self.most_knots}")
        gaps = [after - before for before, after in pairwise((0.0, *knots, 1.0))]
        if min(gaps) < self.least_gap:
            raise ValueError(
                f"knots are {min(gaps):.2g} of the move apart; give fractions that rise from 0 to "
                f"1 by at least {self.least_gap:g}"
            )
        object.__setattr__(self, "knots", knots)

    @property
    def size(self) -> int:
        """One coefficient for each knot."""
        return len(self.knots)

    @property
    def shortest_part(self) -> float:
        """Shortest distance between two knots, or a knot and an end."""
        return float(np.diff([0.0, *self.knots, 1.0]).min())

    def breaks(self, duration: float) -> tuple[float, ...]:
        """The knots."""
        return self.knots

    def steps_between_breaks(self, steps: int) -> int:
        """More where the move has more: else a piece as short as a step would never get finer."""
        coarsest = 80
        return self.steps_of_a_piece * max(1, steps // coarsest)

    @property
    def places(self) -> NDArray[np.float64]:
        """Times at which the coefficients' B-splines act, as shares of the duration: (size,)."""
        ends = np.zeros(self.degree), np.ones(self.degree)
        clamped = np.concatenate([ends[0], [0.0, *self.knots, 1.0], ends[1]])
        share = np.full(self.degree, 1 / self.degree)
        averages = np.convolve(clamped[1:-1], share, mode="valid")
        return averages[self.points_at_rest : -self.points_at_rest]

    def angle(self, coefficients: Values, fraction: Expression) -> Expression:
        """The spline: linear in the coefficients."""
        return self.derivatives(coefficients, fraction)[0]

    def derivatives(self, coefficients: Values, fraction: Expression) -> Slopes:
        """The spline and its derivatives, splines of a lower degree."""
        share, rate, bend = self._spline(coefficients, fraction, 2)
        return share, rate, bend

    def table(self, fractions: NDArray[np.float64]) -> NDArray[np.float64]:
        """The spline by its coefficients: its B-splines, which depend on time alone."""
        at = np.asarray(fractions, dtype=float).ravel()
        units = np.vstack([np.zeros(self.size), np.eye(self.size)])
        orders = self._spline(list(units.T[:, :, None]), at, 3)
        table = np.stack(np.broadcast_arrays(*orders), axis=1)
        table[1:] -= table[0]
        return table

    def _spline(
        self, coefficients: Sequence[Any], fraction: Expression, derivatives: int
    ) -> list[Expression]:
        """Return the spline and a number of its derivatives."""
        turn = 2 * math.pi
        plain = [at - math.sin(turn * at) / turn for at in self.places.tolist()]
        free = [height + a for height, a in zip(plain, coefficients)]
        begin = [0.0] * self.points_at_rest
        end = [1.0] * self.points_at_rest
        points = [*begin, *free, *end]
        knots = [0.0, *self.knots, 1.0]
        return spline(knots, self.degree, points, fraction, derivatives)
