"""`quietarm learn`: the next plan, by what the machine left of the last one."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import click

from quietarm.machine.identify import Identified
from quietarm.machine.learn import learn as learning
from quietarm.machine.recordings.read_recording import ReadRecording, notes_in_words
from quietarm.machine.recordings.read_robot_recording import ReadRobotRecording
from quietarm.models import Plant
from quietarm.ocp import Plan
from quietarm.ocp.files import check_writable
from quietarm.studies.cli.given import Given
from quietarm.studies.cli.options import SOLVER, busy, command, option
from quietarm.studies.cli.outputs import (
    DATASET,
    PICTURE,
    answer_files,
    ending_of,
    finish,
    output_option,
)
from quietarm.studies.cli.quantities import parse_move, parse_share, parse_usual
from quietarm.studies.cli.recording_options import (
    RECORDED,
    read_recordings,
    read_robot_moves,
)
from quietarm.studies.cli.types import INPUT, Parsed
from quietarm.studies.sweep.learned_rows import set_rows, set_sentence
from quietarm.views import pictures
from quietarm.views.report.learning_rows import learning_rows, learning_sentence


def _machine_file(text: str) -> Path:
    path = Path(text)
    if path.suffix.lower() != ".json":
        raise ValueError(f"{text} is no name of a machine's file; give one that ends with .json")
    return check_writable(path)


@command(
    click.Argument(["plan"], type=INPUT, metavar="PLAN"),
    click.Argument(["files"], type=INPUT, nargs=-1, required=True, metavar="RECORDING..."),
    *RECORDED,
    option("--move", "moves", multiple=True, metavar="AXIS=VALUE,...",
           help="Of a dataset of moves: which of them a RECORDING is of, as "
           "target=400mm,duration=800ms; once for each, in their order."),
    option("--dearer", type=Parsed("share", partial(parse_share, name="--dearer")), default="2%",
           metavar="SHARE", help="By how much more energy the next plan may take."),
    option("--machine", type=Parsed("file", _machine_file), metavar="FILE",
           help="File of the machine that gets what was learned of its frequency, as identify "
           "writes it: a PLANT for other moves."),
    option("--delay", type=Parsed("time", partial(parse_usual, "s", "a delay")), metavar="TIME",
           help="Of a robot: by how much its torques are late, such as by a filter of 10ms."),
    *SOLVER,
    output_option({".json": "the next plan, which knows what it was learned from",
                   ".csv": "its path at 1 kHz", PICTURE: "a picture of it",
                   DATASET: "of a dataset, all its moves, corrected"}, formats=["plan"]),
)  # fmt: skip
def learn(given: Given) -> None:
    """Plan the next move of PLAN's task, by each RECORDING of the executed PLAN.

    The move's start is found in the recording, which lasts until two periods after arrival or
    longer. The next plan makes up for what was left, and knows it: learn again from its recording.
    PLAN may be a dataset of quietarm sweep: recordings of some of its moves correct all of them.

    \b
    Examples:
      quietarm learn plan.json run.csv --tip tool_mm --angle axis_mm --output next.json
      quietarm learn next.json run2.csv run3.csv --tip tool_mm --output third.json
      quietarm learn plan.json run.csv --angle axis_mm --torque force_N --output next.json
      quietarm learn moves.zarr run1.csv run2.csv --move target=400mm,duration=800ms \\
          --move target=600mm,duration=900ms --tip tool_mm --angle axis_mm --output learned.zarr
      quietarm learn robot_plan.json joint_states.yaml --output next.json
    """  # noqa: D301  # \b is click's: do not rewrap
    _refuse_the_plan_itself(given)
    if given.plan.is_dir():
        _learn_set(given)
        return
    given.refuse({"moves"}, "is for a dataset of moves")
    if datasets := [path for path in given.output if ending_of(path) == DATASET]:
        raise ValueError(
            f"{datasets[0]} is a dataset of moves, and {given.plan} a plan; give next.json, or "
            "learn from a dataset of quietarm sweep"
        )
    plan = Plan.load(given.plan)
    known = _known_machine(given.machine, plan)
    read = _recordings(given, plan.task.plant)
    with busy("learning"):
        learned = learning(
            plan,
            [one.recording for one in read],
            dearer=given.dearer,
            solver=given.read_solver(),
            delay=given.delay,
        )
    files = answer_files(given.output, lambda: pictures.motion_figure(learned.plan), learned.plan)
    if given.machine:
        machine = learned.machine if known is None else learned.machine_from(known)
        files.append((given.machine, machine.save))
    finish(
        files,
        learning_sentence(learned),
        learning_rows(plan, learned),
        *learned.notes,
        *notes_in_words(read),
    )


def _learn_set(given: Given) -> None:
    """Correct all moves of a dataset by recordings of some."""
    from quietarm.studies.sweep.learn_set import learn_set
    from quietarm.studies.sweep.library import MoveLibrary

    given.refuse({"machine", "dearer"}, "is for one plan, and this is a dataset")
    if len(given.moves) != len(given.files):
        raise click.UsageError(
            f"{len(given.files)} recordings are given, and {len(given.moves)} times --move; say of "
            "each recording which move it is of, such as --move target=400mm,duration=800ms"
        )
    datasets = [path for path in given.output if ending_of(path) == DATASET]
    if len(datasets) != len(given.output) or len(datasets) > 1:
        raise click.UsageError("give one dataset by --output, a folder as learned.zarr")
    library = MoveLibrary(given.plan)
    task = library.grid.task
    at = [parse_move(text, library.grid.names, task.plant) for text in given.moves]
    read = read_recordings(given, given.files, task.plant)
    with busy("learning"):
        learned = learn_set(library, [(move, one.recording) for move, one in zip(at, read)])
    written = None
    for path in datasets:
        if path.exists():
            raise ValueError(f"{path} is there already; give another name")
        with busy("planning all moves anew"):
            written = learned.write(path)
    finish(
        [],
        set_sentence(learned, task.plant),
        set_rows(learned, task.plant),
        *learned.notes,
        *notes_in_words(read),
        *(f"wrote {path}: {written.grid.cells} moves" for path in datasets if written),
    )


def _recordings(given: Given, plant: Plant) -> Sequence[ReadRecording | ReadRobotRecording]:
    """The recordings of the files: of a robot, or of one joint."""
    if not plant.has_path:
        return read_recordings(given, given.files, plant)
    if given.machine:
        raise click.UsageError(
            "--machine is for plants of one joint; the answer says what to write into the robot's "
            "file"
        )
    return read_robot_moves(given, given.files, plant)


def _refuse_the_plan_itself(given: Given) -> None:
    """Refuse to write over what is read: the plan that was executed, and its recordings."""
    read = {path.resolve(): path for path in (given.plan, *given.files)}
    written = [*given.output, *([given.machine] if given.machine else [])]
    for path in written:
        if path.resolve() in read:
            raise ValueError(
                f"{path} is what the next plan is learned from, and would be lost; give another "
                "name"
            )


def _known_machine(path: Path | None, plan: Plan) -> Identified | None:
    """The machine of a file that is there already; ValueError where it is another one."""
    if path is None or not path.exists():
        return None
    machine = Identified.load(path)
    if machine.plant.name != plan.task.plant.name:
        raise ValueError(
            f"{path} is a machine of {machine.plant.name}, and the plan one of "
            f"{plan.task.plant.name}; give the file of this machine, or another name"
        )
    return machine
