"""`quietarm identify`: a plant's parameters from recordings of the machine."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import get_args

import click

from quietarm.machine import Recording
from quietarm.machine import identify as identification
from quietarm.machine.identify.identified import is_modal
from quietarm.machine.recordings.read_recording import notes_in_words
from quietarm.models import Plant
from quietarm.models.drive import Recorded
from quietarm.ocp.checks import has_no
from quietarm.studies.cli.given import Given
from quietarm.studies.cli.options import SET, busy, command, option
from quietarm.studies.cli.outputs import PICTURE, answer_files, ending_of, finish, output_option
from quietarm.studies.cli.plants import Kind, parse_plant
from quietarm.studies.cli.quantities import parse_interval
from quietarm.studies.cli.recording_options import RECORDED, read_recordings
from quietarm.studies.cli.types import INPUT, NAMES, Parsed
from quietarm.views import pictures
from quietarm.views.report.machine_rows import (
    machine_answer,
    machine_notes,
    machine_rows,
    nothing_predicted,
    prediction_answer,
    prediction_rows,
    refuse_defaults,
)


@command(
    click.Argument(["files"], type=INPUT, nargs=-1, required=True, metavar="RECORDING... PLANT"),
    SET,
    *RECORDED,
    option("--part", "parts", type=Parsed("begin:end", parse_interval), multiple=True,
           help="Begin and end of a ring-down [s], such as 3.2:7.3. [default: they are found]"),
    option("--free", type=NAMES, help="The parameters that are sought, such as omega,zeta. "
           "[default: frequencies and dampings, and with a torque what shows in it alone]"),
    option("--assume", type=NAMES, help="Parameters that keep the plant's own default in the "
           "machine's file, such as hub_inertia,friction, or all: neither the recordings nor "
           "--set tell them."),
    option("--recorded", type=click.Choice(get_args(Recorded)), help="How the joint was while it "
           "was recorded: held, or moving under its servo. A --drive needs it. [default: held if "
           "--angle is given, else not known]"),
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
    kind = given.check or _plant_at_the_end(str(given.files[-1]))
    paths = given.files if given.check else given.files[:-1]
    if not paths:
        raise click.UsageError("give a RECORDING before PLANT")
    plant = given.read_plant(kind)
    read = read_recordings(given, paths, plant)
    recordings = [one.recording for one in read]
    notes = notes_in_words(read)
    if given.check:
        return _check(given, plant, recordings, notes)
    known = dict(given.parameters).keys()
    assumed = _assumed(given.assume, plant)
    told_otherwise = {*known, *assumed}
    if isinstance(kind, identification.Identified):
        told_otherwise |= plant.measured.keys()
    saves = any(ending_of(path) != PICTURE for path in given.output)
    if saves:  # what no recording tells is known before they are fitted
        sought = identification.sought(recordings, plant, given.free)
        refuse_defaults(plant, _others(plant, {*sought, *told_otherwise}))
    with busy("fitting"):
        machine = identification.identify(
            recordings, plant, given.free, given.parts, given.recorded
        )
    machine = machine.with_given(plant, known)
    if saves:
        told = set(plant.measured) - set(machine.untold)
        refuse_defaults(plant, _others(plant, told | told_otherwise))
    files = answer_files(
        given.output,
        lambda: pictures.identification_figure(machine, recordings),
        machine,
    )
    return finish(
        files,
        machine_answer(machine),
        machine_rows(machine, known, assumed),
        *machine_notes(machine, machine.recorded is None, known, assumed),
        *notes,
    )


def _others(plant: Plant, names: Collection[str]) -> list[str]:
    """The parameters of a plant that are none of these."""
    return [name for name in plant.measured if name not in names]


def _assumed(names: Sequence[str] | None, plant: Plant) -> Collection[str]:
    """The parameters that keep the plant's own values: none that a ring-down tells."""
    may_stand = [name for name in plant.measured if not is_modal(plant, name)]
    if not names:
        return ()
    if [*names] == ["all"]:
        return may_stand
    for name in names:
        if name not in plant.measured:
            raise ValueError(has_no(plant.name, "parameter", name, plant.measured))
        if name not in may_stand:
            raise ValueError(
                f"--assume {name}: a ring-down tells it; record one, or give it by --set {name}=..."
            )
    return names


def _check(
    given: Given, plant: Plant, recordings: Sequence[Recording], notes: Sequence[str]
) -> None:
    """Show how much of recordings a machine predicts; an error where it is nothing."""
    given.refuse(
        ["output", "parts", "free", "assume", "recorded"], "is not for --check, which fits nothing"
    )
    note = "The state is taken from two periods, and the five after them are predicted."
    predictions = identification.predict(plant, recordings)
    warnings = [
        f"warning: {recording.name}: {change}"
        for recording in recordings
        for change in recording.mended.values()
    ]
    rows = prediction_rows(plant, predictions)
    shown = [prediction_answer(plant, predictions), rows, note, *warnings, *notes]
    finish([], *shown, trouble=nothing_predicted(plant, predictions))


def _plant_at_the_end(name: str) -> Kind:
    try:
        return parse_plant(name)
    except ValueError as error:
        raise click.BadParameter(f"{error}; PLANT comes last, after the recordings") from None
