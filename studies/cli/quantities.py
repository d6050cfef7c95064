"""Read what is typed: quantities with units, such as 30deg, -pi/2, 60deg/s, 10%, and their forms.

Every function raises ValueError with a message for the user.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import fields
from functools import partial, reduce
from operator import add, lt
from typing import Any, TypeVar

import numpy as np

from quietarm.machine.tables.column_units import OF_OPTIONS, normal
from quietarm.metaheuristics.evaluation.noise import noise_share
from quietarm.metaheuristics.parallel import MOST_WORKERS
from quietarm.models import Drive, Plant
from quietarm.models.dimensions import EFFORT, SPEED
from quietarm.models.drive import NUMBERS as DRIVE_NUMBERS
from quietarm.models.drive import WORDS as DRIVE_WORDS
from quietarm.models.drive import Recorded
from quietarm.models.drive import unit_of as drive_unit
from quietarm.models.joint_motion import LINEAR, MIXED, ROTARY
from quietarm.models.plant import DAMPING, OTHER
from quietarm.models.units import is_number, parse_quantity
from quietarm.ocp import ModalState
from quietarm.ocp.checks import finite, has_no, known, unknown, whole
from quietarm.ocp.energy import Energy, Mix
from quietarm.ocp.front.time_front import TIME_AND_ENERGY
from quietarm.ocp.limits import TORQUE_SPEED, quantities_of
from quietarm.ocp.objectives import checked_objectives
from quietarm.ocp.task import OF_MOVES
from quietarm.studies.sweep.move_grid import MOST_VALUES

S = TypeVar("S")
T = TypeVar("T")
_PLUS = re.compile(r"(?<!\d[eE])\+")
RESIDUAL_LIMIT = "residual_limit"
BAND = "band"
MEASURED = "measured"
"""In the place of errors: the intervals of an identified machine."""


_RARE = {
    "a position": (10.0, "metres", "millimetres", "mm"),
    "m": (0.1, "metres", "millimetres", "mm"),
    "rad": (2 * math.pi, "radians", "degrees", "deg"),
    "s": (100.0, "seconds", "milliseconds", "ms"),
}
"""Beyond this a number alone is asked about: it was easily meant in the other unit."""
_MOST_BAND = math.nextafter(0.02, 0.0)
"""The same of a band [m], which is a millimetre or less as a rule: 0.02 is asked about."""


def parse_usual(unit: str, what: str, text: str, most: float | None = None) -> float:
    """Read a quantity; a number alone that is rarely meant in SI is asked about.

    That is one beyond what its kind has at `most`, or beyond this number where one is given.
    """
    value = parse_quantity(text, unit, what)
    usual, name, likely, short = _RARE.get(what) or _RARE.get(unit, (math.inf, "", "", ""))
    most = usual if most is None else most
    if math.isfinite(value) and abs(value) > most and is_number(text):
        raise ValueError(
            f"{text} is in {name}; were {likely} meant? give {text}{short}, or {text}{unit}"
        )
    return value


def parse_share(text: str, name: str) -> float:
    """Read the share of a parameter; from 1 on a number alone is asked about."""
    value = parse_quantity(text, "-", f"a value of {name}")
    if value >= 1 and is_number(text):
        raise ValueError(
            f"{name}={text} is {100 * value:g} %; was {text} % meant? give {name}={text}%, or "
            f"{name}={100 * value:g}%"
        )
    return value


def parse_move(text: str, axes: Sequence[str], plant: Plant) -> dict[str, float]:
    """Read which move of a dataset is meant: a value of each axis, target=400mm,duration=800ms."""
    example = ",".join(f"{name}={'800ms' if name == 'duration' else '0.4'}" for name in axes)
    pairs = (parse_pair(pair, "an axis", example) for pair in text.split(","))
    values = once(pairs, "")
    if {*values} != {*axes}:
        raise ValueError(f"{text} is no move of the dataset; give a value of each axis: {example}")
    several = {
        name: parse_of_plant(name, values[name], plant.joint, plant.tip_unit) for name in axes
    }
    return single_values(several)


def parse_margin(text: str) -> float:
    """Read how many times the residual limit a band is: 3, or 1.5."""
    margin = parse_quantity(text, "-", "a margin")
    if not 1 <= margin < math.inf:
        raise ValueError(f"{text} is no margin; give 1 or more, such as 3")
    return margin


def parse_parameter(text: str, unit: str, name: str, kind: str = OTHER) -> float:
    """Read a plant's parameter; damping ratios are shares."""
    if kind == DAMPING:
        return parse_share(text, name)
    return parse_quantity(text, unit, f"a value of {name}")


def parse_parameters(
    plant: Plant | type[Plant], pairs: Iterable[tuple[str, str]]
) -> dict[str, tuple[float, ...]]:
    """Read the values that a plant's parameters are set to, several for an axis of a sweep."""
    units = plant.units()
    kinds = plant.parameter_kinds()
    entries = plant.parameter_fields()
    meanings = {entry.name: entry.metadata.get("meaning", "") for entry in entries}
    values: dict[str, tuple[float, ...]] = {}
    for name, text in once(pairs, "--set ").items():
        if name not in units:
            symbols = [symbol for symbol, meaning in meanings.items() if name in meaning]
            meant = f"; the {name} is {' or '.join(symbols)}" if symbols else ""
            raise ValueError(has_no(plant.name, "parameter", name, meanings) + meant)
        values[name] = parse_values(
            text, partial(parse_parameter, unit=units[name], name=name, kind=kinds[name])
        )
    return values


def single_values(values: Mapping[str, Sequence[float]]) -> dict[str, float]:
    """Values by name; ValueError where there are several of one name."""
    for name, several in values.items():
        if len(several) > 1:
            raise ValueError(
                f"{name} has {len(several)} values here; give one (a number has a decimal point), "
                "or quietarm sweep for all"
            )
    return {name: value for name, (value,) in values.items()}


def parse_of_plant(
    name: str, text: str, joint: str, tip_unit: str, kinds: Mapping[str, str] | None = None
) -> Any:
    """Read an end or the duration of a move, or a limit of it, in the units of joint and tip.

    Ends and durations may have several values. A limit is one number, or one for each side:
    ``-30:40``. A limit with a unit is of the joints of its kind, where a robot has several kinds.
    """
    if name in OF_MOVES:
        end = ("rad", "an angle") if joint == ROTARY else ("m", "a position")
        kind = ("s", "a time") if name == "duration" else end
        return parse_values(text, partial(parse_usual, *kind))
    if name == TORQUE_SPEED:
        return parse_torque_speed(text, joint)
    if name == BAND:
        return parse_usual("m", "a length", text, _MOST_BAND)
    if name == RESIDUAL_LIMIT:
        return parse_usual(tip_unit, "a length" if tip_unit == "m" else "an angle", text)
    quantities = quantities_of(joint, tip_unit)
    if "=" in text and quantities[name.removesuffix("_limit")].of_joints:
        pairs = (parse_pair(part, "a limit", "elbow_joint=16") for part in text.split(","))
        by_joint = once(pairs, "the limit of ")
        return {
            of: None
            if is_none(value)
            else parse_of_plant(name, value, (kinds or {}).get(of, joint), tip_unit)
            for of, value in by_joint.items()
        }
    limited = quantities[name.removesuffix("_limit")]
    sides = text.split(":")
    if joint == MIXED and limited.of_joints and not all(map(is_number, sides)):
        raise ValueError(
            f"{text!r} is for joints that turn or for those that slide, and the robot has both; "
            "give a limit of each by its name, such as x=500mm/s,elbow=90deg/s"
        )
    article = "an" if limited.name == "acceleration" else "a"
    what = f"{article} {limited.words}"
    values = [parse_usual(str(limited.unit), what, side) for side in sides]
    if len(values) > 2:
        raise ValueError(f"{text!r} is no limit; give one number, or one for each side as -30:40")
    if len({is_number(side) for side in sides}) > 1:
        raise ValueError(f"{text!r} has a unit on one side alone; give it on both, or on none")
    return tuple(values) if len(values) == 2 else values[0]


def is_none(text: str | None) -> bool:
    """Return whether a limit is typed as none, which takes a plant's own away."""
    return text is not None and text.strip().lower() == "none"


def parse_values(text: str, parse: Callable[[str], float]) -> tuple[float, ...]:
    """Read values: one, several as ``0.6,0.8,1.2``, or from, to, step as ``10deg:90deg:5deg``."""
    if ":" in text:
        ends = text.split(":")
        if len(ends) != 3:
            raise ValueError(f"{text!r} is no axis; give from:to:step, such as 10deg:90deg:5deg")
        first, last, step = map(parse, ends)
        steps = (last - first) / step if step else math.inf
        if not (steps > 0 and math.isfinite(steps)):
            raise ValueError(
                f"{text!r}: steps of {ends[2]} do not lead from {ends[0]} to {ends[1]}; give "
                "from:to:step, such as 10deg:90deg:5deg"
            )
        if steps >= MOST_VALUES:
            raise ValueError(
                f"{text!r}: steps of {ends[2]} make {steps + 1:.0f} values, and {MOST_VALUES} are "
                "the most; give wider steps"
            )
        rounding_error = 1e-6 * steps
        if abs(steps - round(steps)) > rounding_error:
            raise ValueError(
                f"{text!r}: steps of {ends[2]} from {ends[0]} do not reach {ends[1]}; give a step "
                "that does"
            )
        return tuple(np.linspace(first, last, round(steps) + 1).round(12).tolist())
    values = tuple(parse(value) for value in text.split(","))
    if len(set(values)) < len(values):
        raise ValueError(f"{text!r} has a value twice; give each once")
    return tuple(sorted(values))


def _two(
    mark: str,
    first: Callable[[str], S],
    second: Callable[[str], T],
    otherwise: str,
    fits: Callable[[S, T], bool] = lambda first, second: True,
) -> Callable[[str], tuple[S, T]]:
    """Return a reader of two values with a mark between them that fit each other.

    `otherwise` says what a text is not, and how it is given.
    """

    def parse(text: str) -> tuple[S, T]:
        with suppress(ValueError):
            left_text, right_text = text.split(mark)
            values = first(left_text), second(right_text)
            if fits(*values):
                return values
        raise ValueError(f"{text!r} is no {otherwise}")

    return parse


def _lengths(text: str) -> tuple[float, ...]:
    lengths = (length.removesuffix("/s") for length in text.split(","))
    return tuple(parse_quantity(length, "m", "a length") for length in lengths)


parse_weights = _two(":", float, float, "pair of weights; give those of residual and energy as 1:3")
"""Read the weights of residual and energy: ``1:3``."""
parse_share_of_work = _two(
    "/", int, int, "part; give the second of eight as 2/8", lambda number, of: 1 <= number <= of
)
"""Read a part of the work: ``2/8``."""
parse_interval = _two(
    ":", float, float, "part; give its begin and end in seconds, such as 3.2:7.3", lt
)
"""Read begin and end of a part of a recording [s]: ``3.2:7.3``."""
_state = _two(
    ":", _lengths, _lengths,
    "state; give W [m] of each mode, a colon, and W' [m/s] of each, such as 5mm:-0.3 or 0,0:0.1,0",
)  # fmt: skip


def _of_drive(joint: str, otherwise: str) -> Callable[[str], tuple[float, float]]:
    """Return a reader of the torque, or the force, that a drive gives at a speed."""
    torque, speed = (
        partial(parse_quantity, unit=unit.of(joint), what="one") for unit in (EFFORT, SPEED)
    )
    return _two("@", torque, speed, otherwise)


_of_drives = {
    ROTARY: _of_drive(
        ROTARY,
        "torque at a speed; give two or more, such as 1.5Nm@0,0.8Nm@20 with speeds in rad/s, or as "
        "190rpm",
    ),
    LINEAR: _of_drive(
        LINEAR,
        "force at a speed; give two or more, such as 100N@0,40N@0.5 with speeds in m/s, or as "
        "500mm/s",
    ),
}


def parse_state(text: str) -> ModalState:
    """Read amplitudes W and rates W' of the modes: ``5mm:-0.3`` or, of two modes, ``0,0:1,0``."""
    return ModalState(*_state(text))


def parse_torque_speed(text: str, joint: str = ROTARY) -> tuple[tuple[float, float], ...]:
    """Read what a drive gives, torques at speeds: ``1.5Nm@0,0.8Nm@20`` or ``0.8Nm@190rpm``.

    Of a linear joint forces: ``100N@0,40N@500mm/s``.
    """
    return tuple(map(_of_drives.get(joint, _of_drives[ROTARY]), text.split(",")))


def parse_drive(texts: Iterable[str], joint: str, recorded: Recorded | None = None) -> Drive | None:
    """Read what is known of a drive: ``speed_loop=40Hz,position_loop=60/s``; None of no text.

    How the frequencies were recorded is `recorded` where no text says it.
    """
    parts = [part for text in texts for part in text.split(",")]
    pairs = [parse_pair(part, "a drive's number", "speed_loop=40Hz") for part in parts]
    values = dict[str, Any]()
    for name, text in once(((name.replace("-", "_"), text) for name, text in pairs), "").items():
        if name in DRIVE_WORDS:
            values[name] = text
        elif name in DRIVE_NUMBERS:
            values[name] = _of_drive_number(name, text, joint)
        else:
            raise ValueError(has_no("a drive", "number", name, (*DRIVE_NUMBERS, *DRIVE_WORDS)))
    if not values:
        return None
    values.setdefault("recorded", recorded)
    return Drive(**values)


def _of_drive_number(name: str, text: str, joint: str) -> float:
    """Read a number of the drive in its unit; a compliance may be typed as a stiffness."""
    if name == "compliance" and (stiffness := _STIFFNESS.fullmatch(text)):
        factor = _STIFFNESSES[joint].get(stiffness[2])
        if factor is not None and float(stiffness[1]) > 0:
            return factor / float(stiffness[1])
    return parse_quantity(text, drive_unit(name, joint), f"a {name.replace('_', ' ')}")


_STIFFNESS = re.compile(r"([0-9.eE+-]+)\s*([kN].*)")
_STIFFNESSES: Mapping[str, Mapping[str, float]] = {
    LINEAR: {"N/m": 1.0, "kN/m": 1e-3, "N/mm": 1e-3, "N/um": 1e-6, "N/µm": 1e-6},
    ROTARY: {"Nm/rad": 1.0, "kNm/rad": 1e-3},
}
"""Units of a stiffness, and its compliance in SI units if there is one of them."""


def parse_workers(text: str) -> int:
    """Read a number of processes."""
    number: Any = text
    with suppress(ValueError):
        number = int(text)
    return whole("workers", number, 1, MOST_WORKERS, "one for each core is the usual number")


def parse_pair(
    text: str, what: str = "a parameter or setting", example: str = "omega=9"
) -> tuple[str, str]:
    """Read a name and its value, ``omega=9``."""
    name, _, value = (part.strip() for part in text.partition("="))
    if not (name and value):
        raise ValueError(f"{text!r} sets nothing; give {what} and its value, such as {example}")
    return name, value


def parse_error(text: str) -> tuple[str, float]:
    """Read the range of a parameter error, ``frequency=10%``, or `MEASURED`."""
    if text == MEASURED:
        return MEASURED, 0.0
    name, share = parse_pair(text, "an error", "frequency=10%")
    return name.replace("-", "_"), parse_share(share, name)


def parse_units(text: str) -> dict[str, str]:
    """Read units of a recording's quantities: ``time:ms,angle:deg``."""
    pairs = (map(str.strip, pair.partition(":")) for pair in text.split(","))
    units = once(((quantity, unit) for quantity, _, unit in pairs), "the unit of ")
    for quantity, unit in units.items():
        factors = _of_column(quantity)
        if normal(unit) not in factors:
            raise ValueError(unknown(f"unit of {quantity}", unit, factors))
    return units


def parse_scales(text: str) -> list[tuple[str, float]]:
    """Read what counts of recorded quantities are in SI units: ``angle=2pi/4096,tip=1e-5``."""
    return [_scale(scale) for scale in text.split(",")]


def _scale(text: str) -> tuple[str, float]:
    quantity, _, factor = (part.strip() for part in text.lower().partition("="))
    _of_column(quantity)
    number, _, divisor = factor.partition("/")
    with suppress(ValueError, ZeroDivisionError):
        scale = parse_quantity(number, "rad", "a scale") / float(divisor or 1)
        if scale and math.isfinite(scale):
            return quantity, scale
    raise ValueError(
        f"{factor!r} is no scale; give a number other than 0, such as {quantity}=2pi/4096"
    )


def _of_column(quantity: str) -> Mapping[str, float]:
    if quantity not in OF_OPTIONS:
        raise ValueError(unknown("quantity", quantity, OF_OPTIONS))
    return OF_OPTIONS[quantity]


def parse_sides(text: str) -> float | tuple[float, ...]:
    """Read a number for all coefficients, or one for each: ``-1,-1,0``."""
    try:
        values = tuple(float(number) for number in text.split(","))
    except ValueError:
        raise ValueError(f"{text!r} is no list of numbers; give them as -1,-1,0") from None
    return values if len(values) != 1 else values[0]


def parse_objectives(text: str) -> tuple[str, ...]:
    """Read names of objectives: ``residual,energy,peak-torque``."""
    return checked_objectives(text.split(","))


def parse_objectives_of_front(text: str) -> tuple[str, ...]:
    """Read names of objectives, also ``time,energy``."""
    names = [name.strip().lower() for name in text.split(",")]
    if "time" not in names:
        return parse_objectives(text)
    if sorted(names) != sorted(TIME_AND_ENERGY):
        raise ValueError(f"objectives are {text}; time is weighed against energy: give time,energy")
    return TIME_AND_ENERGY


def parse_noise(text: str) -> float:
    """Read a standard deviation of noise as a share: ``1%`` or ``0.01``."""
    value = parse_quantity(text, "-", "a noise")
    if 1 <= value <= 100 and is_number(text):
        raise ValueError(
            f"{text} is {100 * value:g} %; was {text} % meant? give {text}%, or less than 1"
        )
    return noise_share(value)


def parse_rate(text: str) -> float:
    """Read samples per second: ``1000``, ``1000Hz`` or ``1kHz``."""
    number = text.strip().lower().removesuffix("hz")
    factor = 1000.0 if number.endswith("k") else 1.0
    with suppress(ValueError):
        rate = factor * float(number.removesuffix("k"))
        if 1e-6 <= rate <= 1e12:  # from one in a fortnight to the fastest of oscilloscopes
            return rate
    raise ValueError(
        f"{text!r} is no rate from 1e-6 to 1e12; give the samples per second, such as 1000 or 1kHz"
    )


def parse_coefficients(text: str) -> list[float]:
    """Read numbers that are separated by commas."""
    try:
        return [
            _finite(f"coefficient {i}", number) for i, number in enumerate(text.split(","), start=1)
        ]
    except ValueError as error:
        raise ValueError(f"{error}, and commas between several, or a file of rows") from None


def _finite(name: str, text: str) -> float:
    """Read a finite number."""
    return finite(name, float(text) if is_number(text) else text)


def parse_energy(text: str) -> Energy:
    """Read an energy or a sum of some: ``0.5*absolute+copper:0.12``."""
    return reduce(add, map(_part_of_energy, _PLUS.split(text)))


def _part_of_energy(text: str) -> Energy:
    weight, times, form = text.rpartition("*")
    name, colon, numbers = (part.strip() for part in form.partition(":"))
    energies: dict[str, Any] = known(Energy)
    del energies[Mix.name]
    if name not in energies:
        raise ValueError(unknown("energy", name, energies))
    wanted = [entry.name for entry in fields(energies[name])]
    values = numbers.split(",") if colon else []
    if len(values) != len(wanted):
        form = f"{name}:{','.join(wanted)}" if wanted else name
        raise ValueError(f"{text!r} has {len(values)} numbers of {len(wanted)}; give {form}")
    energy = energies[name](*map(_finite, wanted, values))
    return _finite("weight", weight) * energy if times else energy


def once(pairs: Iterable[tuple[str, T]], what: str) -> dict[str, T]:
    """Values by their names; ValueError where a name is given twice."""
    values: dict[str, T] = {}
    for name, value in pairs:
        if name in values:
            raise ValueError(f"{what}{name} is given twice; give it once")
        values[name] = value
    return values


def read_settings(pairs: Iterable[tuple[str, str]]) -> dict[str, float | int | bool | str]:
    """Settings of methods by their names."""
    return {name: _literal(text) for name, text in once(pairs, "setting ").items()}


def _literal(text: str) -> float | int | bool | str:
    """Read a value of any kind: true or false, a number, a share such as 25 %, or else a word."""
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    share = text.strip().removesuffix("%")
    if share != text.strip() and is_number(share.strip()):
        return float(share) / 100
    if not is_number(text):
        return text
    number = float(text)
    return int(number) if number.is_integer() and abs(number) < 1e15 else number
