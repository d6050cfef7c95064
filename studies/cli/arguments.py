"""What several commands do with their arguments: make a task, write a plan, refuse an option."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from models import Plant
from ocp import Plan, PointToPoint
from ocp.plan.answer import ticks_of_move
from studies.runs.files import refuse_same_file


def split_options(rest: dict[str, Any]) -> tuple[PointToPoint, dict[str, Any]]:
    """The task and the output options, from a command's shared options."""
    outputs = {name: rest.pop(name) for name in ("output", "csv_file", "sample_rate", "figure")}
    names = {"--output": "output", "--csv": "csv_file", "--figure": "figure"}
    refuse_same_file((option, outputs[name]) for option, name in names.items())
    task = task_of(rest)
    ticks_of_move(task.duration, outputs["sample_rate"])  # refused now rather than after the solve
    return task, outputs


def task_of(rest: dict[str, Any]) -> PointToPoint:
    """The task of the options that `task_options` adds; ValueError where it is none."""
    plant: Plant = rest.pop("plant")
    return PointToPoint(plant, **rest)


def write_plan(
    found: Plan, output: Path | None, csv_file: Path | None, sample_rate: float, figure: Path | None
) -> None:
    """Write a plan to the files that were asked for, and say so."""
    if output is not None:
        found.save(output)
    if csv_file is not None:
        found.save_csv(csv_file, sample_rate)
    if figure is not None:
        from studies.display.pictures import save_figure
        from studies.reports.motion_figure import four_panels

        save_figure(four_panels(found), figure)
    say_written(output, csv_file, figure)


def say_written(*files: Path | None) -> None:
    """Print the names of the files that were written; None is a file that was not asked for."""
    for path in files:
        if path is not None:
            click.echo(f"wrote {path}")


def refuse_idle(context: click.Context, method: str, only_for: Mapping[str, Sequence[str]]) -> None:
    """Refuse an option that was typed and has no effect; ValueError says what it is for.

    Parameters
    ----------
    context : click.Context
        The command's, which knows what was typed.
    method : str
        What was chosen.
    only_for : mapping of str to sequence of str
        For each such option the choices for which it does something.
    """
    for name, methods in only_for.items():
        typed = context.get_parameter_source(name) is not ParameterSource.DEFAULT
        if typed and method not in methods:
            *some, last = methods
            known = f"{', '.join(some)} and {last}" if some else last
            raise ValueError(f"--{name} is for {known}, not for {method}; leave it out")
