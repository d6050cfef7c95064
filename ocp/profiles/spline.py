"""The cycloid whose input is a B-spline, a common choice in practice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar

from quietarm.models import Expression
from quietarm.ocp.profiles.cycloid import Cycloid, Input
from quietarm.ocp.profiles.joint_profile import Values

DEGREE = 5
"""With a cubic, fixed steps miss the residual of a move at rest by 1e-5 m where pieces meet."""


@dataclass(frozen=True)
class CycloidSpline(Cycloid):
    """A cycloid whose input is a clamped quintic B-spline on even knots.

    U = t/TE + sum_j a_j B_j(t/TE), of all B-splines but the first and the last, which are not zero
    at the ends. a_j is how far control point j lies above the straight line: linear, and each
    coefficient acts on its own part of the move.

    Parameters
    ----------
    terms : int
        How many control points may move, 4 to 32; as many coefficients.
    """

    name: ClassVar[str] = "cycloid-spline"
    term: ClassVar[str] = "control point"
    default_bound: ClassVar[float | None] = 0.5
    least_terms: ClassVar[int] = DEGREE - 1

    def input(self, coefficients: Values, fraction: Expression) -> Input:
        """U and its derivatives: linear in the coefficients."""
        pieces = self.terms + 2 - DEGREE
        knots = [0.0] * DEGREE + [i / pieces for i in range(pieces + 1)] + [1.0] * DEGREE
        points = [0.0, *coefficients, 0.0]
        found: list[Expression] = []
        for degree in range(DEGREE, DEGREE - 3, -1):
            basis = b_splines(knots, degree, fraction)
            found.append(sum(p * B for p, B in zip(points, basis, strict=True)))
            knots = knots[1:-1]
            # its derivative's: differences over the length that neighbouring B-splines share
            points = [
                degree * (after - before) / (knots[i + degree] - knots[i])
                for i, (before, after) in enumerate(pairwise(points))
            ]
        return fraction + found[0], 1 + found[1], found[2]


def b_splines(knots: Sequence[float], degree: int, at: Expression) -> list[Expression]:
    """Every B-spline of a degree on clamped knots, by de Boor's recursion."""
    last = len(knots) - degree - 2
    row: list[Expression] = [0 * at] * (len(knots) - 1)
    for i in range(degree, last + 1):  # degree 0: in which piece it is, the ends included
        after = at >= knots[i] if i > degree else 1
        row[i] = after * (at < knots[i + 1] if i < last else 1) + 0 * at
    for d in range(1, degree + 1):
        row = [
            left * _share(at, knots[i], knots[i + d])
            + right * (1 - _share(at, knots[i + 1], knots[i + d + 1]))
            for i, (left, right) in enumerate(pairwise(row))
        ]
    return row


def _share(at: Expression, begin: float, end: float) -> Expression:
    """How far it is from one knot to another; where these are one, no piece lies between them."""
    return (at - begin) / (end - begin) if end > begin else 0 * at
