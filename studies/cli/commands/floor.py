"""`quietarm floor`: the least energy over all joint motions."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
from quietarm.ocp import PointToPoint, energy_floor
from quietarm.studies import figures
from quietarm.studies.cli.ending import finish
from quietarm.studies.cli.options import quiet_option
from quietarm.studies.cli.task import task_options
from quietarm.studies.cli.types import JSON_FILE, PICTURE, WHOLE
from quietarm.studies.display.progress import working
from quietarm.studies.display.saving import drawing
from quietarm.studies.reports.floor import floor_document, plan_beside
from rich.console import Console


@click.command()
@task_options
@click.option("--smooth", is_flag=True, help="Keep the acceleration continuous: the jerk is free.")
@click.option("--starts", type=WHOLE, default=4, show_default=True, help="Starts of the solver.")
@click.option("--seed", type=WHOLE, default=0, show_default=True, help="Seed of the random starts.")
@click.option(
    "--tolerance", type=float, default=0.005, show_default=True,
    help="Refine the grid until the energy changes by less than this share.",
)  # fmt: skip
@click.option("--output", type=JSON_FILE, help="Write the floor to this JSON file.")
@click.option("--figure", type=PICTURE, help="Draw it over the plan (.png, .pdf or .svg).")
@quiet_option
def floor(
    task: PointToPoint, output: Path | None, figure: Path | None, quiet: bool, **asked: Any
) -> None:
    """Find the least energy of a move over all joint motions, at rest on arrival.

    The joint follows no profile: its acceleration is free. The energy of a plan above this floor is
    the price of its profile. Without an acceleration limit the floor's motion begins and ends with
    a jolt.

    \b
    Examples:
      quietarm floor arm-on-flexible-link --target pi/2 --duration 0.8
      quietarm floor single-link --target 30deg --duration 0.8 --acceleration-limit 80 \\
          --figure floor.png --output floor.json
    """  # noqa: D301  # \b is click's: do not rewrap
    with working("refining the grid", Console(stderr=True), quiet=quiet):
        found = energy_floor(task, **asked)
        plan = plan_beside(found)
    finish(
        [(output, found.save), (figure, drawing(lambda: figures.floor_figure(found, plan)))],
        floor_document(found, plan),
    )
