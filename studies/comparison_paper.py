"""What the paper has to say of a task: its own points, where the task is one of its conditions."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from ocp import PointToPoint, evaluate_coefficients
from ocp.task import LIMITS
from studies.comparison_groups import task_difference
from studies.paper import COEFFICIENTS, MENDED, ROWS, Condition


@dataclass(frozen=True)
class PaperPoint:
    """A motion of the paper.

    Attributes
    ----------
    terms : int
        N of eq (6).
    energy : float
        F2 [J]: of the printed coefficients (a misprint mended), or as printed where there are none.
    residual : float or None
        F1 [m] of the printed coefficients; None where the paper prints none.
    """

    terms: int
    energy: float
    residual: float | None

    @property
    def label(self) -> str:
        """What it is, for a legend."""
        if self.residual is None:
            return f"paper, N = {self.terms}: energy as printed"
        return f"paper, N = {self.terms}"


def condition_of(task: PointToPoint) -> Condition | None:
    """The condition of the paper that a task is; None where it is none of them."""
    conditions = dict.fromkeys(row.condition for row in ROWS)
    return next((c for c in conditions if not task_difference(task, c.task)), None)


def paper_points(task: PointToPoint, terms: Collection[int]) -> list[PaperPoint]:
    """The paper's own points for a task.

    Parameters
    ----------
    task : PointToPoint
        The move.
    terms : collection of int
        Numbers of terms that are looked for.

    Returns
    -------
    list of PaperPoint
        None where the task is not a condition of the paper, or it has no such number of terms.
    """
    condition = condition_of(task)
    points: dict[int, PaperPoint] = {}
    for row in ROWS:
        if row.condition is not condition or row.terms not in terms or row.terms in points:
            continue
        key = (row.condition, row.terms)
        coefficients = MENDED.get(key, COEFFICIENTS.get(key))
        if coefficients is None:
            points[row.terms] = PaperPoint(row.terms, row.energy, None)
        else:
            plan = evaluate_coefficients(row.condition.task, coefficients)
            points[row.terms] = PaperPoint(row.terms, plan.energy, plan.residual)
    return list(points.values())


def title_of(task: PointToPoint) -> str:
    """A task in a line: its plant, move and duration; its limits where it has any."""
    condition = condition_of(task)
    if condition is not None:
        return f"{task.plant.name}, {condition.label}"
    limits = "".join(
        f", {name} within {value:g} {LIMITS[f'{name}_limit']}"
        for name, value in task.limits.items()
    )
    move = f"{task.start:.4g} to {task.target:.4g} rad, {task.duration:g} s"
    return f"{task.plant.name}, {move}{limits}"
