"""`quietarm plan`: the move of least energy."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from quietarm.models import RobotOnPath
from quietarm.ocp import (
    Floor,
    JointProfile,
    Plan,
    PointToPoint,
    Solver,
    SolverFailedError,
    correct_in_full,
    energy_floor,
    fastest_move,
    plan_move,
)
from quietarm.ocp.off_model import off_model
from quietarm.ocp.planning.correct import refuse_correction
from quietarm.ocp.planning.cycle import Shuttle
from quietarm.ocp.planning.default_jerk import DRIVE_RISES, with_default_jerk
from quietarm.ocp.planning.named_profiles import chooses_terms, families
from quietarm.ocp.profiles.shaped_cycloid import SHAPERS
from quietarm.ocp.task import OF_MOVES
from quietarm.studies.cli.given import Given
from quietarm.studies.cli.options import (
    BOUND,
    RESIDUAL_LIMIT,
    ROBOT_PATH,
    SEED,
    SENSITIVITIES,
    SOLVER,
    STARTS,
    TASK,
    VERBOSE,
    YES,
    busy,
    command,
    option,
    profile_options,
)
from quietarm.studies.cli.outputs import (
    PICTURE,
    answer_files,
    ending_of,
    finish,
    output_option,
)
from quietarm.studies.cli.robot_options import line_note
from quietarm.studies.cli.types import INPUT, TIME
from quietarm.views import pictures
from quietarm.views.report.acting_words import band_lines
from quietarm.views.report.first_lines import floor_answer, plan_answer
from quietarm.views.report.off_words import off_words
from quietarm.views.report.plan_rows import floor_rows, plan_rows, sensitivity_rows

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FREE = {"free": False, "free-smooth": True}
"""Profiles without a parametrisation, and whether the acceleration is continuous."""
_FASTEST = "fastest"
"""In the place of a duration."""
_OF_AXES = {"parameters", *OF_MOVES}
"""Options that may be axes of a sweep."""
_OF_SOLVES = ("starts", "seed", *(param.name or "" for param in SOLVER))


@command(
    *TASK, *ROBOT_PATH,
    *profile_options(
        *SHAPERS, *FREE,
        words="; a plain cycloid through an input shaper for the plant's frequencies at the "
        "target; or without a parametrisation (free), its acceleration continuous (free-smooth)",
    ),
    BOUND, RESIDUAL_LIMIT, STARTS, SEED, *SOLVER,
    option("--from", "dataset", type=INPUT, help="Take the move from this dataset of quietarm "
           "sweep, between its cells, without solving."),
    option("--in-full", is_flag=True, help="Correct the plan of a robot until hardly anything is "
           "left by its whole equations, every spring nonlinear."),
    option("--return", "returns", is_flag=True, help="Report cycles there and back: effort, heat "
           "and energy of a cycle, and what is left if a parameter is off."),
    option("--dwell", type=TIME, help="Time after each move of a cycle. [default: 0]"),
    option("--repeat", type=int, help="How many cycles. [default: 12]"),
    SENSITIVITIES, VERBOSE, YES,
    output_option({".json": "the plan", ".csv": "the path at 1 kHz", PICTURE: "a picture"},
                  formats=["plan"]),
)  # fmt: skip
def plan(given: Given) -> None:
    """Find the move of least energy whose residual vibration is within a limit.

    An input shaper has nothing to choose: its motion is evaluated.

    \b
    Examples:
      quietarm plan single-link --target 30deg --duration 0.8
      quietarm plan single-link --target pi/2 --duration 1.0 --bound 0.2 --residual-limit 1mm
      quietarm plan arm-on-flexible-link --target 90deg --duration 800ms --torque-limit 0.3 \\
          --output plan.json --output move.csv --output move.png
      quietarm plan single-link --target 30deg --duration fastest --torque-limit 0.15
      quietarm plan dual-link --target pi/2 --duration 0.9 --profile zv
      quietarm plan single-link --target 30deg --duration 0.8 --profile free
      quietarm plan --from moves.zarr --target 37deg --duration 930ms --output plan.json
    """  # noqa: D301  # \b is click's: do not rewrap
    _refuse_meaningless(given)
    shuttle = _read_shuttle(given)
    if given.dataset is not None:
        from quietarm.studies.sweep.library import MoveLibrary, plan_from  # it needs xarray

        with busy("interpolating between the cells"):
            library = MoveLibrary(given.dataset)
            place = given.read_place(library.grid.task.plant)
            solution, between, trouble = plan_from(library, **place)
        answer = FoundMotion(solution, [between.words], trouble=trouble)
    else:
        fastest = given.duration == _FASTEST
        first_duration = {"duration": 1.0} if fastest else {}  # the search begins from it
        task = given.read_task(**first_duration)
        if given.in_full:
            refuse_correction(task)
        free = given.profile in FREE
        chosen = free or chooses_terms(given.profile, given.terms)
        profile = None if chosen else given.read_profile(task)
        residual_limit = given.read_residual_limit(task.plant)
        solves: dict[str, Any] = {"solver": given.read_solver(), "seed": given.seed}
        within: dict[str, Any] = {"residual_limit": residual_limit, "bound": given.bound}
        if free:
            smooth = FREE[given.profile]
            answer = _find_free_motion(task, smooth=smooth, starts=given.starts, **solves)
        elif fastest:
            task = _with_jerk(given, task)
            answer = _find_fastest(task, profile, **within, **solves)
        else:
            answer = _find_least_energy(task, profile, starts=given.starts, **within, **solves)
        if given.in_full and isinstance(answer.motion, Plan):
            with busy("correcting by the whole equations"):
                corrected = correct_in_full(answer.motion, solver=solves["solver"])
            answer = replace(answer, motion=corrected)
        answer = replace(answer, notes=[*given.remarks, *answer.notes])
        if isinstance(task.plant, RobotOnPath):
            straightness = line_note(given, task.plant)
            if straightness is not None:
                answer = replace(answer, notes=[straightness, *answer.notes])
    if shuttle is not None and isinstance(answer.motion, Plan):
        answer = replace(answer, motion=answer.motion.with_entries(shuttle=shuttle))
    finish_motion(_with_errors(answer), given.output, **given.pick("sensitivities", "verbose"))


def _with_errors(answer: FoundMotion) -> FoundMotion:
    """Add what the motion of a certain task leaves where the plant is off its model."""
    motion = answer.motion
    if motion.task.ranges:
        return answer
    try:
        words = off_words(off_model(motion.candidate), motion.task)
    except (ValueError, SolverFailedError) as error:
        words = f"what is left if the frequency is off was not computed: {error}"
    return replace(answer, off=words)


def _read_shuttle(given: Given) -> Shuttle | None:
    """The cycles that were asked for; None without --return, whose options are then refused."""
    if not given.returns:
        given.refuse(["dwell", "repeat"], "is for cycles of --return")
        return None
    usual = 12
    repeat = usual if given.repeat is None else given.repeat
    return Shuttle(given.dwell or 0.0, repeat)


def _refuse_meaningless(given: Given) -> None:
    """Refuse options that have no meaning for what is asked."""
    of_coefficients = ("terms", "bound", "residual_limit")
    if given.dataset is not None:
        given.refuse({param.name for param in TASK} - _OF_AXES, "is in the dataset of --from")
        given.refuse_others({*_OF_AXES, "dataset", "output", "verbose"}, "is not for --from")
        return
    fastest = given.duration == _FASTEST
    if given.profile not in families():
        why = f"is not for {given.profile}, only for profiles with coefficients"
        free = given.profile in FREE
        given.refuse(of_coefficients, why)
        given.refuse(["sensitivities", "in_full", "returns"] if free else _OF_SOLVES, why)
        if free:
            given.refuse(
                ["band"], "is for a range of errors, and free has none but the nominal plant"
            )
        if fastest:
            raise ValueError(f"--duration fastest {why}; give a time")
        endings = [ending_of(path) for path in given.output]
        refused = [ending for ending in endings if ending not in (".json", PICTURE)]
        if free and refused:
            raise ValueError(
                f"a free motion is written as .json or as a picture, not as {refused[0]}"
            )
    if fastest:
        given.refuse(["starts"], "is not for --duration fastest")


@dataclass(frozen=True)
class FoundMotion:
    """One motion that was found, and what is said of it.

    Attributes
    ----------
    motion : Plan or Floor
        What is saved, shown and drawn.
    notes : sequence of str
        Lines below its figures.
    beside : Plan, optional
        A plan of the same move, beside a floor.
    trouble : Exception, optional
        Raised once the files are written.
    fastest : bool
        Whether no shorter motion was found.
    off : str
        What it leaves if the plant is off its model.
    """

    motion: Plan | Floor
    notes: Sequence[str] = ()
    beside: Plan | None = None
    trouble: Exception | None = None
    fastest: bool = False
    off: str = ""


def _find_free_motion(task: PointToPoint, *, solver: Solver, **settings: Any) -> FoundMotion:
    """The best motion without a parametrisation, beside the plan of a polynomial."""
    beside = None
    with busy("refining the grid"):
        floor = energy_floor(task, solver=solver, **settings)
        with suppress(SolverFailedError):
            beside = plan_move(task, solver=solver)
    return FoundMotion(floor, beside=beside)


def _with_jerk(given: Given, task: PointToPoint) -> PointToPoint:
    """The task of a fastest move with a limit of its jerk: its own, or a default that is said."""
    limited = with_default_jerk(task)
    if limited is not task:
        limit = limited.limit_of("jerk")
        given.remarks.append(
            f"the {limit} is taken, as none is given: a plain cycloid's peak acceleration within "
            f"{1e3 * DRIVE_RISES:g} ms, which a position loop of 70 Hz follows; give the drive's "
            "own by --jerk-limit"
        )
    return limited


def _find_fastest(task: PointToPoint, profile: JointProfile | None, **settings: Any) -> FoundMotion:
    """The shortest move, and why a shorter one fails."""
    with busy("looking for the shortest duration"):
        shortest = fastest_move(task, profile, **settings)
    notes = [f"fastest: in {duration:.5g} s {why}" for duration, why in shortest.failed[:1]]
    return FoundMotion(shortest.plan, notes, fastest=True)


def _find_least_energy(
    task: PointToPoint, profile: JointProfile | None, **settings: Any
) -> FoundMotion:
    """The move of least energy in its duration."""
    with busy("solving"):
        return FoundMotion(plan_move(task, profile, **settings))


def finish_motion(
    answer: FoundMotion,
    output: Sequence[Path],
    *,
    sensitivities: bool = False,
    verbose: bool = False,
) -> None:
    """Save a motion; show its figures, and how they change with the parameters of the plant."""
    motion = answer.motion
    shown = list[str | Sequence[tuple[str, str]]]()
    if isinstance(motion, Floor):
        shown += floor_answer(motion, answer.beside)
        shown.append(floor_rows(motion, answer.beside, verbose=verbose, off=answer.off))
    else:
        shown += [*band_lines(motion), *plan_answer(motion, fastest=answer.fastest)]
        shown.append(plan_rows(motion, verbose=verbose, off=answer.off))
        if sensitivities:
            shown += ["\n", "what a parameter that is 1 % larger adds to residual and energy:"]
            shown.append(sensitivity_rows(motion))
    shown += answer.notes
    files = answer_files(output, partial(_drawn, answer), motion)
    finish(files, *shown, trouble=answer.trouble)


def _drawn(answer: FoundMotion) -> Figure:
    """The picture of a motion; what draws is loaded only here."""
    if isinstance(answer.motion, Floor):
        return pictures.floor_figure(answer.motion, answer.beside)
    return pictures.motion_figure(answer.motion)
