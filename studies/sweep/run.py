"""Run a sweep: its missing chunks, here, by processes of this machine or by a cluster."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from quietarm.interrupts import note_interrupts
from quietarm.metaheuristics.parallel import LostWorkersError, reach_scheduler, side_by_side
from quietarm.ocp import PointToPoint, QuietarmError, Solver, Sqp
from quietarm.ocp.checks import has_no, several, takes
from quietarm.ocp.planning.choose_profile import choose_profile
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.task import OF_MOVES
from quietarm.studies.sweep.definition import Definition, PlanSettings
from quietarm.studies.sweep.grid_cells import plan_chunk
from quietarm.studies.sweep.move_grid import Axis, MoveGrid
from quietarm.studies.sweep.store import Store

if TYPE_CHECKING:
    import xarray


@takes(task=PointToPoint, profile=JointProfile, solver=Solver)
def sweep(
    task: PointToPoint,
    profile: JointProfile | None = None,
    *,
    axes: Mapping[str, Sequence[float]],
    path: str | Path,
    residual_limit: float | None = None,
    bound: float | None = None,
    front_points: int = 0,
    margin: float = 0.0,
    solver: Solver = Sqp(),
    workers: int | str = 1,
) -> xarray.Dataset:
    """Plan every move of a grid; after an interruption the same call continues.

    Parameters
    ----------
    task : PointToPoint
        What the moves have in common.
    profile, residual_limit, bound, solver
        As for `plan_moves`.
    axes : mapping of str to sequence of float
        Values of ``"start"``, ``"target"``, ``"duration"`` and of parameters of the plant, in SI
        units.
    path : str or Path
        The dataset, a folder.
    front_points : int
        Points of a front for every move; 0 for none.
    margin : float
        Share of each limit that the plans leave unused, so that moves between the cells keep it.
    workers : int or str
        Processes of this machine, or the address of a dask scheduler.

    Returns
    -------
    xarray.Dataset
        Its variables are explained in docs/sweeps.md.

    Raises
    ------
    FileFormatError
        When the path is something else, or the dataset of another sweep.
    ValueError
        When a name or a number is out of range.
    QuietarmError
        When a worker died or the scheduler is gone; finished chunks are kept.
    """
    units = task.plant.units()
    units |= {name: unit.of(task.plant.joint) for name, unit in OF_MOVES.items()}
    if not isinstance(axes, Mapping):
        raise ValueError(
            f"axes are {axes!r}; give values by name, such as {{'target': [0.3, 0.6]}}"
        )
    for name in axes:
        if name not in units:
            raise ValueError(has_no(task.plant.name, "axis", name, units))
    values = {name: several(f"axis {name}", axes[name], "values") for name in axes}
    order = sorted(axes, key=lambda name: name in OF_MOVES)  # chunks then have few plants
    grid = MoveGrid(
        task,
        tuple(
            Axis(
                name,
                tuple(values[name]),
                units[name],
            )
            for name in order
        ),
    )
    settings = PlanSettings.of(residual_limit, bound, solver)
    profile = choose_profile(task) if profile is None else profile
    if not Path(path).exists():
        reach_scheduler(workers)  # before anything is written
    store = Store.of(
        Path(path),
        Definition(
            grid,
            profile,
            settings,
            front_points,
            margin,
        ),
    )
    run_sweep(store, workers=workers)
    return store.dataset


def run_sweep(
    store: Store,
    part: tuple[int, int] = (1, 1),
    *,
    workers: int | str = 1,
    report: Callable[[int, int], object] = lambda done, total: None,
) -> None:
    """Plan the chunks of a part that are missing; each is in the store as soon as it is done."""
    remedy = "what is done is kept; give the same line again to go on"
    missing = store.missing(part)
    done = 0
    planned = side_by_side(partial(plan_chunk, store.definition), missing, workers)
    try:
        for number, rows in planned:
            with note_interrupts() as came:
                store.write(number, rows)
            done += 1
            report(done, len(missing))
            if came:
                raise came[0]
    except LostWorkersError as error:
        raise QuietarmError(f"{error}; {remedy}") from None
    if not store.missing():
        with note_interrupts() as came:
            store.mark_jumps()
        if came:
            raise came[0]
