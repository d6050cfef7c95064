"""Objectives that a front weighs against each other: residual, energy, and peaks on the way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from quietarm.models import Plant
from quietarm.ocp.checks import several, unknown
from quietarm.ocp.figures import ENERGY, FIGURES, Figure
from quietarm.ocp.limits import QUANTITIES, RESIDUAL
from quietarm.ocp.task import PointToPoint

RESIDUAL_AND_ENERGY = (RESIDUAL, ENERGY)
"""The objectives of every front; those of the paper."""


class Objective(NamedTuple):
    """An objective in the units of a plant.

    Attributes
    ----------
    name, unit, label : str
        Its name, SI unit, and what it is in words.
    column : str
        Its column in tables.
    quantity : str
        The quantity whose peak it is; empty of residual and energy.
    """

    name: str
    unit: str
    label: str
    column: str
    quantity: str = ""


def known_objectives() -> dict[str, Figure]:
    """Every objective by its name, in the order in which fronts have them: figures of steps."""
    figures = FIGURES.items()
    return {
        name: figure for name, figure in figures if name in RESIDUAL_AND_ENERGY or figure.quantity
    }


def checked_objectives(names: Sequence[str]) -> tuple[str, ...]:
    """Names of objectives in the order of `known_objectives`.

    A name may be spelt with hyphens, as on the command line. ValueError where one is not known,
    stands twice, or residual or energy is not among them.
    """
    spelt = [
        _spelt(name) for name in several("objectives", names, "names, such as ['residual', ...]")
    ]
    for name in spelt:
        if name not in known_objectives():
            offered = [known.replace("_", "-") for known in known_objectives()]
            raise ValueError(unknown("objective", name.replace("_", "-"), offered))
        if spelt.count(name) > 1:
            raise ValueError(f"the objective {name.replace('_', '-')} is given twice; give it once")
    for name in RESIDUAL_AND_ENERGY:
        if name not in spelt:
            words = ", ".join(spelt).replace("_", "-") or "none"
            raise ValueError(
                f"objectives are {words}, without the {name}; give residual, energy and those "
                "beside them"
            )
    return tuple(name for name in known_objectives() if name in spelt)


def refuse_more_objectives(name: str, objectives: Sequence[str]) -> None:
    """Refuse a method of the gradient that is for residual and energy alone."""
    if name != "epsilon" and tuple(objectives) != RESIDUAL_AND_ENERGY:
        raise ValueError(
            f"{name} is for residual and energy alone, not for {len(objectives)} objectives; give "
            "epsilon, or a search"
        )


def refuse_peaks(what: str, objectives: Sequence[str]) -> None:
    """Refuse a front with peaks among its objectives, for a page that has no place for them."""
    if tuple(objectives) != RESIDUAL_AND_ENERGY:
        typed = ", ".join(objectives).replace("_", "-")
        raise ValueError(
            f"{what} has the objectives {typed}, and the page has residual and energy; give a "
            "front of these"
        )


def _spelt(name: Any) -> str:
    return name.strip().lower().replace("-", "_") if isinstance(name, str) else repr(name)


def peak_quantities(objectives: Sequence[str]) -> tuple[str, ...]:
    """The quantities whose peaks are objectives, in their order."""
    quantities = (FIGURES[name].quantity for name in objectives)
    return tuple(quantity for quantity in quantities if quantity)


def objectives_on(plant: Plant, names: Sequence[str]) -> tuple[Objective, ...]:
    """Objectives in a plant's units."""
    return tuple(_on(plant, FIGURES[name]) for name in names)


def _on(plant: Plant, figure: Figure) -> Objective:
    unit = figure.unit.on(plant.joint, plant.tip_unit)
    label = f"{figure.label} {figure.symbol}"
    if figure.quantity:
        label = f"peak {QUANTITIES[figure.quantity].label.of(plant.joint)}"
    column = f"{figure.name}_{unit.spelt('', '_per_', str, '_or_')}"
    return Objective(figure.name, str(unit), label, column, figure.quantity)


def with_peaks_measured(task: PointToPoint, quantities: Sequence[str]) -> PointToPoint:
    """A task whose simulation has the peaks of these quantities as well.

    A quantity without a limit gets 1 of its unit: it is to be measured, and not to be kept.
    ValueError where a limit of the task differs by direction, so that it is of no single peak.
    """
    limited = {limit.name: limit for limit in task.limits}
    for name in quantities:
        if name in limited and not limited[name].is_peak:
            raise ValueError(
                f"{limited[name]} differs by direction, so that its peak is no objective; give "
                "one number"
            )
    more = {name: 1.0 for name in quantities if name not in limited}
    return replace(task, bounds={**task.bounds, **more}) if more else task
