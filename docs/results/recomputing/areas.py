"""Areas that points dominate: hypervolume, and what counts as a hundred per cent of it."""

from __future__ import annotations

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
