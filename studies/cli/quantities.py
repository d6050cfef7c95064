"""Quantities as they are typed: 30deg, -pi/2, 60deg/s, 1mm, 800ms, 10%."""

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
_WITH_UNIT = re.compile(rf"([+-]?{_NUMBER})\s*([a-zA-Zµ%°/]*)")
_COMMA = re.compile(r"[+-]?\d+,\d+[^\d,]*")
_PLUS = re.compile(r"(?<!\d[eE])\+")
_LENGTHS = {"m": 1.0, "cm": 100.0, "mm": 1e3, "um": 1e6, "µm": 1e6}
_ANGLES = {"rad": 1.0, **dict.fromkeys(("deg", "°", "degrees"), 180 / math.pi)}
_SPEEDS = {
    **_ANGLES, "rad/s": 1.0, "deg/s": 180 / math.pi, "rpm": 30 / math.pi,
    "Hz": 0.5 / math.pi, "hz": 0.5 / math.pi, "kHz": 5e-4 / math.pi,
}  # fmt: skip
UNITS: Mapping[str, Mapping[str, float]] = {
    "rad": _ANGLES, "rad/s": _SPEEDS, "rad/s^2": _ANGLES, "rad/s^3": _ANGLES,
    "m/s": {"m/s": 1.0, "mm/s": 1e3}, "m/s^2": _LENGTHS, "m/s^3": _LENGTHS,
    "N": {"N": 1.0, "mN": 1e3, "kN": 1e-3},
    "m": _LENGTHS, "s": {"s": 1.0, "ms": 1e3},
    "N m": {"Nm": 1.0, "mNm": 1e3}, "kg": {"kg": 1.0, "g": 1e3}, "-": {"%": 100.0},
}  # fmt: skip
"""By the SI unit of a quantity, the units that it may be typed in, and how many of each make one.

Dividing by 1000 is exact where multiplying by 0.001 is not.
"""
_EXAMPLES = {
    "rad": "radians (0.5), 30deg, pi/6 or -pi/2", "rad/s": "rad/s (2), 60deg/s or 3.2Hz",
    "rad/s^2": "rad/s^2 (2) or 60deg/s^2", "rad/s^3": "rad/s^3 (2) or 60deg/s^3",
    "m": "metres (0.001) or 1mm", "s": "seconds (0.8) or 800ms", "kg": "kilograms (0.1) or 100g",
    "m/s": "m/s (0.5) or 500mm/s", "m/s^2": "m/s^2 (2) or 2000mm/s^2", "m/s^3": "m/s^3 (50)",
    "N": "newtons (20) or 20N", "N m": "newton metres (1.5) or 200mNm",
    "-": "a number (0.1) or 10%",
}  # fmt: skip


def parse_quantity(text: str, unit: str, what: str) -> float:
    """Read a number in an SI unit, or with another unit of its kind: 0.6, 600mm, 3.2Hz, pi/6."""
    plain = text.strip()
    if "^" in unit:
        plain = plain.removesuffix(unit.removeprefix("rad").removeprefix("m"))
    if unit.startswith("rad") and (match := _PI.fullmatch(plain)):
        sign, factor, divisor = match.groups()
        if float(divisor or 1) != 0:
            return float(f"{sign}1") * float(factor or 1) * math.pi / float(divisor or 1)
    match = _WITH_UNIT.fullmatch(plain)
    if match and match[2] in UNITS.get(unit, {}):
        return float(match[1]) / UNITS[unit][match[2]]
    if is_number(plain):
        return float(plain)  # nan and inf, for the task to refuse in its own words
    examples = _EXAMPLES.get(unit, f"a number in {unit}, without the unit")
    if _COMMA.fullmatch(plain):
        examples = f"{plain.replace(',', '.')}, with a point"
    raise ValueError(f"{text!r} is not {what}; give {examples}")


def is_number(text: str) -> bool:
    """Whether a text is a number alone, without a unit."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def parse_pair(text: str, what: str, example: str) -> tuple[str, str]:
    """Read a name and its value, ``omega=9``."""
    name, equals, value = (part.strip() for part in text.partition("="))
    if not (equals and name and value):
        raise ValueError(f"{text!r} sets nothing; give {what} and its value, as {example}")
    return name, value


def parse_state(text: str) -> ModalState:
    """Read amplitudes W and rates W' of the modes: ``5mm:-0.3`` or, of two modes, ``0,0:1,0``."""
    try:
        W, dW = (
            tuple(parse_quantity(one.removesuffix("/s"), "m", "a length") for one in of.split(","))
            for of in text.split(":")
        )
    except ValueError:
        raise ValueError(
            f"{text!r} is no state; give W [m] of each mode, a colon, and W' [m/s] of each, as "
            "5mm:-0.3 or 0,0:0.1,0"
        ) from None
    return ModalState(W, dW)


def parse_torque_speed(text: str) -> tuple[tuple[float, float], ...]:
    """Read what a drive gives, torques at speeds: ``1.5Nm@0,0.8Nm@20`` or ``0.8Nm@190rpm``."""
    points = list[tuple[float, float]]()
    for point in text.split(","):
        torque, at, speed = point.partition("@")
        if not at:
            raise ValueError(
                f"{point!r} is no torque at a speed; give two or more, as 1.5Nm@0,0.8Nm@20 with "
                "speeds in rad/s, or as 190rpm"
            )
        points.append(
            (parse_quantity(torque, "N m", "a torque"), parse_quantity(speed, "rad/s", "a speed"))
        )
    return tuple(points)


def parse_coefficients(text: str) -> list[float]:
    """Read numbers that are separated by commas."""
    try:
        return [finite(f"coefficient {i}", one) for i, one in enumerate(text.split(","), start=1)]
    except ValueError as error:
        raise ValueError(f"{error}, and commas between several, or a file of rows") from None


def parse_weights(text: str) -> tuple[float, float]:
    """Read the weights of residual and energy: ``1:3``."""
    try:
        of_residual, of_energy = map(float, text.split(":"))
    except ValueError:
        raise ValueError(
            f"{text!r} is no pair of weights; give those of residual and energy as in 1:3"
        ) from None
    return of_residual, of_energy


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
    given = numbers.split(",") if colon else []
    if len(given) != len(wanted):
        form = f"{name}:{','.join(wanted)}" if wanted else name
        raise ValueError(f"{text!r} has {len(given)} numbers of {len(wanted)}; give {form}")
    energy = energies[name](*map(finite, wanted, given))
    return finite("weight", weight) * energy if times else energy


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
    if text.lower() in ("true", "false"):
        return text.lower() == "true"
    if not is_number(text):
        return text
    number = float(text)
    return int(number) if number.is_integer() and abs(number) < 1e15 else number
