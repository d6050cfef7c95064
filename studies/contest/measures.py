"""What the runs of a contest say: hypervolume missing on the way, running times, energies."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import astuple, dataclass
from functools import cached_property
from itertools import groupby
from math import inf

import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics.budget.record import CORNER, Visits
from quietarm.ocp.front.points import LEVELS
from quietarm.studies.compare.staircase import objectives, within
from quietarm.studies.contest.landscape import Landscape
from quietarm.studies.contest.names import label_of
from quietarm.studies.contest.store import Run, Store, Yardstick

Array = NDArray[np.float64]
TARGETS = (1e-2, 1e-3)
"""Shares of the exact front's hypervolume that may be missing for a target to count as reached."""
BUDGETS = (0.1, 0.3, 1.0)
"""Shares of a run's evaluations after which methods are held against each other."""
_TIMES = 120
_THIRDS = (np.arange(3000) + 0.5) / 3000


@dataclass(frozen=True, eq=False)
class Field:
    """All runs of one method on one problem; of some other tools' only the ends are known."""

    method: str
    yardstick: Yardstick
    runs: tuple[Run, ...]

    @property
    def label(self) -> str:
        """What the method is called in tables and pictures."""
        return label_of(self.method)

    @property
    def own(self) -> bool:
        """Whether what they had found on the way is known, as they were run here, or recorded."""
        return all(run.marks for run in self.runs)

    @property
    def here(self) -> bool:
        """Whether they were run here."""
        return all(run.here for run in self.runs)

    @cached_property
    def final(self) -> Array:
        """Share of the exact front's hypervolume that is missing at the end, shape (runs,)."""
        if self.own:
            return self.missing[:, -1]
        scale = self.yardstick.scale
        volumes = [scale.hypervolume(objectives(run.front)) for run in self.runs]
        return 1.0 - np.array(volumes) / self.yardstick.hypervolume

    @property
    def middle(self) -> float:
        """Missing share of the middle run; of an even number the better of two, as `quartiles`."""
        return float(quartiles(self.final)[1])

    @property
    def budgets(self) -> set[int | None]:
        """Evaluations of its runs; with None where those of one are not known."""
        return {run.evaluations for run in self.runs}

    @cached_property
    def energies(self) -> Array:
        """How far the least energies within `LEVELS` are above the exact ones, as a share.

        Shape (runs, levels); infinite where a run has no motion within a level.
        """
        exact = within(objectives(self.yardstick.front), LEVELS)
        return self.stairs(np.array(LEVELS)) / exact - 1

    def stairs(self, residuals: Array) -> Array:
        """Least energy [J] of every run within residuals, shape (runs, residuals)."""
        return np.array([within(objectives(run.front), residuals, inf) for run in self.runs])

    @cached_property
    def missing_by_thirds(self) -> Array:
        """Share of the exact hypervolume over each third of the residuals that is missing.

        Shape (runs, 3): still, middle, cheap. Both hypervolumes are up to the corner in the energy.
        """
        scale = self.yardstick.scale
        line = scale.scaled(self.yardstick.filled)
        exact = _over_thirds(np.interp(_THIRDS, *line.T))
        steps = [scale.scaled(objectives(run.front)) for run in self.runs]
        found = [_over_thirds(within(front, _THIRDS, CORNER)) for front in steps]
        return 1.0 - np.array(found) / exact

    @cached_property
    def evaluations(self) -> NDArray[np.int64]:
        """Evaluations of the marks that all runs reached, shape (marks,)."""
        shortest = min((run.marks for run in self.runs), key=len)
        return np.array([mark.evaluations for mark in shortest], dtype=np.int64)

    @cached_property
    def missing(self) -> Array:
        """Share of the exact front's hypervolume that is missing, shape (runs, marks)."""
        count = len(self.evaluations)
        volumes = [[mark.hypervolume for mark in run.marks[:count]] for run in self.runs]
        return 1.0 - np.array(volumes) / self.yardstick.hypervolume

    @cached_property
    def seconds(self) -> Array:
        """Processor time at the marks [s], shape (runs, marks)."""
        count = len(self.evaluations)
        return np.array([[mark.seconds for mark in run.marks[:count]] for run in self.runs])

    @cached_property
    def visited(self) -> Array:
        """Share of the feasible candidates in each third and beyond, shape (runs, 4)."""
        counts = np.array([astuple(run.visits or Visits()) for run in self.runs], dtype=float)
        return counts / np.maximum(counts.sum(axis=1, keepdims=True), 1.0)

    def missing_after(self, evaluations: int) -> Array:
        """Missing share after so many evaluations, shape (runs,); all of it before the first mark.

        Of results from elsewhere, of which the end alone is known, that of the end.
        """
        if not self.own:
            return self.final
        known = np.column_stack([np.ones(len(self.runs)), self.missing])
        return known[:, np.searchsorted(self.evaluations, evaluations, side="right")]

    def hits(self, target: float) -> Array:
        """Evaluations after which a target was first seen reached, shape (runs,).

        Seen at the marks: up to 5 % later than it was reached. Infinite where it was not, and where
        only the end is known.
        """
        if not self.own:
            return np.full(len(self.runs), inf)
        reached = self.missing <= target
        first = self.evaluations[reached.argmax(axis=1)].astype(float)
        return np.where(reached.any(axis=1), first, inf)

    def expected_running_time(self, target: float) -> float:
        """The expected running time to a target, as COCO defines it [evaluations].

        The evaluations that all runs spent until they reached it, or in all where they did not,
        over the number of those that did; infinite where none did.
        """
        hits = self.hits(target)
        reached = np.isfinite(hits)
        if not reached.any():
            return inf
        spent = np.where(reached, hits, [run.front.evaluations for run in self.runs])
        return float(spent.sum() / reached.sum())

    def after_times(self, times: Array) -> Array:
        """Missing share after times [s], shape (runs, times); 1 before the first mark."""
        return np.array(
            [
                np.append(1.0, missing)[np.searchsorted(seconds, times, side="right")]
                for seconds, missing in zip(self.seconds, self.missing, strict=True)
            ]
        )


@dataclass(frozen=True, eq=False)
class Arena:
    """A problem with the runs of all methods on it, results from elsewhere last."""

    yardstick: Yardstick
    fields: tuple[Field, ...]
    landscape: Landscape | None = None

    @property
    def problem(self) -> str:
        """Its name."""
        return self.yardstick.problem

    @property
    def own(self) -> list[Field]:
        """Those of which the way is known."""
        return [field for field in self.fields if field.own]

    @property
    def imports(self) -> list[Field]:
        """Results from elsewhere of which the end alone is known."""
        return [field for field in self.fields if not field.own]

    @property
    def alike(self) -> list[Field]:
        """Those that are compared by tests, of runs with one number of evaluations, known here."""
        first = [field for field in self.fields if field.here] or self.own[:1]
        budgets = {budget for field in first for budget in field.budgets}
        return [field for field in self.fields if field.here or field.budgets == budgets]

    @property
    def best(self) -> Field:
        """The one whose middle run ends nearest to the exact front."""
        return min(self.alike, key=lambda field: field.middle)

    @cached_property
    def times(self) -> Array:
        """Times [s] at even distances on a logarithmic scale, from the first mark to the last."""
        first = min(field.seconds[:, 0].min() for field in self.own)
        last = max(field.seconds[:, -1].max() for field in self.own)
        return np.geomspace(max(first, 1e-4), max(last, 2e-4), _TIMES)


def budgets_of(arenas: Sequence[Arena]) -> list[int]:
    """Evaluations after which the methods are held against each other, the last those of a run."""
    whole = max(run.evaluations or 0 for arena in arenas for one in arena.own for run in one.runs)
    return [round(share * whole) for share in BUDGETS]


def arenas_of(store: Store) -> tuple[Arena, ...]:
    """The problems with runs, in the order of their names; methods in that of theirs."""

    def order(run: Run) -> tuple[str, bool, str, int, str]:
        return run.problem, bool(run.file), run.method, run.front.seed or 0, run.file or ""

    runs, arenas = sorted(store.of(Run), key=order), list[Arena]()
    landscapes = {one.problem: one for one in store.of(Landscape)}
    for problem, yardstick in sorted(store.yardsticks.items()):
        here = [run for run in runs if run.problem == problem]
        fields = tuple(
            Field(method, yardstick, tuple(own))
            for (_, method), own in groupby(here, key=lambda run: (bool(run.file), run.method))
        )
        if any(field.own for field in fields):
            arenas.append(Arena(yardstick, fields, landscapes.get(problem)))
    return tuple(arenas)


def _over_thirds(energies: Array) -> Array:
    """Area between scaled energies at `_THIRDS` and the corner over each third, shape (3,)."""
    return np.maximum(CORNER - energies, 0.0).reshape(3, -1).mean(axis=1)


def methods_in(arenas: Iterable[Arena]) -> tuple[str, ...]:
    """Names of the methods that have runs on any problem, each once."""
    return tuple(dict.fromkeys(field.method for arena in arenas for field in arena.fields))


def quartiles(rows: Array) -> Array:
    """Lower quartile, median and upper quartile over runs: shape (runs, ...) gives (3, ...).

    Values that exist rather than means of two, so that one infinite run makes no other infinite.
    """
    return np.quantile(rows, [0.25, 0.5, 0.75], axis=0, method="inverted_cdf")
