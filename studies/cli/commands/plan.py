"""`quietarm plan`: the move of least energy."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

from quietarm.ocp import (
    Plan,
    SolverFailedError,
    energy_floor,
    fastest_move,
    plan_move,
)
from quietarm.ocp.profiles.shaped_cycloid import SHAPERS
from quietarm.studies import figures
from quietarm.studies.cli.files import PICTURE, ending_of, files_of, finish, output_option
from quietarm.studies.cli.options import (
    bound_option,
    busy,
    command,
    option,
    profile_options,
    refuse_typed,
    residual_limit_option,
    seed_option,
    sensitivities_option,
    solver_option,
    starts_option,
    typed,
)
from quietarm.studies.cli.plants import values_of_plant
from quietarm.studies.cli.task import NAMES, TypedMove, task_options
from quietarm.studies.cli.types import INPUT
from quietarm.studies.registry.profiles import FAMILIES, chooses_terms, profile_of
from quietarm.studies.report.moves import floor_rows, plan_rows, sensitivity_rows
from quietarm.studies.report.saving import File
from quietarm.studies.sweep.grid import OF_MOVES

FREE = {"free": False, "free-smooth": True}
"""Profiles without a parametrisation, and whether the acceleration is continuous."""
_OF_COEFFICIENTS = ("terms", "bound", "residual_limit", "solver", "sensitivities")
_OF_SOLVERS = ("starts", "seed")


@command()
@task_options
@profile_options(
    *SHAPERS, *FREE,
    words="; a plain cycloid through an input shaper for the plant's frequencies at the target; or "
    "without a parametrisation (free), its acceleration continuous (free-smooth)",
)  # fmt: skip
@bound_option
@residual_limit_option
@starts_option
@seed_option
@solver_option
@option("--from", "dataset", type=INPUT, help="Take the move from this dataset of quietarm sweep, "
        "between its cells, without solving.")  # fmt: skip
@sensitivities_option
@output_option({".json": "the plan", ".csv": "the path at 1 kHz", PICTURE: "a picture"})
def plan(
    move: TypedMove,
    profile: str,
    terms: int | None,
    dataset: Path | None,
    sensitivities: bool,
    output: Sequence[Path],
    **asked: Any,
) -> None:
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
    if dataset is not None:
        idle = (*_OF_COEFFICIENTS, *_OF_SOLVERS, "profile")
        refuse_typed(idle, "is not for --from; leave it out")
        return _look_up(move, dataset, output)
    if profile not in FAMILIES:
        idle = _OF_COEFFICIENTS if profile in FREE else (*_OF_COEFFICIENTS[:-1], *_OF_SOLVERS)
        why = f"is not for {profile}, only for profiles with coefficients"
        refuse_typed(idle, f"{why}; leave it out")
        if move.fastest:
            raise ValueError(f"--duration fastest {why}; give a time")
    if profile in FREE:
        return _plan_freely(move, FREE[profile], asked["starts"], asked["seed"], output)
    task, notes = move.task(), list[str]()
    motions = None if chooses_terms(profile, terms) else profile_of(profile, task, terms)
    if move.fastest:
        refuse_typed(["starts"], "is not for --duration fastest; leave it out")
        del asked["starts"]
        with busy("looking for the shortest duration"):
            shortest = fastest_move(task, motions, **asked)
        found = shortest.plan
        notes = [f"fastest: in {duration:.5g} s {why}" for duration, why in shortest.failed[:1]]
    else:
        with busy("solving"):
            found = plan_move(task, motions, **asked)
    return finish(plan_files(output, found), *shown_plan(found, sensitivities), *notes)


def shown_plan(found: Plan, sensitivities: bool) -> Sequence[Sequence[tuple[str, str]] | str]:
    """The figures of a plan, and how they change with the parameters of the plant."""
    if not sensitivities:
        return [plan_rows(found)]
    title = "\nwhat a parameter that is 1 % larger adds to residual and energy:"
    return [plan_rows(found), title, sensitivity_rows(found)]


def plan_files(output: Sequence[Path], plan: Plan) -> list[File]:
    """A plan as JSON, its path as CSV, and its picture."""
    draw = partial(figures.motion_figure, plan)
    return files_of(output, {".json": plan.save, ".csv": plan.save_csv, PICTURE: draw})


def _plan_freely(
    move: TypedMove, smooth: bool, starts: int, seed: int, output: Sequence[Path]
) -> None:
    """The best motion without a parametrisation, beside the plan of a polynomial."""
    task, beside = move.task(), None
    if any(ending_of(path) == ".csv" for path in output):
        raise ValueError("a free motion is written as .json or as a picture, not as .csv")
    with busy("refining the grid"):
        found = energy_floor(task, smooth=smooth, starts=starts, seed=seed)
        with suppress(SolverFailedError):
            beside = plan_move(task)
    draw = partial(figures.floor_figure, found, beside)
    finish(files_of(output, {".json": found.save, PICTURE: draw}), floor_rows(found, beside))


def _look_up(move: TypedMove, dataset: Path, output: Sequence[Path]) -> None:
    """A move between the cells of a sweep; one that breaks a limit is written, with status 1."""
    from quietarm.studies.sweep.library import plan_from
    from quietarm.studies.sweep.store import Store

    kept = [name for name in NAMES if name not in ("parameters", *OF_MOVES)]
    refuse_typed(kept, "is in the dataset of --from; leave it out")
    with busy("interpolating between the cells"):
        plant = Store(dataset).definition.grid.task.plant
        at = values_of_plant(plant, move.given["parameters"])
        ends = {name: move.read(name, plant.joint) for name in ("start", "target")}
        at |= {name: {**move.given, **ends}[name][0] for name in OF_MOVES if typed(name)}
        found, between, trouble = plan_from(dataset, **at)
    finish(plan_files(output, found), plan_rows(found), between.words, trouble=trouble)
