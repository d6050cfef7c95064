"""Areas that points dominate: hypervolume, and what counts as a hundred per cent of it."""

from __future__ import annotations

from collections.abc import Sequence

import moocore
import numpy as np

from .runs import Array

CORNER = 1.1
"""Areas are dominated up to here, where a problem's scale goes from 0 to 1."""


def area(points: Array) -> float:
    """Return the area that points of a scale dominate, up to the corner."""
    if not len(points):
        return 0.0
    return float(moocore.hypervolume(points, ref=[CORNER] * points.shape[1]))


def scaled_by_best(fronts: Sequence[Array]) -> tuple[list[Array], Array]:
    """Return all fronts, and the best points of all of them, in the scale of these points.

    It goes from their least to their largest values.
    """
    best = moocore.filter_dominated(np.vstack(fronts))
    least = best.min(axis=0)
    extent = np.ptp(best, axis=0)
    return [(points - least) / extent for points in fronts], (best - least) / extent


def gaps_to_best(fronts: Sequence[Array]) -> list[float]:
    """What every front lacks of the area of the best points of all of them [%].

    The scale goes from the least to the largest values of those points.
    """
    scaled, best = scaled_by_best(fronts)
    whole = area(best)
    return [100 * (1 - area(points) / whole) for points in scaled]


def best_known(points: Array) -> float:
    """The area that counts as a hundred per cent: of all points of all runs of a problem.

    Of two objectives it is the area above the straight lines through the best of them, the last
    extended to the corner, so that it does not grow with the number of points on one curve.
    """
    inside = points[(points < CORNER).all(axis=1)]
    best = moocore.filter_dominated(inside)
    if points.shape[1] > 2:
        return area(best)
    x, y = best[np.argsort(best[:, 0])].T
    x = np.append(x, CORNER)
    y = np.append(y, y[-1])
    return float(np.sum(np.diff(x) * (CORNER - (y[1:] + y[:-1]) / 2)))
