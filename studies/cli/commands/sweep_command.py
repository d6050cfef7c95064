"""`quietarm sweep`: a certified plan for every cell of a grid."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from quietarm.studies.cli.given import Given
from quietarm.studies.cli.interrupted import InterruptedCommandError
from quietarm.studies.cli.options import (
    BOUND,
    PART,
    RESIDUAL_LIMIT,
    ROBOT_PATH,
    SCHEDULER,
    SOLVER,
    TASK,
    VERBOSE,
    WORKERS,
    command,
    counting,
    option,
    profile_options,
)
from quietarm.studies.cli.outputs import (
    DATASET,
    PICTURE,
    answer_files,
    ending_of,
    finish,
    output_option,
)
from quietarm.studies.cli.types import SHARE

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@command(
    *TASK, *ROBOT_PATH, *profile_options(), BOUND, RESIDUAL_LIMIT, *SOLVER,
    option("--limit-margin", "margin", type=SHARE, default="0%", help="Share of each limit that "
           "plans leave unused, so that moves between the cells keep it."),
    option("--front", type=click.IntRange(2, 1000), metavar="POINTS",
           help="Find a front of so many points for every move as well."),
    PART,
    option("--yes", is_flag=True, help="Do more than a million cells."),
    WORKERS, SCHEDULER, VERBOSE,
    output_option({DATASET: "the moves; the same line goes on where one was stopped",
                   PICTURE: "a picture"}, required=True),
)  # fmt: skip
def sweep(given: Given) -> None:
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
    from quietarm.metaheuristics.parallel import reach_scheduler
    from quietarm.studies.sweep.definition import Definition, PlanSettings
    from quietarm.studies.sweep.run import run_sweep
    from quietarm.studies.sweep.store import Store
    from quietarm.studies.sweep.sweep_rows import cells_along, sweep_answer, sweep_rows

    grid = given.read_grid()
    if not grid.axes:
        raise click.UsageError(
            "no axis is given; give one as --target 10deg:90deg:5deg, or quietarm plan"
        )
    datasets = [path for path in given.output if ending_of(path) == DATASET]
    if len(datasets) != 1:
        raise click.UsageError("give one dataset by --output, a folder as moves.zarr")
    if grid.cells > 1_000_000 and not given.yes:
        raise ValueError(
            f"the grid has {grid.cells} cells, some {grid.hours:.0f} hours on a core; give wider "
            "steps, or --yes"
        )
    profile = given.read_profile(grid.task)
    residual_limit = given.read_residual_limit(grid.task.plant)
    settings = PlanSettings.of(residual_limit, given.bound, given.read_solver())
    definition = Definition(grid, profile, settings, given.front or 0, given.margin)
    workers = given.scheduler or given.workers
    if not datasets[0].exists():
        reach_scheduler(workers)  # before anything is written
    store = Store.of(datasets[0], definition)
    missing = len(store.missing(given.part))
    trouble = None
    if not missing:
        store.check()
    try:
        with counting(missing, "chunks") as report:
            run_sweep(store, given.part, workers=workers, report=report)
    except KeyboardInterrupt as stop:
        done = missing - len(store.missing(given.part))
        words = f"interrupted: {done} of {missing} chunks are done"
        trouble = InterruptedCommandError(f"{words}; give the same line again to go on", stop)

    def picture() -> Figure:
        from quietarm.studies.sweep.grid_figures import fronts_figure, grid_figure

        return fronts_figure(store) if given.front else grid_figure(store)

    files = answer_files([path for path in given.output if path not in datasets], picture)
    rows = sweep_rows(store, verbose=given.verbose)
    shown = [sweep_answer(store), rows, *cells_along(store), *given.remarks]
    finish(files, *shown, trouble=trouble)
