"""The archive of a search: candidates that none before dominates, and the effort until then."""

from __future__ import annotations

import time
from dataclasses import replace
from importlib import metadata
from typing import TYPE_CHECKING, Any

import moocore
import numpy as np
from numpy.typing import NDArray

from quietarm.interrupts import note_interrupts
from quietarm.metaheuristics.score import share_of_box
from quietarm.metaheuristics.thinning import thinned
from quietarm.ocp import Front, Mark
from quietarm.ocp.cost import COST, Cost
from quietarm.ocp.front.points import Entries
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY
from quietarm.ocp.record import Record, versions

if TYPE_CHECKING:
    from quietarm.metaheuristics.problems.problem_function import ProblemFunction

Array = NDArray[np.float64]
Places = NDArray[np.int64]
_BLOCK = 512
"""Candidates that are compared with each other at once: the pairs of as many fit into the cache."""


class Archive:
    """The feasible candidates that no earlier one dominates, and marks of the effort.

    What dominates is what the search believes: with noise, its noisy values. The true ones are kept
    beside them.

    Parameters
    ----------
    problem : ProblemFunction
        What is searched: it makes entries, points and fronts of what was found.
    noisy : bool
        Whether the values that it takes have noise.
    """

    def __init__(self, problem: ProblemFunction, noisy: bool = False) -> None:
        self.problem = problem
        self.names = problem.objectives
        self.noisy = noisy
        self.evaluations = 0
        self.marks = list[Mark]()
        self._corner = problem.corner
        self._next_mark = 1.0
        self._front: Places = np.empty(0, dtype=np.int64)  # which of those that entered
        self._objectives = np.empty((0, len(self.names)))
        self._entered = list[tuple[Places, Array, Array, Array]]()
        self._entered_rows = 0
        self._waiting = list[tuple[Places, Array, Array, Array]]()
        self._waiting_rows = 0
        # what a simulator or a machine takes is no time of this thread
        self._clock = time.thread_time if problem.of_model else time.monotonic
        self._began = self._clock()
        self._seconds_here = 0.0
        self._cost = COST.copy()

    @property
    def corner(self) -> tuple[float, ...]:
        """The corner that hypervolumes are measured from: the problem's, or the largest values."""
        if self._corner is not None:
            return self._corner
        self._let_enter()
        blocks = [block[3] for block in self._entered]
        if not blocks:
            return (1.0,) * len(self.names)
        return tuple(np.concatenate(blocks).max(axis=0).tolist())

    def measure_from(self, corner: tuple[float, ...]) -> None:
        """Measure hypervolumes from a corner, unless the problem has one of its own."""
        if self._corner is None and len(corner) == len(self.names):
            self._corner = corner

    @property
    def seconds(self) -> float:
        """Processor time since the beginning, without the archive's and compilation's [s].

        Of a user's own function all the time that has passed.
        """
        apart = self._seconds_here + self._spent().builds
        return self._clock() - self._began - apart

    def add(
        self,
        X: Array,
        F: Array,
        usable: NDArray[np.bool_],
        true: Array | None = None,
        repeated: int = 0,
    ) -> None:
        """Take evaluated candidates, of which those that are usable may enter.

        F are their objectives with any noise, `true` those without, and so many evaluations were
        spent beyond one for each. Ctrl-C waits until all of them are taken.
        """
        with note_interrupts() as came:
            self._take(X, F, usable, true, repeated)
        if came:
            raise came[0]

    def _take(
        self,
        X: Array,
        F: Array,
        usable: NDArray[np.bool_],
        true: Array | None,
        repeated: int,
    ) -> None:
        # evaluations between neighbouring marks: 24 in a decade, at the ends of generations
        step = 10 ** (1 / 24)
        seconds = self.seconds
        began = self._clock()
        numbers = self.evaluations + 1 + np.flatnonzero(usable)
        self.evaluations += len(X) + repeated
        if len(numbers):
            believed = F[usable].copy()
            known = believed if true is None else true[usable].copy()
            self._waiting.append((numbers, X[usable].copy(), believed, known))
            self._waiting_rows += len(numbers)
        if self._waiting_rows >= _BLOCK:
            self._let_enter()
        if self.evaluations >= self._next_mark:
            self.mark(seconds)
            self._next_mark = max(self.evaluations, 1) * step
        self._seconds_here += self._clock() - began

    def entering(self, F: Array, usable: NDArray[np.bool_]) -> Places:
        """Rows of objectives that would enter, of those that are usable."""
        self._let_enter()
        return np.flatnonzero(usable)[entering(self._objectives, F[usable])]

    def charge(self, evaluations: int) -> None:
        """Count so many candidates that were simulated for derivatives, and may not enter."""
        self.evaluations += evaluations

    def _spent(self) -> Cost:
        """Return the work since the beginning; none of a function, which another thread may ask."""
        return COST.since(self._cost) if self.problem.of_model else Cost()

    def mark(self, seconds: float) -> None:
        """Note the effort until now."""
        spent = self._spent()
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
        return self._of_front(1, len(self.problem.variables)), self._objectives

    def _of_front(self, column: int, width: int) -> Array:
        """A column of the entries, of those alone that none dominates now."""
        if not self._entered:
            return np.empty((0, width))
        blocks: list[Any] = [block[column] for block in self._entered]
        return np.concatenate(blocks)[self._front]

    def share_of_box(self) -> float:
        """Share of the reference area that is dominated."""
        self._let_enter()
        points = self._objectives
        if len(self.names) > len(RESIDUAL_AND_ENERGY):  # of all, it would take longer than a search
            points = points[thinned(points)]
        return share_of_box(points, self.corner)

    @property
    def entries(self) -> Entries:
        """Every candidate that entered."""
        self._let_enter()
        if not self._entered:
            return self.problem.entries_of((), (), ((), ()), ())
        columns: list[Any] = [np.concatenate(column) for column in zip(*self._entered)]
        numbers, coefficients, believed, true = columns
        return self.problem.entries_of(
            tuple(numbers.tolist()),
            _rows(coefficients),
            tuple(tuple(column.tolist()) for column in true.T),
            _rows(believed) if self.noisy else (),
        )

    def _let_enter(self) -> None:
        """Compare what waits with what entered before; Ctrl-C leaves no half of it."""
        if not self._waiting:
            return
        with note_interrupts() as came:
            self._let_all_enter()
        if came:
            raise came[0]

    def _let_all_enter(self) -> None:
        """Compare what waits with what entered before, and with what waits before it."""
        columns = [np.concatenate(column) for column in zip(*self._waiting)]
        self._waiting = []
        self._waiting_rows = 0
        for begin in range(0, len(columns[0]), 2 * _BLOCK):
            numbers, X, F, true = (column[begin : begin + 2 * _BLOCK] for column in columns)
            rows = entering(self._objectives, F)
            if not len(rows):
                continue
            self._entered.append((numbers[rows], X[rows], F[rows], true[rows]))
            new = np.arange(self._entered_rows, self._entered_rows + len(rows))
            self._entered_rows += len(rows)
            F = np.vstack([self._objectives, F[rows]])
            alive = np.flatnonzero(moocore.is_nondominated(F))
            alive = alive[np.argsort(F[alive, 0])]
            self._front = np.concatenate([self._front, new])[alive]
            self._objectives = F[alive]

    def front(
        self,
        record: Record,
        *,
        failed: int = 0,
        infeasible: int = 0,
    ) -> Front:
        """Make a front of at most 100 points, with every candidate that entered.

        Of a move the points are by CVODES. The record states the method and its settings; here it
        gets the effort and the versions.
        """
        searched = self.seconds
        if not self.marks or self.marks[-1].evaluations < self.evaluations:
            self.mark(searched)
        coefficients, objectives = self.non_dominated()
        began = self._clock()
        chosen = thinned(objectives)
        true = self._of_front(3, len(self.names))
        points = self.problem.points_of(coefficients[chosen], true[chosen], record.bound)
        record = replace(
            record,
            evaluations=self.evaluations,
            versions=search_versions(),
            seconds=searched + self._clock() - began,
        )
        return self.problem.front_with(
            points,
            record,
            reference=self.corner,
            failed=failed,
            infeasible=infeasible,
            history=tuple(self.marks),
            entries=self.entries,
        )


def _rows(table: Array) -> tuple[tuple[float, ...], ...]:
    """The rows of a table as tuples, without a list for each of ten thousands."""
    return tuple(zip(*table.T.tolist()))


def entering(front: Array, candidates: Array) -> Places:
    """Rows of candidates, in order, that no point of a front and no earlier row weakly dominates.

    The front's points are in order of residual, shape (n, objectives).
    """
    if candidates.shape[1] > len(RESIDUAL_AND_ENERGY):
        within = np.asarray((front <= candidates[:, None]).all(axis=2))
        dominated = np.any(within, axis=1)
        rows = np.flatnonzero(~dominated)
        remaining = candidates[rows]
        as_good = (remaining <= remaining[:, None]).all(axis=2)
        return rows[~np.any(np.tril(as_good, -1), axis=1)]
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
