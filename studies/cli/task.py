"""The options that describe a task, and the task that is made of them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial, wraps
from pathlib import Path
from typing import Any, TypeVar

import click
from quietarm.models import Plant
from quietarm.ocp import PointToPoint
from quietarm.ocp.task import QUANTITIES, Quantity
from quietarm.studies.cli.options import options, typed
from quietarm.studies.cli.plants import chosen_plant, uncertain, units_of_plant
from quietarm.studies.cli.quantities import parse_in, parse_joint_angle, parse_rate, parse_time
from quietarm.studies.cli.types import (
    ANGLE,
    ENERGY,
    ERROR,
    INPUT,
    LENGTH,
    MODES,
    PLANT,
    PLANT_FILE,
    SETTING,
    TIME,
    TORQUE,
    Parsed,
)
from quietarm.studies.display.words import plant_words
from quietarm.studies.sweep.grid import OF_MOVES, Axis, Grid, axis_values

F = TypeVar("F", bound=Callable[..., Any])
_OF_A_MOVE = (
    "start", "target", "duration", "residual_window", "initial", "final", "energy",
    *(quantity.limit for quantity in QUANTITIES.values()),
)  # fmt: skip
_EARLIER = ("after", "wait")


def _limit_option(quantity: Quantity) -> Callable[[F], F]:
    option, words = f"--{quantity.name}-limit", f"Largest {quantity.label} on the way"
    if quantity.unit == "m":
        return click.option(option, type=LENGTH, help=f"{words}.")
    if quantity.derivative is not None:
        parse = partial(parse_rate, order=quantity.derivative)
        help_text = f"{words} [{quantity.unit}], or as 60deg."
        return click.option(option, type=Parsed(quantity.name, parse), help=help_text)
    kind = TORQUE if quantity.unit == "N m" else float
    return click.option(option, type=kind, help=f"{words} [{quantity.unit}].")


plant_file_option = partial(
    click.option, "--plant-file", type=PLANT_FILE,
    is_eager=True,  # the plants in it are then known by name
    help="A plant of your own: a file in Python, which is run.",
)  # fmt: skip
robust_option = click.option(
    "--robust", type=ERROR, multiple=True, metavar="NAME=SHARE",
    help="Count as the residual the largest one while the frequency, the damping or a parameter of "
    "the plant is wrong by up to this, as frequency=10%; may be repeated. `measured` has the "
    "intervals of an identified machine.",
)  # fmt: skip


FASTEST = "fastest"
"""In the place of a duration: the shortest within the limits."""
_BEGIN = 1.0
"""Duration [s] at which the shortest is begun to be looked for."""
_TIME_OR_FASTEST = Parsed("time", lambda text: text if text == FASTEST else parse_time(text), "0.8")
BEST = "best"
"""In the place of a wait: the one of least energy."""
_TIME_OR_BEST = Parsed("time", lambda text: text if text == BEST else parse_time(text))


def _range(text: str) -> float | tuple[float, float]:
    """A time, or two with a colon between."""
    first, colon, last = text.partition(":")
    return (parse_time(first), parse_time(last)) if colon else parse_time(text)


_TIME_OR_RANGE = Parsed("time", _range, "0.8")


def _task_options(
    required: bool,
    fastest: bool = False,
    ranged: bool = False,
    axes: bool = False,
    argument: str = "plant",
) -> Callable[[F], F]:
    time, words = TIME, "Travelling time."
    angle = _axis_of(parse_joint_angle) if axes else ANGLE
    if axes:
        time = _axis_of(parse_time)
    wait, until = TIME, "Time from that plan's arrival to this start"
    if ranged:
        time, words = _TIME_OR_RANGE, "Travelling time; with --over duration two, as 600ms:1.4s."
    if fastest:
        time, words = _TIME_OR_FASTEST, "Travelling time, or `fastest`: the least in the limits."
        wait, until = _TIME_OR_BEST, f"{until}, or `best`: of least energy, up to a period"
    plant = click.argument("plant", type=PLANT, required=False, metavar="PLANT")
    return options(
        *([plant] if argument == "plant" else []),
        plant_file_option(),
        click.option("--set", "parameters", type=SETTING, multiple=True,
                     help="Set a parameter of the plant, as omega=9 (SI units); may be repeated."),
        click.option("--start", type=angle, default="0", show_default=True,
                     help="Joint angle at the start."),
        click.option("--target", type=angle, required=required, help="Joint angle at the end."),
        click.option("--duration", type=time, required=required, help=words),
        *map(_limit_option, QUANTITIES.values()),
        click.option("--residual-window", type=TIME, default=1.0, show_default=True,
                     help="Time after arrival in which the residual is measured."),
        click.option("--after", type=INPUT,
                     help="Begin where an earlier plan, of this file, has ended, and with what it "
                     "left ringing."),
        click.option("--wait", type=wait, help=f"{until}.  [default: 0]"),
        click.option("--initial", type=MODES,
                     help="What rings at the start, modal amplitudes W [m] and rates W' [m/s]: "
                     "5mm:-0.3, or of two modes 5mm,0:0,0.1."),
        click.option("--final", type=MODES,
                     help="What shall ring on arrival, likewise; at rest by default."),
        click.option("--energy", type=ENERGY, default="absolute", show_default=True,
                     help="What counts as energy: absolute or positive power, the copper loss by "
                     "the motor constant [N m/W^0.5] as copper:0.12, a sum as 0.5*absolute+"
                     "copper:0.12, or one of your own in --plant-file."),
    )  # fmt: skip


def task_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the plant and the options that describe a task, which the command gets as `task`."""

    @wraps(command)
    def with_task(*positional: Any, **named: Any) -> Any:
        return command(*positional, task=_task_of(named), **named)

    return _task_options(required=True)(with_task)


def task_or_fastest_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """The same where duration or wait may be looked for: the command gets `fastest` as well.

    And as `best_after` the file of the plan after which the best wait is looked for, or None.
    """

    @wraps(command)
    def with_task(*positional: Any, **named: Any) -> Any:
        fastest, best = named["duration"] == FASTEST, named["wait"] == BEST
        after = named["after"] if best else None
        if fastest:
            named["duration"] = _BEGIN
        if best:
            named["wait"] = 0.0
        task = _task_of(named)
        return command(*positional, task=task, fastest=fastest, best_after=after, **named)

    return _task_options(required=True, fastest=True)(with_task)


def task_or_durations_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """The same where the duration may be a range: the command gets both its ends or None."""

    @wraps(command)
    def with_task(*positional: Any, **named: Any) -> Any:
        given = named["duration"]
        durations = given if isinstance(given, tuple) else None
        if durations is not None:
            named["duration"] = durations[0]
        return command(*positional, task=_task_of(named), durations=durations, **named)

    return _task_options(required=True, ranged=True)(with_task)


def _axis_of(parse: Callable[[str], float]) -> Parsed:
    return Parsed("axis", partial(axis_values, parse=parse))


def task_grid_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """The same where start, target, duration and parameters may be axes: it gets a `grid`."""

    @wraps(command)
    def with_grid(*positional: Any, **named: Any) -> Any:
        grid = _grid_of(named)
        if not grid.axes:
            raise click.UsageError(
                "no axis is given; give one as --target 10deg:90deg:5deg, or quietarm plan"
            )
        return command(*positional, grid=grid, **named)

    return _task_options(required=True, axes=True)(robust_option(with_grid))


def own_grid_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """The same where the first of `problems` may be a plant: else the `grid` is None."""

    @wraps(command)
    def with_grid(*positional: Any, problems: tuple[str, ...], **named: Any) -> Any:
        own = ("plant_file", "parameters", "robust", *_OF_A_MOVE, *_EARLIER)
        if not any(map(typed, own)):
            kept = {name: value for name, value in named.items() if name not in own}
            return command(*positional, problems=problems, grid=None, **kept)
        for name in ("target", "duration"):
            if named[name] is None:
                raise click.UsageError(f"give --{name} for conditions of a plant, or PROBLEM alone")
        if len(problems) > 1:
            raise click.UsageError("conditions are of one PLANT; give its name alone")
        named["plant"] = PLANT.convert(problems[0], None, None) if problems else None
        return command(*positional, problems=(), grid=_grid_of(named), **named)

    return _task_options(required=False, axes=True, argument="problems")(robust_option(with_grid))


def _grid_of(named: dict[str, Any]) -> Grid:
    moves = {name: named[name] for name in OF_MOVES}
    named |= {name: max(values, key=abs) for name, values in moves.items()}  # one not at rest
    kind, own, given = (named[name] for name in ("plant", "plant_file", "parameters"))
    several = {name: text for name, text in given if ":" in text or "," in text}
    single = [(name, text) for name, text in given if name not in several]
    plant = chosen_plant(kind, own, single)
    units = units_of_plant(plant, several)
    axes = [
        Axis(name, axis_values(text, partial(parse_in, units[name], name=name)), units[name])
        for name, text in several.items()
    ]
    axes += [
        Axis(name, values, OF_MOVES[name]) for name, values in moves.items() if len(values) > 1
    ]
    firsts = [(axis.name, repr(axis.values[0])) for axis in axes if axis.name in several]
    named["parameters"] = (*single, *firsts)
    return Grid(_task_of(named), tuple(axes))


def task_or_path_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """The same where a file may have the path: the command gets it as `recorded`, or None."""

    @wraps(command)
    def with_task(*positional: Any, path: Path | None, **named: Any) -> Any:
        if path is None:
            for name, as_one in (("target", "30deg"), ("duration", "0.8")):
                if named[name] is None:
                    words = f"Missing option '--{name}'. Give it as --{name} {as_one}"
                    raise click.UsageError(words)
            return command(*positional, task=_task_of(named), recorded=None, **named)
        for name in ("start", "target", "duration"):
            if typed(name):
                raise click.UsageError(f"--{name} is in the file of --path; leave it out")
        if typed("after"):
            raise click.UsageError("--after is not for a --path; give what rings as --initial")
        from quietarm.studies.reading.path import read_path

        recorded = read_path(path)
        named |= {name: getattr(recorded, name) for name in ("start", "target", "duration")}
        return command(*positional, task=_task_of(named), recorded=recorded, **named)

    path = click.option(
        "--path", type=INPUT,
        help="A CSV file with the joint's path in columns such as time_s and angle_deg, in the "
        "place of start, target and duration.",
    )  # fmt: skip
    return _task_options(required=False)(path(with_task))


def own_task_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """The same where PLANT may be left out: `task` is then None."""

    @wraps(command)
    def with_task(*positional: Any, **named: Any) -> Any:
        if named["plant"] is None and named["plant_file"] is None:
            return command(*positional, task=_no_task(named), **named)
        for name in ("target", "duration"):
            if named[name] is None:
                raise click.UsageError(
                    f"give --{name} with the plant, or no plant for the paper's tasks"
                )
        return command(*positional, task=_task_of(named), **named)

    return _task_options(required=False)(with_task)


def _task_of(named: dict[str, Any]) -> PointToPoint:
    kind, own, parameters = (named.pop(name) for name in ("plant", "plant_file", "parameters"))
    plant = uncertain(chosen_plant(kind, own, parameters), named.pop("robust", ()), kind)
    after, wait = (named.pop(name) for name in _EARLIER)
    if after is not None:
        named |= _left_by(after, wait or 0.0, plant)
    elif wait is not None:
        raise ValueError("--wait is for --after: give the earlier plan, too, or leave it out")
    return PointToPoint(plant, **{name: named.pop(name) for name in _OF_A_MOVE})


def _left_by(file: Path, wait: float, plant: Plant) -> dict[str, Any]:
    """Where an earlier plan of the same plant has ended, and what rings there a while [s] later."""
    for name in ("start", "initial"):
        if typed(name):
            raise ValueError(f"--{name} follows from the plan of --after; leave it out")
    from quietarm.studies.reading.saved import load_plans

    (earlier,) = load_plans([file]).values()
    its_plant = earlier.task.plant.nominal
    if its_plant != plant.nominal:
        raise ValueError(
            f"{file} moves {plant_words(its_plant)}, not {plant_words(plant.nominal)}; give its "
            "plant and parameters"
        )
    return {"start": earlier.task.target, "initial": earlier.state_after(wait)}


def _no_task(named: dict[str, Any]) -> None:
    for name in ("plant", "plant_file", "parameters", *_OF_A_MOVE, *_EARLIER):
        if typed(name):
            option = "set" if name == "parameters" else name.replace("_", "-")
            raise click.UsageError(f"--{option} is for a task of your own: give its plant as well")
        del named[name]
