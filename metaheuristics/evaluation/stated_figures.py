"""Check that the figures that a file states are those of its motions."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from quietarm.metaheuristics.evaluation.population import figures_of_motions
from quietarm.ocp import Front, JudgedMotion, Plan
from quietarm.ocp.checks import quoted, table_of
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.figures import ENERGY, FIGURES
from quietarm.ocp.front.function_front import FunctionFront
from quietarm.ocp.front.points import refuse_beyond_box
from quietarm.ocp.joint_words import peak_words
from quietarm.ocp.limits import RESIDUAL
from quietarm.ocp.objectives import Objective, objectives_on
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.ocp.record import AGREEMENT
from quietarm.ocp.rest import rest_of
from quietarm.ocp.task import PointToPoint

PEAK_AGREEMENT = 0.02
"""The share by which a peak may differ: the steps of a search see it at their nodes alone, which
miss up to 1.4 % of it in the boxes of the named problems."""
Array = NDArray[np.float64]
T = TypeVar("T", float, Array)


def agrees(stated: T, gives: T, least: float | Array) -> Any:
    """Return whether stated figures are those of a motion, element by element; NaN is not."""
    return abs(stated - gives) <= AGREEMENT * abs(gives) + least


def check_figures(front: Front, name: str, remedy: str = "find the front again") -> None:
    """Evaluate motions of a front again, and refuse it where the figures differ."""
    if isinstance(front, FunctionFront):  # what it states a function gave, which is not here
        return
    try:
        _check_box(front, front.coefficients)
        _check_points(front)
        _check_entries(front)
    except ValueError as error:
        raise ValueError(f"{name}: {error}; {remedy}") from None


def _check_box(front: Front, table: Array) -> None:
    if len(table):
        refuse_beyond_box(front.profile, table, front.record.bound, remedy="")


def _check_points(front: Front) -> None:
    """Evaluate some points again, and refuse those that give other figures or break a limit."""
    count = len(front.points)
    for i, figures, violations in _evaluated_again(front, front.coefficients):
        which = f"point {i + 1} of {count}"
        _refuse_other_figures(which, front, front.objective_values[i], figures)
        for limit, passed in zip(front.task.limits, violations):
            if not passed <= OVERRUN:
                row = np.asarray(front.coefficients)[i]
                motion = JudgedMotion.of_profile(front.task, front.profile, row)
                raise ValueError(
                    f"{which} breaks the {limit.label} limit of {limit.bounds}: its coefficients "
                    f"give {peak_words(limit, motion, OVERRUN)}"
                )


def _check_entries(front: Front) -> None:
    """Check the figures of the candidates that a search found; other fronts have none."""
    entries = front.entries
    if not len(entries):
        return
    if entries.candidates[-1] > front.record.evaluations:
        raise ValueError(
            f"it states candidate {entries.candidates[-1]} of {front.record.evaluations}"
        )
    table = table_of(entries.coefficients, front.profile.size)
    _check_box(front, table)
    stated = entries.objectives()
    for i, figures, _ in _evaluated_again(front, table):
        which = f"candidate {entries.candidates[i]}"
        _refuse_other_figures(which, front, stated[i], figures)


def _evaluated_again(front: Front, table: Array) -> Iterator[tuple[int, Array, Array]]:
    """Some rows of coefficients: which, their objectives, and violations of the limits."""
    # points that are evaluated again: as many as one call takes. An edit or a conversion rarely
    # leaves all of these as they were
    sample = 100
    count = len(table)
    if not count:
        return
    spread = np.linspace(0, count - 1, min(count, sample))
    places = np.unique(spread.round().astype(int))
    with np.errstate(all="ignore"):  # coefficients of any size: what overflows is refused
        figures, violations = figures_of_motions(front, table[places])
    yield from zip(places.tolist(), figures, violations)


def _refuse_other_figures(which: str, front: Front, stated: Array, figures: Array) -> None:
    objectives = objectives_on(front.task.plant, front.objectives)
    for objective, states, gives in zip(objectives, stated, figures):
        if not agrees(states, gives, _least_of(objective, front, gives)):
            unit = objective.unit
            name = objective.name.replace("_", " ")
            words = f"{gives:.4g} {unit}" if np.isfinite(gives) else "no finite figure"
            raise ValueError(
                f"{which} states {name} {states:.4g} {unit}, but its coefficients give {words}"
            )


def _least_of(objective: Objective, front: Front, gives: float) -> float:
    """The difference within which an objective always agrees [its unit]."""
    if objective.name == ENERGY:
        return front.task.energy.agreement * abs(gives)
    if objective.quantity:
        return PEAK_AGREEMENT * abs(gives)
    return rest_of(front.task)


def always_agrees_within(name: str, task: PointToPoint) -> float:
    """The difference of a figure from what a file states that is never held against it."""
    return rest_of(task) if name == RESIDUAL else FIGURES[name].agreement


def check_plan(plan: Plan, path: Path) -> None:
    """Hold what the file of a plan states against its motion.

    ValueError where a figure is another, or not known here; SolverFailedError where the motion has
    none.
    """
    stated = Plan.stated_by(path)
    figures = plan.figures
    try:
        _ = figures[ENERGY], figures[RESIDUAL]
    except SolverFailedError as error:
        raise SolverFailedError(f"{path}: {error}") from None
    for name, states in stated.items():
        if name not in FIGURES:
            raise ValueError(
                f"{path} states {quoted(name)}, which is no figure here; import the file that "
                "defines it first, or name it by --plant-file"
            )
        gives = figures.get(name)
        if gives is not None and agrees(states, gives, always_agrees_within(name, plan.task)):
            continue
        unit = FIGURES[name].unit_on(plan.task.plant)
        words = "none" if gives is None else f"{gives:.4g} {unit}"
        raise ValueError(
            f"{path} states {name.replace('_', ' ')} {states:.4g} {unit}, but its coefficients "
            f"give {words}; find the plan again"
        )
