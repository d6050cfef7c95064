"""Quantities as people type them, in SI units or with another unit: 30deg, 8mm, pi/6, 3.2Hz."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

from quietarm.models.number_checks import quoted

_NUMBER = r"(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?"
_PI = re.compile(rf"([+-]?)(?:({_NUMBER})\s*\*?\s*)?pi(?:\s*/\s*({_NUMBER}))?\s*(?:rad)?")
_WITH_UNIT = re.compile(rf"([+-]?{_NUMBER})\s*([a-zA-Zµ%°/][a-zA-Zµ%°/^0-9]*|)")
_COMMA = re.compile(r"[+-]?\d+,\d+[^\d,]*")
_LENGTHS = {"m": 1.0, "cm": 100.0, "mm": 1e3, "um": 1e6, "µm": 1e6, "nm": 1e9}
_ANGLES = {
    "rad": 1.0, **dict.fromkeys(("deg", "°", "degrees"), 180 / math.pi),
    "mrad": 1e3, "rev": 0.5 / math.pi,
}  # fmt: skip
_SPEEDS = {
    **_ANGLES, "rad/s": 1.0, "deg/s": 180 / math.pi, "rpm": 30 / math.pi,
    "Hz": 0.5 / math.pi, "hz": 0.5 / math.pi, "kHz": 5e-4 / math.pi,
}  # fmt: skip
UNITS: Mapping[str, tuple[str, Mapping[str, float]]] = {
    "rad": ("radians (0.5), 30deg, pi/6 or -pi/2", _ANGLES),
    "rad/s": ("rad/s (2), 60deg/s or 3.2Hz", _SPEEDS),
    "rad/s^2": ("rad/s^2 (2) or 60deg/s^2", _ANGLES),
    "rad/s^3": ("rad/s^3 (2) or 60deg/s^3", _ANGLES),
    "m": ("metres (0.001) or 1mm", _LENGTHS),
    "m/s": ("m/s (0.5) or 500mm/s", {"m/s": 1.0, "mps": 1.0, "mm/s": 1e3}),
    "m/s^2": ("m/s^2 (2) or 2000mm/s^2", _LENGTHS),
    "m/s^3": ("m/s^3 (50)", _LENGTHS),
    "s": ("seconds (0.8) or 800ms", {"s": 1.0, "ms": 1e3, "us": 1e6, "µs": 1e6}),
    "N": ("newtons (20) or 20N", {"N": 1.0, "mN": 1e3, "kN": 1e-3}),
    "N m": ("newton metres (1.5) or 200mNm", {"Nm": 1.0, "mNm": 1e3}),
    "kg": ("kilograms (0.1) or 100g", {"kg": 1.0, "g": 1e3}),
    "kg/m": ("kg/m (0.26) or 260g/m", {"kg/m": 1.0, "g/m": 1e3}),
    "kg/m^3": ("kg/m^3 (2700)", {"kg/m^3": 1.0, "kg/m3": 1.0}),
    "kg m^2": ("kg m^2 (0.1)", {}),
    "N/m": ("N/m (5000)", {"N/m": 1.0, "kN/m": 1e-3}),
    "N m/rad": ("N m/rad (8000) or 8kNm/rad", {"Nm/rad": 1.0, "kNm/rad": 1e-3}),
    "N s/m": ("N s/m (10)", {"Ns/m": 1.0}),
    "N m s/rad": ("N m s/rad (10)", {"Nms/rad": 1.0}),
    "N m^2": ("N m^2 (80)", {"Nm2": 1.0}),
    "Pa": ("pascal (7e10) or 70GPa", {"Pa": 1.0, "MPa": 1e-6, "GPa": 1e-9}),
    "1/s": ("1/s (60), 60/s or 9.5Hz", {"1/s": 1.0, "/s": 1.0, "Hz": 0.5 / math.pi}),
    "Hz": ("hertz (40) or 40Hz", {"Hz": 1.0, "kHz": 1e-3, "rad/s": 2 * math.pi}),
    "m/N": (
        "m/N (1.7e-7), 0.17um/N, or a stiffness as 6N/um",
        {"m/N": 1.0, "mm/N": 1e3, "um/N": 1e6, "µm/N": 1e6, "nm/N": 1e9},
    ),
    "rad/N/m": (
        "rad/(N m) (1e-4), 0.1mrad/Nm, or a stiffness as 8kNm/rad",
        {"rad/Nm": 1.0, "mrad/Nm": 1e3},
    ),
    "-": ("a number (0.1) or 10%", {"%": 100.0}),
}
"""By the SI unit of a quantity: examples, and how many of each unit it is typed in make one.

Dividing by 1000 is exact where multiplying by 0.001 is not.
"""


def parse_quantity(text: str, unit: str, what: str) -> float:
    """Read a number in an SI unit, or with another unit of its kind: 0.6, 600mm, 3.2Hz, pi/6."""
    examples, others = UNITS.get(unit, (f"a number in {unit}, without the unit", {}))
    longest = 100  # letters: of more the forms below would take time by their square
    if len(text) > longest:
        raise ValueError(f"{quoted(text)} is not {what}; give {examples}")
    plain = text.strip()
    if "^" in unit:
        plain = plain.removesuffix(unit.removeprefix("rad").removeprefix("m"))
    plain = plain.replace("N m", "Nm").replace("Nm s", "Nms").replace("N s", "Ns")
    if unit.startswith("rad") and (match := _PI.fullmatch(plain)):
        sign, factor, divisor = match.groups()
        if float(divisor or 1) != 0:
            return float(f"{sign}1") * float(factor or 1) * math.pi / float(divisor or 1)
    match = _WITH_UNIT.fullmatch(plain)
    if match and match[2] in others:
        return float(match[1]) / others[match[2]]
    if is_number(plain):
        return float(plain)  # nan and inf, for the task to refuse in its own words
    if _COMMA.fullmatch(plain):
        examples = f"{plain.replace(',', '.')}, with a point"
    raise ValueError(f"{quoted(text)} is not {what}; give {examples}")


def is_number(text: str) -> bool:
    """Return whether a text is a number alone, without a unit."""
    try:
        float(text)
    except ValueError:
        return False
    return True
