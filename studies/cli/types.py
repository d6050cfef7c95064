"""What an option may be: quantities with units, names, pairs, files that are read."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import click
from quietarm.models import load_plant_file
from quietarm.models.joint_motion import ROTARY
from quietarm.ocp.checks import spelling, unknown
from quietarm.ocp.files import check_writable
from quietarm.ocp.limits import quantities_of
from quietarm.studies.cli.folders import check_folder
from quietarm.studies.cli.plants import parse_error, parse_plant
from quietarm.studies.cli.quantities import (
    is_number,
    parse_coefficients,
    parse_energy,
    parse_pair,
    parse_quantity,
    parse_state,
    parse_torque_speed,
    parse_weights,
)
from quietarm.studies.sweep.grid import axis_values

_RARE = {
    "rad": (2 * math.pi, "deg"), "m": (0.1, "mm"), "a position": (10.0, "mm"), "s": (100.0, "ms")
}  # fmt: skip
"""Beyond this a number alone is asked about: it was easily meant in the other unit."""


class Parsed(click.ParamType):
    """A value read by a function that raises ValueError with a message for the user."""

    def __init__(self, name: str, parse: Callable[[str], Any]) -> None:
        self.name, self.parse = name, parse

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Read the text; a click error names the option."""
        if not isinstance(value, str):
            return value
        try:
            return self.parse(value)
        except ValueError as error:
            self.fail(str(error), param, ctx)


class Named(click.Choice):  # pyright: ignore[reportMissingTypeArgument]
    """One of several names; an error suggests the nearest one, or says why a name is none here.

    Large letters, hyphens and spaces do not matter: NSGA-II and nsga_2 are nsga2.
    """

    def __init__(self, what: str, names: Iterable[str], none: Mapping[str, str] | None = None):
        super().__init__(list(names))
        self._what, self._none = what, none or {}

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The name."""
        same = [name for name in self.choices if spelling(name) == spelling(value)]
        if not same:
            known = unknown(self._what, value, self.choices)
            self.fail(self._none.get(value, known), param, ctx)
        return same[0]


def quantity(unit: str, what: str, text: str) -> float:
    """Read a quantity; a number alone that is rarely meant in SI is asked about."""
    value = parse_quantity(text, unit, what)
    most, other = _RARE.get(what) or _RARE.get(unit, (math.inf, ""))
    if math.isfinite(value) and abs(value) > most and is_number(text):
        name = {"deg": "degrees", "mm": "millimetres", "ms": "milliseconds"}[other]
        raise ValueError(
            f"{text} is in {_NAMES[unit]}; were {name} meant? give {text}{other}, or {text}{unit}"
        )
    return value


_NAMES = {"rad": "radians", "m": "metres", "s": "seconds"}


def _sides(parse: Callable[[str], float], text: str) -> float | tuple[float, ...]:
    """A limit of both directions, or one for each: ``-30:40``."""
    values = [parse(side) for side in text.split(":")]
    if len(values) > 2:
        raise ValueError(f"{text!r} is no limit; give one number, or one for each side as -30:40")
    if len({is_number(side.strip()) for side in text.split(":")}) > 1:
        raise ValueError(f"{text!r} has a unit on one side alone; give it on both, or on none")
    return tuple(values) if len(values) == 2 else values[0]


def parse_of_joint(name: str, text: str, joint: str) -> Any:
    """Read an end of a move, or a limit, in the units of a kind of joint.

    Ends have one value or several; a limit is a number, or one for each direction.
    """
    if name in ("start", "target"):
        rotary = partial(quantity, "rad", "an angle")
        linear = partial(quantity, "m", "a position")
        return axis_values(text, rotary if joint == ROTARY else linear)
    limited = quantities_of(joint)[name.removesuffix("_limit")]
    what = f"a{'n' * (limited.name == 'acceleration')} {limited.name}"
    return _sides(partial(quantity, limited.unit, what), text)


LENGTH, TIME, TORQUE, SHARE = (
    Parsed(name, partial(quantity, unit, f"a {name}"))
    for name, unit in (
        ("length", "m"), ("time", "s"), ("torque", "N m"), ("share", "-")
    )
)  # fmt: skip
FASTEST = "fastest"
"""In the place of a duration: the shortest within the limits."""
TIMES = Parsed(
    "time", lambda text: FASTEST if text == FASTEST else axis_values(text, parse=TIME.parse)
)
PLANT = Parsed("plant", parse_plant)
PLANT_FILE = Parsed("file", load_plant_file)
SETTING = Parsed(
    "name=value", partial(parse_pair, what="a parameter or setting", example="omega=9")
)
ERROR = Parsed("name=share", parse_error)
ENERGY = Parsed("energy", parse_energy)
MODES = Parsed("W:W'", parse_state)
COEFFICIENTS = Parsed(
    "numbers",
    lambda text: Path(text) if Path(text).suffix in _TABLES else parse_coefficients(text),
)
_TABLES = (".csv", ".txt", ".dat", ".npy", ".npz", ".mat")
TORQUE_SPEED = Parsed("torque@speed", parse_torque_speed)
WEIGHTS = Parsed("weights", parse_weights)
WHOLE = click.INT
INPUT = click.Path(path_type=Path)
FILE, FOLDER = Parsed("file", check_writable), Parsed("folder", check_folder)
"""What is written, after it was made sure that it can be."""
