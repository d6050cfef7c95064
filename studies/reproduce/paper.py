"""Values that the paper prints: conditions, coefficients and energies of its Tables 1 to 6."""

from __future__ import annotations

import csv
from collections.abc import Collection
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from math import pi
from pathlib import Path

from quietarm.metaheuristics import PAPER_BOX, PRESETS
from quietarm.metaheuristics.spread import SEARCH_RESIDUAL
from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
from quietarm.ocp import Plan, PointToPoint, evaluate_coefficients, task_difference
from quietarm.ocp.window import EQ_11
from quietarm.views.pictures import KnownPoint
from quietarm.views.report.words import counted

_PLANTS = {plant.name: plant for plant in (SingleLinkManipulator(), ArmOnFlexibleLink())}
_OF_PLANT = {
    "single-link": ("vepso", (23, "network")),
    "arm-on-flexible-link": ("nsga2-paper", (24, "Gaussians")),
}
"""The paper's search, sections 3.1 and 3.2, and the earlier study, sections 1 and 3: its reference,
and its input of the cycloid."""


@dataclass(frozen=True)
class Case:
    """A driving condition of the paper: a move, its search, and the earlier study of its plant."""

    task: PointToPoint
    label: str
    search: str
    earlier: tuple[int, str]

    @property
    def bound(self) -> float:
        """Largest absolute coefficient, eqs (12) and (17)."""
        return PAPER_BOX[self.task.plant.name]

    @property
    def name(self) -> str:
        """Plant and move."""
        return f"{self.task.plant.name}, {self.label}"

    @property
    def search_label(self) -> str:
        """Label of its search in texts."""
        return PRESETS[self.search].label


@dataclass(frozen=True)
class PaperRow:
    """A row of Tables 2, 3, 5 or 6: energies [J]."""

    table: int
    condition: Case
    terms: int
    energy: float
    earlier_energy: float | None = None


@cache
def _case(plant: str, start: str, target: str, duration: str) -> Case:
    """A driving condition: start and target as pi/6, duration [s]."""
    move = _angle(target), float(duration), _angle(start)
    task = PointToPoint(_PLANTS[plant], *move, residual_window=EQ_11)
    return Case(task, f"{start} to {target}, {duration} s", *_OF_PLANT[plant])


def _angle(text: str) -> float:
    """An angle [rad] as 0, -pi/6 or 3pi/4."""
    before, _, after = text.partition("pi")
    share = Fraction({"": "1", "-": "-1"}.get(before, before) + after)
    return pi * share.numerator / share.denominator


def _row(cells: dict[str, str]) -> PaperRow:
    case = _case(cells["plant"], cells["start"], cells["target"], cells["duration"])
    earlier = float(cells["earlier"]) if cells["earlier"] else None
    return PaperRow(
        int(cells["table"]),
        case,
        int(cells["terms"]),
        float(cells["energy"]),
        earlier,
    )


with Path(__file__).with_name("printed.csv").open(encoding="utf-8") as _file:
    _PRINTED = [(_row(cells), cells) for cells in csv.DictReader(_file)]
ROWS: tuple[PaperRow, ...] = tuple(row for row, _ in _PRINTED)
SIX = tuple(row for row in ROWS if row.earlier_energy is not None)
"""Tables 3 and 6: a row for each driving condition."""
CONDITIONS: tuple[Case, ...] = tuple(row.condition for row in SIX)
"""The six driving conditions of these tables."""
SINGLE_LINK_SIXTH, SINGLE_LINK_HALF_1_0, SINGLE_LINK_HALF_1_1, *_OF_ARM = CONDITIONS
ARM_HALF, ARM_THREE_QUARTERS, ARM_WHOLE = _OF_ARM
STUDIED = (SINGLE_LINK_SIXTH, ARM_HALF)
"""The conditions whose number of terms the paper varies: its Figs 2 and 5."""
COEFFICIENTS, MENDED = (
    {
        (row.condition, row.terms): tuple(map(float, cells[column].split()))
        for row, cells in _PRINTED
        if cells[column]
    }
    for column in ("coefficients", "mended")
)
"""Tables 1 and 4, as printed, by condition and number of terms; and Table 4, N = 6, with the
exponent of a_5 mended: only this reproduces Table 5's 0.149 J."""


def condition_of(task: PointToPoint) -> Case | None:
    """The condition of the paper that a task is, within any window; None where it is none."""
    task = replace(task, residual_window=EQ_11)
    return next((c for c in CONDITIONS if not task_difference(task, c.task)), None)


def paper_points(task: PointToPoint, terms: Collection[int]) -> list[KnownPoint]:
    """The paper's own points for a task, within its residual window."""
    condition = condition_of(task)
    printed = {row.terms: row for row in ROWS if row.condition is condition}
    points = list[KnownPoint]()
    for number in sorted(printed.keys() & set(terms)):
        plan = paper_plan(printed[number].condition, number)
        name = f"the paper's best ({counted(number, 'term')})"
        points.append(
            KnownPoint(f"{name}: energy as printed", None, printed[number].energy)
            if plan is None
            else KnownPoint(name, plan.on(task).residual, plan.energy)
        )
    return points


@cache
def paper_plan(case: Case, terms: int, mended: bool = True) -> Plan | None:
    """The printed coefficients evaluated, a misprint mended; None where the paper prints none."""
    coefficients = COEFFICIENTS.get((case, terms))
    if mended:
        coefficients = MENDED.get((case, terms), coefficients)
    return None if coefficients is None else evaluate_coefficients(case.task, coefficients)


def residual_level(case: Case, terms: int) -> float:
    """Residual [m] at which a search is judged: that of the paper's coefficients for the plant."""
    same_plant = [c for c, n in COEFFICIENTS if (c.task.plant, n) == (case.task.plant, terms)]
    plan = paper_plan(case, terms) or next((paper_plan(c, terms) for c in same_plant), None)
    return SEARCH_RESIDUAL if plan is None else plan.residual
