"""What the paper prints: conditions, coefficients and energies of its Tables 1 to 6."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import cache
from math import pi

from quietarm.metaheuristics import PAPER_BOX, PRESETS
from quietarm.metaheuristics.spread import SEARCH_RESIDUAL
from quietarm.models import ArmOnFlexibleLink, Plant, SingleLinkManipulator
from quietarm.ocp import Plan, PointToPoint, evaluate_coefficients, task_difference
from quietarm.studies.figures import KnownPoint

SINGLE_LINK, ARM = SingleLinkManipulator(), ArmOnFlexibleLink()
_OF_PLANT = {SINGLE_LINK.name: ("vepso", 23, "network"), ARM.name: ("nsga2-paper", 24, "Gaussians")}
"""The paper's search, sections 3.1 and 3.2, and the earlier study, sections 1 and 3: its reference,
and its input of the cycloid."""


@dataclass(frozen=True)
class Case:
    """A driving condition of the paper: a move, and the box that its coefficients stay in."""

    task: PointToPoint
    label: str

    @property
    def bound(self) -> float:
        """Largest absolute coefficient, eqs (12) and (17)."""
        return PAPER_BOX[self.task.plant.name]

    @property
    def name(self) -> str:
        """Plant and move."""
        return f"{self.task.plant.name}, {self.label}"

    @property
    def search(self) -> str:
        """The paper's search for its plant."""
        return _OF_PLANT[self.task.plant.name][0]

    @property
    def search_label(self) -> str:
        """What texts call it."""
        return PRESETS[self.search].label

    @property
    def earlier(self) -> tuple[int, str]:
        """The earlier study of its plant: reference, and input of the cycloid."""
        return _OF_PLANT[self.task.plant.name][1:]


def _condition(plant: Plant, start: float, target: float, duration: float, label: str) -> Case:
    """A driving condition: start and target [rad], duration [s]."""
    return Case(PointToPoint(plant, target, duration, start), label)


SINGLE_LINK_SIXTH = _condition(SINGLE_LINK, 0.0, pi / 6, 0.8, "0 to pi/6, 0.8 s")
SINGLE_LINK_HALF_1_0 = _condition(SINGLE_LINK, 0.0, pi / 2, 1.0, "0 to pi/2, 1.0 s")
SINGLE_LINK_HALF_1_1 = _condition(SINGLE_LINK, 0.0, pi / 2, 1.1, "0 to pi/2, 1.1 s")
ARM_HALF = _condition(ARM, 0.0, pi / 2, 0.8, "0 to pi/2, 0.8 s")
ARM_THREE_QUARTERS = _condition(ARM, -pi / 2, pi / 4, 1.0, "-pi/2 to pi/4, 1.0 s")
ARM_WHOLE = _condition(ARM, -pi / 2, pi / 2, 1.2, "-pi/2 to pi/2, 1.2 s")
STUDIED = (SINGLE_LINK_SIXTH, ARM_HALF)
"""The conditions whose number of terms the paper varies: its Figs 2 and 5."""

COEFFICIENTS: dict[tuple[Case, int], tuple[float, ...]] = {
    (SINGLE_LINK_SIXTH, 2): (3.347e-3, -1.697e-1),
    (SINGLE_LINK_SIXTH, 4): (-1.690e-3, -1.367e-1, -1.951e-2, -1.971e-1),
    (SINGLE_LINK_SIXTH, 6): (-1.889e-3, -1.427e-1, -4.247e-2, -1.187e-1, 4.800e-2, -1.890e-1),
    (ARM_HALF, 2): (-1.023e-1, -4.365e-1),
    (ARM_HALF, 4): (-9.583e-2, -3.350e-1, 2.090e-1, -2.854e-1),
    (ARM_HALF, 6): (-9.346e-2, -3.488e-1, 1.989e-1, -1.515e-1, -2.993e-1, -2.377e-1),
}
"""Tables 1 and 4, as printed."""

MENDED: dict[tuple[Case, int], tuple[float, ...]] = {
    (ARM_HALF, 6): (-9.346e-2, -3.488e-1, 1.989e-1, -1.515e-1, -2.993e-2, -2.377e-1),
}
"""Table 4, N = 6, with the exponent of a_5 mended: only this reproduces Table 5's 0.149 J."""


@dataclass(frozen=True)
class Row:
    """A row of Tables 2, 3, 5 or 6: energies [J]."""

    table: int
    condition: Case
    terms: int
    energy: float
    earlier_energy: float | None = None


ROWS: tuple[Row, ...] = (
    Row(2, SINGLE_LINK_SIXTH, 2, 6.29e-2),
    Row(2, SINGLE_LINK_SIXTH, 4, 5.26e-2),
    Row(2, SINGLE_LINK_SIXTH, 6, 5.15e-2),
    Row(3, SINGLE_LINK_SIXTH, 6, 5.15e-2, 6.30e-2),
    Row(3, SINGLE_LINK_HALF_1_0, 6, 2.96e-1, 4.21e-1),
    Row(3, SINGLE_LINK_HALF_1_1, 6, 2.23e-1, 3.52e-1),
    Row(5, ARM_HALF, 2, 2.09e-1),
    Row(5, ARM_HALF, 4, 1.65e-1),
    Row(5, ARM_HALF, 6, 1.49e-1),
    Row(6, ARM_HALF, 6, 1.49e-1, 2.00e-1),
    Row(6, ARM_THREE_QUARTERS, 6, 1.43e-1, 1.55e-1),
    Row(6, ARM_WHOLE, 6, 2.00e-1, 2.22e-1),
)
SIX = tuple(row for row in ROWS if row.earlier_energy is not None)
"""Tables 3 and 6: a row for each driving condition."""
CONDITIONS: tuple[Case, ...] = tuple(row.condition for row in SIX)
"""The six driving conditions of these tables."""


def condition_of(task: PointToPoint) -> Case | None:
    """The condition of the paper that a task is; None where it is none of them."""
    return next((c for c in CONDITIONS if not task_difference(task, c.task)), None)


def paper_points(task: PointToPoint, terms: Collection[int]) -> list[KnownPoint]:
    """The paper's own points for a task."""
    condition = condition_of(task)
    printed = {row.terms: row for row in ROWS if row.condition is condition}
    points = list[KnownPoint]()
    for number in sorted(printed.keys() & set(terms)):
        plan, name = paper_plan(printed[number].condition, number), f"paper, N = {number}"
        points.append(
            KnownPoint(f"{name}: energy as printed", None, printed[number].energy)
            if plan is None else KnownPoint(name, plan.residual, plan.energy)
        )  # fmt: skip
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
