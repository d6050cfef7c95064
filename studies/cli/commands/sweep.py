"""`quietarm sweep`: a certified plan for every cell of a grid."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from quietarm.ocp import QuietarmError, SolveSettings
from quietarm.ocp.planning.terms import choose_profile
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
from quietarm.studies.cli.types import DATASET, LENGTH, PICTURE, RESIDUAL, WHOLE
from quietarm.studies.display.progress import progress
from quietarm.studies.display.saving import drawing
from quietarm.studies.registry.profiles import chooses_terms, profile_of
from quietarm.studies.sweep.grid import Grid
from rich.console import Console

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from quietarm.studies.sweep.store import Store

_MANY = 1_000_000
_HOURS_OF_MANY = 1.4
_MOST_POINTS = 1000


def _check_size(grid: Grid, yes: bool) -> None:
    if grid.cells > _MANY and not yes:
        hours = _HOURS_OF_MANY * grid.cells / _MANY
        raise ValueError(
            f"the grid has {grid.cells} cells, some {hours:.0f} hours on a core; give wider steps, "
            "or --yes"
        )


@click.command()
@task_grid_options
@family_option
@terms_option
@click.option("--bound", type=float, help="Largest coefficient; no bound by default.")
@click.option("--residual-limit", type=RESIDUAL, default="0", show_default=True,
              help="Largest tip displacement after arrival; 0 is at rest, and with --robust 5 % of "
              "how far the plain cycloid bends the tip.")  # fmt: skip
@click.option("--front", type=click.IntRange(2, _MOST_POINTS), metavar="POINTS",
              help="Find a front of so many points for every move as well.")  # fmt: skip
@click.option("--refine", type=LENGTH,
              help="Halve axes until a hundred random moves between the cells leave no more than "
              "this, and break limits by no more than 1 %.")  # fmt: skip
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
    front: int | None,
    refine: float | None,
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
    from quietarm.metaheuristics.sharing.workers import Workers
    from quietarm.studies.reports.sweep import sweep_document
    from quietarm.studies.sweep.asked import Sweep
    from quietarm.studies.sweep.refine import swept
    from quietarm.studies.sweep.work import run_sweep

    _check_size(grid, yes)
    if refine is not None and part != (1, 1):
        raise ValueError("--refine is for a whole grid; leave --part out, or refine afterwards")
    motions, errors = profile_of(profile, grid.task, terms), Console(stderr=True)
    if chooses_terms(profile, terms):
        motions = choose_profile(grid.task)
    asked = Sweep(grid, motions, SolveSettings(**settings), front or 0, refine)
    troubles = list[Exception]()

    def run(store: Store) -> bool:
        missing = len(store.missing(part))
        warn_of_workers(errors, workers, missing)
        with progress(missing, errors, quiet=quiet) as begin:
            done = run_sweep(store, part, Workers(workers, scheduler), begin)
        if done.stopped:
            troubles.append(QuietarmError(
                f"{done.stopped}: {len(done.answers)} of {missing} chunks are done; give the same "
                "line again to go on"
            ))  # fmt: skip
        return not done.stopped

    store, between = swept(output, asked, run, partial(_check_size, yes=yes))

    def picture() -> Figure:
        from quietarm.studies.figures.grid import fronts_figure, grid_figure

        return fronts_figure(store) if front else grid_figure(store)

    document = sweep_document(store, between)
    trouble = troubles[0] if troubles else None
    finish([(figure, drawing(picture))], document, trouble=trouble, quiet=quiet)
