"""`quietarm sweep`: a certified plan for every cell of a grid."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click
from quietarm.ocp import QuietarmError, SolveSettings
from quietarm.studies.cli.ending import finish
from quietarm.studies.cli.options import (
    family_option,
    quiet_option,
    terms_option,
    warn_of_workers,
    workers_options,
)
from quietarm.studies.cli.task import task_grid_options
from quietarm.studies.cli.types import FOLDER, LENGTH, PICTURE, WHOLE, Parsed
from quietarm.studies.display.progress import progress
from quietarm.studies.display.saving import drawing
from quietarm.studies.registry.profiles import profile_of
from quietarm.studies.sweep.grid import Grid
from rich.console import Console

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MANY = 1_000_000
_HOURS_OF_MANY = 3


def _part(text: str) -> tuple[int, int]:
    number, slash, of = text.partition("/")
    if not (slash and number.isdigit() and of.isdigit() and 1 <= int(number) <= int(of)):
        raise ValueError(f"{text!r} is no part; give the second of eight as 2/8")
    return int(number), int(of)


@click.command()
@task_grid_options
@family_option
@terms_option
@click.option("--bound", type=float, help="Largest coefficient; no bound by default.")
@click.option("--residual-limit", type=LENGTH, default="0", show_default=True,
              help="Largest tip displacement after arrival; 0 is at rest.")  # fmt: skip
@click.option("--starts", type=WHOLE, default=1, show_default=True, help="Starts of each cell.")
@click.option("--part", type=Parsed("i/n", _part), default="1/1",
              help="Do every n-th chunk alone, as 2/8 in a queue's array job.")  # fmt: skip
@click.option("--yes", is_flag=True, help="Do more than a million cells.")
@click.option("--output", type=FOLDER, required=True,
              help="The dataset, a folder as moves.zarr: the same line goes on where one was "
              "stopped.")  # fmt: skip
@click.option("--figure", type=PICTURE, help="Draw energies over the last two axes.")
@workers_options
@quiet_option
def sweep(
    grid: Grid,
    profile: str,
    terms: int | None,
    bound: float | None,
    residual_limit: float,
    starts: int,
    part: tuple[int, int],
    yes: bool,
    output: Path,
    figure: Path | None,
    workers: int,
    scheduler: str | None,
    quiet: bool,
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
    try:
        from quietarm.studies.sweep.store import Store
    except ImportError:
        raise ValueError("a sweep needs zarr: install quietarm[sweep]") from None
    from quietarm.metaheuristics.sharing.workers import Workers
    from quietarm.studies.reports.sweep import sweep_document
    from quietarm.studies.sweep.work import run_sweep

    if grid.cells > _MANY and not yes:
        hours = _HOURS_OF_MANY * grid.cells / _MANY
        raise ValueError(
            f"the grid has {grid.cells} cells, some {hours:.0f} hours on a core; give wider steps, "
            "or --yes"
        )
    motions, errors = profile_of(profile, grid.task, terms), Console(stderr=True)
    settings = SolveSettings(residual_limit, bound, starts)
    store = Store(output, grid, motions, settings)
    missing = len(store.missing(part))
    warn_of_workers(errors, workers, missing)
    with progress(missing, errors, quiet=quiet) as begin:
        done = run_sweep(store, motions, settings, part, Workers(workers, scheduler), begin)
    trouble = next(iter(done.failures.values()), None)
    if done.stopped:
        trouble = QuietarmError(
            f"{done.stopped}: {len(done.answers)} of {missing} chunks are done; give the same line "
            "again to go on"
        )

    def picture() -> Figure:
        from quietarm.studies.figures.grid import grid_figure

        return grid_figure(store)

    finish([(figure, drawing(picture))], sweep_document(store), trouble=trouble, quiet=quiet)
