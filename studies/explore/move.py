"""A move that is changed by hand, and its figures: what the page shows, without the page."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil, degrees, tau
from pathlib import Path
from typing import Any, NamedTuple

from quietarm.metaheuristics import PAPER_BOX
from quietarm.models import Plant
from quietarm.models.dimensions import WAY
from quietarm.models.joint_motion import ROTARY
from quietarm.ocp import Front, Plan, PointToPoint, epsilon_front, evaluate_coefficients, plan_move
from quietarm.ocp.front.tradeoff import Progress, no_report
from quietarm.ocp.limits import QUANTITIES, quantities_of
from quietarm.ocp.planning.named_profiles import families, profile_of
from quietarm.ocp.window import default_window
from quietarm.studies.sweep.library import MoveLibrary
from quietarm.studies.sweep.move_grid import OF_MOVES
from quietarm.views.formats.formats import export_plan
from quietarm.views.report.words import moved, raised

FRONT_POINTS = 20
"""Enough for a line, within a second."""
_SHORTEST = 0.1
_LONGEST = 5.0
_FURTHEST = 2.0
_TENTH = 0.1
"""To which the range of coefficients is rounded up, where one is outside of the box."""
_USUAL_BOX = 0.2
"""The paper's for the single link."""
_LEAST = 1e-3
_MOST = 1e4
"""Ranges of durations [s], of a linear axis [m], and of limits in the unit that is shown."""
_SHOWN = {"rad": ("deg", degrees(1.0)), "m": ("mm", 1e3)}
"""Units that are shown in the place of SI's, and the factors to them."""
FILES: Mapping[str, Callable[[Plan, Path], object]] = {
    "plan.json": Plan.save,
    "move.csv": Plan.save_csv,
    "move.c": export_plan,
    "move.h": lambda plan, path: export_plan(plan, path.with_suffix(".c")),
}
"""What can be downloaded, and what writes it."""


class Dial(NamedTuple):
    """A number that is set by hand: its range in the unit that is shown, the factor to that."""

    label: str
    least: float
    most: float
    factor: float
    group: str
    """Where it stands: move, shape or limits; these may be empty."""


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
    reach: tuple[float, ...] = ()
    """Range of every coefficient by hand, on either side of 0: the box, or more where it is beyond
    that or at its edge."""
    opened: PointToPoint | None = None
    """The move of the first plan; its dials keep their ranges."""

    def __post_init__(self) -> None:
        before = self.reach or (0.0,) * len(self.plan.coefficients)
        pairs = zip(before, self.plan.coefficients, strict=True)
        reach = tuple(max(range_before, self._range(value)) for range_before, value in pairs)
        object.__setattr__(self, "reach", reach)
        object.__setattr__(self, "opened", self.opened or self.task)

    def _range(self, coefficient: float) -> float:
        """The bound that the gradient is asked for, the profile's own or the paper's; or more.

        A coefficient at its end is given room: else its handle could go one way alone.
        """
        of_profile = self.plan.profile.default_bound
        box = self.bound or of_profile or PAPER_BOX.get(self.plan.task.plant.name, _USUAL_BOX)
        room = 0.02  # of a coefficient: so far at least is the end of its slider
        if (1 + room) * abs(coefficient) <= box:
            return box
        tenths = ceil((1 + room) * abs(coefficient) / _TENTH)
        return max(box, float(f"{tenths * _TENTH:.6g}"))

    @property
    def task(self) -> PointToPoint:
        """The move in hand."""
        return self.plan.task

    @property
    def profile(self) -> str:
        """The name of the profile's family; its label where it has none."""
        kinds: dict[Any, str] = {kind: name for name, kind in families().items()}
        return kinds.get(type(self.plan.profile), self.plan.profile.label)

    @cached_property
    def coefficients(self) -> dict[str, float]:
        """The coefficients by the names of their dials."""
        return {f"a{i}": value for i, value in enumerate(self.plan.coefficients, start=1)}

    @cached_property
    def dials(self) -> dict[str, Dial]:
        """What can be set, by name."""
        task = self.opened or self.task
        joint = self.task.plant.joint
        tip_unit = task.plant.tip_unit
        way = tau if joint == ROTARY else max(_FURTHEST, abs(task.start), abs(task.target))
        ends = dict.fromkeys(OF_MOVES, (WAY.of(joint), -way, way))
        ends["duration"] = "s", min(_SHORTEST, task.duration), max(_LONGEST, task.duration)
        for axis in self.library.grid.axes if self.library else ():
            ends[axis.name] = axis.unit, axis.values[0], axis.values[-1]
        quantities = quantities_of(joint, tip_unit).values()
        limits = {
            quantity.limit: (str(quantity.words), raised(str(quantity.unit)))
            for quantity in quantities
        }
        limits |= {"residual_limit": ("residual", tip_unit), "bound": ("largest |a_n|", "-")}
        return {
            **{name: _dial("move", name, *end) for name, end in ends.items()},
            **{
                name: _dial("shape", name, "-", -reach, reach)
                for name, reach in zip(self.coefficients, self.reach, strict=True)
            },
            **{name: _dial("limits", *limit) for name, limit in limits.items()},
        }

    @cached_property
    def _values(self) -> dict[str, Any]:
        """Values of the dials in SI, None where one is empty."""
        settings = {"residual_limit": self.residual_limit, "bound": self.bound, **self.coefficients}
        limits = {quantity.limit: None for quantity in QUANTITIES.values()}
        limits |= {QUANTITIES[name].limit: size for name, size in self.task.bounds.items()}
        known = {**self.task.plant.parameters, **vars(self.task), **limits, **settings}
        return {name: known[name] for name in self.dials}

    @cached_property
    def shown(self) -> dict[str, Any]:
        """What stands in every field, in the units that are shown; a limit of two sides is none."""
        terms = getattr(self.plan.profile, "terms", None)
        chosen = {"plant": moved(self.task), "profile": self.profile, "terms": terms}
        return chosen | {
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
            elif dial.group == "limits":
                values[name] = None
        task = self.task
        coefficients = [values[name] for name in self.coefficients]
        if self.library:
            at = {name: values[name] for name in self.library.grid.names}
            task = self.library.task(**at)
            if not shown.keys().isdisjoint(at):
                coefficients = self.library.coefficients(**at).tolist()
        task = replace(task, **{name: values[name] for name in _OF_TASK})
        settings = {name: values[name] for name in ("residual_limit", "bound")}
        same_bound = values["bound"] == self.bound
        same = task == self.task and same_bound
        reach = self.reach if same_bound else ()
        front = self.front if same else None
        return self._moved(task, coefficients, front=front, reach=reach, **settings)

    def _moved(
        self, task: PointToPoint, coefficients: Any, profile: Any = None, **options: Any
    ) -> Explored:
        """The same with another motion, which nothing has optimised."""
        plan = evaluate_coefficients(task, coefficients, profile=profile or self.plan.profile)
        return replace(self, plan=plan, **options)

    def begin_again(self) -> Explored:
        """The same move with the coefficients from which the gradient starts first."""
        return self._moved(self.task, self.plan.profile.plain)

    def choose_plant(self, plant: Plant) -> Explored:
        """The same move and motion of another plant, which begins at rest.

        The residual window is the plant's, too, unless it was given; in a file both are numbers.
        """
        task = self.task
        window = self.task.residual_window
        by_default = default_window([(task.plant, task.target)])
        if window == by_default:
            window = by_default
        task = replace(task, plant=plant, initial=None, final=None, residual_window=window)
        return self._moved(task, self.plan.coefficients, library=None, front=None)

    def choose_profile(self, name: str, terms: int | None = None) -> Explored:
        """The same move by another profile, of its usual size by default."""
        profile = profile_of(name, self.task, terms)
        return self._moved(self.task, profile.plain, profile, front=None, reach=())

    def solve(self) -> Explored:
        """The same with the gradient's motion; it raises what `plan_move` does."""
        settings: dict[str, Any] = {"residual_limit": self.residual_limit, "bound": self.bound}
        return replace(self, plan=plan_move(self.task, self.plan.profile, **settings))

    def find_front(self, report: Progress = no_report) -> Explored:
        """The same with the front of this move; it raises what `epsilon_front` does."""
        settings: dict[str, Any] = {"bound": self.bound, "points": FRONT_POINTS, "report": report}
        return replace(self, front=epsilon_front(self.task, self.plan.profile, **settings))

    def pick(self, number: int) -> Explored:
        """The same with the motion of a point of the front, by its number from 0."""
        assert self.front is not None
        picked = self.front.points[number]
        record = self.front.record
        now = self._moved(self.task, picked.coefficients)
        plan = now.plan.restated(method=record.method, settings=record.settings)
        return replace(now, plan=plan)

    def keep(self) -> Explored:
        """The same with this motion kept to be compared; no more where it is kept already."""
        return replace(self, kept=None if self.kept is self.plan else self.plan)

    @property
    def of_front(self) -> bool:
        """Whether the motion is a point of the front."""
        return self.front is not None and self.plan.record.method == self.front.record.method

    def file(self, name: str) -> str:
        """The text of one of `FILES`."""
        with tempfile.TemporaryDirectory(prefix="quietarm-") as folder:
            path = Path(folder, name)
            FILES[name](self.plan, path)
            return path.read_text(encoding="utf-8")


_OF_TASK = (*OF_MOVES, *(quantity.limit for quantity in QUANTITIES.values()))


def _dial(group: str, label: str, unit: str, *ends: float) -> Dial:
    """In the unit that is shown for one of SI, as its ends are; those of limits are the same."""
    shown, factor = _SHOWN.get(unit, (unit, 1.0))
    low, high = [factor * end for end in ends] or (_LEAST * (label != "residual"), _MOST)
    return Dial(label if unit == "-" else f"{label} [{shown}]", low, high, factor, group)
