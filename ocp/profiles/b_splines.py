"""B-splines on clamped knots, and a spline with its first two derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from quietarm.models import Expression
from quietarm.models.joint_motion import is_zero


def spline(
    knots: Sequence[float],
    degree: int,
    points: Sequence[Expression],
    at: Expression,
    derivatives: int = 2,
) -> list[Expression]:
    """A spline of control points on knots that rise, and its first derivatives.

    There are as many points as knots, plus the degree, less one. The spline begins at the first
    point and ends at the last one.
    """
    clamped = [knots[0]] * degree + list(knots) + [knots[-1]] * degree
    rows = b_splines(clamped, degree, at)
    values = list[Expression]()
    for order in range(degree, degree - derivatives - 1, -1):
        # of a lower degree the first and last ones stand on repeated knots alone: they are nothing
        unused = degree - order
        basis = rows[order][unused : len(rows[order]) - unused]
        values.append(sum(point * B for point, B in zip(points, basis)))
        clamped = clamped[1:-1]
        # its derivative's: differences over the length that neighbouring B-splines share
        points = [
            order * (after - before) / (clamped[i + order] - clamped[i])
            for i, (before, after) in enumerate(pairwise(points))
        ]
    return values


def b_splines(knots: Sequence[float], degree: int, at: Expression) -> list[list[Expression]]:
    """Every B-spline on clamped knots of each degree from 0, by de Boor's recursion."""
    last = len(knots) - degree - 2
    row: list[Expression] = [0.0] * (len(knots) - 1)
    for i in range(degree, last + 1):  # degree 0: in which piece it is, the ends included
        after = at >= knots[i] if i > degree else 1
        row[i] = after * (at < knots[i + 1] if i < last else 1) + 0 * at
    rows = [row]
    for d in range(1, degree + 1):
        pairs = list(zip(knots, knots[d:]))
        shares = [_share(at, *pair) for pair in pairs]
        row = [
            _blend(before, shares[i], after, shares[i + 1])
            for i, (before, after) in enumerate(pairwise(row))
        ]
        rows.append(row)
    return rows


def _blend(
    before: Expression, share: Expression, after: Expression, share_of_next: Expression
) -> Expression:
    """One step of the recursion; B-splines that are nothing anywhere cost nothing."""
    rising = 0.0 if is_zero(before) else before * share
    falling = 0.0 if is_zero(after) else after * (1 - share_of_next)
    if is_zero(rising):
        return falling
    return rising if is_zero(falling) else rising + falling


def _share(at: Expression, begin: float, end: float) -> Expression:
    """Return the share of the way between two knots; 0 if these are one."""
    return (at - begin) / (end - begin) if end > begin else 0.0
