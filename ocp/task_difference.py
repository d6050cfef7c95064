"""In what two tasks differ: the one comparison of tasks, within rounding."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from math import isclose

from quietarm.models import Plant
from quietarm.models.joint_motion import joint_unit
from quietarm.ocp.energy import Energy
from quietarm.ocp.limits import QUANTITIES
from quietarm.ocp.task import PointToPoint
from quietarm.ocp.uncertainty import Uncertainty

_SAME, _NONE = 1e-9, 1e-15
"""Relative and absolute difference below which numbers are one: 30deg and pi/6."""
_UNITS = {"start": "rad", "target": "rad", "duration": "s", "residual window": "s"} | {
    f"{quantity.name} limit": quantity.unit for quantity in QUANTITIES.values()
}


def task_difference(one: PointToPoint, other: PointToPoint) -> str:
    """Every entry in which two tasks differ, in words; empty where they are the same.

    Numbers are the same within rounding; states of rest are the same, given or not.
    """
    if one.plant.name != other.plant.name:
        return f"plant is {one.plant.name}, not {other.plant.name}"
    mine, theirs = dict(_entries(one)), dict(_entries(other))
    joint = one.plant.joint
    return ", ".join(
        f"{name} is {_words(name, mine.get(name), joint)}, "
        f"not {_words(name, theirs.get(name), joint)}"
        for name in mine | theirs
        if not _same(mine.get(name), theirs.get(name))
    )


def _entries(value: object, name: str = "") -> Iterator[tuple[str, object]]:
    """Names and values of all that a task has."""
    match value:
        case PointToPoint():
            states = {name: getattr(value, f"{name}_state") for name in ("initial", "final")}
            for entry in fields(value):
                own = states.get(entry.name, getattr(value, entry.name))
                named = f"{entry.name} state" if entry.name in states else entry.name
                yield from _entries(own, named.replace("_", " "))
        case Plant():
            yield from _entries(value.parameters, "plant parameter")
        case Energy():
            yield name, value.label
        case Uncertainty():
            yield from _entries(value.ranges, "error of")
            yield from _entries(value.samples, "scenario")
        case Mapping():
            for key, entry in value.items():
                yield from _entries(entry, f"{name} {key}")
        case list() | tuple():
            for place, entry in enumerate(value, start=1):
                yield from _entries(entry, f"{name} {place}")
        case _ if is_dataclass(value):
            for entry in fields(value):
                yield from _entries(getattr(value, entry.name), f"{name} {entry.name}")
        case _:
            yield name, value


def _same(one: object, other: object) -> bool:
    if isinstance(one, float | int) and isinstance(other, float | int):
        return isclose(one, other, rel_tol=_SAME, abs_tol=_NONE)
    return one == other


def _words(name: str, value: object, joint: str) -> str:
    if value is None:
        return "none"
    unit = joint_unit(_UNITS.get(name, ""), joint)
    return f"{value:.10g} {unit}".strip() if isinstance(value, float) else str(value)
