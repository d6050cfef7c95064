"""`quietarm evaluate`: the figures of coefficients, of a path, or of a table of results."""

from __future__ import annotations

from pathlib import Path

import click

from quietarm.machine.tables.table import TABLES
from quietarm.models import Robot, RobotOnPath
from quietarm.ocp import evaluate_coefficients
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.planning.as_timed import WINDOW, evaluate_as_timed
from quietarm.ocp.planning.named_profiles import families
from quietarm.ocp.profiles.shaped_cycloid import SHAPERS
from quietarm.studies.cli.commands.plan_command import FoundMotion, finish_motion
from quietarm.studies.cli.given import Given
from quietarm.studies.cli.options import (
    BLEND,
    BOUND,
    LINE,
    OBJECTIVES,
    PATH_TOLERANCE,
    SENSITIVITIES,
    SOME_WAYPOINTS,
    TASK,
    VERBOSE,
    busy,
    command,
    option,
    profile_options,
)
from quietarm.studies.cli.outputs import (
    PICTURE,
    answer_files,
    check_page,
    finish,
    output_option,
    refuse_formats,
)
from quietarm.studies.cli.plants import choose_kind
from quietarm.studies.cli.quantities import (
    parse_coefficients,
    parse_parameters,
    single_values,
)
from quietarm.studies.cli.types import INPUT, Parsed
from quietarm.views import pictures
from quietarm.views.report.acting_words import path_lines
from quietarm.views.report.first_lines import path_answer, timed_answer
from quietarm.views.report.front_rows import search_lines
from quietarm.views.report.plan_rows import path_rows
from quietarm.views.report.timed_rows import timed_rows


def _coefficients(text: str) -> list[float] | Path:
    return Path(text) if Path(text).suffix.lower() in TABLES else parse_coefficients(text)


@command(
    *TASK, *profile_options(*SHAPERS, words="; or the plain cycloid through an input shaper"),
    option("--coefficients", type=Parsed("numbers", _coefficients), metavar="NUMBERS|FILE",
           help="Those of the profile, such as --coefficients=-0.0019,-0.14; or a file with a row "
           "a motion (.csv, .txt, .npy, .npz, .mat), which gives a front."),
    option("--path", type=INPUT, help="A CSV file with columns such as time_s and angle_deg, in "
           "place of start, target and duration; of a robot its waypoints."),
    PATH_TOLERANCE,
    SOME_WAYPOINTS,
    BLEND,
    *LINE,
    BOUND,
    option("--evaluations", type=int, help="Candidates that it took to find a file's rows."),
    OBJECTIVES,
    SENSITIVITIES,
    VERBOSE,
    option("--as-timed", is_flag=True, help="Judge the trajectory of --path with its own times: "
           "what it takes and leaves, and what makes it ring."),
    output_option({".json": "the plan or front", ".csv": "the path at 1 kHz or the front",
                   PICTURE: "a picture"}, formats=["plan", "front"]),
)  # fmt: skip
def evaluate(given: Given) -> None:
    """Compute residual, energy and peaks of coefficients, an input shaper, a path or a table.

    A --path is followed as a cubic spline through its points, at rest at both ends. The columns of
    a table are a_1, a_2, ...; what it states in columns residual_m and energy_J is compared with
    what its coefficients give.

    \b
    Examples; the first has the paper's two terms for the single link:
      quietarm evaluate single-link --target pi/6 --duration 0.8 --coefficients=0.003347,-0.1697
      quietarm evaluate single-link --target pi/6 --duration 0.8 --profile zvd
      quietarm evaluate flexible-beam --set omega=3.2Hz --path recorded.csv
      quietarm evaluate ur5_bar.yaml --path trajectory.yaml --as-timed
      quietarm evaluate single-link --target pi/6 --duration 0.8 --coefficients results.csv \\
          --output front.json --output front.png
    """  # noqa: D301  # \b is click's: do not rewrap
    if given.as_timed:
        _evaluate_as_timed(given)
    elif given.path is not None and not isinstance(given.plant, Robot):
        _evaluate_path(given)
    elif isinstance(given.coefficients, Path):
        _evaluate_table(given)
    else:
        _evaluate_coefficients(given)


def _evaluate_coefficients(given: Given) -> None:
    """A plan of coefficients, or of an input shaper."""
    task = given.read_task()
    given.refuse(["bound", "evaluations", "objectives"], "is for a table of results")
    refuse_formats(given.output, (".json", ".csv", PICTURE), "plan")
    if given.profile in SHAPERS:
        given.refuse(["coefficients", "terms"], f"is not for {given.profile}")
        profile = given.read_profile(task)
    elif given.coefficients is None:
        raise click.UsageError("Missing option '--coefficients'.")
    else:
        given.refuse(["terms"], "follows from the number of --coefficients")
        profile = families()[given.profile].of_size(len(given.coefficients))
    with busy("integrating"):
        plan = evaluate_coefficients(task, given.coefficients or [], profile=profile)
    answer = FoundMotion(plan, given.remarks)
    finish_motion(answer, given.output, **given.pick("sensitivities", "verbose"))


def _evaluate_path(given: Given) -> None:
    """The figures of a recorded path."""
    from quietarm.machine.recordings.recorded_path import read_path

    given.refuse(["start", "target", "duration"], "is in the file of --path")
    given.refuse_others({"path", *(param.name for param in TASK)}, "is not for a --path")
    recorded = read_path(given.path, given.read_plant(given.plant).joint)
    task = given.read_task(start=recorded.start, target=recorded.target, duration=recorded.duration)
    motion = JudgedMotion.of_free_motion(task, recorded.motion)
    with busy("integrating"):
        first = [*path_lines(motion), *path_answer(motion)]
        rows = path_rows(motion, recorded)
    finish([], *first, rows, *recorded.notes, *given.remarks)


def _evaluate_as_timed(given: Given) -> None:
    """The figures of a robot's trajectory with its own times."""
    robot = choose_kind(given.plant, given.plant_file)
    if not isinstance(robot, Robot) or given.path is None:
        raise ValueError(
            "--as-timed is for the trajectory of a robot; give its file and --path trajectory.yaml"
        )
    kept = {"plant", "path", "as_timed", "residual_window", "energy", "parameters"}
    given.refuse_others(kept, "is not for a trajectory with its own times")
    multiples = single_values(parse_parameters(RobotOnPath, given.parameters))
    window = given.residual_window if given.typed("residual_window") else WINDOW
    with busy("integrating"):
        answer = evaluate_as_timed(
            robot, given.path, residual_window=window, energy=given.energy, **multiples
        )
        rows = timed_rows(answer)
    finish([], timed_answer(answer), rows)


def _evaluate_table(given: Given) -> None:
    """A front of coefficients that another program found, beside what it states of them."""
    from quietarm.studies.answers.importing import import_front

    task = given.read_task()
    given.refuse(["sensitivities", "verbose"], "is not for a table")
    refuse_formats(given.output, (".json", ".csv", PICTURE), "front")
    check_page(given.output, given.objectives)
    if given.profile in SHAPERS:
        raise ValueError(
            f"{given.profile} has no coefficients; give one of {', '.join(families())}"
        )
    family = families()[given.profile]
    stated = given.pick("terms", "bound", "evaluations", "objectives")
    with busy("evaluating"):
        front, notes = import_front(given.coefficients, task, family, **stated)
    files = answer_files(given.output, lambda: pictures.front_figure([front]), front)
    finish(files, *search_lines([front], notes), *given.remarks)
