"""In what two tasks differ: the one comparison of tasks, within rounding."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields
from math import isclose

from quietarm.models.joint_motion import joint_unit
from quietarm.ocp.limits import QUANTITIES
from quietarm.ocp.task import PointToPoint

_SAME, _NONE = 1e-9, 1e-15
"""Relative and absolute difference below which numbers are one: 30deg and pi/6."""
_APART = "plant", "initial", "final", "energy", "uncertainty"
"""Fields that are told in another way."""
_UNITS = {"start": "rad", "target": "rad", "duration": "s", "residual window": "s"} | {
    f"{quantity.name} limit": quantity.unit for quantity in QUANTITIES.values()
}


def task_difference(one: PointToPoint, other: PointToPoint) -> str:
    """Every entry in which two tasks differ, in words; empty where they are the same.

    Numbers are the same within rounding; states of rest are the same, given or not.
    """
    if one.plant.name != other.plant.name:
        return f"plant is {one.plant.name}, not {other.plant.name}"
    mine, theirs = dict(_entries(_stated(one))), dict(_entries(_stated(other)))
    joint = one.plant.joint
    return ", ".join(
        f"{name} is {_words(name, mine.get(name), joint)}, "
        f"not {_words(name, theirs.get(name), joint)}"
        for name in mine | theirs
        if not _same(mine.get(name), theirs.get(name))
    )


def _stated(task: PointToPoint) -> dict[str, object]:
    """All that a task has, by words; states are numbers, given or not."""
    plain = (entry.name for entry in fields(task) if entry.name not in _APART)
    return {
        "plant parameter": task.plant.parameters,
        **{name.replace("_", " "): getattr(task, name) for name in plain},
        "initial state": task.initial_state,
        "final state": task.final_state,
        "energy": task.energy.label,
        "error of": task.ranges,
        "scenario": task.scenarios[1:],
    }


def _entries(value: object, name: str = "") -> Iterator[tuple[str, object]]:
    """Names and values of numbers and words in mappings and sequences."""
    match value:
        case Mapping():
            for key, entry in value.items():
                yield from _entries(entry, f"{name} {key}".strip())
        case list() | tuple():
            for place, entry in enumerate(value, start=1):
                yield from _entries(entry, f"{name} {place}")
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
