"""Facts about a problem from its reference front: where it is not convex, what is active."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from quietarm.metaheuristics.score import objectives
from quietarm.ocp import Front


@dataclass(frozen=True)
class Card:
    """The properties of a front that make it hard to search.

    Attributes
    ----------
    nonconvex : tuple of (float, float)
        Ranges of the residual [m] that no weighted sum reaches.
    nonconvex_share : float
        Their share of the residual axis between the front's ends.
    active : tuple of int
        Coefficients, from 1, that are at the bound of the box at some of the points.
    still_falls : float
        How steep the energy falls at the end of largest residual, over its mean slope: near 0 the
        front has come to its end, else it is cut off there by the box or the limits.
    """

    nonconvex: tuple[tuple[float, float], ...]
    nonconvex_share: float
    active: tuple[int, ...]
    still_falls: float


def card_of(front: Front) -> Card:
    """The card of a front, by its points; a range between two neighbours is taken as convex."""
    # share of the bound within which a coefficient is at it
    near = 1e-6
    # share of the front's extent in energy by which it rises above its convex hull where it
    # counts
    shallow = 1e-4
    points = objectives(front)
    span = np.ptp(points, axis=0)
    ranges = [
        (float(points[i, 0]), float(points[j, 0]))
        for i, j in pairwise(_hull(points))
        if _depth(points[i : j + 1]) > shallow * span[1]
    ]
    bound = front.record.bound or np.inf
    coefficients = np.abs([point.coefficients for point in front.points])
    at = np.flatnonzero((coefficients >= bound * (1 - near)).any(axis=0)) + 1
    last = np.diff(points[-2:], axis=0)[0] if len(points) > 1 else span
    return Card(
        tuple(ranges),
        sum(end - begin for begin, end in ranges) / span[0] if span[0] > 0 else 0.0,
        tuple(at.tolist()),
        float(-last[1] / last[0] * span[0] / span[1]) if last[0] * span[1] > 0 else 0.0,
    )


def _hull(points: np.ndarray) -> list[int]:
    """Points on the lower convex hull, in order."""
    hull: list[int] = []
    for k, point in enumerate(points):
        while len(hull) > 1:
            a = points[hull[-2]]
            b = points[hull[-1]]
            if (b[0] - a[0]) * (point[1] - a[1]) > (point[0] - a[0]) * (b[1] - a[1]):
                break
            hull.pop()
        hull.append(k)
    return hull


def _depth(points: np.ndarray) -> float:
    """Return how far points rise above the line between the first and the last of them."""
    line = np.interp(points[:, 0], points[[0, -1], 0], points[[0, -1], 1])
    return float((points[:, 1] - line).max())
