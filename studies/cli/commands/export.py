"""`quietarm export`: a plan in the form that a controller reads."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
from quietarm.studies.cli.ending import finish
from quietarm.studies.cli.options import command, typed
from quietarm.studies.cli.task import plant_file_option
from quietarm.studies.cli.types import INPUT, OUTPUT, Named
from quietarm.studies.document.blocks import Document, Lines
from quietarm.studies.export.formats import (
    COLUMNS,
    FORMATS,
    JOINT,
    RATE,
    export_moves,
    export_plan,
    format_of,
)
from quietarm.studies.reading.saved import load_plans


@command()
@click.argument("plan", type=INPUT)
@click.option("--output", type=OUTPUT, required=True, help="The file; move.c has move.h beside it.")
@click.option("--format", "form", type=Named("format", FORMATS),
              help="The form. [default: by the file's ending]")  # fmt: skip
@click.option("--columns", default=COLUMNS, show_default=True,
              help="Of csv and mat, with units: time:ms,angle:deg,speed,acceleration,jerk,tip:mm,"
              "torque,power.")  # fmt: skip
@click.option("--rate", type=float, default=RATE, show_default=True,
              help="Rows or points in a second [Hz].")  # fmt: skip
@click.option("--joint", default=JOINT, show_default=True, help="The joint's name, for ROS.")
@plant_file_option(expose_value=False)
def export(plan: Path, output: Path, form: str | None, **wishes: Any) -> None:
    """Write a saved PLAN for a controller: csv, C, a ROS 2 JointTrajectory, or MATLAB.

    The PLAN may be the dataset of quietarm sweep, whose moves are written as C with the
    interpolation between them.

    The C source gives angle, speed and acceleration at any time from the coefficients, with nothing
    but math.h.

    \b
    Examples:
      quietarm export plan.json --output move.c
      quietarm export plan.json --output move.csv --columns time:ms,angle:deg,torque --rate 500
      quietarm export plan.json --output move.yaml --joint shoulder_pan_joint --rate 100
      quietarm export moves.zarr --output moves.c
    """  # noqa: D301  # \b is click's: do not rewrap
    form = form or format_of(output)
    for name in wishes:
        if typed(name) and name not in FORMATS[form].takes:
            takers = " and ".join(one for one, each in FORMATS.items() if name in each.takes)
            raise ValueError(f"--{name} is for {takers}, not for {form}; leave it out")
    if plan.is_dir():
        written = export_moves(plan, output, form)
    else:
        (saved,) = load_plans([plan]).values()
        written = export_plan(saved, output, form, **wishes)
    finish([], Document("", [Lines([f"wrote {path}" for path in written])]))
