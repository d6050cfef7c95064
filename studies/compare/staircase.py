"""Fronts as staircases, and what lies between their points."""

from __future__ import annotations

import moocore
import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics.quality import with_motions_between
from quietarm.ocp import Front

Array = NDArray[np.float64]
_STATIONS = 101


def filled(front: Front) -> Array:
    """Residual and energy of a front and of motions between its points, rising in residual."""
    return best_of([with_motions_between(front)])


def best_of(fronts: list[Array]) -> Array:
    """The points of several fronts that none of them dominates; residuals rise."""
    best = moocore.filter_dominated(np.vstack(fronts))
    return best[np.argsort(best[:, 0])]


def evenly_spaced(points: Array, stations: int = _STATIONS) -> Array:
    """The points of a front nearest to stations at even distances along it, shape (few, 2)."""
    ordered = points[np.argsort(points[:, 0])]
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(ordered, axis=0).T))])
    wanted = np.linspace(0.0, along[-1], stations)
    return ordered[np.unique(np.abs(along - wanted[:, None]).argmin(axis=1))]
