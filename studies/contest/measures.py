"""What the runs of a contest say: hypervolume missing on the way, running times, energies."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import astuple, dataclass
from functools import cached_property
from math import inf
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics.budget.record import CORNER
from quietarm.metaheuristics.ensemble import Spread
from quietarm.ocp.front.points import LEVELS
from quietarm.studies.comparison.staircase import objectives, within
from quietarm.studies.contest.imported import Imported
from quietarm.studies.contest.landscape import Landscape
from quietarm.studies.contest.problems import Yardstick
from quietarm.studies.contest.runs import Run
from quietarm.studies.contest.store import Store

Array = NDArray[np.float64]
_Kind = TypeVar("_Kind", Run, Imported)
TARGETS = (1e-2, 1e-3)
"""Shares of the exact front's hypervolume that may be missing for a target to count as reached."""
_TIMES = 120
_PLACES = 3000


@dataclass(frozen=True, eq=False)
class Outcome:
    """What the runs of one method on one problem ended with; all that is known of other tools'."""

    method: str
    yardstick: Yardstick
    runs: tuple[Run, ...] | tuple[Imported, ...]

    @cached_property
    def final(self) -> Array:
        """Share of the exact front's hypervolume that is missing at the end, shape (runs,)."""
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
        found = [within(objectives(run.front), LEVELS, inf) for run in self.runs]
        return np.array(found) / exact - 1

    @cached_property
    def missing_by_thirds(self) -> Array:
        """Share of the exact hypervolume over each third of the residuals that is missing.

        Shape (runs, 3): still, middle, cheap. Both hypervolumes are up to the corner in the energy.
        """
        scale = self.yardstick.scale
        exact = _over_thirds(scale.scaled(self.yardstick.filled))
        found = [_over_thirds(scale.scaled(objectives(run.front))) for run in self.runs]
        return 1.0 - np.array(found) / exact


@dataclass(frozen=True, eq=False)
class Field(Outcome):
    """All runs of one method on one problem, with what they had found on the way."""

    runs: tuple[Run, ...]

    @cached_property
    def evaluations(self) -> NDArray[np.int64]:
        """Evaluations of the marks that all runs reached, shape (marks,)."""
        longest = min((run.marks for run in self.runs), key=len)
        return np.array([mark.evaluations for mark in longest], dtype=np.int64)

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
    def final(self) -> Array:
        """Missing share at the last mark, shape (runs,)."""
        return self.missing[:, -1]

    @cached_property
    def visited(self) -> Array:
        """Share of the feasible candidates in each third and beyond, shape (runs, 4)."""
        counts = np.array([astuple(run.visits) for run in self.runs], dtype=float)
        return counts / np.maximum(counts.sum(axis=1, keepdims=True), 1.0)

    def hits(self, target: float) -> Array:
        """Evaluations after which a target was first seen reached, shape (runs,); else infinite.

        Seen at the marks: up to 5 % later than it was reached.
        """
        reached = self.missing <= target
        first = self.evaluations[reached.argmax(axis=1)].astype(float)
        return np.where(reached.any(axis=1), first, inf)

    def expected_running_time(self, target: float) -> float:
        """The expected running time to a target, as COCO defines it [evaluations].

        The evaluations that all runs spent until they reached it, or in all where they did not,
        over the number of those that did; infinite where none did [1]_.
        """
        hits = self.hits(target)
        reached = np.isfinite(hits)
        if not reached.any():
            return inf
        spent = np.where(reached, hits, [run.front.evaluations for run in self.runs])
        return float(spent.sum() / reached.sum())

    def after_times(self, times: Array) -> Array:
        """Missing share after times [s], shape (runs, times); 1 before the first mark."""
        rows = list[Array]()
        for seconds, missing in zip(self.seconds, self.missing, strict=True):
            count = np.searchsorted(seconds, times, side="right")
            rows.append(np.where(count > 0, missing[np.maximum(count - 1, 0)], 1.0))
        return np.array(rows)


@dataclass(frozen=True, eq=False)
class Arena:
    """A problem with the runs of all methods on it."""

    yardstick: Yardstick
    fields: tuple[Field, ...]
    imports: tuple[Outcome, ...] = ()
    landscape: Landscape | None = None

    @property
    def problem(self) -> str:
        """Its name."""
        return self.yardstick.problem

    @property
    def outcomes(self) -> tuple[Outcome, ...]:
        """Of all methods."""
        return *self.fields, *self.imports

    @property
    def alike(self) -> tuple[Outcome, ...]:
        """Those that are compared by tests: of runs with one number of evaluations, known here."""
        budgets = {budget for field in self.fields for budget in field.budgets}
        return *self.fields, *(one for one in self.imports if one.budgets == budgets)

    @cached_property
    def times(self) -> Array:
        """Times [s] at even distances on a logarithmic scale, from the first mark to the last."""
        first = min(field.seconds[:, 0].min() for field in self.fields)
        last = max(field.seconds[:, -1].max() for field in self.fields)
        return np.geomspace(max(first, 1e-4), max(last, 2e-4), _TIMES)


def arenas_of(store: Store) -> tuple[Arena, ...]:
    """The problems with runs, in the order of their names; methods in that of theirs."""
    runs = [run for _, run in sorted(store.runs.items())]
    imports = [run for _, run in sorted(store.imports.items())]
    arenas = list[Arena]()
    for problem in dict.fromkeys(run.problem for run in runs):
        yardstick = store.yardsticks[problem]
        fields = [Field(name, yardstick, own) for name, own in _by_method(runs, problem)]
        given = [Outcome(name, yardstick, own) for name, own in _by_method(imports, problem)]
        landscape = store.landscapes.get(problem)
        arenas.append(Arena(yardstick, tuple(fields), tuple(given), landscape))
    return tuple(arenas)


def _by_method(runs: Iterable[_Kind], problem: str) -> Iterable[tuple[str, tuple[_Kind, ...]]]:
    """The runs on a problem, one method after another."""
    own = [run for run in runs if run.problem == problem]
    for method in dict.fromkeys(run.method for run in own):
        yield method, tuple(run for run in own if run.method == method)


def _over_thirds(scaled: Array) -> Array:
    """Area between a front and the corner's energy over each third of the residuals, shape (3,)."""
    ordered = scaled[np.argsort(scaled[:, 0])]
    places = np.linspace(0.0, 1.0, _PLACES, endpoint=False) + 0.5 / _PLACES
    height = np.maximum(CORNER - within(ordered, places, CORNER), 0.0)
    return height.reshape(3, -1).mean(axis=1)


def methods_in(arenas: Iterable[Arena]) -> tuple[str, ...]:
    """Names of the methods that have runs on any problem, each once."""
    return tuple(dict.fromkeys(one.method for arena in arenas for one in arena.outcomes))


def quartiles(rows: Array) -> Array:
    """Lower quartile, median and upper quartile over runs: shape (runs, ...) gives (3, ...).

    Values that exist rather than means of two, so that one infinite run makes no other infinite.
    """
    return np.quantile(rows, [0.25, 0.5, 0.75], axis=0, method="inverted_cdf")


def spread(values: Sequence[float] | Array) -> Spread:
    """Quartiles of the finite values, with how many there are."""
    return Spread.of([float(value) for value in values])
