"""A sweep from Python."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING

from quietarm.metaheuristics.sharing.workers import Workers
from quietarm.ocp import CycloidPolynomial, PointToPoint, SolveSettings
from quietarm.ocp.checks import has_no
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.studies.sweep.asked import Sweep
from quietarm.studies.sweep.grid import OF_MOVES, Axis, Grid
from quietarm.studies.sweep.refine import swept
from quietarm.studies.sweep.store import NEEDS, Store
from quietarm.studies.sweep.work import run_sweep

if TYPE_CHECKING:
    import xarray


def sweep(
    task: PointToPoint,
    axes: Mapping[str, Sequence[float]],
    path: str | Path,
    *,
    profile: JointProfile | None = None,
    residual_limit: float = 0.0,
    bound: float | None = None,
    starts: int = 1,
    front: int = 0,
    refine: float | None = None,
    workers: int = 1,
    scheduler: str | None = None,
) -> xarray.Dataset:
    """Plan every move of a grid; the same call goes on where one was stopped.

    Parameters
    ----------
    task : PointToPoint
        What the moves have in common.
    axes : mapping of str to sequence of float
        Values of ``"start"``, ``"target"``, ``"duration"`` and of parameters of the plant, in SI
        units, rising or falling.
    path : str or Path
        The dataset, a folder.
    profile, residual_limit, bound, starts
        As for `plan_moves`.
    front : int
        Points of a front for every move; 0 for none.
    refine : float, optional
        Halve axes until a hundred random moves between the cells leave no more than this [m], and
        break limits by no more than 1 %.
    workers, scheduler : int, str, optional
        Processes of this machine, or the address of a dask scheduler.

    Returns
    -------
    xarray.Dataset
        Its variables are told in docs/sweeps.md. After Ctrl-C cells may be left, whose status is 0.

    Raises
    ------
    FileFormatError
        When the path is something else, or the dataset of another sweep.
    ValueError
        When a name or a number is out of range.
    """
    try:
        import xarray as xr
    except ImportError:
        raise ValueError(NEEDS) from None

    units = {entry.name: entry.metadata.get("unit", "-") for entry in fields(task.plant)}
    units |= OF_MOVES
    for name in axes:
        if name not in units:
            raise ValueError(has_no(task.plant.name, "axis", name, units))
    order = sorted(axes, key=lambda name: name in OF_MOVES)  # chunks then have few plants
    grid = Grid(task, tuple(Axis(name, tuple(map(float, axes[name])), units[name])
                            for name in order))  # fmt: skip
    settings = SolveSettings(residual_limit, bound, starts)
    profile = CycloidPolynomial() if profile is None else profile
    asked, chosen = Sweep(grid, profile, settings, front, refine), Workers(workers, scheduler)

    def run(store: Store) -> bool:
        return not run_sweep(store, (1, 1), chosen, lambda name: None).stopped

    store, _ = swept(Path(path), asked, run)
    return xr.open_zarr(store.path, consolidated=False)
