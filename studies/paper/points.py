"""The paper's own motions for a task, where the task is one of its conditions."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from ocp import PointToPoint, evaluate_coefficients
from studies.paper.printed import COEFFICIENTS, MENDED, ROWS
from studies.paper.tasks import condition_of


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
