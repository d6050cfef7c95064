"""Finer grids, until moves between the cells leave little enough and keep the limits."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from quietarm.studies.sweep.asked import COEFFICIENTS, Sweep
from quietarm.studies.sweep.branches import jumps
from quietarm.studies.sweep.grid import Axis, Grid
from quietarm.studies.sweep.interpolation import Interpolation
from quietarm.studies.sweep.library import Between, MoveLibrary
from quietarm.studies.sweep.store import Store, lay_out

_OF_LIMITS = 1.01
"""Peaks over their limits up to which no axis is halved: where a limit begins to act, coefficients
have a kink, and halving an axis brings little."""


def finer_beside(path: Path) -> Path:
    """Where the finer grid of a dataset is until it is whole."""
    return path.with_name(f"{path.name}.finer")


def swept(
    path: Path,
    asked: Sweep,
    run: Callable[[Store], bool],
    allow: Callable[[Grid], None] = lambda grid: None,
) -> tuple[Store, Between | None]:
    """The dataset of a sweep, refined where that is asked for, and what is left between its cells.

    `run` plans what a store lacks and says whether that is all of it, and `allow` refuses a finer
    grid by a ValueError. A finer dataset stands beside the coarser one until it is whole; a run
    that was stopped goes on with it.
    """
    finer = finer_beside(path)
    if finer.exists() and not path.exists():  # it was killed between two renames
        os.rename(finer, path)
    store = Store.of(path, asked)
    whole, between = run(store), None
    while asked.refine is not None and whole:
        between = MoveLibrary(path).between()
        if between.residual <= asked.refine and between.of_limits <= _OF_LIMITS:
            break
        if not finer.exists():
            grid = halved(store)
            allow(grid)
            lay_out(finer, asked, replace(store.sweep, grid=grid))
        whole = run(Store.of(finer, asked))
        if whole:
            coarse = path.with_name(f"{path.name}.coarse")
            os.rename(path, coarse)
            os.rename(finer, path)
            shutil.rmtree(coarse)
            store = Store(path)
    return store, between


def halved(store: Store) -> Grid:
    """The grid with one axis halved: the one along which interpolation is worst."""
    grid = store.sweep.grid
    worst = int(np.argmax(_errors(grid.axes, store.read(COEFFICIENTS))))
    axes = [*grid.axes]
    values = np.array(axes[worst].values)
    between = (values[1:] + values[:-1]) / 2
    both = np.insert(values, np.arange(1, len(values)), between)
    axes[worst] = Axis(axes[worst].name, tuple(both.tolist()), axes[worst].unit)
    return replace(grid, axes=tuple(axes))


def _errors(axes: tuple[Axis, ...], cells: NDArray[np.float64]) -> list[float]:
    """For each axis the median error at every second cell, by the polynomials of the others."""
    errors = list[float]()
    for k, axis in enumerate(axes):
        count = (len(axis.values) - 1) // 2 * 2 + 1  # those that are left out lie between others
        if count < 3:
            errors.append(np.inf)
            continue
        values = [np.array(one.values) for one in axes]
        left_out, values[k] = values[k][1:count:2], values[k][:count:2]
        kept = np.take(cells, np.arange(0, count, 2), axis=k)
        exact = np.take(cells, np.arange(1, count, 2), axis=k)
        grid = np.meshgrid(*(left_out if i == k else one for i, one in enumerate(values)),
                           indexing="ij")  # fmt: skip
        places = np.stack(grid, axis=-1).reshape(-1, len(axes))
        found = Interpolation(values, kept, jumps(kept))(places)
        missed = np.linalg.norm(found - exact.reshape(found.shape), axis=1)
        known = missed[np.isfinite(missed)]
        errors.append(float(np.median(known)) if known.size else np.inf)
    return errors
