"""`quietarm identify`: a plant's parameters from recordings of the machine."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import click
from quietarm.models import Plant
from quietarm.studies import figures
from quietarm.studies.cli.ending import finish
from quietarm.studies.cli.options import command, quiet_option
from quietarm.studies.cli.plants import chosen_plant, parse_plant
from quietarm.studies.cli.task import plant_file_option
from quietarm.studies.cli.types import INPUT, JSON_FILE, PICTURE, SETTING, Parsed
from quietarm.studies.display.progress import working
from quietarm.studies.display.saving import drawing
from quietarm.studies.identify import Identified
from quietarm.studies.identify import identify as identified
from quietarm.studies.reading.recording import read_recording, units_of
from quietarm.studies.reports.identify import identified_document
from rich.console import Console


def _plant_at_the_end(name: str) -> type[Plant] | Identified:
    try:
        return parse_plant(name)
    except ValueError as error:
        raise ValueError(f"{error}; PLANT comes last, after the recordings") from None


@command()
@click.argument("recordings", type=INPUT, nargs=-1, required=True, metavar="RECORDING...")
@click.argument("plant", type=Parsed("plant", _plant_at_the_end), metavar="PLANT")
@plant_file_option()
@click.option("--set", "parameters", type=SETTING, multiple=True,
              help="What is known of the plant, as length=0.6 (SI); may be repeated.")  # fmt: skip
@click.option("--time", help="Column of the time.  [default: the one that is called so]")
@click.option("--angle", help="Column of the joint's angle; without it the joint was held.")
@click.option("--tip", multiple=True, help="Column of the tip's displacement; one for each tip.")
@click.option("--acceleration", multiple=True,
              help="Column of an accelerometer at the tip, across; one for each tip.")  # fmt: skip
@click.option("--torque", help="Column of the joint's torque.")
@click.option("--units", type=Parsed("units", units_of), default={},
              help="Of columns whose names do not end in them, as time:ms,angle:deg,tip:mm,"
              "acceleration:g. [default: SI]")  # fmt: skip
@click.option("--free", type=Parsed("names", lambda text: [one.strip() for one in text.split(",")]),
              help="The parameters that are sought, as omega,zeta. [default: frequencies and "
              "dampings, and with a torque what shows in it alone]")  # fmt: skip
@click.option("--output", type=JSON_FILE,
              help="Write the machine to this JSON file, which serves as a PLANT.")  # fmt: skip
@click.option("--figure", type=PICTURE, help="Draw recordings and fit (.png, .pdf or .svg).")
@quiet_option
def identify(
    recordings: tuple[Path, ...],
    plant: type[Plant],
    plant_file: Mapping[str, type[Plant]] | None,
    parameters: tuple[tuple[str, str], ...],
    units: Mapping[str, str],
    free: list[str] | None,
    output: Path | None,
    figure: Path | None,
    quiet: bool,
    **named: str | tuple[str, ...] | None,
) -> None:
    """Fit parameters of PLANT to each RECORDING of a machine: csv, npy, or MATLAB's up to v7.

    Ring-downs are found by themselves. Where the joint's angle is recorded, how the tip follows the
    joint is fitted, too.

    \b
    Examples:
      quietarm identify push.csv flexible-beam --tip tip_mm --output arm.json
      quietarm identify run*.mat flexible-beam --time t --angle theta --tip w --output arm.json
      quietarm plan arm.json --error measured --target 60deg --duration 0.9
    """  # noqa: D301  # \b is click's: do not rewrap
    columns = {
        quantity: [names] if isinstance(names, str) else list(names or ())
        for quantity, names in named.items()
    }
    if not any(columns[one] for one in ("tip", "acceleration", "torque")):
        raise click.UsageError("give the column of what rings: --tip, --acceleration or --torque")
    short = len({path.name for path in recordings}) == len(recordings)
    read = [
        read_recording(path, columns, units, path.name if short else str(path))
        for path in recordings
    ]
    known = chosen_plant(plant, plant_file, parameters)
    with working("fitting", Console(stderr=True), quiet=quiet):
        found = identified(read, known, free)
    picture = drawing(lambda: figures.identification_figure(found, read))
    finish([(output, found.save), (figure, picture)], identified_document(found))
