"""`quietarm identify`: a plant's parameters from recordings of the machine."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from functools import partial
from pathlib import Path
from typing import get_args

import click

from quietarm.machine import Recording
from quietarm.machine import identify as identification
from quietarm.machine.held_robots.held_load import TurnedTorquesError
from quietarm.machine.held_robots.identify_robot import IdentifiedRobot, identify_robot
from quietarm.machine.held_robots.robot_lines import write_robot
from quietarm.machine.identify.identified import is_modal
from quietarm.machine.recordings.read_recording import notes_in_words
from quietarm.machine.recordings.robot_recording import RobotRecording
from quietarm.models import Plant, Robot
from quietarm.models.drive import Recorded
from quietarm.models.joint_motion import kind_of_joints
from quietarm.models.robot.robot_file import is_robot_file
from quietarm.ocp.checks import has_no
from quietarm.studies.cli.given import Given
from quietarm.studies.cli.options import SET, busy, command, option
from quietarm.studies.cli.outputs import PICTURE, answer_files, ending_of, finish, output_option
from quietarm.studies.cli.plants import OF_ROBOTS, Kind, parse_plant
from quietarm.studies.cli.quantities import parse_interval
from quietarm.studies.cli.recording_options import (
    RECORDED,
    read_recordings,
    read_robot_recordings,
    scales_typed,
)
from quietarm.studies.cli.robot_options import OF_ROBOT, positions_typed
from quietarm.studies.cli.types import INPUT, NAMES, Parsed
from quietarm.views import pictures
from quietarm.views.report.identified_robot_rows import (
    identified_robot_rows,
    robot_answer,
    robot_notes,
)
from quietarm.views.report.machine_rows import (
    machine_answer,
    machine_notes,
    machine_rows,
    nothing_predicted,
    prediction_answer,
    prediction_rows,
    refuse_defaults,
)

ROBOT_FILE = ".yaml"
"""The ending of a robot's file that is written."""


@command(
    click.Argument(["files"], type=INPUT, nargs=-1, required=True, metavar="RECORDING... PLANT"),
    option("--posture", "postures", multiple=True, metavar="POSITIONS",
           help="Where the joints of a robot were held, as 0,-80deg,97deg, once or for each "
           "RECORDING in order.  [default: as recorded]"),
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
                   PICTURE: "a picture of the fit",
                   ".yaml": "the file of a robot with what was measured"}),
)  # fmt: skip
def identify(given: Given) -> None:
    """Fit parameters of PLANT to each RECORDING of a machine: csv, npy, or MATLAB's up to v7.

    Ring-downs are found, and each is fitted alone; two intervals tell how well the mean is known,
    and where the next swing will be. Where the joint's angle is recorded, its motion counts, too.

    PLANT may be a robot's file: springs, damping and load by the torques of its held joints, or by
    its tip.

    \b
    Examples:
      quietarm identify push*.csv flexible-beam --tip tip_mm --output arm.json --output fit.png
      quietarm identify run*.mat flexible-beam --time t --angle theta --tip w --output arm.json
      quietarm identify --check arm.json new.csv --tip tip_mm
      quietarm identify ring.csv robot.yaml --posture 0,-80deg,97deg,-107deg,-90deg,0
      quietarm plan arm.json --error measured --target 60deg --duration 0.9
    """  # noqa: D301  # \b is click's: do not rewrap
    files = _robot_last(given.files)
    kind = given.check or _plant_at_the_end(str(files[-1]))
    paths = files if given.check else files[:-1]
    if not paths:
        raise click.UsageError("give a RECORDING before PLANT")
    if isinstance(kind, Robot):
        return _identify_robot(given, kind, files[-1], paths)
    given.refuse(["postures"], OF_ROBOT)
    if written := [path for path in given.output if ending_of(path) == ROBOT_FILE]:
        raise ValueError(f"{written[0]} is the file of a robot; give machine.json")
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


def _robot_last(files: Sequence[Path]) -> Sequence[Path]:
    """The files, with that of a robot at the end where it was given first."""
    first, last = files[0], files[-1]
    is_robot = first.suffix in OF_ROBOTS and is_robot_file(first)
    if len(files) > 1 and is_robot and not (last.suffix in OF_ROBOTS and is_robot_file(last)):
        return [*files[1:], first]
    return files


def _identify_robot(given: Given, robot: Robot, file: Path, paths: Sequence[Path]) -> None:
    """Show and write what ring-downs with held joints tell of a robot."""
    given.refuse(["free", "assume", "recorded", "check"], "is for plants of one joint")
    given.refuse(["parameters"], "is not for a robot: its springs are what is sought")
    for path in given.output:
        if ending_of(path) != ROBOT_FILE:
            raise ValueError(f"{path} is no file of a robot; give another.yaml")
        if path.resolve() in {one.resolve() for one in (file, *paths)}:
            raise ValueError(f"{path} is what is read, and would be lost; give another name")
    postures = [positions_typed(text, "--posture", robot) for text in given.postures]
    if len(postures) not in (0, 1, len(paths)):
        raise click.UsageError(
            f"--posture is given {len(postures)} times for {len(paths)} recordings; give it once "
            "for all, or once for each"
        )
    kinds = kind_of_joints([robot.kind_of(name) for name in robot.joints])
    read = read_robot_recordings(given, paths, robot.joints, kinds)
    with busy("fitting"):
        found = _found(given, [one.recording for one in read], robot, postures)
    finish(
        [(path, partial(write_robot, found, file)) for path in given.output],
        robot_answer(found),
        identified_robot_rows(found),
        *robot_notes(found),
        *notes_in_words(read),
    )


def _found(
    given: Given,
    recordings: Sequence[RobotRecording],
    robot: Robot,
    postures: Sequence[Sequence[float]],
) -> IdentifiedRobot:
    """Return what ring-downs tell; refuse torques of the other sign in the words of --scale."""
    try:
        return identify_robot(recordings, robot, postures, given.parts)
    except TurnedTorquesError as error:
        scale = scales_typed(given).get("torque", 1.0)
        cause = str(error).partition(";")[0]
        typed = f"--scale torque={scale:g}"
        remedy = f"leave out {typed}" if scale == -1 else f"give --scale torque={-scale:g}"
        raise ValueError(f"{cause}; {remedy}") from None


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
