"""`quietarm sweep`: a certified plan for every cell of a grid."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from quietarm.ocp import QuietarmError, SolveSettings
from quietarm.studies.cli.ending import finish
from quietarm.studies.cli.options import (
    family_option,
    part_option,
    quiet_option,
    terms_option,
    warn_of_workers,
    workers_options,
)
from quietarm.studies.cli.task import task_grid_options
from quietarm.studies.cli.types import DATASET, PICTURE, RESIDUAL, SHARE, WHOLE
from quietarm.studies.display.progress import count
from quietarm.studies.display.saving import drawing
from quietarm.studies.registry.profiles import profile_of
from quietarm.studies.sweep.grid import Grid
from rich.console import Console

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MANY = 1_000_000
_HOURS_OF_MANY = 1.4
_MOST_POINTS = 1000


def _refuse_refine(context: click.Context, option: click.Parameter, value: str | None) -> None:
    if value is not None:
        raise ValueError("--refine is gone; sweep a finer grid, or leave a --limit-margin")


@click.command()
@task_grid_options
@family_option
@terms_option
@click.option("--bound", type=float, help="Largest coefficient; no bound by default.")
@click.option("--residual-limit", type=RESIDUAL, default="0", show_default=True,
              help="Largest tip displacement after arrival; 0 is at rest, and with --robust 5 % of "
              "how far the plain cycloid bends the tip.")  # fmt: skip
@click.option("--limit-margin", "margin", type=SHARE, default="0%", show_default=True,
              help="Share of each limit that plans leave unused, so that moves between the cells "
              "keep it.")  # fmt: skip
@click.option("--front", type=click.IntRange(2, _MOST_POINTS), metavar="POINTS",
              help="Find a front of so many points for every move as well.")  # fmt: skip
@click.option("--refine", hidden=True, expose_value=False, callback=_refuse_refine)
@click.option("--starts", type=WHOLE, default=1, show_default=True, help="Starts of each cell.")
@part_option("chunk")
@click.option("--yes", is_flag=True, help="Do more than a million cells.")
@click.option("--output", type=DATASET, required=True,
              help="The dataset, a folder as moves.zarr: the same line goes on where one was "
              "stopped.")  # fmt: skip
@click.option("--figure", type=PICTURE, help="Draw energy, residual, price and feasibility over "
              "the last two axes; with --front the fronts.")  # fmt: skip
@workers_options
@quiet_option
def sweep(
    grid: Grid,
    profile: str,
    terms: int | None,
    margin: float,
    front: int | None,
    part: tuple[int, int],
    yes: bool,
    output: Path,
    figure: Path | None,
    workers: int,
    scheduler: str | None,
    quiet: bool,
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
          --duration 600ms:1s:20ms --torque-limit 1.5 --output payload.zarr --figure payload.png
    """  # noqa: D301  # \b is click's: do not rewrap
    from quietarm.studies.reports.sweep import sweep_document
    from quietarm.studies.sweep.definition import Definition
    from quietarm.studies.sweep.run import run_sweep
    from quietarm.studies.sweep.store import Store

    if grid.cells > _MANY and not yes:
        hours = _HOURS_OF_MANY * grid.cells / _MANY
        raise ValueError(
            f"the grid has {grid.cells} cells, some {hours:.0f} hours on a core; give wider steps, "
            "or --yes"
        )
    motions, errors = profile_of(profile, grid.task, terms), Console(stderr=True)
    definition = Definition(grid, motions, SolveSettings(**settings), front or 0, margin)
    store = Store.of(output, definition)
    missing, trouble = len(store.missing(part)), None
    warn_of_workers(errors, workers, missing)
    try:
        with count(missing, "chunks", errors, quiet=quiet) as report:
            run_sweep(store, part, workers=workers, scheduler=scheduler, report=report)
    except KeyboardInterrupt:
        done = missing - len(store.missing(part))
        trouble = QuietarmError(
            f"interrupted: {done} of {missing} chunks are done; give the same line again to go on"
        )

    def picture() -> Figure:
        from quietarm.studies.figures.grid import fronts_figure, grid_figure

        return fronts_figure(store) if front else grid_figure(store)

    document = sweep_document(store)
    finish([(figure, drawing(picture))], document, trouble=trouble, quiet=quiet)
