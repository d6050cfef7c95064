"""Where two tasks differ, in words, and which are the paper's."""

from __future__ import annotations

from math import isclose

from quietarm.ocp import PointToPoint, UncertainPlant
from quietarm.ocp.task.quantities import QUANTITIES
from quietarm.studies.paper.case import Case
from quietarm.studies.paper.printed import CONDITIONS

_SAME = 1e-9
"""Relative difference below which two numbers of a task are one: 30deg and pi/6."""


def task_difference(one: PointToPoint, other: PointToPoint) -> str:
    """Every quantity in which two tasks differ, in words; empty where they are equal."""
    if one.plant.name != other.plant.name:
        return f"plant is {one.plant.name}, not {other.plant.name}"
    mine, theirs = _quantities(one), _quantities(other)
    words: list[str] = []
    for name, (_, unit) in (mine | theirs).items():
        value, wanted = (of.get(name, (None, ""))[0] for of in (mine, theirs))
        if value is None or wanted is None:
            same = value is wanted
        else:
            same = isclose(value, wanted, rel_tol=_SAME)
        if not same:
            words.append(f"{name} is {_words(value, unit)}, not {_words(wanted, unit)}")
    if not words and _samples(one) != _samples(other):
        words.append("its samples within the errors are others")
    return ", ".join(words)


def _quantities(task: PointToPoint) -> dict[str, tuple[float | None, str]]:
    table: dict[str, tuple[float | None, str]] = {
        f"plant parameter {name}": (value, "") for name, value in task.plant.parameters.items()
    }
    if isinstance(task.plant, UncertainPlant):
        table |= {f"error of {name}": (size, "") for name, size in task.plant.ranges.items()}
    for name in ("start", "target"):
        table[name] = (getattr(task, name), "rad")
    for name in ("duration", "residual_window"):
        table[name.replace("_", " ")] = (getattr(task, name), "s")
    for name, quantity in QUANTITIES.items():
        table[f"{name} limit"] = (getattr(task, quantity.limit), quantity.unit)
    return table


def _samples(task: PointToPoint) -> tuple[tuple[float, ...], ...]:
    return task.plant.samples if isinstance(task.plant, UncertainPlant) else ()


def _words(value: float | None, unit: str) -> str:
    return "none" if value is None else f"{value:.10g} {unit}".strip()


def condition_of(task: PointToPoint) -> Case | None:
    """The condition of the paper that a task is; None where it is none of them."""
    return next((c for c in CONDITIONS if not task_difference(task, c.task)), None)
