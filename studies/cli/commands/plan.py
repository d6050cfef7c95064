"""`quietarm plan`: the move of least energy."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click
from quietarm.ocp import (
    Plan,
    SolverFailedError,
    energy_floor,
    fastest_move,
    plan_move,
)
from quietarm.ocp.profiles.shaped_cycloid import SHAPERS
from quietarm.studies import figures
from quietarm.studies.cli.ending import finish
from quietarm.studies.cli.files import PICTURE, ending_of, files_of, output_option
from quietarm.studies.cli.options import (
    bound_option,
    command,
    profile_options,
    quiet,
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
from quietarm.studies.report.progress import working
from quietarm.studies.report.saving import File, drawing
from quietarm.studies.sweep.grid import OF_MOVES
from rich.console import Console

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
@click.option(
    "--from", "dataset", type=INPUT,
    help="Take the move from this dataset of quietarm sweep, between its cells, without solving.",
)  # fmt: skip
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
        _look_up(move, dataset, output)
        return
    if profile not in FAMILIES:
        idle = _OF_COEFFICIENTS if profile in FREE else (*_OF_COEFFICIENTS[:-1], *_OF_SOLVERS)
        why = f"is not for {profile}, only for profiles with coefficients"
        refuse_typed(idle, f"{why}; leave it out")
        if move.fastest:
            raise ValueError(f"--duration fastest {why}; give a time")
    if profile in FREE:
        _plan_freely(move, FREE[profile], asked["starts"], asked["seed"], output)
        return
    task, notes = move.task(), list[str]()
    motions = None if chooses_terms(profile, terms) else profile_of(profile, task, terms)
    errors = Console(stderr=True)
    if move.fastest:
        if typed("starts"):
            raise ValueError("--starts is not for --duration fastest; leave it out")
        del asked["starts"]
        with working("looking for the shortest duration", errors, quiet=quiet()):
            shortest = fastest_move(task, motions, **asked)
        found = shortest.plan
        notes = [f"fastest: in {duration:.5g} s {why}" for duration, why in shortest.failed[:1]]
    else:
        with working("solving", errors, quiet=quiet()):
            found = plan_move(task, motions, **asked)
    sensitive = sensitivity_rows(found) if sensitivities else []
    title = "\nwhat a parameter that is 1 % larger adds to residual and energy:" * bool(sensitive)
    finish(plan_files(output, found), plan_rows(found), title, sensitive, *notes)


def plan_files(output: Sequence[Path], plan: Plan) -> list[File]:
    """A plan as JSON, its path as CSV, and its picture."""
    picture = drawing(lambda: figures.motion_figure(plan))
    return files_of(output, {".json": plan.save, ".csv": plan.save_csv, PICTURE: picture})


def _plan_freely(
    move: TypedMove, smooth: bool, starts: int, seed: int, output: Sequence[Path]
) -> None:
    """The least energy over all joint motions, beside the plan of a polynomial."""
    task = move.task()
    if any(ending_of(path) == ".csv" for path in output):
        raise ValueError("a free motion is written as .json or as a picture, not as .csv")
    with working("refining the grid", Console(stderr=True), quiet=quiet()):
        found = energy_floor(task, smooth=smooth, starts=starts, seed=seed)
        try:
            beside = plan_move(task)
        except SolverFailedError:
            beside = None
    writes = {
        ".json": found.save,
        PICTURE: drawing(lambda: figures.floor_figure(found, beside)),
    }
    finish(files_of(output, writes), floor_rows(found, beside))


def _look_up(move: TypedMove, dataset: Path, output: Sequence[Path]) -> None:
    """A move between the cells of a sweep; one that breaks a limit is written, with status 1."""
    from quietarm.studies.sweep.library import plan_from
    from quietarm.studies.sweep.store import Store

    kept = [name for name in NAMES if name not in ("parameters", *OF_MOVES)]
    move.refuse("is in the dataset of --from; leave it out", *kept)
    with working("interpolating between the cells", Console(stderr=True), quiet=quiet()):
        plant = Store(dataset).definition.grid.task.plant
        at = values_of_plant(plant, move.given["parameters"])
        ends = {name: move.read(name, plant.joint) for name in ("start", "target")}
        given = {**move.given, **ends}
        at |= {name: given[name][0] for name in OF_MOVES if typed(name)}
        found, between, trouble = plan_from(dataset, **at)
    finish(plan_files(output, found), plan_rows(found), between.words, trouble=trouble)
