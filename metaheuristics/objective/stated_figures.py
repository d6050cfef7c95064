"""Whether the figures that a file states are those of its motions; what it does not is skipped."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from quietarm.metaheuristics.objective.population import objectives_of
from quietarm.ocp import Front, Plan
from quietarm.ocp.checks import table_of
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.front.points import refuse_beyond_box
from quietarm.ocp.limits import quantities_of
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.ocp.record import AGREEMENT, REST
from quietarm.ocp.robustness import worst_of
from quietarm.ocp.simulation.evaluator import Evaluator

FIGURES = (("residual", "m", REST), ("energy", "J", 0.0))
"""Name and unit of both objectives, and the difference within which they always agree."""
Array = NDArray[np.float64]
T = TypeVar("T", float, Array)


def agrees(stated: T, gives: T, least: float | Array) -> Any:
    """Whether a stated figure is what a motion gives, element by element; what is NaN is not."""
    return abs(stated - gives) <= AGREEMENT * abs(gives) + least


def check_figures(front: Front, name: str, remedy: str = "find the front again") -> None:
    """Evaluate motions of a front again, and refuse it where the figures differ."""
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
        point = front.points[i]
        _refuse_other_figures(which, (point.residual, point.energy), figures)
        for limit, passed in zip(front.task.limits, violations):
            if not passed <= OVERRUN:
                raise ValueError(
                    f"{which} breaks the {limit.label} limit of {limit.bounds}: its coefficients "
                    f"give {limit.describe(limit.size * (1 + passed))}"
                )


def _check_entries(front: Front) -> None:
    """The same of the candidates that a search found; a front of another method has none."""
    entries = front.entries
    if not len(entries):
        return
    if entries.candidates[-1] > front.record.evaluations:
        raise ValueError(
            f"it states candidate {entries.candidates[-1]} of {front.record.evaluations}"
        )
    table = table_of(entries.coefficients, front.profile.size)
    _check_box(front, table)
    for i, figures, _ in _evaluated_again(front, table):
        which = f"candidate {entries.candidates[i]}"
        _refuse_other_figures(
            which,
            (entries.residuals[i], entries.energies[i]),
            figures,
        )


def _evaluated_again(front: Front, table: Array) -> Iterator[tuple[int, Array, Array]]:
    """Some rows of coefficients: which, residual and energy, and violations of the limits."""
    # points that are evaluated again: as many as one call takes. An edit or a conversion rarely
    # leaves all of these as they were
    sample = 100
    count = len(table)
    if not count:
        return
    places = np.unique(
        np.linspace(
            0,
            count - 1,
            min(count, sample),
        )
        .round()
        .astype(int)
    )
    with np.errstate(all="ignore"):  # coefficients of any size: what overflows is refused
        evaluation = Evaluator(front.task, front.profile)(table[places])
        figures = objectives_of(evaluation)
        violations = evaluation.violations
    yield from zip(places.tolist(), figures, violations)


def _refuse_other_figures(which: str, stated: tuple[float, float], figures: Array) -> None:
    for (name, unit, least), states, gives in zip(FIGURES, stated, figures):
        if not agrees(states, gives, least):
            words = f"{gives:.4g} {unit}" if np.isfinite(gives) else "no finite figure"
            raise ValueError(
                f"{which} states {name} {states:.4g} {unit}, but its coefficients give {words}"
            )


def check_plan(plan: Plan, name: str) -> None:
    """Evaluate the motion of a plan again, and refuse the plan where the figures differ.

    A peak that the file does not state, as of a quantity that is newer, is skipped.
    """
    try:
        motion = plan.candidate.motion
        _check_worst(plan, name)
    except SolverFailedError as error:
        raise SolverFailedError(f"{name}: {error}") from None
    known = quantities_of(plan.task.plant.joint, plan.task.plant.tip_unit)
    peaks = ((name, quantity.unit, 0.0) for name, quantity in known.items())
    for figure, unit, least in (*FIGURES, *peaks):
        stated = plan.motion.peak(figure)
        gives = motion.peak(figure)
        if figure in known and not plan.motion.states(figure):
            continue
        if stated != gives and not (np.isfinite(gives) and agrees(stated, gives, least)):
            figure = f"peak {figure}" if figure in known else figure
            raise ValueError(
                f"{name} states {figure} {stated:.4g} {unit}, but its coefficients give "
                f"{gives:.4g} {unit}; find the plan again"
            )


def _check_worst(plan: Plan, name: str) -> None:
    """Find the worst case of a plan for an uncertain plant again, and compare."""
    if plan.worst is None:
        return
    worst = worst_of(plan.candidate)
    stated = plan.worst.residual
    if worst is None or list(worst.errors) != list(plan.worst.errors):
        what = ", ".join(plan.worst.errors) or "none"
        raise ValueError(
            f"{name} states a worst case with errors of {what}, which its plant does not have; "
            "find the plan again"
        )
    there = plan.candidate.perturbed(plan.worst.errors)
    for gives, words in (worst.residual, ""), (there.residual, " with these errors"):
        if not agrees(stated, gives, REST):
            raise ValueError(
                f"{name} states a worst-case residual of {stated:.4g} m, but its coefficients "
                f"give {gives:.4g} m{words}; find the plan again"
            )
