"""Quantities as they are typed: 30deg, -pi/2, 60deg/s, 1mm, 800ms."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import fields
from functools import reduce
from operator import add
from typing import Any, TypeVar

from quietarm.ocp import ModalState
from quietarm.ocp.checks import finite, known, unknown
from quietarm.ocp.energy import Energy, Mix

T = TypeVar("T")
_NUMBER = r"(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?"
_PI = re.compile(rf"([+-]?)(?:({_NUMBER})\s*\*?\s*)?pi(?:\s*/\s*({_NUMBER}))?\s*(?:rad)?")
_PLAIN = re.compile(rf"([+-]?{_NUMBER})\s*([a-zA-Zµ%°/]*)")
_LENGTHS = {"": 1.0, "m": 1.0, "cm": 100.0, "mm": 1e3, "um": 1e6, "µm": 1e6}
_TIMES = {"": 1.0, "s": 1.0, "ms": 1e3}
_ANGLES = {"": 1.0, "rad": 1.0, **dict.fromkeys(("deg", "°", "degrees"), 180 / math.pi)}
_COMMA = re.compile(r"[+-]?\d+,\d+[^\d,]*")
_TORQUES = {"": 1.0, "Nm": 1.0, "mNm": 1e3}
_IN_UNITS: Mapping[str, dict[str, float]] = {
    "m": _LENGTHS, "s": _TIMES, "N m": _TORQUES, "kg": {"": 1.0, "kg": 1.0, "g": 1e3},
    "rad/s": {"": 1.0, "rad/s": 1.0, "kHz": 5e-4 / math.pi,
              **dict.fromkeys(("Hz", "hz"), 0.5 / math.pi)},
}  # fmt: skip
"""By the unit of SI, those that a quantity may be typed in."""
_PLUS = re.compile(r"(?<!\d[eE])\+")
_MOST_WHOLE = 1e15
# Units a metre, second or radian: dividing by 1000 is exact where multiplying by 0.001 is not.


def parse_angle(text: str) -> float:
    """Read an angle."""
    match = _PI.fullmatch(text.strip())
    if match:
        sign, factor, divisor = match.groups()
        if divisor is None or float(divisor) != 0:
            size = float(factor or 1) * math.pi / float(divisor or 1)
            return -size if sign == "-" else size
    return _with_unit(text, _ANGLES, "an angle", "radians (0.5), 30deg, pi/6 or -pi/2")


def parse_joint_angle(text: str) -> float:
    """Read where a joint stands: beyond a turn with its unit alone, as degrees are easily meant."""
    angle = parse_angle(text)
    if abs(angle) > 2 * math.pi and is_number(text):
        raise ValueError(
            f"{text} is in radians, {math.degrees(angle):.6g} degrees, more than a turn; were "
            f"degrees meant? give {text}deg, or {text}rad"
        )
    return angle


def parse_rate(text: str, order: int) -> float:
    """Read a speed, acceleration or jerk of the joint."""
    per = "/s" if order == 1 else f"/s^{order}"
    try:
        return parse_angle(text.strip().removesuffix(per))
    except ValueError:
        raise ValueError(
            f"{text!r} is not a number in rad{per}; give that (2), 60deg, 60deg{per} or pi/2"
        ) from None


def is_number(text: str) -> bool:
    """Whether a text is a number alone, without a unit."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def parse_length(text: str) -> float:
    """Read a length: metres, or with m, cm, mm or um. ValueError when it is none."""
    return _with_unit(text, _LENGTHS, "a length", "metres (0.001) or 1mm")


def parse_residual(text: str) -> float:
    """Read a residual: beyond 0.1 m with its unit alone, as millimetres are easily meant."""
    residual = parse_length(text)
    if residual > 0.1 and is_number(text):
        raise ValueError(f"{text} is in metres; were millimetres meant? give {text}mm, or {text}m")
    return residual


def parse_time(text: str) -> float:
    """Read a time: seconds, or with s or ms. ValueError when it is none."""
    return _with_unit(text, _TIMES, "a time", "seconds (0.8) or 800ms")


def parse_duration(text: str) -> float:
    """Read a time: beyond 100 s with its unit alone, as milliseconds are easily meant."""
    time = parse_time(text)
    if math.isfinite(time) and time > 100 and is_number(text):
        raise ValueError(
            f"{text} is in seconds; were milliseconds meant? give {text}ms, or {text}s"
        )
    return time


def parse_torque(text: str) -> float:
    """Read a torque: newton metres, or with Nm or mNm. ValueError when it is none."""
    return _with_unit(text, _TORQUES, "a torque", "newton metres (1.5) or 200mNm")


def parse_in(unit: str, text: str, name: str) -> float:
    """Read a number of a unit of SI, or with another unit of its kind: 0.6, 600mm, 3.2Hz."""
    units = _IN_UNITS.get(unit, {"": 1.0} if unit != "-" else {"": 1.0, "%": 100.0})
    others = [one for one in units if one not in ("", unit, "hz")]
    of_unit = "" if unit == "-" else f" in {unit}"
    behind = f"or with {' or '.join(others)} behind it" if others else "without the unit"
    wanted = f"number{of_unit}, {behind}"
    value = _with_unit(text, units, f"a value of {name}", f"a {wanted}")
    if name.startswith(("zeta", "damping")) and value >= 1 and is_number(text):
        raise ValueError(
            f"{name}={text} is a damping ratio of {100 * value:g} %; was {text} % meant? give "
            f"{name}={text}%, or {name}={100 * value:g}%"
        )
    return value


def parse_state(text: str) -> ModalState:
    """Read what rings, amplitudes W and rates W': ``5mm:-0.3`` or, of two modes, ``0,0:1,0``."""
    try:
        W, dW = (
            [parse_length(one.removesuffix("/s")) for one in of.split(",")]
            for of in text.split(":")
        )
    except ValueError:
        raise ValueError(
            f"{text!r} is no state; give W [m] of each mode, a colon, and W' [m/s] of each, as "
            "5mm:-0.3 or 0,0:0.1,0"
        ) from None
    return ModalState(tuple(W), tuple(dW))


def parse_share(text: str) -> float:
    """Read a share: ``10%`` or 0.1. ValueError when it is none."""
    return _with_unit(text, {"": 1.0, "%": 100.0}, "a share", "10% or 0.1")


def parse_whole(text: str) -> int:
    """Read a whole number: ``1000`` or ``1e3``. ValueError when it is none."""
    try:
        return int(text)
    except ValueError:
        value = float(text) if is_number(text) else math.nan
    if not value.is_integer():
        raise ValueError(f"{text!r} is no whole number; give one, as 2 or 1e3")
    if abs(value) > _MOST_WHOLE:
        raise ValueError(f"{text!r} is more than any count here; give at most {_MOST_WHOLE:.0e}")
    return int(value)


def parse_coefficients(text: str) -> list[float]:
    """Read numbers that are separated by commas. ValueError when one is not a finite number."""
    try:
        return [finite(f"coefficient {i}", one) for i, one in enumerate(text.split(","), start=1)]
    except ValueError as error:
        raise ValueError(f"{error}, and commas between several") from None


def parse_weights(text: str) -> tuple[float, float]:
    """Read a pair of weights, of residual and energy: ``1:3``. ValueError when it is none."""
    try:
        of_residual, of_energy = map(float, text.split(":"))
    except ValueError:
        raise ValueError(
            f"{text!r} is no pair of weights; give those of residual and energy as in 1:3"
        ) from None
    return of_residual, of_energy


def parse_energy(text: str) -> Energy:
    """Read an energy or a sum of some: ``0.5*absolute+copper:0.12``. ValueError when it is none."""
    return reduce(add, map(_part_of_energy, _PLUS.split(text)))


def _part_of_energy(text: str) -> Energy:
    weight, times, form = text.rpartition("*")
    name, colon, numbers = (part.strip() for part in form.partition(":"))
    energies: dict[str, Any] = known(Energy)
    del energies[Mix.name]
    if name not in energies:
        raise ValueError(unknown("energy", name, energies))
    wanted = [entry.name for entry in fields(energies[name])]
    given = numbers.split(",") if colon else []
    if len(given) != len(wanted):
        form = f"{name}:{','.join(wanted)}" if wanted else name
        raise ValueError(f"{text!r} has {len(given)} numbers of {len(wanted)}; give {form}")
    energy = energies[name](*map(finite, wanted, given))
    return finite("weight", weight) * energy if times else energy


def _with_unit(text: str, units: dict[str, float], kind: str, examples: str) -> float:
    match = _PLAIN.fullmatch(text.strip())
    if match and match.group(2) in units:
        return float(match.group(1)) / units[match.group(2)]
    try:
        return float(text)  # nan and inf, for the task to refuse with its own words
    except ValueError:
        if _COMMA.fullmatch(text.strip()):
            examples = f"{text.strip().replace(',', '.')}, with a point"
        raise ValueError(f"{text!r} is not {kind}; give {examples}") from None


def once(pairs: Iterable[tuple[str, T]], what: str) -> dict[str, T]:
    """Values by their names; ValueError where a name is given twice."""
    values: dict[str, T] = {}
    for name, value in pairs:
        if name in values:
            raise ValueError(f"{what}{name} is given twice; give it once")
        values[name] = value
    return values


def literal(text: str) -> float | int | bool | str:
    """Read a value of any kind: true or false, a number, or else a word."""
    words = {"true": True, "false": False}
    if text.lower() in words:
        return words[text.lower()]
    for kind in (parse_whole, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text
