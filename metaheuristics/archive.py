"""What a search has found, and what it had found on the way."""

from __future__ import annotations

import time
from collections.abc import Mapping
from importlib import metadata

import moocore
import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics.quality import Reference
from quietarm.ocp import Front, JointProfile, Mark, PointToPoint, reference_corner
from quietarm.ocp.cost import COST
from quietarm.ocp.front.points import LEVELS, evaluated
from quietarm.ocp.record import Record, Setting, versions

Array = NDArray[np.float64]
_STEP = 10 ** (1 / 24)
"""Evaluations between neighbouring marks: 24 in a decade, at the ends of generations."""
MOST_POINTS = 100
"""Points of a search's front: as many as a population has, whatever archive a method keeps."""


class Archive:
    """The feasible candidates that no other dominates, and marks on the way.

    Parameters
    ----------
    task : PointToPoint
        The move.
    variables : int
        Coefficients of a candidate.
    reference : Reference, optional
        The scale of the marks' quality.
    """

    def __init__(
        self, task: PointToPoint, variables: int, reference: Reference | None = None
    ) -> None:
        self.evaluations, self.marks = 0, list[Mark]()
        self.corner = reference_corner(task)
        self._reference, self._next = reference, 1.0
        self._X, self._F = np.empty((0, variables)), np.empty((0, 2))
        self._waiting: list[tuple[Array, Array]] = []
        self._began, self._own, self._cost = time.thread_time(), 0.0, COST.copy()

    @property
    def seconds(self) -> float:
        """Processor time since the beginning, without the archive's and compilation's [s]."""
        apart = self._own + COST.since(self._cost).builds
        return time.thread_time() - self._began - apart

    def non_dominated(self) -> tuple[Array, Array]:
        """Coefficients and objectives of what was found."""
        if self._waiting:
            X = np.vstack([self._X, *(part for part, _ in self._waiting)])
            F = np.vstack([self._F, *(part for _, part in self._waiting)])
            kept = np.flatnonzero(moocore.is_nondominated(F))
            self._X, self._F, self._waiting = X[kept], F[kept], []
        return self._X, self._F

    def add(self, X: Array, F: Array, usable: NDArray[np.bool_]) -> None:
        """Take evaluated candidates, of which those that are usable count as found."""
        seconds, began = self.seconds, time.thread_time()
        self.evaluations += len(X)
        if usable.any():
            self._waiting.append((X[usable].copy(), F[usable].copy()))
        if self.evaluations >= self._next:
            self.mark(seconds)
            self._next = max(self.evaluations, 1) * _STEP
        self._own += time.thread_time() - began

    def share_of_box(self) -> float:
        """Share of the reference box that is dominated."""
        return share_of_box(self.non_dominated()[1], self.corner)

    def mark(self, seconds: float) -> None:
        """Note where the search is."""
        F = self.non_dominated()[1]
        points = F[spread(F, MOST_POINTS)]  # as many as its front would have
        quality = None if self._reference is None else self._reference.quality(points)
        self.marks.append(Mark(self.evaluations, self.share_of_box(), seconds, quality=quality))

    def front(
        self,
        task: PointToPoint,
        profile: JointProfile,
        *,
        method: str,
        settings: Mapping[str, Setting],
        bound: float,
        seed: int | None,
        failed: int = 0,
        infeasible: int = 0,
    ) -> Front:
        """What was found, `MOST_POINTS` of it, by CVODES."""
        searched = self.seconds
        if not self.marks or self.marks[-1].evaluations < self.evaluations:
            self.mark(searched)
        X, F = self.non_dominated()
        began = time.thread_time()
        kept = evaluated(task, profile, X[spread(F, MOST_POINTS)], bound)
        return Front(
            task, profile, kept.points,
            Record(method, settings, bound, seed, self.evaluations, versions=search_versions(),
                   seconds=searched + time.thread_time() - began),
            self.corner, failed=failed, infeasible=infeasible, history=tuple(self.marks),
        )  # fmt: skip


def share_of_box(points: Array, corner: tuple[float, float]) -> float:
    """Share of the box from zero to a corner that points dominate."""
    if not len(points):
        return 0.0
    return float(moocore.hypervolume(points / corner, ref=[1.0, 1.0]))


def spread(points: Array, most: int) -> NDArray[np.int64]:
    """Places of so many points at even distances along a front, with the best at each level."""
    order = np.argsort(points[:, 0])
    if len(order) <= most:
        return order
    ordered = points[order] / np.ptp(points, axis=0)
    along = np.append(0.0, np.cumsum(np.hypot(*np.diff(ordered, axis=0).T)))
    at = np.searchsorted(along, np.linspace(0.0, along[-1], most - len(LEVELS)))
    levels = np.searchsorted(points[order, 0], LEVELS, side="right") - 1
    chosen = np.unique(np.concatenate([at, levels[levels >= 0]]).clip(0, len(order) - 1))
    return order[chosen]


def search_versions() -> dict[str, str]:
    """Versions of what computes a search."""
    return {**versions(), "pymoo": metadata.version("pymoo")}
