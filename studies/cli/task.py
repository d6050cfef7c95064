"""The options that describe a task, and the task or the grid of tasks that is made of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial, wraps
from typing import Any, TypeVar

import click
from quietarm.models import Plant
from quietarm.models.joint_motion import ROTARY, joint_unit
from quietarm.ocp import PointToPoint
from quietarm.ocp.limits import QUANTITIES
from quietarm.studies.cli.options import option, options, plant_file, refuse_typed
from quietarm.studies.cli.plants import (
    check_machine,
    chosen_plant,
    parse_plant,
    uncertainty_of,
    units_of_plant,
)
from quietarm.studies.cli.quantities import (
    parse_energy,
    parse_error,
    parse_quantity,
    parse_state,
    parse_torque_speed,
)
from quietarm.studies.cli.types import SETTING, TIME, Parsed, parse_of_joint
from quietarm.studies.sweep.grid import OF_MOVES, Axis, Grid, axis_values

F = TypeVar("F", bound=Callable[..., Any])
FASTEST = "fastest"
"""In the place of a duration: the shortest within the limits."""
BEGIN = 1.0
"""Duration [s] from which the shortest one is looked for."""
_NEEDED = {"target": "30deg", "duration": "0.8"}


def _times(text: str) -> tuple[float, ...] | str:
    return FASTEST if text == FASTEST else axis_values(text, TIME.parse)


set_option = option(
    "--set", "parameters", type=SETTING, multiple=True, metavar="NAME=VALUE",
    help="Set a parameter of the plant, as omega=3.2Hz or length=600mm; may be repeated.",
)  # fmt: skip
error_option = option(
    "--error", "errors", type=Parsed("NAME=SHARE", parse_error), multiple=True,
    help="Range of the error of frequency, damping or a parameter, as frequency=8%; the "
    "residual is then that of the worst case. `measured`: as it was identified. May be repeated.",
)  # fmt: skip
_OPTIONS = options(
    click.argument("plant", type=Parsed("plant", parse_plant), required=False, metavar="[PLANT]"),
    set_option,
    option("--start", default="0", metavar="ANGLE", help="Joint angle at the start."),
    option("--target", metavar="ANGLE",
                 help="Joint angle at the end; of a linear axis a length, as 300mm."),
    option("--duration", type=Parsed("time", _times),
                 help="Travelling time; quietarm plan also takes `fastest`, the shortest within "
                 "the limits."),
    *(
        option(f"--{one.name}-limit", metavar=f"[{one.unit}]",
                     help=f"Largest {one.label} during the move; by direction as LEAST:LARGEST.")
        for one in QUANTITIES.values()
    ),
    option("--torque-speed", type=Parsed("torque@speed", parse_torque_speed),
                 help="Torque limit by speed, as points: 1.5Nm@0,0.8Nm@190rpm."),
    option("--residual-window", type=TIME, default="1",
                 help="Time after arrival in which the residual is measured."),
    option("--initial", type=Parsed("W:W'", parse_state),
                 help="Vibration at the start, modal amplitudes W [m] and rates W' [m/s]: "
                 "5mm:-0.3, or of two modes 5mm,0:0,0.1."),
    option("--final", type=Parsed("W:W'", parse_state),
                 help="Vibration wanted on arrival, likewise; none by default."),
    option("--energy", type=Parsed("energy", parse_energy), default="absolute",
                 help="What counts as energy: absolute or positive power, copper loss by the motor "
                 "constant [N m/W^0.5] as copper:0.12, or a sum as 0.5*absolute+copper:0.12."),
    error_option,
)  # fmt: skip
_OF_JOINT = ("start", "target", *(quantity.limit for quantity in QUANTITIES.values()))
"""Options that are read once the plant is known: in radians, or in metres of a linear axis."""
NAMES = (
    "plant", "parameters", "errors", "duration", "residual_window", "initial", "final", "energy",
    "torque_speed", *_OF_JOINT,
)  # fmt: skip
"""What the options of a task are called among a command's arguments."""


def task_options(command: F) -> F:
    """Add the options that describe a task; the command gets what was typed as `move`."""

    @wraps(command)
    def with_move(**named: Any) -> Any:
        return command(move=TypedMove({name: named.pop(name) for name in NAMES}), **named)

    return _OPTIONS(with_move)  # pyright: ignore[reportReturnType]


@dataclass(frozen=True)
class TypedMove:
    """What was typed of a task."""

    given: Mapping[str, Any]

    @property
    def fastest(self) -> bool:
        """Whether the shortest duration is asked for."""
        return self.given["duration"] == FASTEST

    def refuse(self, why: str, *names: str) -> None:
        """Refuse options of a task, all by default, where they have no meaning."""
        refuse_typed(names or NAMES, why)

    def read(self, name: str, joint: str) -> Any:
        """What an option says that is in the units of the joint; None where it was not typed."""
        text = self.given[name]
        try:
            return None if text is None else parse_of_joint(name, text, joint)
        except ValueError as error:
            option = f"'--{name.replace('_', '-')}'"
            raise click.BadParameter(str(error), param_hint=option) from None

    def plant(self, parameters: Iterable[tuple[str, str]] | None = None) -> Plant:
        """The plant, with the parameters that were typed."""
        typed = self.given["parameters"] if parameters is None else parameters
        return chosen_plant(self.given["plant"], plant_file(), typed)

    def task(self, **known: float) -> PointToPoint:
        """The task, with what is `known` in the place of options."""
        grid = self.grid(**known)
        if grid.axes:
            name = grid.axes[0].name
            raise click.UsageError(
                f"{name} has {len(grid.axes[0].values)} values here; give one (a number has a "
                "decimal point), or quietarm sweep for all"
            )
        return grid.task

    def grid(self, **known: float) -> Grid:
        """The task, and axes over what has several values."""
        given: dict[str, Any] = dict(self.given)
        kind, parameters, errors = (given.pop(name) for name in ("plant", "parameters", "errors"))
        along = {name: text for name, text in parameters if ":" in text or "," in text}
        single = [(name, text) for name, text in parameters if name not in along]
        units = units_of_plant(self.plant(single), along)
        found = [
            Axis(name, axis_values(text, _parser(units[name], name)), units[name])
            for name, text in along.items()
        ]
        single += [(axis.name, repr(axis.values[0])) for axis in found]
        plant = self.plant(single)
        check_machine(kind, single, errors)
        given |= {name: self.read(name, plant.joint) for name in _OF_JOINT}
        given |= {name: (one,) for name, one in known.items()}
        if plant.joint != ROTARY and given["torque_speed"] is not None:
            raise ValueError("--torque-speed is for a joint that turns; give --torque-limit in N")
        for name, example in _NEEDED.items():
            if given[name] is None:
                raise click.UsageError(f"Missing option '--{name}'. Give it as --{name} {example}")
        if given["duration"] == FASTEST:
            given["duration"] = (BEGIN,)
        found += [
            Axis(name, given[name], joint_unit(unit, plant.joint))
            for name, unit in OF_MOVES.items()
            if len(given[name]) > 1
        ]
        given |= {name: max(given[name], key=abs) for name in OF_MOVES}  # one that moves
        uncertainty = uncertainty_of(errors, kind)
        return Grid(PointToPoint(plant, **given, uncertainty=uncertainty), tuple(found))


def _parser(unit: str, name: str) -> Callable[[str], float]:
    return partial(parse_quantity, unit=unit, what=f"a value of {name}")
