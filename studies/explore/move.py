"""A move that is changed by hand, and its figures: what the page shows, without the page."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from math import ceil, degrees
from pathlib import Path
from typing import Any, NamedTuple

from quietarm.models import Plant
from quietarm.ocp import (
    CycloidPolynomial,
    Front,
    Plan,
    PointToPoint,
    Robustness,
    epsilon_front,
    evaluate_coefficients,
    evaluate_robustness,
    plan_move,
)
from quietarm.ocp.front.curve import Report, no_report
from quietarm.ocp.limits import QUANTITIES
from quietarm.studies.export.formats import export_plan
from quietarm.studies.registry.profiles import FAMILIES, profile_of
from quietarm.studies.sweep.grid import OF_MOVES
from quietarm.studies.sweep.library import MoveLibrary

FRONT_POINTS = 20
"""Enough for a line, within a second."""
FREQUENCY = 0.2
"""Largest error of the frequency that is looked at."""
_ANGLE, _SHORTEST, _LONGEST, _LEAST, _MOST = 360.0, 0.1, 5.0, 1e-3, 1e4
"""Ranges of sliders [deg, s, s], and of limits in the unit that is shown."""
_SHOWN = {"rad": ("deg", degrees(1.0)), "m": ("mm", 1e3)}
"""Units that are shown in the place of SI's, and the factors to them."""
FILES = ("plan.json", "move.csv", "move.c", "move.h")
"""What can be downloaded."""


class Dial(NamedTuple):
    """A number that is set by hand, and its range in the unit that is shown."""

    label: str
    least: float
    most: float
    factor: float = 1.0
    """From SI to this unit."""
    optional: bool = False
    """Whether it may be empty, as a limit."""

    def clip(self, shown: float | None) -> float | None:
        """The nearest value in the range, in SI; None stays None where that may be."""
        if shown is None:
            return None if self.optional else self.least / self.factor
        return min(max(shown, self.least), self.most) / self.factor


def _dial(name: str, unit: str, least: float, most: float, optional: bool = False) -> Dial:
    """A dial in the unit that is shown for this one of SI; the range is in the shown unit."""
    shown, factor = _SHOWN.get(unit, (unit, 1.0))
    return Dial(name if unit == "-" else f"{name} [{shown}]", least, most, factor, optional)


@dataclass(frozen=True, eq=False)
class Explored:
    """A move that is changed by hand; every change gives a new one.

    The plan is the motion in hand, with the figures of CVODES; limit and bound are what the
    gradient is asked for. With a library coefficients are interpolated when the move is changed,
    else they stay. A front is that of this move, a kept plan is drawn beside the one in hand.
    """

    plan: Plan
    residual_limit: float | None = None
    bound: float | None = None
    library: MoveLibrary | None = None
    front: Front | None = None
    kept: Plan | None = None
    reach: float = 1.0
    """Range of the coefficients by hand, on either side of 0."""

    def __post_init__(self) -> None:
        furthest = max(map(abs, self.plan.coefficients), default=0.0)
        object.__setattr__(self, "reach", max(self.reach, float(ceil(furthest))))

    @property
    def task(self) -> PointToPoint:
        """The move in hand."""
        return self.plan.task

    @cached_property
    def coefficients(self) -> dict[str, float]:
        """The coefficients by the names of their dials."""
        return {f"a{i}": value for i, value in enumerate(self.plan.coefficients, start=1)}

    @property
    def profile(self) -> str:
        """The name of the profile's family; its label where it has none."""
        kinds: dict[Any, str] = {kind: name for name, kind in FAMILIES.items()}
        return kinds.get(type(self.plan.profile), self.plan.profile.label)

    @cached_property
    def dials(self) -> dict[str, Dial]:
        """What can be set, by name."""
        shortest, longest = min(_SHORTEST, self.task.duration), max(_LONGEST, self.task.duration)
        dials = {name: _dial(name, "rad", -_ANGLE, _ANGLE) for name in ("start", "target")}
        dials["duration"] = _dial("duration", "s", shortest, longest)
        for axis in self.library.grid.axes if self.library else ():
            _, factor = _SHOWN.get(axis.unit, ("", 1.0))
            ends = factor * min(axis.values), factor * max(axis.values)
            dials[axis.name] = _dial(axis.name, axis.unit, *ends)
        for name, quantity in QUANTITIES.items():
            dials[quantity.limit] = _dial(name, quantity.unit, _LEAST, _MOST, optional=True)
        dials["residual_limit"] = _dial("residual", "m", 0.0, _MOST, optional=True)
        dials["bound"] = _dial("largest |a_n|", "-", _LEAST, _MOST, optional=True)
        return dials | {name: Dial(name, -self.reach, self.reach) for name in self.coefficients}

    @cached_property
    def _values(self) -> dict[str, Any]:
        """Values of the dials in SI, None where one is empty."""
        own = {"residual_limit": self.residual_limit, "bound": self.bound, **self.coefficients}
        known = {**self.task.plant.parameters, **vars(self.task), **own}
        return {name: known[name] for name in self.dials}

    @property
    def shown(self) -> dict[str, float | None]:
        """Values of the dials in the units that are shown."""
        return {
            name: None
            if value is None or isinstance(value, tuple)  # a limit that differs by direction
            else float(f"{value * self.dials[name].factor:.12g}")
            for name, value in self._values.items()
        }

    def change(self, shown: Mapping[str, float | None]) -> Explored:
        """The same with some dials set, each within its range.

        ValueError where there is no such move, or the library has none.
        """
        clipped = {name: self.dials[name].clip(value) for name, value in shown.items()}
        values: dict[str, Any] = {**self._values, **clipped}
        coefficients: Any = [values[name] for name in self.coefficients]
        limits = {quantity.limit: values[quantity.limit] for quantity in QUANTITIES.values()}
        limits["torque_speed"] = self.task.torque_speed
        task = replace(self.task, **{name: values[name] for name in OF_MOVES}, **limits)
        axes = self.library.grid.axes if self.library else ()
        at = {axis.name: values[axis.name] for axis in axes}
        if self.library and not clipped.keys().isdisjoint(at):
            coefficients = self.library.coefficients(**at)
            task = replace(self.library.task(**at), **limits)
        same = task == self.task and values["bound"] == self.bound
        return replace(
            self._evaluate(task, coefficients), front=self.front if same else None,
            residual_limit=values["residual_limit"], bound=values["bound"],
        )  # fmt: skip

    def _evaluate(self, task: PointToPoint, coefficients: Any, **record: Any) -> Explored:
        plan = evaluate_coefficients(task, coefficients, profile=self.plan.profile, **record)
        return replace(self, plan=plan)

    def begin_again(self) -> Explored:
        """The same move with the coefficients from which the gradient starts first."""
        return self._evaluate(self.task, self.plan.profile.plain)

    def choose_plant(self, plant: Plant) -> Explored:
        """The same move and motion of another plant, which begins at rest."""
        task = replace(self.task, plant=plant, initial=None, final=None)
        changed = self._evaluate(task, self.plan.coefficients)
        return replace(changed, library=None, front=None)

    def choose_profile(self, name: str, terms: int | None = None) -> Explored:
        """The same move by another profile, of its usual size by default."""
        profile = profile_of(name, self.task, terms)
        plan = evaluate_coefficients(self.task, profile.plain, profile=profile)
        return replace(self, plan=plan, front=None, reach=1.0)

    def choose_terms(self, terms: int | None) -> Explored:
        """The same with so many terms."""
        return self.choose_profile(self.profile, terms)

    def solve(self) -> Explored:
        """The same with the gradient's motion; it raises what `plan_move` does."""
        plan = plan_move(
            self.task, self.plan.profile, residual_limit=self.residual_limit, bound=self.bound
        )
        return replace(self, plan=plan)

    def find_front(self, report: Report = no_report) -> Explored:
        """The same with the front of this move; it raises what `epsilon_front` does."""
        front = epsilon_front(
            self.task, self.plan.profile, bound=self.bound, points=FRONT_POINTS, report=report
        )
        return replace(self, front=front)

    def pick(self, number: int) -> Explored:
        """The same with the motion of a point of the front, by its number from 0."""
        assert self.front is not None
        coefficients, record = self.front.points[number].coefficients, self.front.record
        return self._evaluate(
            self.task, coefficients, method=record.method, settings=record.settings
        )

    def keep(self) -> Explored:
        """The same with this motion kept to be compared; no more where it is kept already."""
        return replace(self, kept=None if self.kept is self.plan else self.plan)

    @property
    def of_front(self) -> bool:
        """Whether the motion is a point of the front."""
        return self.front is not None and self.plan.record.method == self.front.record.method

    @property
    def cycloid(self) -> Plan:
        """The plain cycloid of this move."""
        return _cycloid(self.task)

    @cached_property
    def robustness(self) -> Robustness:
        """The residual of the motion over the error of the frequency."""
        plan, ranges = self.plan, {"frequency": FREQUENCY}
        return evaluate_robustness(self.task, plan.profile, plan.coefficients, ranges, samples=1)

    def file(self, name: str) -> str:
        """The text of one of `FILES`."""
        with tempfile.TemporaryDirectory(prefix="quietarm-") as folder:
            path = Path(folder) / name
            if name == "plan.json":
                self.plan.save(path)
            elif name == "move.csv":
                self.plan.save_csv(path)
            else:
                export_plan(self.plan, path.with_suffix(".c"))
            return path.read_text(encoding="utf-8")


@lru_cache(maxsize=8)
def _cycloid(task: PointToPoint) -> Plan:
    return evaluate_coefficients(task, [], profile=CycloidPolynomial(0))
