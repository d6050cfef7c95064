"""What a search finds: every candidate that none before it dominates, and the effort until then."""

from __future__ import annotations

import time
from dataclasses import replace
from importlib import metadata

import moocore
import numpy as np
from numpy.typing import NDArray

from quietarm.metaheuristics.score import share_of_box
from quietarm.metaheuristics.thinning import thinned
from quietarm.ocp import Front, JointProfile, Mark, PointToPoint, reference_corner
from quietarm.ocp.cost import COST
from quietarm.ocp.front.points import Entries, evaluated
from quietarm.ocp.record import Record, versions

Array = NDArray[np.float64]
Places = NDArray[np.int64]
_BLOCK = 512
"""Candidates that are compared with each other at once: the pairs of as many fit into the cache."""


class Archive:
    """The feasible candidates that no earlier one dominates, and marks of the effort.

    Parameters
    ----------
    task : PointToPoint
        The move.
    variables : int
        Coefficients of a candidate.
    """

    def __init__(self, task: PointToPoint, variables: int) -> None:
        self.task = task
        self.evaluations = 0
        self.marks = list[Mark]()
        self.corner = reference_corner(task)
        self._next_mark = 1.0
        self._coefficients = np.empty((0, variables))
        self._objectives = np.empty((0, 2))
        self._entered = list[tuple[Places, Array, Array]]()
        self._waiting = list[tuple[Places, Array, Array]]()
        self._waiting_rows = 0
        self._began = time.thread_time()
        self._seconds_here = 0.0
        self._cost = COST.copy()

    @property
    def seconds(self) -> float:
        """Processor time since the beginning, without the archive's and compilation's [s]."""
        apart = self._seconds_here + COST.since(self._cost).builds
        return time.thread_time() - self._began - apart

    def add(self, X: Array, F: Array, usable: NDArray[np.bool_]) -> None:
        """Take evaluated candidates, of which those that are usable may enter."""
        # evaluations between neighbouring marks: 24 in a decade, at the ends of generations
        step = 10 ** (1 / 24)
        seconds = self.seconds
        began = time.thread_time()
        numbers = self.evaluations + 1 + np.flatnonzero(usable)
        self.evaluations += len(X)
        if len(numbers):
            self._waiting.append((numbers, X[usable].copy(), F[usable].copy()))
            self._waiting_rows += len(numbers)
        if self._waiting_rows >= _BLOCK:
            self._let_enter()
        if self.evaluations >= self._next_mark:
            self.mark(seconds)
            self._next_mark = max(self.evaluations, 1) * step
        self._seconds_here += time.thread_time() - began

    def charge(self, evaluations: int) -> None:
        """Count so many candidates that were simulated for derivatives, and may not enter."""
        self.evaluations += evaluations

    def mark(self, seconds: float) -> None:
        """Note the effort until now."""
        spent = COST.since(self._cost)
        self.marks.append(
            Mark(
                self.evaluations,
                seconds=seconds,
                gradients=spent.gradients,
                hessians=spent.hessians,
            )
        )

    def non_dominated(self) -> tuple[Array, Array]:
        """Coefficients and objectives of what was found, by increasing residual."""
        self._let_enter()
        return self._coefficients, self._objectives

    def share_of_box(self) -> float:
        """Share of the reference box that is dominated."""
        return share_of_box(self.non_dominated()[1], self.corner)

    @property
    def entries(self) -> Entries:
        """Every candidate that entered."""
        self._let_enter()
        if not self._entered:
            return Entries()
        numbers, coefficients, objectives = (
            np.concatenate(column).tolist() for column in zip(*self._entered)
        )
        residuals, energies = zip(*objectives)
        return Entries(
            tuple(numbers),
            tuple(map(tuple, coefficients)),
            residuals,
            energies,
        )

    def _let_enter(self) -> None:
        """Compare what waits with what entered before, and with what waits before it."""
        if not self._waiting:
            return
        columns = [np.concatenate(column) for column in zip(*self._waiting)]
        self._waiting = []
        self._waiting_rows = 0
        for begin in range(0, len(columns[0]), _BLOCK):
            numbers, X, F = (column[begin : begin + _BLOCK] for column in columns)
            rows = entering(self._objectives, F)
            if not len(rows):
                continue
            self._entered.append((numbers[rows], X[rows], F[rows]))
            X = np.vstack([self._coefficients, X[rows]])
            F = np.vstack([self._objectives, F[rows]])
            alive = np.flatnonzero(moocore.is_nondominated(F))
            alive = alive[np.argsort(F[alive, 0])]
            self._coefficients = X[alive]
            self._objectives = F[alive]

    def front(
        self,
        profile: JointProfile,
        record: Record,
        *,
        failed: int = 0,
        infeasible: int = 0,
    ) -> Front:
        """What was found, at most 100 points of it by CVODES, with every candidate that entered.

        The record states the method and its settings; here it gets the effort and the versions.
        """
        searched = self.seconds
        if not self.marks or self.marks[-1].evaluations < self.evaluations:
            self.mark(searched)
        coefficients, objectives = self.non_dominated()
        began = time.thread_time()
        shown = coefficients[thinned(objectives)]
        points = evaluated(self.task, profile, shown, record.bound).points
        record = replace(
            record,
            evaluations=self.evaluations,
            versions=search_versions(),
            seconds=searched + time.thread_time() - began,
        )
        return Front(
            self.task,
            profile,
            points,
            record,
            self.corner,
            failed=failed,
            infeasible=infeasible,
            history=tuple(self.marks),
            entries=self.entries,
        )


def entering(front: Array, candidates: Array) -> Places:
    """Rows of candidates, in order, that no point of a front and no earlier row weakly dominates.

    The front's points are in order of residual, shape (n, 2).
    """
    below = np.searchsorted(front[:, 0], candidates[:, 0], side="right") - 1
    least = np.append(front[:, 1], np.inf)[below]  # the last is for those with none below
    rows = np.flatnonzero(candidates[:, 1] < least)
    energies = candidates[rows, 1]
    residuals = candidates[rows, 0]
    as_good = (residuals <= residuals[:, None]) & (energies <= energies[:, None])
    return rows[~np.tril(as_good, -1).any(axis=1)]


def search_versions() -> dict[str, str]:
    """Versions of what computes a search."""
    return {**versions(), "pymoo": metadata.version("pymoo")}
