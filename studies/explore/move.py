"""A move that is changed by hand, and its figures: what the page shows, without the page."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from math import ceil, degrees, tau
from pathlib import Path
from typing import Any, NamedTuple

from quietarm.models import Plant
from quietarm.models.joint_motion import ROTARY, joint_unit
from quietarm.ocp import (
    CycloidPolynomial,
    Front,
    Plan,
    PointToPoint,
    epsilon_front,
    evaluate_coefficients,
    plan_move,
)
from quietarm.ocp.front.curve import Report, no_report
from quietarm.ocp.limits import quantities_of
from quietarm.studies.export.formats import export_plan
from quietarm.studies.registry.profiles import FAMILIES, profile_of
from quietarm.studies.sweep.grid import OF_MOVES
from quietarm.studies.sweep.library import MoveLibrary

FRONT_POINTS = 20
"""Enough for a line, within a second."""
_SHORTEST, _LONGEST, _FURTHEST, _LEAST, _MOST = 0.1, 5.0, 2.0, 1e-3, 1e4
"""Ranges of durations [s], of a linear axis [m], and of limits in the unit that is shown."""
_SHOWN = {"rad": ("deg", degrees(1.0)), "m": ("mm", 1e3)}
"""Units that are shown in the place of SI's, and the factors to them."""
FILES = ("plan.json", "move.csv", "move.c", "move.h")
"""What can be downloaded."""


class Dial(NamedTuple):
    """A number that is set by hand: its range in the unit that is shown, the factor to that."""

    label: str
    least: float
    most: float
    factor: float = 1.0
    optional: bool = False
    """Whether it may be empty, as a limit."""

    @classmethod
    def of(cls, name: str, unit: str, ends: tuple[float, float] | None = None) -> Dial:
        """In the unit that is shown for one of SI, as its ends are; without ends a limit."""
        shown, factor = _SHOWN.get(unit, (unit, 1.0))
        label = name if unit == "-" else f"{name} [{shown}]"
        if ends is None:
            return cls(label, 0.0 if name == "residual" else _LEAST, _MOST, factor, True)
        return cls(label, factor * ends[0], factor * ends[1], factor)


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
    opened: PointToPoint | None = None
    """The move of the first plan; its dials keep their ranges."""

    def __post_init__(self) -> None:
        furthest = max(map(abs, self.plan.coefficients), default=0.0)
        object.__setattr__(self, "reach", max(self.reach, float(ceil(furthest))))
        object.__setattr__(self, "opened", self.opened or self.task)

    @property
    def task(self) -> PointToPoint:
        """The move in hand."""
        return self.plan.task

    @property
    def profile(self) -> str:
        """The name of the profile's family; its label where it has none."""
        kinds: dict[Any, str] = {kind: name for name, kind in FAMILIES.items()}
        return kinds.get(type(self.plan.profile), self.plan.profile.label)

    @cached_property
    def coefficients(self) -> dict[str, float]:
        """The coefficients by the names of their dials."""
        return {f"a{i}": value for i, value in enumerate(self.plan.coefficients, start=1)}

    @cached_property
    def dials(self) -> dict[str, Dial]:
        """What can be set, by name."""
        task, joint = self.opened or self.task, self.task.plant.joint
        way = tau if joint == ROTARY else max(_FURTHEST, abs(task.start), abs(task.target))
        angle, time = joint_unit("rad", joint), task.duration
        ends = dict.fromkeys(OF_MOVES, (angle, (-way, way)))
        ends["duration"] = "s", (min(_SHORTEST, time), max(_LONGEST, time))
        for axis in self.library.grid.axes if self.library else ():
            ends[axis.name] = axis.unit, (axis.values[0], axis.values[-1])
        limits = {one.limit: (one.name, one.unit) for one in quantities_of(joint).values()}
        limits |= {"residual_limit": ("residual", "m"), "bound": ("largest |a_n|", "-")}
        return (
            {name: Dial.of(name, *one) for name, one in ends.items()}
            | {name: Dial.of(*one) for name, one in limits.items()}
            | {name: Dial(name, -self.reach, self.reach) for name in self.coefficients}
        )

    @cached_property
    def _values(self) -> dict[str, Any]:
        """Values of the dials in SI, None where one is empty."""
        own = {"residual_limit": self.residual_limit, "bound": self.bound, **self.coefficients}
        known = {**self.task.plant.parameters, **vars(self.task), **own}
        return {name: known[name] for name in self.dials}

    @property
    def shown(self) -> dict[str, float | None]:
        """Values of the dials in the units that are shown; a limit of two sides shows none."""
        return {
            name: float(f"{value * self.dials[name].factor:.12g}")
            if isinstance(value, float | int) else None
            for name, value in self._values.items()
        }  # fmt: skip

    def change(self, shown: Mapping[str, float | None]) -> Explored:
        """The same with some dials set, in the units that are shown, each within its range.

        ValueError where there is no such move, or the library has none.
        """
        values = dict(self._values)
        for name, value in shown.items():
            dial = self.dials[name]
            if value is not None:
                values[name] = min(max(value, dial.least), dial.most) / dial.factor
            elif dial.optional:
                values[name] = None
        at = {name: values[name] for name in (self.library.grid.names if self.library else ())}
        if self.library and not shown.keys().isdisjoint(at):
            task, coefficients = self.library.task(**at), self.library.coefficients(**at)
        else:
            ends = {name: values[name] for name in OF_MOVES}
            task, coefficients = replace(self.task, **ends), [values[a] for a in self.coefficients]
        limits = {name: value for name, value in values.items() if name in _LIMITS}
        task = replace(task, **limits, torque_speed=self.task.torque_speed)
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
        return replace(self._evaluate(task, self.plan.coefficients), library=None, front=None)

    def choose_profile(self, name: str, terms: int | None = None) -> Explored:
        """The same move by another profile, of its usual size by default."""
        profile = profile_of(name, self.task, terms)
        plan = evaluate_coefficients(self.task, profile.plain, profile=profile)
        return replace(self, plan=plan, front=None, reach=1.0)

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


_LIMITS = tuple(quantity.limit for quantity in quantities_of(ROTARY).values())


@lru_cache(maxsize=8)
def _cycloid(task: PointToPoint) -> Plan:
    return evaluate_coefficients(task, [], profile=CycloidPolynomial(0))
