"""What the paper prints: conditions, coefficients and energies of its Tables 1 to 6; its motions.

And the move of a third plant that its group published elsewhere. May import `registry`, `display`.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from math import isclose, pi

from quietarm.metaheuristics import PAPER_BOX
from quietarm.metaheuristics.ensemble import SEARCH_RESIDUAL
from quietarm.models import ArmOnFlexibleLink, DualLinkManipulator, Plant, SingleLinkManipulator
from quietarm.ocp import Plan, PointToPoint, evaluate_coefficients
from quietarm.ocp.checks import positive
from quietarm.ocp.limits import TORQUE_SPEED
from quietarm.studies.registry.methods import NSGA2, VEPSO


@dataclass(frozen=True)
class Case:
    """A task and the box that its coefficients stay in."""

    task: PointToPoint
    bound: float | None = None
    label: str = ""

    def __post_init__(self) -> None:
        bound = PAPER_BOX.get(self.task.plant.name) if self.bound is None else self.bound
        if bound is None:
            raise ValueError(
                f"give a bound on the coefficients: the paper has none for {self.task.plant.name}"
            )
        object.__setattr__(self, "bound", positive("bound on the coefficients", bound))

    @property
    def name(self) -> str:
        """Plant and move."""
        return f"{self.task.plant.name}, {self.label}"


SINGLE_LINK, ARM = SingleLinkManipulator(), ArmOnFlexibleLink()


def _condition(plant: Plant, start: float, target: float, duration: float, label: str) -> Case:
    """A driving condition: start and target [rad], duration [s]; in its plant's box."""
    return Case(PointToPoint(plant, target, duration, start), label=label)


SINGLE_LINK_SIXTH = _condition(SINGLE_LINK, 0.0, pi / 6, 0.8, "0 to pi/6, 0.8 s")
SINGLE_LINK_HALF_1_0 = _condition(SINGLE_LINK, 0.0, pi / 2, 1.0, "0 to pi/2, 1.0 s")
SINGLE_LINK_HALF_1_1 = _condition(SINGLE_LINK, 0.0, pi / 2, 1.1, "0 to pi/2, 1.1 s")
ARM_HALF = _condition(ARM, 0.0, pi / 2, 0.8, "0 to pi/2, 0.8 s")
ARM_THREE_QUARTERS = _condition(ARM, -pi / 2, pi / 4, 1.0, "-pi/2 to pi/4, 1.0 s")
ARM_WHOLE = _condition(ARM, -pi / 2, pi / 2, 1.2, "-pi/2 to pi/2, 1.2 s")

DUAL_LINK_HALF = Case(
    PointToPoint(DualLinkManipulator(), pi / 2, 0.9), bound=0.5, label="0 to pi/2, 0.9 s"
)
"""Not of this paper: docs/physics.md, 'A third plant'; the box is this project's."""

PAPER_SEARCH = {SINGLE_LINK.name: VEPSO, ARM.name: NSGA2}
"""The paper's search for each plant: sections 3.1 and 3.2."""

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


EARLIER: dict[str, tuple[int, str]] = {
    SINGLE_LINK.name: (23, "network"),
    ARM.name: (24, "Gaussians"),
}
"""The earlier study of each plant: its reference, and what it moves the joint with, by a name of
`quietarm.studies.registry.profiles.OTHERS`; sections 1 and 3."""


@dataclass(frozen=True)
class Row:
    """A row of Tables 2, 3, 5 or 6."""

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

CONDITIONS: tuple[Case, ...] = tuple(dict.fromkeys(row.condition for row in ROWS))
"""The six driving conditions of these tables."""


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
    lines = [task.limit_of(TORQUE_SPEED) for task in (one, other)]
    if lines[0] != lines[1]:
        words.append("torque-speed line is {}, not {}".format(*(x and x.bounds for x in lines)))
    if one.energy != other.energy:
        words.append(f"energy is {one.energy.label}, not {other.energy.label}")
    if not words and one.scenarios != other.scenarios:
        words.append("its samples within the errors are others")
    return ", ".join(words)


def _quantities(task: PointToPoint) -> dict[str, tuple[float | None, str]]:
    table: dict[str, tuple[float | None, str]] = {
        f"plant parameter {name}": (value, "") for name, value in task.plant.parameters.items()
    }
    table |= {f"error of {name}": (size, "") for name, size in task.ranges.items()}
    for name in ("start", "target"):
        table[name] = (getattr(task, name), "rad")
    for name in ("duration", "residual_window"):
        table[name.replace("_", " ")] = (getattr(task, name), "s")
    for limit in task.limits:
        unit = limit.quantity.unit
        table[f"{limit.name} limit"] = (limit.upper, unit)
        table |= {} if limit.both_ways else {f"least {limit.name}": (limit.lower, unit)}
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
