"""Fronts as staircases, and what lies between their points."""

from __future__ import annotations

import moocore
import numpy as np
from numpy.typing import NDArray

from quietarm.metaheuristics.thinning import farthest_apart
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY

Array = NDArray[np.float64]


def best_of(fronts: list[Array]) -> Array:
    """The points of several fronts that none of them dominates; residuals rise."""
    best = moocore.filter_dominated(np.vstack(fronts))
    return best[np.argsort(best[:, 0])]


def evenly_spaced(points: Array, stations: int = 101) -> Array:
    """The points of a front nearest to stations at even distances along it, shape (few, 2).

    Of three objectives and more as many that are far from each other.
    """
    if points.shape[1] > len(RESIDUAL_AND_ENERGY):
        return points[farthest_apart(points, stations)]
    ordered = points[np.argsort(points[:, 0])]
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(ordered, axis=0).T))])
    wanted = np.linspace(0.0, along[-1], stations)
    return ordered[np.unique(np.abs(along - wanted[:, None]).argmin(axis=1))]
