"""The points of a front that together dominate most: exact for two objectives, greedy for more."""

from __future__ import annotations

import moocore
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
CORNER = 1.1
MOST = 400
"""More points than these are thinned evenly before: the effort grows with their square."""


def best_subset(points: Array, count: int, corner: float = CORNER) -> NDArray[np.int64]:
    """Rows of at most `count` points of greatest hypervolume, by increasing first objective.

    Of three objectives and more, the point that adds least is left out, again and again. Of two,
    dynamic programming over the points in order (Auger and others 2009): the best of k points that
    end at one is the best of k - 1 that end at an earlier one, and what the last adds.
    """
    inside = (points < corner).all(axis=1)
    rows = np.flatnonzero(inside)
    rows = rows[moocore.is_nondominated(points[rows])] if len(rows) else rows
    rows = rows[np.argsort(points[rows, 0])]
    if len(rows) > MOST:
        rows = rows[np.linspace(0, len(rows) - 1, MOST).astype(int)]
    if points.shape[1] > 2:
        while len(rows) > count:
            added = moocore.hv_contributions(points[rows], ref=[corner] * points.shape[1])
            rows = np.delete(rows, added.argmin())
        return rows
    if len(rows) <= count:
        return rows
    x, y = points[rows].T
    # what point j adds after point i: width to the corner times the step down from i
    added = (corner - x)[None, :] * (y[:, None] - y[None, :])
    added[np.tril_indices(len(rows))] = -np.inf
    best = (corner - x) * (corner - y)
    before = np.empty((count, len(rows)), dtype=int)
    for chosen in range(1, count):
        totals = best[:, None] + added
        before[chosen] = totals.argmax(axis=0)
        best = totals.max(axis=0)
    place = int(best.argmax())
    taken = [place]
    for chosen in range(count - 1, 0, -1):
        place = int(before[chosen, place])
        taken.append(place)
    return rows[taken[::-1]]
