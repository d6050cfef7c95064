"""`quietarm plan`: the move of least energy."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from quietarm.models import RobotOnPath
from quietarm.ocp import Plan, SolverFailedError, energy_floor, fastest_move, plan_move
from quietarm.ocp.profiles.shaped_cycloid import SHAPERS
from quietarm.studies import figures
from quietarm.studies.cli.files import (
    PICTURE,
    TRAJECTORY,
    answer_files,
    ending_of,
    finish,
    output_option,
)
from quietarm.studies.cli.given import Given, single_values
from quietarm.studies.cli.options import (
    BOUND,
    RESIDUAL_LIMIT,
    ROBOT_PATH,
    SEED,
    SENSITIVITIES,
    SOLVER,
    STARTS,
    TASK,
    YES,
    busy,
    command,
    option,
    profile_options,
)
from quietarm.studies.cli.plants import read_parameters
from quietarm.studies.cli.robots import line_note
from quietarm.studies.cli.types import INPUT
from quietarm.studies.reading.profiles import chooses_terms, families
from quietarm.studies.report.moves import floor_rows, plan_rows, sensitivity_rows
from quietarm.studies.sweep.grid import OF_MOVES

FREE = {"free": False, "free-smooth": True}
"""Profiles without a parametrisation, and whether the acceleration is continuous."""
_FASTEST, _BEGIN = "fastest", 1.0
"""In the place of a duration; and the one [s] from which the shortest is looked for."""
_OF_COEFFICIENTS = ("terms", "bound", "residual_limit", "sensitivities")
_OF_SOLVES = ("starts", "seed", *(one.name or "" for one in SOLVER))


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
    SENSITIVITIES, YES,
    output_option({
        ".json": "the plan", ".csv": "the path at 1 kHz", PICTURE: "a picture",
        TRAJECTORY: "a JointTrajectory of ROS 2 at 1 kHz",
    }),
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
    if given.dataset is not None:
        return _look_up(given)
    fastest = given.duration == _FASTEST
    if given.profile not in families():
        free = given.profile in FREE
        why = f"is not for {given.profile}, only for profiles with coefficients"
        given.refuse(_OF_COEFFICIENTS if free else (*_OF_COEFFICIENTS[:-1], *_OF_SOLVES), why)
        if fastest:
            raise ValueError(f"--duration fastest {why}; give a time")
        if free:
            return _plan_freely(given)
    task = given.read_task(**{"duration": _BEGIN} if fastest else {})
    notes = list[str]()
    if isinstance(task.plant, RobotOnPath) and (straight := line_note(given, task.plant)):
        notes.append(straight)
    motions = None if chooses_terms(given.profile, given.terms) else given.read_profile(task)
    asked: dict[str, Any] = given.pick("bound", "seed") | {
        "residual_limit": given.read_residual_limit(task.plant),
        "solver": given.read_solver(),
    }
    if fastest:
        given.refuse(["starts"], "is not for --duration fastest")
        with busy("looking for the shortest duration"):
            shortest = fastest_move(task, motions, **asked)
        found = shortest.plan
        notes += [f"fastest: in {duration:.5g} s {why}" for duration, why in shortest.failed[:1]]
    else:
        with busy("solving"):
            found = plan_move(task, motions, starts=given.starts, **asked)
    return finish_plan(given, found, *notes)


def finish_plan(given: Given, found: Plan, *notes: str, trouble: Exception | None = None) -> None:
    """Save a plan; show its figures, and how they change with the parameters of the plant."""
    title = "\nwhat a parameter that is 1 % larger adds to residual and energy:"
    more = [title, sensitivity_rows(found)] if given.sensitivities else []
    files = answer_files(given.output, lambda: figures.motion_figure(found), found)
    finish(files, plan_rows(found), *more, *notes, trouble=trouble)


def _plan_freely(given: Given) -> None:
    """The best motion without a parametrisation, beside the plan of a polynomial."""
    task, beside = given.read_task(), None
    if any(ending_of(path) == ".csv" for path in given.output):
        raise ValueError("a free motion is written as .json or as a picture, not as .csv")
    with busy("refining the grid"):
        solver = given.read_solver()
        smooth = FREE[given.profile]
        found = energy_floor(task, smooth=smooth, solver=solver, **given.pick("starts", "seed"))
        with suppress(SolverFailedError):
            beside = plan_move(task, solver=solver)
    files = answer_files(given.output, lambda: figures.floor_figure(found, beside), found)
    finish(files, floor_rows(found, beside))


def _look_up(given: Given) -> None:
    """A move between the cells of a sweep; one that breaks a limit is written, with status 1."""
    from quietarm.studies.sweep.library import plan_from
    from quietarm.studies.sweep.store import Store

    taken = {"parameters", *OF_MOVES}
    given.refuse({one.name for one in TASK} - taken, "is in the dataset of --from")
    given.refuse_others({*taken, "dataset", "output"}, "is not for --from")
    with busy("interpolating between the cells"):
        plant = Store(given.dataset).definition.grid.task.plant
        typed = [name for name in OF_MOVES if given.typed(name)]
        at = {name: given.read_of_plant(name, plant) for name in typed}
        at |= read_parameters(plant, given.parameters)
        found, between, trouble = plan_from(given.dataset, **single_values(at))
    finish_plan(given, found, between.words, trouble=trouble)
