"""`quietarm identify`: a plant's parameters from recordings of the machine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

import click
from quietarm.models import Plant
from quietarm.studies import figures
from quietarm.studies import identify as identification
from quietarm.studies.cli.files import PICTURE, files_of, finish, output_option
from quietarm.studies.cli.options import busy, command, option, plant_file
from quietarm.studies.cli.plants import chosen_plant, parse_plant
from quietarm.studies.cli.quantities import once, parse_interval, parse_scale, parse_units
from quietarm.studies.cli.task import set_option
from quietarm.studies.cli.types import INPUT, Parsed
from quietarm.studies.reading.recording import read_recording
from quietarm.studies.report.machines import machine_notes, machine_rows, prediction_rows


def _plant_at_the_end(name: str) -> type[Plant] | identification.Identified:
    try:
        return parse_plant(name)
    except ValueError as error:
        raise ValueError(f"{error}; PLANT comes last, after the recordings") from None


@command()
@click.argument("files", type=INPUT, nargs=-1, required=True, metavar="RECORDING... PLANT")
@set_option
@option("--time", help="Column of the time.  [default: the one that is called so]")
@option("--angle", help="Column of the joint's angle; without it the joint was held.")
@option("--tip", multiple=True, help="Column of the tip's displacement; one for each tip.")
@option("--acceleration", multiple=True, help="Column of an accelerometer at the tip, likewise.")
@option("--torque", help="Column of the joint's torque.")
@option("--units", type=Parsed("units", parse_units), help="Of columns whose names "
        "have none, as time:ms,angle:deg,tip:mm,acceleration:g. [default: SI]")  # fmt: skip
@option("--scale", "scales", type=Parsed("scale", parse_scale), multiple=True,
        help="What a count is in SI units, as angle=2pi/4096; may be repeated.")  # fmt: skip
@option("--part", "parts", type=Parsed("begin:end", parse_interval), multiple=True,
        help="Begin and end of a ring-down [s], as 3.2:7.3; may be repeated. [default: they are "
        "found]")  # fmt: skip
@option("--free", type=Parsed("names", lambda text: [one.strip() for one in text.split(",")]),
        help="The parameters that are sought, as omega,zeta. [default: frequencies and dampings, "
        "and with a torque what shows in it alone]")  # fmt: skip
@option("--check", type=Parsed("machine", parse_plant), help="An identified machine: how much of "
        "the recordings it predicts. PLANT is left out.")  # fmt: skip
@output_option({".json": "the machine, which serves as a PLANT", PICTURE: "a picture of the fit"})
@click.pass_context
def identify(
    context: click.Context,
    files: tuple[Path, ...],
    parameters: tuple[tuple[str, str], ...],
    units: Mapping[str, str] | None,
    scales: tuple[tuple[str, float], ...],
    parts: tuple[tuple[float, float], ...],
    free: list[str] | None,
    check: type[Plant] | identification.Identified | None,
    output: Sequence[Path],
    **named: str | tuple[str, ...] | None,
) -> None:
    """Fit parameters of PLANT to each RECORDING of a machine: csv, npy, or MATLAB's up to v7.

    Ring-downs are found, and each is fitted alone; two intervals tell how well the mean is known,
    and where the next swing will be. Where the joint's angle is recorded, its motion counts, too.

    \b
    Examples:
      quietarm identify push*.csv flexible-beam --tip tip_mm --output arm.json --output fit.png
      quietarm identify run*.mat flexible-beam --time t --angle theta --tip w --output arm.json
      quietarm identify --check arm.json new.csv --tip tip_mm
      quietarm plan arm.json --error measured --target 60deg --duration 0.9
    """  # noqa: D301  # \b is click's: do not rewrap
    columns = {
        quantity: [names] if isinstance(names, str) else list(names or ())
        for quantity, names in named.items()
    }
    if not any(columns[one] for one in ("tip", "acceleration", "torque")):
        raise click.UsageError("give the column of what rings: --tip, --acceleration or --torque")
    kind = check or Parsed("plant", _plant_at_the_end).convert(str(files[-1]), None, context)
    paths = files if check else files[:-1]
    if not paths:
        raise click.UsageError("give a RECORDING before PLANT")
    known = chosen_plant(kind, plant_file(), parameters)
    short = len({path.name for path in paths}) == len(paths)
    of_scale = once(scales, "--scale ")
    read = [
        read_recording(path, columns, units or {}, path.name if short else str(path), of_scale)
        for path in paths
    ]
    if check:
        if output or parts or free:
            raise click.UsageError("--check fits nothing: leave --output, --part and --free out")
        note = "The state is taken from two periods, and the five after them are predicted."
        finish([], prediction_rows(known, identification.predict(known, read)), note)
        return
    with busy("fitting"):
        found = identification.identify(read, known, free, parts)
    draw = partial(figures.identification_figure, found, read)
    written = files_of(output, {".json": found.save, PICTURE: draw})
    finish(written, machine_rows(found), *machine_notes(found, not columns["angle"]))
