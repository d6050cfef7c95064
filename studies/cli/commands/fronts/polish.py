"""`quietarm polish`: a front improved by the gradient."""

from __future__ import annotations

from pathlib import Path

import click
from quietarm.studies.cli.options import (
    INPUT,
    OUTPUT,
    PICTURE,
    WHOLE,
    plant_file_option,
    quiet_option,
)
from quietarm.studies.runs.files import FrontFiles


@click.command()
@click.argument("front", type=INPUT, metavar="FRONT")
@click.option(
    "--points", type=WHOLE,
    help="Only this many points, spread evenly along the front; all of them by default, which "
    "takes about 50 ms each.",
)  # fmt: skip
@click.option("--output", type=OUTPUT, help="Write the improved front to this JSON file.")
@click.option("--csv", "csv_file", type=OUTPUT, help="Write every point's gain to this CSV file.")
@click.option(
    "--figure", type=PICTURE, help="Draw the front before and after (.png, .pdf or .svg)."
)
@plant_file_option(expose_value=False)
@quiet_option
def polish(
    front: Path,
    points: int | None,
    output: Path | None,
    csv_file: Path | None,
    figure: Path | None,
    quiet: bool,
) -> None:
    """Improve the points of a front that was written by `quietarm front`.

    From each point the gradient looks for a cheaper motion of no larger residual. What a
    metaheuristic's front gains shows how far it was from the optimum. Ctrl-C ends the work early
    and keeps what was improved.

    \b
    Examples:
      quietarm polish front.json
      quietarm polish front.json --points 50 --output polished.json --figure polished.png
    """  # noqa: D301  # \b is click's: do not rewrap
    from quietarm.studies.runs.polishing import run_polish

    run_polish(front, points, FrontFiles(output, csv_file, figure), quiet)
