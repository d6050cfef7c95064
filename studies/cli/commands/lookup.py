"""`quietarm lookup`: a move between the cells of a sweep."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import click
from quietarm.ocp import Plan
from quietarm.studies.cli.ending import finish
from quietarm.studies.cli.files import plan_file_options
from quietarm.studies.cli.options import quiet_option
from quietarm.studies.cli.plants import values_of_plant
from quietarm.studies.cli.task import plant_file_option
from quietarm.studies.cli.types import ANGLE, INPUT, SETTING, TIME
from quietarm.studies.display.progress import working
from quietarm.studies.display.saving import File
from quietarm.studies.reports.plan import plan_document
from rich.console import Console


@click.command()
@click.argument("moves", type=INPUT, metavar="DATASET")
@plant_file_option(expose_value=False)
@click.option("--start", type=ANGLE, help="Joint angle at the start, where that is an axis.")
@click.option("--target", type=ANGLE, help="Joint angle at the end.")
@click.option("--duration", type=TIME, help="Travelling time.")
@click.option("--set", "parameters", type=SETTING, multiple=True,
              help="A parameter of the plant that is an axis, as tip_mass=150g.")  # fmt: skip
@quiet_option
@plan_file_options
def lookup(
    moves: Path,
    parameters: tuple[tuple[str, str], ...],
    quiet: bool,
    files_of: Callable[[Plan], list[File]],
    **asked: float | None,
) -> None:
    """Take a move from the DATASET of quietarm sweep, by interpolation between its cells.

    It says what such moves leave, how much more they cost than plans of their own and how far they
    break limits, each the largest of a hundred random ones. A move that breaks a limit is written,
    and ends with status 1.

    \b
    Examples:
      quietarm lookup moves.zarr --target 37deg --duration 930ms --output plan.json
    """  # noqa: D301  # \b is click's: do not rewrap
    from quietarm.studies.sweep.library import plan_from
    from quietarm.studies.sweep.store import Store

    with working("looking between the cells", Console(stderr=True), quiet=quiet):
        plant = Store(moves).definition.grid.task.plant
        at = values_of_plant(plant, parameters)
        at |= {name: value for name, value in asked.items() if value is not None}
        found, between, trouble = plan_from(moves, **at)
    finish(files_of(found), plan_document(found, [between.words]), trouble=trouble)
