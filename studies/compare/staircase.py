"""Fronts as staircases, and what lies between their points."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil

import moocore
import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics.objective.claims import objective_of
from quietarm.ocp import Front

Array = NDArray[np.float64]
_KEPT = 1e-6
"""Share by which a limit may be exceeded, as when a search verifies its points."""
_STATIONS = 101


def objectives(front: Front) -> Array:
    """Residual [m] and energy [J] of every point, shape (points, 2)."""
    return np.column_stack([front.residuals, front.energies])


def filled(front: Front, points: int) -> Array:
    """Residual and energy of a front and of motions between its points.

    So that a front is not judged by its number of points. The coefficients of neighbouring points
    are interpolated and the motions evaluated: each is a motion that can be driven and stays in the
    box; those that break a limit of the task do not count.
    """
    own = objectives(front)
    between = ceil(points / max(len(own) - 1, 1)) - 1
    if len(own) < 2 or between < 1:
        return own
    corners = np.array([point.coefficients for point in front.points])
    share = (np.arange(1, between + 1) / (between + 1))[:, None]
    inner = corners[:-1, None] * (1 - share) + corners[1:, None] * share
    values = objective_of(front.task, front.profile)(inner.reshape(-1, front.profile.size))
    table = np.column_stack([values.residual, values.energy])
    kept = np.isfinite(table).all(axis=1) & (values.violations <= _KEPT).all(axis=1)
    return best_of([own, table[kept]])


def best_of(fronts: list[Array]) -> Array:
    """The points of several fronts that none of them dominates; residuals rise."""
    best = moocore.filter_dominated(np.vstack(fronts))
    return best[np.argsort(best[:, 0])]


def within(front: Array, residuals: Sequence[float] | Array, missing: float = np.nan) -> Array:
    """Least energies [J] on a staircase within residuals."""
    if not len(front):
        return np.full(np.shape(residuals), missing)
    count = np.searchsorted(front[:, 0], residuals, side="right")
    return np.where(count > 0, front[np.maximum(count - 1, 0), 1], missing)


def evenly_spaced(points: Array, stations: int = _STATIONS) -> Array:
    """The points of a front nearest to stations at even distances along it, shape (few, 2)."""
    ordered = points[np.argsort(points[:, 0])]
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(ordered, axis=0).T))])
    wanted = np.linspace(0.0, along[-1], stations)
    return ordered[np.unique(np.abs(along - wanted[:, None]).argmin(axis=1))]
