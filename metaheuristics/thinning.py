"""Choice of the points of a front from many: at even distances, the best at each residual."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.front.points import LEVELS
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY

MOST_POINTS = 100
"""Points of a search's front: as many as a population has, whatever archive a method keeps."""


def thinned(points: NDArray[np.float64], most: int = MOST_POINTS) -> NDArray[np.int64]:
    """Rows of at most so many points, shape (n, objectives), at even distances along a front.

    The best point within each of `LEVELS` is among them. On a surface, of three objectives or more,
    the ends come first, and then the point that is farthest from those that are chosen.
    """
    order = np.argsort(points[:, 0])
    if len(order) <= most:
        return order
    if points.shape[1] > len(RESIDUAL_AND_ENERGY):
        return _spread(points, most)
    ordered = points[order] / np.ptp(points, axis=0)
    along = np.append(0.0, np.cumsum(np.hypot(*np.diff(ordered, axis=0).T)))
    at = np.searchsorted(along, np.linspace(0.0, along[-1], most - len(LEVELS)))
    levels = np.searchsorted(points[order, 0], LEVELS, side="right") - 1
    chosen = np.unique(np.concatenate([at, levels[levels >= 0]]).clip(0, len(order) - 1))
    return order[chosen]


def _spread(points: NDArray[np.float64], most: int) -> NDArray[np.int64]:
    """So many rows, in order of the first objective, the cheapest within `LEVELS` among them."""
    cheapest = [
        int(np.argmin(np.where(points[:, 0] <= level, points[:, 1], np.inf)))
        for level in LEVELS
        if (points[:, 0] <= level).any()
    ]
    rows = farthest_apart(points, most, cheapest)
    return rows[np.argsort(points[rows, 0], kind="stable")]


def farthest_apart(
    points: NDArray[np.float64], most: int, first: Sequence[int] = ()
) -> NDArray[np.int64]:
    """So many rows: the least in each column, these first ones, and then ever the farthest."""
    extent = np.ptp(points, axis=0)
    scaled = points / np.where(extent > 0, extent, 1.0)
    chosen = list(dict.fromkeys([*np.argmin(points, axis=0).tolist(), *first]))[:most]
    distance = np.min(
        [np.linalg.norm(scaled - scaled[row], axis=1) for row in chosen],
        axis=0,
    )
    while len(chosen) < most and distance.max() > 0:
        farthest = int(np.argmax(distance))
        chosen.append(farthest)
        distance = np.minimum(distance, np.linalg.norm(scaled - scaled[farthest], axis=1))
    return np.array(chosen)
