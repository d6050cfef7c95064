"""Finer grids, until what moves between the cells leave is little enough."""

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
from quietarm.studies.sweep.store import Store, lay_out


def finer_beside(path: Path) -> Path:
    """Where the finer grid of a dataset is until it is whole."""
    return path.with_name(f"{path.name}.finer")


def begun_or_laid_out(path: Path, asked: Sweep) -> Store:
    """The dataset of a sweep; a finer one that is whole takes its place."""
    finer = finer_beside(path)
    if finer.exists() and not path.exists():  # it was killed between two renames
        os.rename(finer, path)
    return Store.of(path, asked)


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


def refine_once(
    path: Path, store: Store, asked: Sweep, grid: Grid, run: Callable[[Store], bool]
) -> tuple[Store, bool]:
    """The dataset on a finer grid, in the place of the coarser one as soon as it is whole.

    Where `run` says that it did not get to the end, the finer one stays beside it to go on with,
    and the coarser one is returned, and False.
    """
    finer = finer_beside(path)
    if not finer.exists():
        lay_out(finer, asked, replace(store.sweep, grid=grid))
    if not run(Store.of(finer, asked)):
        return store, False
    coarse = path.with_name(f"{path.name}.coarse")
    os.rename(path, coarse)
    os.rename(finer, path)
    shutil.rmtree(coarse)
    return Store(path), True
