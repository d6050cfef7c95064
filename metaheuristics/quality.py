"""How near a front comes to the reference front of its problem; formulas: docs/measures.md."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import ceil

import moocore
import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics.objective.population import objectives_of
from quietarm.ocp import Front, Quality
from quietarm.ocp.checks import takes
from quietarm.ocp.front.points import LEVELS
from quietarm.ocp.simulation.evaluator import Evaluator

Array = NDArray[np.float64]
CORNER = 1.1
"""Hypervolumes are measured from here, where 0 is the reference front's least and 1 its largest
value of each objective: as is usual, a tenth beyond, so that the ends of the front count."""
BETWEEN = 300
"""About so many points a front has once motions between its own are added: as a reference front."""
_KEPT = 1e-6
"""Share by which a motion between may exceed a limit, as those of a reference front."""


class Reference:
    """A reference front as a scale for others.

    Parameters
    ----------
    front : Front
        The reference front; ValueError where it is a single motion, which is no scale.
    """

    @takes(front=Front)
    def __init__(self, front: Front) -> None:
        if len(front.points) < 2:
            raise ValueError(
                "the reference front is a single motion, which is no scale for others; give "
                "another problem"
            )
        self.front, self._points = front, objectives(front)
        self.ideal, self.nadir = self._points.min(axis=0), self._points.max(axis=0)
        self.hypervolume = self._of_line()

    def scaled(self, points: Array) -> Array:
        """Residuals [m] and energies [J], shape (n, 2), from 0 at the ideal to 1 at the nadir."""
        return (points - self.ideal) / (self.nadir - self.ideal)

    def quality(self, points: Array) -> Quality | None:
        """Of points, shape (n, 2), residual [m] and energy [J]; None of no points."""
        if not len(points):
            return None
        scaled, stations = self.scaled(points), self.scaled(self._points)
        energies = within(points, LEVELS).tolist()
        return Quality(
            hypervolume=float(moocore.hypervolume(scaled, ref=[CORNER] * 2)) / self.hypervolume,
            igd_plus=float(moocore.igd_plus(scaled, ref=stations)),
            epsilon=float(moocore.epsilon_additive(scaled, ref=stations)),
            energies=tuple(one if np.isfinite(one) else None for one in energies),
        )

    def _of_line(self) -> float:
        """What the straight lines through the points dominate, up to the corner."""
        residuals, energies = self.scaled(self._points).T
        # the last point is the cheapest there is
        residuals, energies = np.append(residuals, CORNER), np.append(energies, energies[-1])
        above = CORNER - (energies[1:] + energies[:-1]) / 2
        return float(np.sum(above * np.diff(residuals)))


def objectives(front: Front) -> Array:
    """Residual [m] and energy [J] of every point, shape (points, 2)."""
    return np.column_stack([front.residuals, front.energies])


def within(points: Array, residuals: Sequence[float] | Array) -> Array:
    """Least energies [J] of points within residuals [m]; NaN where there is none."""
    found = [points[points[:, 0] <= one, 1] for one in residuals]
    return np.array([one.min() if one.size else np.nan for one in found])


def with_motions_between(front: Front) -> Array:
    """Points of a front and of motions between neighbours, shape (n, 2).

    Coefficients are interpolated and the motions simulated: each can be driven, and stays in the
    box. Those that break a limit do not count. So a front is not judged by its number of points.
    """
    points = objectives(front)
    coefficients = front.coefficients
    between = ceil(BETWEEN / max(len(points) - 1, 1)) - 1
    if len(points) < 2 or between < 1:
        return points
    share = (np.arange(1, between + 1) / (between + 1))[:, None]
    inner = coefficients[:-1, None] * (1 - share) + coefficients[1:, None] * share
    evaluation = Evaluator(front.task, front.profile)(inner.reshape(-1, front.profile.size))
    table = objectives_of(evaluation)
    kept = np.isfinite(table).all(axis=1) & (evaluation.violations <= _KEPT).all(axis=1)
    return np.vstack([points, table[kept]])


def measured(front: Front, reference: Reference) -> Front:
    """The front with the quality of its own points, and of motions between, as its last mark."""
    if not front.history:
        return front
    points = objectives(front)
    between = with_motions_between(front)
    last = replace(
        front.history[-1], quality=reference.quality(points), between=reference.quality(between)
    )
    return replace(front, history=(*front.history[:-1], last))
