"""Where tasks differ, which are the paper's, and the paper's own motions for them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from math import isclose

from quietarm.metaheuristics.ensemble import SEARCH_RESIDUAL
from quietarm.ocp import Plan, PointToPoint, evaluate_coefficients
from quietarm.ocp.task.quantities import QUANTITIES
from quietarm.studies.paper.printed import COEFFICIENTS, CONDITIONS, MENDED, ROWS, Case

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
    if not words and one.plant.error_samples != other.plant.error_samples:
        words.append("its samples within the errors are others")
    return ", ".join(words)


def _quantities(task: PointToPoint) -> dict[str, tuple[float | None, str]]:
    table: dict[str, tuple[float | None, str]] = {
        f"plant parameter {name}": (value, "") for name, value in task.plant.parameters.items()
    }
    table |= {f"error of {name}": (size, "") for name, size in task.errors.items()}
    for name in ("start", "target"):
        table[name] = (getattr(task, name), "rad")
    for name in ("duration", "residual_window"):
        table[name.replace("_", " ")] = (getattr(task, name), "s")
    for name, quantity in QUANTITIES.items():
        table[f"{name} limit"] = (getattr(task, quantity.limit), quantity.unit)
    return table


def _words(value: float | None, unit: str) -> str:
    return "none" if value is None else f"{value:.10g} {unit}".strip()


def condition_of(task: PointToPoint) -> Case | None:
    """The condition of the paper that a task is; None where it is none of them."""
    return next((c for c in CONDITIONS if not task_difference(task, c.task)), None)


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
