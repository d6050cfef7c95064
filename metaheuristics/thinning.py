"""Which points of many a front has: at even distances, with the best at each residual."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.front.points import LEVELS

MOST_POINTS = 100
"""Points of a search's front: as many as a population has, whatever archive a method keeps."""


def thinned(points: NDArray[np.float64], most: int = MOST_POINTS) -> NDArray[np.int64]:
    """Rows of at most so many points, shape (n, 2), at even distances along a front.

    The best point within each of `LEVELS` is among them.
    """
    order = np.argsort(points[:, 0])
    if len(order) <= most:
        return order
    ordered = points[order] / np.ptp(points, axis=0)
    along = np.append(0.0, np.cumsum(np.hypot(*np.diff(ordered, axis=0).T)))
    at = np.searchsorted(along, np.linspace(0.0, along[-1], most - len(LEVELS)))
    levels = np.searchsorted(points[order, 0], LEVELS, side="right") - 1
    chosen = np.unique(np.concatenate([at, levels[levels >= 0]]).clip(0, len(order) - 1))
    return order[chosen]
