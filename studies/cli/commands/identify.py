"""`quietarm identify`: a plant's parameters from recordings of the machine."""

from __future__ import annotations

from itertools import chain

import click

from quietarm.studies import figures
from quietarm.studies import identify as identification
from quietarm.studies.cli.files import PICTURE, answer_files, finish, output_option
from quietarm.studies.cli.given import Given
from quietarm.studies.cli.options import SET, busy, command, option
from quietarm.studies.cli.plants import Kind, parse_plant
from quietarm.studies.cli.quantities import (
    once,
    parse_interval,
    parse_rate,
    parse_scales,
    parse_units,
)
from quietarm.studies.cli.types import INPUT, NAMES, Parsed
from quietarm.studies.reading.recording import read_recording
from quietarm.studies.report.machines import machine_notes, machine_rows, prediction_rows


@command(
    click.Argument(["files"], type=INPUT, nargs=-1, required=True, metavar="RECORDING... PLANT"),
    SET,
    option("--time", help="Column of the time.  [default: the one that is called so, or the "
           "first if it rises evenly]"),
    option("--rate", type=Parsed("rate", parse_rate), help="Samples per second, as 1kHz, of files "
           "without a column of the time."),
    option("--angle", help="Column of the joint's angle; without it the joint was held."),
    option("--tip", multiple=True, help="Column of a tip's displacement."),
    option("--acceleration", multiple=True, help="Column of an accelerometer at a tip."),
    option("--torque", help="Column of the joint's torque."),
    option("--units", type=Parsed("units", parse_units), help="As time:ms,angle:deg,tip:mm,"
           "acceleration:g. [default: those of the columns' names, or SI]"),
    option("--scale", "scales", type=Parsed("scale", parse_scales), multiple=True,
           help="What a count is in SI units, as angle=2pi/4096,tip=1e-5."),
    option("--part", "parts", type=Parsed("begin:end", parse_interval), multiple=True,
           help="Begin and end of a ring-down [s], as 3.2:7.3. [default: they are found]"),
    option("--free", type=NAMES, help="The parameters that are sought, as omega,zeta. [default: "
           "frequencies and dampings, and with a torque what shows in it alone]"),
    option("--check", type=Parsed("machine", parse_plant), help="An identified machine: how much "
           "of the recordings it predicts. PLANT is left out."),
    output_option({".json": "the machine, which serves as a PLANT",
                   PICTURE: "a picture of the fit"}),
)  # fmt: skip
def identify(given: Given) -> None:
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
    # columns of which at least one shows how the machine rings
    rings = ("tip", "acceleration", "torque")
    columns = {
        quantity: [names] if isinstance(names, str) else list(names or ())
        for quantity, names in given.pick("time", "angle", *rings).items()
    }
    if not any(columns[quantity] for quantity in rings):
        raise click.UsageError("give the column of what rings: --tip, --acceleration or --torque")
    kind = given.check or _plant_at_the_end(str(given.files[-1]))
    paths = given.files if given.check else given.files[:-1]
    if not paths:
        raise click.UsageError("give a RECORDING before PLANT")
    if given.rate and given.time:
        raise click.UsageError("--rate is for files without a column of the time; leave --time out")
    plant = given.read_plant(kind)
    scales = once(chain.from_iterable(given.scales), "--scale ")
    short = len({path.name for path in paths}) == len(paths)
    recordings = [
        read_recording(
            path, columns, given.units or {}, path.name if short else str(path), scales, given.rate
        )
        for path in paths
    ]
    if given.check:
        if given.output or given.parts or given.free:
            raise click.UsageError("--check fits nothing: leave --output, --part and --free out")
        note = "The state is taken from two periods, and the five after them are predicted."
        predictions = identification.predict(plant, recordings)
        return finish([], prediction_rows(plant, predictions), note)
    with busy("fitting"):
        machine = identification.identify(recordings, plant, given.free, given.parts)
    files = answer_files(
        given.output,
        lambda: figures.identification_figure(machine, recordings),
        machine,
    )
    return finish(files, machine_rows(machine), *machine_notes(machine, not columns["angle"]))


def _plant_at_the_end(name: str) -> Kind:
    try:
        return parse_plant(name)
    except ValueError as error:
        raise click.BadParameter(f"{error}; PLANT comes last, after the recordings") from None
