"""`quietarm sweep`: a certified plan for every cell of a grid."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from quietarm.ocp import QuietarmError, SolveSettings
from quietarm.ocp.planning.terms import choose_profile
from quietarm.studies.cli.files import DATASET, PICTURE, ending_of, files_of, finish, output_option
from quietarm.studies.cli.options import (
    bound_option,
    command,
    counting,
    option,
    part_option,
    profile_options,
    residual_limit_option,
    scheduler_option,
    workers_option,
)
from quietarm.studies.cli.task import TypedMove, task_options
from quietarm.studies.cli.types import SHARE
from quietarm.studies.registry.profiles import chooses_terms, profile_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MANY = 1_000_000
_HOURS_OF_MANY = 1.4
_MOST_POINTS = 1000


@command()
@task_options
@profile_options()
@bound_option
@residual_limit_option
@option("--limit-margin", "margin", type=SHARE, default="0%", help="Share of each limit that plans "
        "leave unused, so that moves between the cells keep it.")  # fmt: skip
@option("--front", type=click.IntRange(2, _MOST_POINTS), metavar="POINTS",
        help="Find a front of so many points for every move as well.")  # fmt: skip
@part_option
@option("--yes", is_flag=True, help="Do more than a million cells.")
@workers_option
@scheduler_option
@output_option(
    {DATASET: "the moves; the same line goes on where one was stopped", PICTURE: "a picture"},
    required=True,
)
def sweep(
    move: TypedMove,
    profile: str,
    terms: int | None,
    margin: float,
    front: int | None,
    part: tuple[int, int],
    yes: bool,
    output: Sequence[Path],
    residual_limit: float | None,
    workers: int,
    scheduler: str | None,
    **settings: Any,
) -> None:
    """Plan every move of a grid: axes over start, target, duration and parameters of the plant.

    An axis is from:to:step or a list with commas. The dataset is read by xarray.open_zarr. It needs
    quietarm[sweep].

    \b
    Examples:
      quietarm sweep single-link --target 10deg:90deg:5deg --duration 600ms:1.4s:50ms \\
          --output moves.zarr
      quietarm sweep flexible-beam --set tip_mass=0,100g,200g --target 60deg \\
          --duration 600ms:1s:20ms --torque-limit 1.5 --output payload.zarr --output payload.png
    """  # noqa: D301  # \b is click's: do not rewrap
    from quietarm.studies.report.sweeps import cells_along, sweep_rows
    from quietarm.studies.sweep.definition import Definition
    from quietarm.studies.sweep.run import run_sweep
    from quietarm.studies.sweep.store import Store

    grid = move.grid()
    if not grid.axes:
        raise click.UsageError(
            "no axis is given; give one as --target 10deg:90deg:5deg, or quietarm plan"
        )
    datasets = [path for path in output if ending_of(path) == DATASET]
    if len(datasets) != 1:
        raise click.UsageError("give one dataset by --output, a folder as moves.zarr")
    if grid.cells > _MANY and not yes:
        hours = _HOURS_OF_MANY * grid.cells / _MANY
        raise ValueError(
            f"the grid has {grid.cells} cells, some {hours:.0f} hours on a core; give wider steps, "
            "or --yes"
        )
    motions = profile_of(profile, grid.task, terms)
    if chooses_terms(profile, terms):
        motions = choose_profile(grid.task)
    solve = SolveSettings(residual_limit=residual_limit or 0.0, starts=1, **settings)
    store = Store.of(datasets[0], Definition(grid, motions, solve, front or 0, margin))
    missing, trouble = len(store.missing(part)), None
    try:
        with counting(missing, "chunks") as report:
            run_sweep(store, part, workers=workers, scheduler=scheduler, report=report)
    except KeyboardInterrupt:
        done = missing - len(store.missing(part))
        trouble = QuietarmError(
            f"interrupted: {done} of {missing} chunks are done; give the same line again to go on"
        )

    def picture() -> Figure:
        from quietarm.studies.figures.grid import fronts_figure, grid_figure

        return fronts_figure(store) if front else grid_figure(store)

    pictures = [path for path in output if path not in datasets]
    files = files_of(pictures, {PICTURE: picture})
    finish(files, sweep_rows(store), cells_along(store), trouble=trouble)
