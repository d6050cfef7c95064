"""The same search from many seeds, and the spread of what it finds."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from quietarm.metaheuristics.runs.progress import SearchProgress
from quietarm.metaheuristics.search import search
from quietarm.metaheuristics.sharing.pieces import (
    INTERRUPTED,
    Done,
    InterruptedPiece,
    Listener,
    LostPieceError,
    Piece,
    Say,
)
from quietarm.metaheuristics.sharing.running import run_pieces
from quietarm.metaheuristics.sharing.workers import Workers
from quietarm.ocp import Front, PointToPoint, QuietarmError
from quietarm.ocp.checks import whole

SEARCH_RESIDUAL = 1e-3
"""Residual [m] at which the energies of different seeds are compared."""
MOST_RUNS = 10_000

_REMEDY = "where memory ran short, give fewer workers or a smaller population"


class LostSeedsError(QuietarmError):
    """Workers died while they searched, or the scheduler that was to share the seeds is gone.

    Attributes
    ----------
    fronts : list of Front
        What the seeds found that are done, and the others so far.
    """

    def __init__(self, shared: Done, fronts: list[Front], runs: int) -> None:
        self.fronts = fronts
        lost = ", ".join(f"seed {seed} ({why})" for seed, why in sorted(shared.failures.items()))
        words = [
            shared.stopped,
            f"lost {lost}" if lost else "",
            f"{len(shared.answers)} of {runs} seeds are done",
            f"{len(shared.parts)} in part" if shared.parts else "",
            _REMEDY if lost else "",
        ]
        super().__init__("; ".join(filter(None, words)))


@dataclass(frozen=True)
class Spread:
    """Quartiles of a figure over seeds.

    Attributes
    ----------
    lower, median, upper : float
        Quartiles over all seeds; infinite where they fall on a seed without the figure.
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
        """Quartiles, interpolated as by `numpy.quantile`; what is not finite counts as infinite.

        So that a median over the seeds is no better for those that never got there.
        """
        finite = np.isfinite(values)
        if not len(values):
            return cls(np.inf, np.inf, np.inf, count=0, seeds=0)
        ordered = np.sort(np.where(finite, values, np.inf))
        quartiles = list[float]()
        for place in (len(ordered) - 1) * np.array([0.25, 0.5, 0.75]):  # numpy's finds no infinity
            part, below = float(place % 1), float(ordered[int(place)])
            above = float(ordered[int(np.ceil(place))])
            quartiles.append(below + part * (above - below) if below < above else below)
        return cls(*quartiles, count=int(finite.sum()), seeds=len(values))


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
    scheduler: str | None = None,
    seed: int = 0,
    report: Callable[[SearchProgress, int], None] = lambda progress, seed: None,
    done: Callable[[Front], None] = lambda front: None,
    **settings: Any,
) -> list[Front]:
    """Run independent seeds, each as `search` does.

    Parameters
    ----------
    task : PointToPoint
        The move.
    method : str
        A name of `PRESETS`.
    runs : int
        Number of seeds, from `seed` on.
    workers : int
        Processes of this machine that share the seeds; 1 runs in this one.
    scheduler : str, optional
        Address of a dask scheduler whose workers share the seeds instead, as
        ``tcp://host:8786``.
    seed : int
        First seed.
    report : callable, optional
        Called with a `SearchProgress` and its seed, as the searches go on.
    done : callable, optional
        Called with every front when its run ends.
    **settings : Any
        As for `search`: profile, bound, population, generations, settings.

    Returns
    -------
    list of Front
        In the order of the seeds. After Ctrl-C those that were done, and what the searches that
        were running had found, with ``complete`` false.

    Raises
    ------
    ValueError
        When `runs` or `workers` is below 1, a setting is out of range, several runs are to share a
        checkpoint, or no scheduler answers.
    LostSeedsError
        When a seed cost its worker time and again, as where memory runs out, or the scheduler is
        gone; it holds the fronts of the other seeds.
    KeyboardInterrupt
        When it was interrupted before anything was found.
    """
    seeds, where = seeds_of(seed, runs), Workers(workers, scheduler)
    _refuse_checkpoints(settings, runs, where)
    pieces = [
        Piece(one, f"seed {one}", partial(one_seed, task, method, settings, one)) for one in seeds
    ]
    listener = Listener(
        report=lambda seed, progress: report(progress, seed),
        ended=lambda seed, front: done(front),
    )
    shared = run_pieces(pieces, listener, workers=where, note=LostPieceError)
    found = {**shared.parts, **shared.answers}
    fronts: list[Front] = [found[one] for one in seeds if one in found]
    if shared.failures or shared.stopped not in ("", INTERRUPTED):
        raise LostSeedsError(shared, fronts, runs)
    if not fronts:
        raise KeyboardInterrupt
    return fronts


def _refuse_checkpoints(settings: Mapping[str, Any], runs: int, where: Workers) -> None:
    if not (settings.get("checkpoint") or settings.get("resume")):
        return
    if runs > 1:
        raise ValueError(
            f"a checkpoint holds one search, and there are {runs} runs; leave checkpoint and "
            "resume out, or give 1 run"
        )
    if where.scheduler is not None:
        raise ValueError(
            "a checkpoint is a file of this machine; leave checkpoint and resume out, or the "
            "scheduler"
        )


def one_seed(
    task: PointToPoint,
    method: str,
    settings: Mapping[str, Any],
    seed: int,
    known: Done,
    say: Say,
) -> Front:
    """A search as a piece of work."""
    front = search(task, method, seed=seed, report=say.report, found=say.found, **settings)
    if not front.complete:
        raise InterruptedPiece(front)
    return front
