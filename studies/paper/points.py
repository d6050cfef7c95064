"""The paper's own motions for a task, where the task is one of its conditions."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from quietarm.metaheuristics.ensemble import SEARCH_RESIDUAL
from quietarm.ocp import Plan, PointToPoint, evaluate_coefficients
from quietarm.studies.paper.case import Case
from quietarm.studies.paper.printed import COEFFICIENTS, MENDED, ROWS
from quietarm.studies.paper.tasks import condition_of


@dataclass(frozen=True)
class PaperPoint:
    """A motion of the paper."""

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
    """The paper's own points for a task."""
    condition = condition_of(task)
    points: list[PaperPoint] = []
    printed = {row.terms: row for row in ROWS if row.condition is condition}
    for number, row in printed.items():
        if number in terms:
            plan = paper_plan(row.condition, number)
            energy, residual = (row.energy, None) if plan is None else (plan.energy, plan.residual)
            points.append(PaperPoint(number, energy, residual))
    return points


def paper_plan(case: Case, terms: int) -> Plan | None:
    """The printed coefficients evaluated, a misprint mended; None where the paper prints none."""
    key = (case, terms)
    coefficients = MENDED.get(key, COEFFICIENTS.get(key))
    return None if coefficients is None else evaluate_coefficients(case.task, coefficients)


def residual_level(case: Case, terms: int) -> float:
    """Residual at which a search is judged."""
    same_plant = (c for c, n in COEFFICIENTS if (c.task.plant, n) == (case.task.plant, terms))
    printed = case if (case, terms) in COEFFICIENTS else next(same_plant, None)
    plan = None if printed is None else paper_plan(printed, terms)
    return SEARCH_RESIDUAL if plan is None else plan.residual
