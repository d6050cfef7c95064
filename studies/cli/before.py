"""Helpers under their names of before, for commands that are not moved yet; goes with the last."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Any

import click
from quietarm.ocp.files import check_writable
from quietarm.ocp.profiles.shaped_cycloid import SHAPERS
from quietarm.studies.cli.folders import check_folder
from quietarm.studies.cli.options import (
    plant_file,
    profile_options,
    quiet,
    settings_given,
    settings_option,
    workers_options,
)
from quietarm.studies.cli.plants import parse_plant
from quietarm.studies.cli.task import TypedMove, task_options
from quietarm.studies.cli.types import LENGTH, SETTING, Parsed
from quietarm.studies.registry.profiles import FAMILIES
from quietarm.studies.report.saving import STDOUT

RESIDUAL, METHOD_SETTING = LENGTH, SETTING


def _file(check: Callable[[str], Path]) -> Parsed:
    return Parsed("file", lambda text: STDOUT if text == "-" else check(text))


OUTPUT = STATE = _file(check_writable)
FOLDER = Parsed("folder", check_folder)


def _passing(**values: Callable[[], Any]) -> Callable[[Any], Any]:
    def add(command: Any) -> Any:
        @wraps(command)
        def passing(**named: Any) -> Any:
            return command(**{name: of() for name, of in values.items()}, **named)

        return passing

    return add


quiet_option = _passing(quiet=quiet)


def plant_file_option(expose_value: bool = True) -> Callable[[Any], Any]:
    return _passing(plant_file=plant_file) if expose_value else lambda command: command


def robust_option(command: Any) -> Any:
    return command


profile_option = profile_options(*SHAPERS)
family_option = profile_options()
terms_option = robust_option
latex_option = click.option("--latex", type=OUTPUT, help="Write the tables as LaTeX.")
method_settings_option = settings_option
settings_of_one = settings_given
workers_at_hand_options = workers_options


def _moving(make: Callable[[TypedMove, dict[str, Any]], dict[str, Any]]) -> Callable[[Any], Any]:
    def add(command: Any) -> Any:
        @wraps(command)
        def with_task(move: TypedMove, **named: Any) -> Any:
            return command(**make(move, named), **named)

        return task_options(with_task)

    return add


def _grid_or_problems(move: TypedMove, named: dict[str, Any]) -> dict[str, Any]:
    problems = named.pop("problems")
    if not move.typed:
        return {"problems": problems, "grid": None}
    if len(problems) > 1:
        raise click.UsageError("conditions are of one PLANT; give its name alone")
    for name in ("target", "duration"):
        if move.given[name] is None:
            raise click.UsageError(f"give --{name} for conditions of a plant, or PROBLEM alone")
    kind = parse_plant(problems[0]) if problems else None
    return {"problems": (), "grid": TypedMove({**move.given, "plant": kind}).grid()}


def own_grid_options(command: Any) -> Any:
    made = _moving(_grid_or_problems)(command)
    own = [one for one in made.__click_params__ if one.name != "plant"]
    made.__click_params__ = own

    @wraps(made)
    def without_plant(**named: Any) -> Any:
        return made(plant=None, **named)

    return without_plant


__all__ = ["FAMILIES"]
