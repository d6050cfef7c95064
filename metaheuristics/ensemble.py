"""The same search from many seeds, in processes, and the spread of what it finds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing import get_context
from typing import Any

import numpy as np

from metaheuristics.search import search
from ocp import Front, PointToPoint

STILL = 1e-3
"""Residual [m] at which the energies of different seeds are compared."""


@dataclass(frozen=True)
class Spread:
    """Quartiles of a figure over seeds; NaN where fewer than one seed has it."""

    lower: float
    median: float
    upper: float

    @classmethod
    def of(cls, values: Sequence[float]) -> Spread:
        """Quartiles of the finite values."""
        finite = [value for value in values if np.isfinite(value)]
        if not finite:
            return cls(np.nan, np.nan, np.nan)
        return cls(*(float(q) for q in np.quantile(finite, [0.25, 0.5, 0.75])))


def hypervolumes(fronts: Sequence[Front]) -> Spread:
    """Quartiles of the final hypervolume, as a share of the reference box."""
    return Spread.of([front.history[-1].hypervolume if front.history else 0.0 for front in fronts])


def energies_at(fronts: Sequence[Front], residual_limit: float = STILL) -> Spread:
    """Quartiles of the least energy [J] with a residual within the limit [m]."""
    return Spread.of([_energy_at(front, residual_limit) for front in fronts])


def _energy_at(front: Front, residual_limit: float) -> float:
    try:
        return front.cheapest(residual_limit).energy
    except ValueError:
        return np.nan


def search_many(
    task: PointToPoint,
    method: str,
    runs: int,
    *,
    workers: int = 1,
    seed: int = 0,
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
        Processes; 1 stays in this one.
    seed : int
        First seed.
    done : callable, optional
        Called with every front when its run ends.
    **settings : Any
        As for `search`: profile, bound, population, generations.

    Returns
    -------
    list of Front
        In the order of the seeds; those of the runs that were done when Ctrl-C came.

    Raises
    ------
    ValueError
        When `runs` or `workers` is below 1, or a setting is out of range.
    """
    for name, value in (("runs", runs), ("workers", workers)):
        if value < 1:
            raise ValueError(f"{name} is {value}; give 1 or more")
    fronts: dict[int, Front] = {}
    seeds = range(seed, seed + runs)
    if workers == 1:
        for one in seeds:
            fronts[one] = search(task, method, seed=one, **settings)
            done(fronts[one])
            if not fronts[one].complete:
                break
        return list(fronts.values())
    # spawn: a fork would carry casadi's and the threads' state into the child
    with ProcessPoolExecutor(min(workers, runs), mp_context=get_context("spawn")) as pool:
        futures = {pool.submit(search, task, method, seed=s, **settings): s for s in seeds}
        try:
            for future in as_completed(futures):
                fronts[futures[future]] = future.result()
                done(future.result())
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
    return [fronts[one] for one in seeds if one in fronts]
