"""A move that is changed by hand, and its figures: what the page shows, without the page."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from math import ceil, degrees
from pathlib import Path
from typing import Any

from numpy.typing import ArrayLike
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
from quietarm.ocp.task import QUANTITIES
from quietarm.studies.export import export_plan
from quietarm.studies.sweep.grid import OF_MOVES
from quietarm.studies.sweep.library import MoveLibrary

OF_A_FRONT = 20
"""Points of a front: enough for a line, within a second."""
FREQUENCY = 0.2
"""Largest error of the frequency that is looked at."""
_ANGLE, _SHORTEST, _LONGEST = 360.0, 0.1, 5.0
"""Ranges of the sliders [deg, s, s]."""
_LEAST, _MOST = 1e-3, 1e4
"""Range of a limit, in the unit that is shown."""
_SHOWN = {"rad": ("deg", degrees(1.0)), "m": ("mm", 1e3)}
"""Units that are shown in the place of SI's, and the factors to them."""
FILES = ("plan.json", "move.csv", "move.c", "move.h")
"""What can be downloaded."""


@dataclass(frozen=True)
class Dial:
    """A number that is set by hand: what it is and its range, in the unit that is shown."""

    label: str
    least: float
    most: float
    factor: float = 1.0
    """From SI to this unit."""
    optional: bool = False
    """Whether it may be empty, as a limit."""

    @classmethod
    def of(cls, words: str, unit: str, least: float, most: float, optional: bool = False) -> Dial:
        """A dial in the unit that is shown for this one of SI; the range is in the shown unit."""
        shown, factor = _SHOWN.get(unit, (unit, 1.0))
        label = words if unit == "-" else f"{words} [{shown}]"
        return cls(label, least, most, factor, optional)

    def held(self, shown: float | None) -> float | None:
        """The nearest value in the range, in SI; None stays None where that may be."""
        if shown is None:
            return None if self.optional else self.least / self.factor
        return min(max(shown, self.least), self.most) / self.factor


@dataclass(frozen=True, eq=False)
class Explored:
    """A move that is changed by hand; every change gives a new one."""

    plan: Plan
    """The move and the motion in hand, with the figures of CVODES."""
    residual_limit: float | None = None
    bound: float | None = None
    """What the gradient is asked for, as by `plan_move`."""
    library: MoveLibrary | None = None
    """Where coefficients come from when the move is changed; else they stay as they are."""
    front: Front | None = None
    """The front of this move, where it was asked for."""
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

    @cached_property
    def dials(self) -> dict[str, Dial]:
        """What can be set, by name."""
        task, axes = self.task, self.library.grid.axes if self.library else ()
        longest = max(_LONGEST, task.duration)
        dials = {
            "start": Dial.of("start", "rad", -_ANGLE, _ANGLE),
            "target": Dial.of("target", "rad", -_ANGLE, _ANGLE),
            "duration": Dial.of("duration", "s", min(_SHORTEST, task.duration), longest),
        }
        for axis in axes:
            _, factor = _SHOWN.get(axis.unit, ("", 1.0))
            ends = factor * min(axis.values), factor * max(axis.values)
            dials[axis.name] = Dial.of(axis.name, axis.unit, *ends)
        for name, quantity in QUANTITIES.items():
            dials[quantity.limit] = Dial.of(name, quantity.unit, _LEAST, _MOST, optional=True)
        dials["residual_limit"] = Dial.of("residual", "m", 0.0, _MOST, optional=True)
        dials["bound"] = Dial.of("largest |a_n|", "-", _LEAST, _MOST, optional=True)
        return dials | {name: Dial(name, -self.reach, self.reach) for name in self.coefficients}

    @cached_property
    def _values(self) -> dict[str, Any]:
        """Values of the dials in SI, None where one is empty."""
        mine = {"residual_limit": self.residual_limit, "bound": self.bound, **self.coefficients}
        known = {**self.task.plant.parameters, **vars(self.task), **mine}
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

    def changed(self, shown: Mapping[str, float | None]) -> Explored:
        """The same with some dials set, each held within its range.

        It raises ValueError where there is no such move, or the library has none.
        """
        held = {name: self.dials[name].held(value) for name, value in shown.items()}
        values: dict[str, Any] = {**self._values, **held}
        coefficients: ArrayLike = [values[name] for name in self.coefficients]
        limits = {quantity.limit: values[quantity.limit] for quantity in QUANTITIES.values()}
        limits["torque_speed"] = self.task.torque_speed
        task = replace(self.task, **{name: values[name] for name in OF_MOVES}, **limits)
        method = "given coefficients"
        if self.library and not held.keys().isdisjoint(self._axes):
            at = {name: values[name] for name in self._axes}
            coefficients, method = self.library.coefficients(**at), "lookup"
            task = replace(self.library.task(**at), **limits)
        plan = evaluate_coefficients(task, coefficients, profile=self.plan.profile, method=method)
        same = task == self.task and values["bound"] == self.bound
        return replace(
            self, plan=plan, residual_limit=values["residual_limit"], bound=values["bound"],
            front=self.front if same else None,
        )  # fmt: skip

    @property
    def _axes(self) -> list[str]:
        return [axis.name for axis in self.library.grid.axes] if self.library else []

    def plain(self) -> Explored:
        """The same move with the coefficients from which the gradient starts first."""
        return self.changed(dict(zip(self.coefficients, self.plan.profile.plain, strict=True)))

    def of_plant(self, plant: Plant) -> Explored:
        """The same move and motion of another plant, which begins at rest."""
        task = replace(self.task, plant=plant, initial=None, final=None)
        plan = evaluate_coefficients(task, self.plan.coefficients, profile=self.plan.profile)
        return replace(self, plan=plan, library=None, front=None)

    def solved(self) -> Explored:
        """The same with the gradient's motion; it raises what `plan_move` does."""
        plan = plan_move(
            self.task, self.plan.profile, residual_limit=self.residual_limit, bound=self.bound
        )
        return replace(self, plan=plan)

    def with_front(self, report: Report = no_report) -> Explored:
        """The same with the front of this move; it raises what `epsilon_front` does."""
        front = epsilon_front(
            self.task, self.plan.profile, bound=self.bound, points=OF_A_FRONT, report=report
        )
        return replace(self, front=front)

    def picked(self, number: int) -> Explored:
        """The same with the motion of a point of the front, by its number from 0."""
        assert self.front is not None
        found = self.front.points[number].coefficients
        plan = evaluate_coefficients(
            self.task, found, profile=self.front.profile, method=self.front.method,
            settings=self.front.settings,
        )  # fmt: skip
        return replace(self, plan=plan)

    @property
    def of_front(self) -> bool:
        """Whether the motion is a point of the front."""
        return self.front is not None and self.plan.provenance.method == self.front.method

    @property
    def cycloid(self) -> Plan:
        """The plain cycloid of this move."""
        return _cycloid(self.task)

    @cached_property
    def robustness(self) -> Robustness:
        """What the motion leaves where the frequency is another one."""
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
