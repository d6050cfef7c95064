"""What several commands do with their arguments: make a task, name files, refuse an option."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource
from quietarm.ocp import Front, Plan, PointToPoint
from quietarm.ocp.plan.answer import ticks_of_move
from quietarm.studies.cli.options import bare_angles
from quietarm.studies.cli.plants import chosen_plant, uncertain
from quietarm.studies.display.saving import File, drawing
from rich.console import Console

if TYPE_CHECKING:
    from matplotlib.figure import Figure


TURN = 2 * math.pi


def split_options(rest: dict[str, Any]) -> tuple[PointToPoint, dict[str, Any]]:
    """The task and the output options, from a command's shared options."""
    outputs = {name: rest.pop(name) for name in ("output", "csv_file", "sample_rate", "figure")}
    names = {"--output": "output", "--csv": "csv_file", "--figure": "figure"}
    refuse_same_file((option, outputs[name]) for option, name in names.items())
    task = task_of(rest)
    context = click.get_current_context()
    typed = context.get_parameter_source("sample_rate") is not ParameterSource.DEFAULT
    if typed and outputs["csv_file"] is None:
        raise ValueError("--sample-rate is for --csv, which is not given; give it, or leave it out")
    if outputs["csv_file"] is not None:  # refused now rather than after the solve
        ticks_of_move(task.duration, outputs["sample_rate"])
    return task, outputs


def task_of(rest: dict[str, Any]) -> PointToPoint:
    """The task of the options that `task_options` adds; ValueError where it is none."""
    plant = chosen_plant(rest.pop("plant"), rest.pop("plant_file"), rest.pop("set"))
    plant = uncertain(plant, rest.pop("robust", ()))
    task = PointToPoint(plant, **rest)
    _ask_for_degrees(task)
    return task


def _ask_for_degrees(task: PointToPoint) -> None:
    """Refuse a move beyond a turn whose angles were typed without a unit."""
    for name, text in bare_angles(click.get_current_context()).items():
        if abs(task.span) > TURN and abs(getattr(task, name)) > TURN:
            degrees = math.degrees(getattr(task, name))
            raise ValueError(
                f"{name} {text} is in radians, {degrees:.6g} degrees, more than a turn; were "
                f"degrees meant? give {text}deg, or {text}rad"
            )


def plan_files(
    found: Plan, output: Path | None, csv_file: Path | None, sample_rate: float, figure: Path | None
) -> list[File]:
    """The files of a plan that were asked for."""

    def picture() -> Figure:
        from quietarm.studies.figures import motion_figure

        return motion_figure(found)

    return [
        (output, found.save),
        (csv_file, lambda path: found.save_csv(path, sample_rate)),
        (figure, drawing(picture)),
    ]


def refuse_idle(
    context: click.Context,
    method: str,
    only_for: Mapping[str, Sequence[str]],
    called: str = "",
) -> None:
    """Refuse an option that would have no effect; ValueError says what it is for."""
    for name, methods in only_for.items():
        typed = context.get_parameter_source(name) is not ParameterSource.DEFAULT
        if typed and method not in methods:
            *some, last = methods
            known = called or (f"{', '.join(some)} and {last}" if some else last)
            raise ValueError(f"--{name} is for {known}, not for {method}; leave it out")


@dataclass(frozen=True)
class FrontFiles:
    """The files that a front is written to; None where one is not asked for."""

    output: Path | None
    csv: Path | None
    figure: Path | None

    def written(self, front: Front, picture: Callable[[], Figure]) -> list[File]:
        """What writes each of them."""
        return [
            (self.output, front.save),
            (self.csv, front.save_csv),
            (self.figure, drawing(picture)),
        ]

    def refuse_same(self, *read: tuple[str, Path]) -> None:
        """Make sure that no two are one file, nor one that is read; ValueError names both."""
        written = [("--output", self.output), ("--csv", self.csv), ("--figure", self.figure)]
        refuse_same_file([*read, *written])


def refuse_same_file(files: Iterable[tuple[str, Path | None]]) -> None:
    """Make sure that no two options name one file; ValueError names them."""
    names: dict[str, str] = {}
    for name, path in files:
        if path is None:
            continue
        place = os.path.realpath(path)  # of a link that goes in a circle, too
        if names.setdefault(place, name) != name:
            raise ValueError(f"{names[place]} and {name} are both {path}; give two files")


def warn_of_workers(console: Console, workers: int, pieces: int) -> None:
    """Warn where more workers start than there are cores; no more start than pieces of work."""
    # a plan by the gradient needs no workers
    from quietarm.metaheuristics.sharing.workers import Workers, cores_here

    cores, workers = cores_here(), Workers(workers).local(pieces)
    if workers > cores:
        console.print(
            f"{workers} workers will share {cores} core{'s' * (cores > 1)}", highlight=False
        )
