"""The same search from many seeds, in processes, and the spread of what it finds."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

import numpy as np

from metaheuristics.algorithms.presets import PRESETS
from metaheuristics.runs.progress import SearchProgress
from metaheuristics.search import search
from ocp import Front, PointToPoint, QuietarmError
from ocp.base.checks import whole
from ocp.base.workers import Say, Workers, number_of_workers, remedy

SEARCH_RESIDUAL = 1e-3
"""Residual [m] at which the energies of different seeds are compared."""
MOST_RUNS = 10_000

_KILLED_REMEDY = "where memory ran short, give fewer workers or a smaller population"


class Report(Protocol):
    """Called as searches go on."""

    def __call__(self, progress: SearchProgress, seed: int) -> None:
        """Hear where the search of this seed is."""
        ...


class LostSeedsError(QuietarmError):
    """Processes died while they searched.

    Attributes
    ----------
    fronts : list of Front
        What the other seeds found.
    """

    def __init__(self, lost: Mapping[int, str], fronts: list[Front], runs: int) -> None:
        self.fronts = fronts
        seeds = ", ".join(f"seed {seed} ({how})" for seed, how in sorted(lost.items()))
        super().__init__(
            f"the process of {seeds} died; {len(fronts)} of {runs} seeds are done; "
            + remedy(lost.values(), _KILLED_REMEDY)
        )


@dataclass(frozen=True)
class Spread:
    """Quartiles of a figure over seeds.

    Attributes
    ----------
    lower, median, upper : float
        Quartiles over the seeds that have the figure; NaN where none has it.
    count, seeds : int
        How many seeds have the figure, of how many.
    """

    lower: float
    median: float
    upper: float
    count: int
    seeds: int

    @classmethod
    def of(cls, values: Sequence[float]) -> Spread:
        """Quartiles of the finite values, interpolated as by `numpy.quantile`."""
        finite = [value for value in values if np.isfinite(value)]
        quartiles = np.quantile(finite, [0.25, 0.5, 0.75]) if finite else np.full(3, np.nan)
        return cls(*(float(q) for q in quartiles), count=len(finite), seeds=len(values))


def hypervolumes(fronts: Sequence[Front]) -> Spread:
    """Quartiles of the final hypervolume, as a share of the reference box."""
    return Spread.of([front.history[-1].hypervolume if front.history else 0.0 for front in fronts])


def energies_at(fronts: Sequence[Front], residual_limit: float = SEARCH_RESIDUAL) -> Spread:
    """Quartiles of the least energy [J] with a residual within the limit [m]."""
    return Spread.of([energy_at(front, residual_limit) for front in fronts])


def energy_at(front: Front, residual_limit: float = SEARCH_RESIDUAL) -> float:
    """Least energy [J] of a front with a residual within the limit [m]; NaN where none is."""
    try:
        return front.cheapest(residual_limit).energy
    except ValueError:
        return np.nan


def number_of_runs(value: object, name: str = "runs") -> int:
    """A number of seeds as an int; ValueError when it is out of range."""
    return whole(name, value, 1, MOST_RUNS, "the fronts of more would fill the memory")


def seeds_of(seed: int, runs: int) -> range:
    """The seeds of so many runs from the first on; ValueError when a number is out of range."""
    seed, runs = whole("seed", seed, 0), number_of_runs(runs)
    return range(seed, seed + runs)


def search_many(
    task: PointToPoint,
    method: str,
    runs: int,
    *,
    workers: int = 1,
    seed: int = 0,
    report: Report = lambda progress, seed: None,
    done: Callable[[Front], None] = lambda front: None,
    **settings: Any,
) -> list[Front]:
    """Run independent seeds, each as `search` does.

    Parameters
    ----------
    task : PointToPoint
        The move.
    method : str
        ``"nsga2"`` or ``"vepso"``.
    runs : int
        Number of seeds, from `seed` on.
    workers : int
        Processes; 1 runs in this one.
    seed : int
        First seed.
    report : callable, optional
        Called with a `SearchProgress` and its seed, as the searches go on.
    done : callable, optional
        Called with every front when its run ends.
    **settings : Any
        As for `search`: profile, bound, population, generations.

    Returns
    -------
    list of Front
        In the order of the seeds. After Ctrl-C those that were done, and what the searches that
        were running had found, with ``complete`` false.

    Raises
    ------
    ValueError
        When `runs` or `workers` is below 1, a setting is out of range, or several runs are to
        share a checkpoint or an algorithm of your own.
    LostSeedsError
        When a process died, as where memory runs out; it holds the fronts of the other seeds.
    """
    seeds, workers = seeds_of(seed, runs), number_of_workers(workers)
    if not isinstance(method, str):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise ValueError(
            f"method is {type(method).__name__}; give {' or '.join(map(repr, PRESETS))}, or call "
            "`search` once a seed with an algorithm of your own"
        )
    if runs > 1 and (settings.get("checkpoint") or settings.get("resume")):
        raise ValueError(
            f"a checkpoint holds one search, and there are {runs} runs; leave checkpoint and "
            "resume out, or give 1 run"
        )
    if min(workers, runs) == 1:
        return _one_after_another(task, method, seeds, report, done, settings)
    pool = Workers(
        partial(_search, task, method, settings),
        {one: one for one in seeds},
        report=lambda seed, progress: report(progress, seed),
        done=lambda _, front: done(front) if front.complete else None,
    )
    pool.run(min(workers, runs))
    fronts = [pool.answers[one] for one in seeds if one in pool.answers]
    if pool.lost:
        raise LostSeedsError(pool.lost, fronts, runs)
    return fronts


def _search(
    task: PointToPoint, method: str, settings: Mapping[str, Any], seed: int, say: Say
) -> Front:
    return search(task, method, seed=seed, report=say, **settings)


def _one_after_another(
    task: PointToPoint,
    method: str,
    seeds: Iterable[int],
    report: Report,
    done: Callable[[Front], None],
    settings: Mapping[str, Any],
) -> list[Front]:
    fronts: list[Front] = []
    try:
        for seed in seeds:
            tell = partial(report, seed=seed)
            fronts.append(search(task, method, seed=seed, report=tell, **settings))
            if not fronts[-1].complete:
                break
            done(fronts[-1])
    except KeyboardInterrupt:
        if not fronts:
            raise
    return fronts
