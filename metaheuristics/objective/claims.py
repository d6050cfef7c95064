"""Whether the figures that a file states are those of its motions."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics.objective.population import PopulationObjective
from quietarm.ocp import Front, JointProfile, Plan, PointToPoint
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.front.points import refuse_beyond_box
from quietarm.ocp.limits import quantities_of
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.ocp.record import AGREEMENT, REST
from quietarm.ocp.robustness import worst_of
from quietarm.ocp.simulation.grid import default_steps

_SAMPLE = 100
"""Points that are evaluated again: as many as one call takes. An edit or a conversion rarely leaves
all of these as they were."""

FIGURES = (("residual", "m", REST), ("energy", "J", 0.0))
"""Name and unit of both objectives, and the difference within which they always agree."""
T = TypeVar("T", float, NDArray[np.float64])


def agrees(stated: T, gives: T, least: float | NDArray[np.float64]) -> Any:
    """Whether a stated figure is what a motion gives, element by element; what is NaN is not."""
    return abs(stated - gives) <= AGREEMENT * abs(gives) + least


@lru_cache(maxsize=4)
def objective_of(task: PointToPoint, profile: JointProfile) -> PopulationObjective:
    """The objective at the steps that fronts are verified with; made once for a task."""
    return PopulationObjective(task, profile, steps=default_steps(task))


def check_figures(front: Front, name: str, remedy: str = "find the front again") -> None:
    """Evaluate motions of a front again, and refuse it where the figures differ."""
    if not front.points:
        return
    try:
        table = np.array([point.coefficients for point in front.points])
        refuse_beyond_box(front.profile, table, front.record.bound, remedy="")
        _check_points(front, table)
    except ValueError as error:
        raise ValueError(f"{name}: {error}; {remedy}") from None


def _check_points(front: Front, table: NDArray[np.float64]) -> None:
    """Evaluate some rows again, and refuse those that give other figures or break a limit."""
    count, limits = len(table), front.task.limits
    places = np.unique(np.linspace(0, count - 1, min(count, _SAMPLE)).round().astype(int))
    with np.errstate(all="ignore"):  # coefficients of any size: what overflows is refused below
        values = objective_of(front.task, front.profile)(table[places])
    rows = zip(places.tolist(), values.residual, values.energy, values.violations)
    for i, *both, violations in rows:
        which = f"point {i + 1} of {count}"
        for (figure, unit, least), found in zip(FIGURES, both):
            stated = getattr(front.points[i], figure)
            if not agrees(stated, found, least):
                gives = f"{found:.4g} {unit}" if np.isfinite(found) else "no finite figure"
                raise ValueError(
                    f"{which} states {figure} {stated:.4g} {unit}, but its coefficients give "
                    f"{gives}"
                )
        for limit, passed in zip(limits, violations):
            if not passed <= OVERRUN:
                raise ValueError(
                    f"{which} breaks the {limit.name} limit of {limit.bounds}: its coefficients "
                    f"give {limit.describe(limit.size * (1 + passed))}"
                )


def check_plan(plan: Plan, name: str) -> None:
    """Evaluate the motion of a plan again, and refuse the plan where the figures differ."""
    try:
        found = plan.candidate.motion
        _check_worst(plan, name)
    except SolverFailedError as error:
        raise SolverFailedError(f"{name}: {error}") from None
    known = quantities_of(plan.task.plant.joint, plan.task.plant.tip_unit)
    peaks = ((name, quantity.unit, 0.0) for name, quantity in known.items())
    for figure, unit, least in (*FIGURES, *peaks):
        stated, gives = plan.motion.peak(figure), found.peak(figure)
        if figure in known and not plan.motion.states(figure):
            continue
        if stated != gives and not agrees(stated, gives, least):
            figure = f"peak {figure}" if figure in known else figure
            raise ValueError(
                f"{name} states {figure} {stated:.4g} {unit}, but its coefficients give "
                f"{gives:.4g} {unit}; find the plan again"
            )


def _check_worst(plan: Plan, name: str) -> None:
    """Find the worst case of a plan for an uncertain plant again, and compare."""
    if plan.worst is None:
        return
    where = plan.task, plan.profile, plan.coefficients
    found, stated = worst_of(*where), plan.worst.residual
    if found is None or list(found.errors) != list(plan.worst.errors):
        what = ", ".join(plan.worst.errors) or "none"
        raise ValueError(
            f"{name} states a worst case with errors of {what}, which its plant does not have; "
            "find the plan again"
        )
    there = plan.candidate.perturbed(plan.worst.errors)
    for gives, words in (found.residual, ""), (there.residual, " with these errors"):
        if not agrees(stated, gives, REST):
            raise ValueError(
                f"{name} states a worst-case residual of {stated:.4g} m, but its coefficients "
                f"give {gives:.4g} m{words}; find the plan again"
            )
