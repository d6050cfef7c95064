"""Units of recorded columns, as people write them into a column's name."""

from __future__ import annotations

import re
from collections.abc import Mapping
from math import pi

_TIMES = {
    "s": 1.0, "sec": 1.0, "secs": 1.0, "second": 1.0, "seconds": 1.0, "ms": 1e-3, "msec": 1e-3,
    "millisecond": 1e-3, "milliseconds": 1e-3, "millis": 1e-3, "us": 1e-6, "usec": 1e-6,
    "microseconds": 1e-6, "microsecond": 1e-6, "micros": 1e-6, "ns": 1e-9, "nsec": 1e-9,
    "nanoseconds": 1e-9, "nanosecond": 1e-9, "nanos": 1e-9, "min": 60.0,
    "mins": 60.0, "minute": 60.0, "minutes": 60.0,
    "h": 3600.0, "hr": 3600.0, "hrs": 3600.0, "hour": 3600.0, "hours": 3600.0,
}  # fmt: skip
_ANGLES = {
    "rad": 1.0, "radian": 1.0, "radians": 1.0, "mrad": 1e-3, "deg": pi / 180, "degs": pi / 180,
    "degree": pi / 180, "degrees": pi / 180, "°": pi / 180, "grad": pi / 200, "rev": 2 * pi,
    "turn": 2 * pi, "turns": 2 * pi,
}  # fmt: skip
_LENGTHS = {
    "m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "nm": 1e-9, "micron": 1e-6, "microns": 1e-6,
    "metre": 1.0, "metres": 1.0, "meter": 1.0, "meters": 1.0, "millimetre": 1e-3,
    "millimetres": 1e-3, "millimeter": 1e-3, "millimeters": 1e-3, "in": 0.0254, "inch": 0.0254,
    "inches": 0.0254, "ft": 0.3048, "mil": 2.54e-5, "thou": 2.54e-5,
}  # fmt: skip
_SENSORS = dict.fromkeys(("v", "mv", "counts", "strain", "ue", "pixel", "px"), 1.0)
"""A tip's signal may be of any sensor: frequencies and dampings need no scale."""
UNITS: Mapping[str, Mapping[str, float]] = {
    "time": _TIMES,
    "angle": _ANGLES,
    "position": _LENGTHS,
    "tip": {**_LENGTHS, **_ANGLES, **_SENSORS},
    "acceleration": {"m/s^2": 1.0, "mps2": 1.0, "mm/s^2": 1e-3, "g": 9.80665, "mg": 9.80665e-3,
                     "rad/s^2": 1.0, "deg/s^2": pi / 180, "v": 1.0, "mv": 1.0, "counts": 1.0},
    "torque": {"nm": 1.0, "mnm": 1e-3, "nmm": 1e-3, "ncm": 1e-2, "knm": 1e3},
    "force": {"n": 1.0, "newton": 1.0, "newtons": 1.0, "mn": 1e-3, "kn": 1e3, "kgf": 9.80665,
              "lbf": 4.4482216152605},
}  # fmt: skip
"""What a unit of a quantity is in SI units; a position and a force are those of a linear joint."""
OF_OPTIONS: Mapping[str, Mapping[str, float]] = {
    **UNITS,
    "angle": {**_ANGLES, **_LENGTHS},
    "torque": {**UNITS["torque"], **UNITS["force"]},
}
"""Units that an option may give before the kind of joint is known."""
KINDS: Mapping[str, str] = {
    "time": "time", "angle": "angle", "torque": "torque", "force": "force", "position": "length",
    "acceleration": "acceleration",
}  # fmt: skip
"""What the units of a quantity are of, in words: Nm is looked for before nm."""
_SIGNALS = {
    *("time", "stamp", "timestamp", "angle", "theta", "position", "pos", "q", "tip", "torque"),
    *("force", "acceleration", "acc", "joint", "axis", "hub", "motor", "encoder", "sensor"),
    *("signal", "value", "actual", "measured", "raw", "x", "y", "z"),
}
"""Words of headings that are no unit."""
_ELSEWHERE = """
    day days samples ticks tick ft feet yd mil thou kg lb lbf oz ozin
    lbin lbft kgf kgcm gf ma ua amps volt volts bar pa kpa mpa psi kn hz khz rpm % rad/s deg/s
    arcmin arcsec cnt count steps pulses lsb a n
"""
_LIKE_UNITS = {unit for table in UNITS.values() for unit in table if unit != "in"} | set(
    _ELSEWHERE.split()
)
"""Endings that look like a unit, of whatever quantity."""
_IN_BRACKETS = re.compile(r"(.*?)\s*[(\[{<]\s*([^()\[\]{}<>]+?)\s*[)\]}>]")
_INDEX = re.compile(r"\d+(?:\s*[,:;]\s*\d+)*")
_AFTER = re.compile(r"(.*?[^\s_/,:;-])\s*(?:[_/,:; -]| in )\s*([^\s_,:;-]+(?:\s*[*·]\s*m)?)")


def kind_of(unit: str) -> str:
    """Name the kind of quantity that a unit measures, in words; empty if it is unknown."""
    return next((words for kind, words in KINDS.items() if normal(unit) in UNITS[kind]), "")


def unknown_ending(name: str) -> str:
    """The word at the end of a heading that may be meant as a unit; empty where there is none."""
    words = re.split(r"[\s_]+", name.strip())
    last = words[-1]
    is_word = len(words) > 1 and re.fullmatch(r"[^\W\d]{1,8}", last)
    return last if is_word and last.lower() not in _SIGNALS else ""


def normal(unit: str) -> str:
    """A unit as it stands in `UNITS`: m/s², m/s**2 and m/s2 are m/s^2, N·m and N m are Nm."""
    text = unit.strip().strip("()[]{}<>").strip().lower()
    text = text.replace("µ", "u").replace("μ", "u").replace("²", "^2").replace("**", "^")
    text = re.sub(r"(?<=s)(?:ec)?-?2$", "^2", text) if "/s" in text else text
    text = re.sub(r"[\s·*]", "", text)
    return text.replace("m/s/s", "m/s^2")


def split_name(name: str) -> tuple[str, str]:
    """The name and the unit that a column's heading has: ``Time (ms)``, ``tip_mm``, ``theta/deg``.

    The unit is empty where none is written. In brackets it is whatever stands there but an index,
    which belongs to the name: ``tau[3]``.
    """
    if match := _IN_BRACKETS.fullmatch(name.strip()):
        return (name.strip(), "") if _INDEX.fullmatch(match[2]) else (match[1], match[2])
    for front in ("mm", "m", "rad", "deg"):
        for ending in ("/s^2", "/s2", "/s²", "/s**2"):  # these have a slash of their own
            if name.lower().endswith(f"{front}{ending}"):
                return name[: -len(front + ending)].rstrip(" _/,:"), front + ending
    if (match := _AFTER.fullmatch(name.strip())) and normal(match[2]) in _LIKE_UNITS:
        return match[1], match[2]
    if name.strip().endswith("°"):
        return name.strip()[:-1], "°"
    return name, ""


def is_unit(text: str) -> bool:
    """Return whether a cell is a unit and nothing else, as in a row of units below the names."""
    text = text.strip()
    bracketed = text[:1] in "([{" and text[-1:] in ")]}" and len(text) > 1
    if bracketed and _INDEX.fullmatch(text[1:-1].strip()):
        return False
    return bracketed or normal(text) in _LIKE_UNITS
