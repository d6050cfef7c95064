"""Motions between the points of a front: their coefficients are interpolated."""

from __future__ import annotations

import time
from dataclasses import replace
from itertools import pairwise
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.checks import instance, takes
from quietarm.ocp.front.front import Front
from quietarm.ocp.front.points import Entries, evaluated, non_dominated
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY
from quietarm.ocp.record import versions
from quietarm.ocp.task import PointToPoint

Array = NDArray[np.float64]
BETWEEN = 300
"""About so many motions are tried between the points of a front."""
INTERPOLATED = "interpolated"
"""The setting of a record that counts them."""


@takes(front=Front)
def interpolate_front(front: Front) -> Front:
    """Add the motions between neighbours on a front, with interpolated coefficients.

    About 300 motions are simulated. The front of a search with few candidates becomes finer by
    them, without a further search.

    Parameters
    ----------
    front : Front
        A front of a move, by any method.

    Returns
    -------
    Front
        The points that are not dominated, without the progress of their search. Its record counts
        the motions that were tried as candidates, and as the setting ``interpolated``.
        `infeasible` and `failed` count those of the given front as well.

    Raises
    ------
    NoTaskError
        When the front is that of a function: interpolate the coefficients of its points, and call
        the function.
    ValueError
        When the front has no point.
    """
    began = time.perf_counter()
    front.smallest_residual()
    instance("task", front.task, PointToPoint)  # a front of a function has none
    between = coefficients_between(front)
    motions = evaluated(front.task, front.profile, between, objectives=front.objectives)
    given = front.record
    before: Any = given.settings.get(INTERPOLATED, 0)
    record = replace(
        given,
        settings={**given.settings, INTERPOLATED: before + len(between)},
        evaluations=given.evaluations + len(between),
        versions=versions(),
        seconds=given.seconds + time.perf_counter() - began,
    )
    return replace(
        front,
        points=non_dominated([*front.points, *motions.points], front.objectives),
        record=record,
        failed=front.failed + motions.failed,
        infeasible=front.infeasible + motions.infeasible,
        history=(),  # of the search, whose candidates were fewer
        entries=Entries(),
    )


def coefficients_between(front: Front) -> Array:
    """Coefficients between neighbours on a front, shape (motions, size); the points not among them.

    Neighbours follow each other along the front; with more than two objectives they are the nearest
    points. The box is convex, so what lies between two of its motions is in it.
    """
    points = front.objective_values
    pairs = np.array(_neighbours(points)) if len(points) > 1 else np.empty((0, 2), dtype=int)
    between = ceil(BETWEEN / len(pairs)) - 1 if len(pairs) else 0
    share = (np.arange(1, between + 1) / (between + 1))[:, None]
    first, second = (front.coefficients[places][:, None] for places in pairs.T)
    return (first * (1 - share) + second * share).reshape(-1, front.profile.size)


def _neighbours(points: Array) -> list[tuple[int, int]]:
    """Pairs of points between which motions are looked at."""
    if points.shape[1] == len(RESIDUAL_AND_ENERGY):
        return list(pairwise(range(len(points))))
    # as many as a point has beside it on a surface of that dimension
    nearest = 2 * (points.shape[1] - 1)
    extent = np.ptp(points, axis=0)
    scaled = points / np.where(extent > 0, extent, 1.0)
    distance = np.linalg.norm(scaled[:, None] - scaled, axis=2)
    order = np.argsort(distance, axis=1)[:, 1 : nearest + 1]
    pairs = {(min(i, j), max(i, j)) for i, row in enumerate(order.tolist()) for j in row}
    return sorted(pairs)
