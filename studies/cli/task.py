"""The options that describe a task, and the task that is made of them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial, wraps
from pathlib import Path
from typing import Any, TypeVar

import click
from quietarm.ocp import PointToPoint
from quietarm.ocp.task import QUANTITIES, Quantity
from quietarm.studies.cli.bounds import parse_bounds, parse_torque_speed
from quietarm.studies.cli.options import options, refuse_typed, typed
from quietarm.studies.cli.plants import (
    check_machine,
    chosen_plant,
    uncertainty_of,
    units_of_plant,
)
from quietarm.studies.cli.quantities import (
    parse_duration,
    parse_in,
    parse_joint_angle,
    parse_length,
    parse_rate,
    parse_torque,
)
from quietarm.studies.cli.types import (
    ANGLE,
    ENERGY,
    ERROR,
    INPUT,
    MODES,
    PLANT,
    PLANT_FILE,
    SETTING,
    TIME,
    Parsed,
)
from quietarm.studies.sweep.grid import OF_MOVES, Axis, Grid, axis_values

F = TypeVar("F", bound=Callable[..., Any])
_OF_A_MOVE = (
    "start", "target", "duration", "residual_window", "initial", "final", "energy",
    *(quantity.limit for quantity in QUANTITIES.values()), "torque_speed",
)  # fmt: skip
_OWN = ("plant_file", "parameters", *_OF_A_MOVE)


def _limit_option(quantity: Quantity) -> Callable[[F], F]:
    parse, also = parse_torque, ""
    if quantity.unit == "m":
        parse = parse_length
    if quantity.derivative is not None:
        parse, also = partial(parse_rate, order=quantity.derivative), ", or as 60deg"
    words = f"Largest {quantity.label} on the way [{quantity.unit}]{also}; -30:40 by direction."
    kind = Parsed(quantity.name, partial(parse_bounds, parse=parse))
    return click.option(f"--{quantity.name}-limit", type=kind, help=words)


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


def _time_or_fastest(text: str) -> float | str:
    return text if text == FASTEST else parse_duration(text)


def _axis_of(parse: Callable[[str], float]) -> Parsed:
    return Parsed("axis", partial(axis_values, parse=parse))


def _with_task(
    asked: Callable[[dict[str, Any]], dict[str, Any]],
    *,
    required: bool = True,
    plant: bool = True,
    angle: Parsed = ANGLE,
    time: Parsed = TIME,
    words: str = "Travelling time.",
) -> Callable[[F], F]:
    """The options that describe a task; the command gets what `asked` makes of them."""
    several = options(
        *([click.argument("plant", type=PLANT, required=False, metavar="PLANT")] * plant),
        plant_file_option(),
        click.option("--set", "parameters", type=SETTING, multiple=True,
                     help="Set a parameter of the plant, as omega=9 (SI units); may be repeated."),
        click.option("--start", type=angle, default="0", show_default=True,
                     help="Joint angle at the start."),
        click.option("--target", type=angle, required=required, help="Joint angle at the end."),
        click.option("--duration", type=time, required=required, help=words),
        *map(_limit_option, QUANTITIES.values()),
        click.option("--torque-speed", type=Parsed("torque@speed", parse_torque_speed),
                     help="What the drive gives, torques at speeds [rad/s]: 1.5Nm@0,0.8Nm@20."),
        click.option("--residual-window", type=TIME, default=1.0, show_default=True,
                     help="Time after arrival in which the residual is measured."),
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

    def add(command: F) -> F:
        @wraps(command)
        def with_task(**named: Any) -> Any:
            return command(**asked(named), **named)

        return several(with_task)  # pyright: ignore[reportReturnType]

    return add


def _task(named: dict[str, Any]) -> dict[str, Any]:
    return {"task": _task_of(named)}


def _task_or_fastest(named: dict[str, Any]) -> dict[str, Any]:
    fastest = named["duration"] == FASTEST
    if fastest:
        named["duration"] = _BEGIN
    return {"task": _task_of(named), "fastest": fastest}


def _task_or_path(named: dict[str, Any]) -> dict[str, Any]:
    path: Path | None = named.pop("path")
    if path is None:
        _need_move(named, "Missing option '--{0}'. Give it as --{0} {1}")
        return {"task": _task_of(named), "recorded": None}
    refuse_typed(("start", "target", "duration"), "is in the file of --path; leave it out")
    from quietarm.studies.reading.path import read_path

    recorded = read_path(path)
    named |= {name: getattr(recorded, name) for name in ("start", "target", "duration")}
    return {"task": _task_of(named), "recorded": recorded}


def _task_or_none(named: dict[str, Any]) -> dict[str, Any]:
    if named["plant"] is not None or named["plant_file"] is not None:
        _need_move(named, "give --{} with the plant, or no plant for the paper's tasks")
        return {"task": _task_of(named)}
    own = ("plant", *_OWN)
    refuse_typed(own, "is for a task of your own: give its plant as well")
    for name in own:
        del named[name]
    return {"task": None}


def _grid(named: dict[str, Any]) -> dict[str, Any]:
    grid = _grid_of(named)
    if not grid.axes:
        raise click.UsageError(
            "no axis is given; give one as --target 10deg:90deg:5deg, or quietarm plan"
        )
    return {"grid": grid}


def _grid_or_problems(named: dict[str, Any]) -> dict[str, Any]:
    problems, own = named.pop("problems"), (*_OWN, "robust")
    if not any(map(typed, own)):
        for name in own:
            del named[name]
        return {"problems": problems, "grid": None}
    _need_move(named, "give --{} for conditions of a plant, or PROBLEM alone")
    if len(problems) > 1:
        raise click.UsageError("conditions are of one PLANT; give its name alone")
    named["plant"] = PLANT.convert(problems[0], None, None) if problems else None
    return {"problems": (), "grid": _grid_of(named)}


def _need_move(named: dict[str, Any], words: str) -> None:
    for name, example in (("target", "30deg"), ("duration", "0.8")):
        if named[name] is None:
            raise click.UsageError(words.format(name, example))


_AXES: dict[str, Any] = {"angle": _axis_of(parse_joint_angle), "time": _axis_of(parse_duration)}
_PATH = click.option(
    "--path", type=INPUT,
    help="A CSV file with the joint's path in columns such as time_s and angle_deg, in the "
    "place of start, target and duration.",
)  # fmt: skip

task_options = _with_task(_task)
"""The command gets a `task`."""
task_or_fastest_options = _with_task(
    _task_or_fastest,
    time=Parsed("time", _time_or_fastest, "0.8"),
    words="Travelling time, or `fastest`: the least in the limits.",
)
"""It gets `fastest`, too: whether the shortest duration is asked for."""
task_or_path_options = options(_with_task(_task_or_path, required=False), _PATH)
"""A file may have the path: it gets that as `recorded`, too, or None."""
own_task_options = _with_task(_task_or_none, required=False)
"""PLANT may be left out: `task` is then None."""
task_grid_options = options(_with_task(_grid, **_AXES), robust_option)
"""Start, target, duration and parameters may be axes: it gets a `grid`."""
own_grid_options = options(
    _with_task(_grid_or_problems, required=False, plant=False, **_AXES), robust_option
)
"""The same where the first of `problems` may be a plant: else the `grid` is None."""


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


def _task_of(named: dict[str, Any]) -> PointToPoint:
    kind, own, parameters = (named.pop(name) for name in ("plant", "plant_file", "parameters"))
    errors = named.pop("robust", ())
    check_machine(kind, parameters, errors)
    plant, uncertainty = chosen_plant(kind, own, parameters), uncertainty_of(errors, kind)
    move = {name: named.pop(name) for name in _OF_A_MOVE}
    return PointToPoint(plant, **move, uncertainty=uncertainty)
