"""A move that is changed by hand, and the numbers by which that is done."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil, degrees, floor, log10, pi, tau
from pathlib import Path
from typing import Any, NamedTuple

import msgspec

from quietarm.metaheuristics import PAPER_BOX
from quietarm.models import Plant, known_plants
from quietarm.models.dimensions import WAY
from quietarm.models.joint_motion import LINEAR, ROTARY
from quietarm.ocp import (
    CycloidPolynomial,
    Front,
    JointProfile,
    Plan,
    PointToPoint,
    Solver,
    Sqp,
    epsilon_front,
    evaluate_coefficients,
    plan_move,
)
from quietarm.ocp.checks import unknown
from quietarm.ocp.escapes import one_line
from quietarm.ocp.limits import QUANTITIES, quantities_of
from quietarm.ocp.planning.named_profiles import families, profile_of
from quietarm.ocp.task import OF_MOVES
from quietarm.ocp.told_progress import Progress, no_report
from quietarm.ocp.window import default_window
from quietarm.views.explore.move_library import Library
from quietarm.views.formats.formats import export_plan
from quietarm.views.report.words import plant_words, raised

FRONT_POINTS = 20
"""Enough for a line, within a second."""
MOST_TERMS = 60
"""Of a profile that is asked for: a motion of so many still takes a fraction of a second."""
_FARTHEST = 100.0
"""A coefficient that is typed, on either side of 0; sliders begin with a range that makes sense."""
_SHORTEST = 0.1
_LONGEST = 5.0
_FURTHEST = 2.0
_TENTH = 0.1
"""To which the range of coefficients is rounded up, where one is outside of the bounds."""
_USUAL_BOX = 0.2
"""The paper's for the single link."""
_LEAST = 1e-3
_MOST = 1e4
"""Ranges of durations [s], of a linear axis [m], and of limits in the unit that is shown."""
_STEPS = 500
"""Steps of a slider, at least."""
_SHOWN = {"rad": ("deg", degrees(1.0)), "m": ("mm", 1e3)}
"""Units that are shown in the place of SI's, and the factors to them."""
FILES: Mapping[str, Callable[[Plan, Path], object]] = {
    "plan.json": Plan.save,
    "move.csv": export_plan,
    "move.c": export_plan,
    "move.h": lambda plan, path: export_plan(plan, path.with_suffix(".c")),
}
"""What can be downloaded, and what writes it."""


class Question(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A question of the page, beside the move that it began with.

    Attributes
    ----------
    plant, profile : str
        The words of a plant of the menu and the name of a profile; empty for those of the start.
    terms : int or None
        How many terms the profile has; None for its usual number.
    values : dict of str to float or None
        Dials that were set, in the units that are shown; None sets a limit free.
    optimal : bool
        Whether the gradient's motion of this move is asked for.
    point : int or None
        A point of this move's front, by its number from 0.
    """

    plant: str = ""
    profile: str = ""
    terms: int | None = None
    values: dict[str, float | None] = {}
    optimal: bool = False
    point: int | None = None


class Dial(NamedTuple):
    """A number that is set by hand: its range in the unit that is shown, the factor to that."""

    label: str
    least: float
    most: float
    factor: float
    group: str
    """Where it stands: move, shape or limits; these may be empty."""

    @property
    def step(self) -> float:
        """Step of a slider by an arrow key."""
        return float(10 ** floor(log10((self.most - self.least) / _STEPS)))

    def held(self, shown: float) -> float:
        """Return a value within the range; of a coefficient also beyond it, as it is typed."""
        if self.group == "shape":
            return min(max(shown, -_FARTHEST), _FARTHEST)
        return min(max(shown, self.least), self.most)


@dataclass(frozen=True, eq=False)
class MoveByHand:
    """A move with the motion in hand; every change gives another one.

    Attributes
    ----------
    task, profile, coefficients
        The motion in hand.
    residual_limit, bound : float or None
        What the gradient is asked for beside the task's limits [m]; the largest coefficient.
    library : Library or None
        Where coefficients are looked up when the move is changed; without one they stay.
    front : Front or None
        The front of this move, where it is known.
    plan : Plan or None
        The motion as its method gave it; evaluated by CVODES where there is none.
    begun : PointToPoint or None
        The move of the start, from which the dials have their ranges.
    solver : Solver
        What finds the gradient's motion and the front.
    """

    task: PointToPoint
    profile: JointProfile
    coefficients: Sequence[float]
    residual_limit: float | None = None
    bound: float | None = None
    library: Library | None = None
    front: Front | None = None
    plan: Plan | None = None
    begun: PointToPoint | None = None
    solver: Solver = Sqp()

    @classmethod
    def of_plan(cls, plan: Plan, **more: Any) -> MoveByHand:
        """Take the motion of a plan in hand."""
        return cls(plan.task, plan.profile, plan.coefficients, plan=plan, **more)

    @cached_property
    def motion(self) -> Plan:
        """The plan in hand, with the figures of CVODES."""
        if self.plan is not None:
            return self.plan
        return evaluate_coefficients(self.task, self.coefficients, profile=self.profile)

    @property
    def family(self) -> str:
        """The name of the profile's family; its label where it has none."""
        kinds: dict[Any, str] = {kind: name for name, kind in families().items()}
        return kinds.get(type(self.profile), self.profile.label)

    @cached_property
    def coefficient_names(self) -> list[str]:
        """The names of the dials of the coefficients."""
        return [f"a{number}" for number in range(1, len(self.coefficients) + 1)]

    def reach_of(self, coefficient: float) -> float:
        """Return how far a slider goes on either side of 0: the bound, or more if it is beyond.

        The box is the bound that the gradient is asked for, the profile's own or the paper's. A
        coefficient at its end is given room: else its slider could go one way alone.
        """
        of_profile = self.profile.default_bound
        box = self.bound or of_profile or PAPER_BOX.get(self.task.plant.name, _USUAL_BOX)
        room = 0.02  # of a coefficient: so far at least is the end of its slider
        if (1 + room) * abs(coefficient) <= box:
            return box
        tenths = ceil((1 + room) * abs(coefficient) / _TENTH)
        return max(box, float(f"{tenths * _TENTH:.6g}"))

    @cached_property
    def dials(self) -> dict[str, Dial]:
        """All dials by name."""
        reaches = map(self.reach_of, self.coefficients)
        return {
            **{name: _dial("move", name, *end) for name, end in self._ends().items()},
            **{
                name: _dial("shape", name, "-", -reach, reach)
                for name, reach in zip(self.coefficient_names, reaches)
            },
            **{name: _dial("limits", *limit) for name, limit in self._limits().items()},
        }

    def _ends(self) -> dict[str, tuple[str, float, float]]:
        """Unit and range in SI of what a move has; along a path it has no ends of its own."""
        task = self.begun or self.task
        joint = self.task.plant.joint
        way = tau if joint == ROTARY else max(_FURTHEST, abs(task.start), abs(task.target))
        ends = dict.fromkeys(OF_MOVES, (WAY.of(joint), -way, way))
        if self.task.plant.has_path:
            ends = {}
        ends["duration"] = "s", min(_SHORTEST, task.duration), max(_LONGEST, task.duration)
        for axis in self.library.grid.axes if self.library else ():
            ends[axis.name] = axis.unit, axis.values[0], axis.values[-1]
        return ends

    def _limits(self) -> dict[str, tuple[str, str]]:
        """Label and unit of what can be limited."""
        joint = self.task.plant.joint
        tip_unit = self.task.plant.tip_unit
        limits = {
            quantity.limit: (str(quantity.words), raised(str(quantity.unit)))
            for quantity in quantities_of(joint, tip_unit).values()
        }
        return limits | {"residual_limit": ("residual", tip_unit), "bound": ("largest |a_n|", "-")}

    @cached_property
    def _values(self) -> dict[str, Any]:
        """Values of the dials in SI, None where one is empty."""
        settings = {"residual_limit": self.residual_limit, "bound": self.bound}
        coefficients = dict(zip(self.coefficient_names, self.coefficients))
        limits = {quantity.limit: None for quantity in QUANTITIES.values()}
        limits |= {QUANTITIES[name].limit: size for name, size in self.task.bounds.items()}
        known = {**self.task.plant.parameters, **vars(self.task), **limits}
        known |= {**settings, **coefficients}
        return {name: known[name] for name in self.dials}

    @cached_property
    def shown(self) -> dict[str, Any]:
        """The value of every field in the unit that is shown; a limit with two sides has none."""
        terms = getattr(self.profile, "terms", None)
        chosen = {"plant": words_of_plant(self.task.plant), "profile": self.family, "terms": terms}
        return chosen | {
            name: float(f"{value * self.dials[name].factor:.12g}")
            if isinstance(value, float | int) else None
            for name, value in self._values.items()
        }  # fmt: skip

    def asked(self, question: Question, plants: Mapping[str, Plant]) -> MoveByHand:
        """Return the move of a question, without its optimum or a point of its front.

        ValueError where there is no such move, or the library has none.
        """
        move = self
        if question.plant and question.plant != self.shown["plant"]:
            if question.plant not in plants:
                raise ValueError(unknown("plant", question.plant, plants))
            move = move.choose_plant(plants[question.plant])
        if question.profile:
            move = move.choose_profile(question.profile, question.terms)
        return move.change(question.values)

    def change(self, shown: Mapping[str, float | None]) -> MoveByHand:
        """Set some dials, in the units that are shown, each within its range.

        ValueError where there is no such move, or the library has none.
        """
        if not shown:
            return self
        values = dict(self._values)
        for name, value in shown.items():
            if name not in self.dials:
                raise ValueError(unknown("number", name, self.dials))
            dial = self.dials[name]
            if value is not None:
                values[name] = dial.held(value) / dial.factor
            elif dial.group == "limits":
                values[name] = None
        task = self.task
        coefficients = [values[name] for name in self.coefficient_names]
        if self.library:
            at = {name: values[name] for name in self.library.grid.names}
            task = self.library.task(**at)
            if shown.keys().isdisjoint(self.coefficient_names):
                coefficients = self.library.coefficients(**at).tolist()
        of_task = (*OF_MOVES, *(quantity.limit for quantity in QUANTITIES.values()))
        task = replace(task, **{name: values[name] for name in of_task if name in values})
        settings = {name: values[name] for name in ("residual_limit", "bound")}
        same = task == self.task and settings["bound"] == self.bound
        front = self.front if same else None
        return self._with(task=task, coefficients=coefficients, front=front, **settings)

    def _with(self, **changes: Any) -> MoveByHand:
        """Return another motion, which nothing has optimised."""
        return replace(self, **{"plan": None, "begun": self.begun or self.task, **changes})

    def choose_plant(self, plant: Plant) -> MoveByHand:
        """Make the same move with another plant, which begins at rest.

        The residual window is the plant's, too, unless it was given; in a file both are numbers.
        """
        if self.library:
            raise ValueError("the moves of a sweep have its plant; open another plant for itself")
        task = self.task
        window = self.task.residual_window
        by_default = default_window([(task.plant, task.target)])
        if window == by_default:
            window = by_default
        task = replace(task, plant=plant, initial=None, final=None, residual_window=window)
        return self._with(task=task, front=None)

    def choose_profile(self, name: str, terms: int | None = None) -> MoveByHand:
        """Make the same move by another profile, of its usual size by default."""
        if self.library:
            raise ValueError("the moves of a sweep have its profile; open their plant for itself")
        if name == self.family and terms in (None, getattr(self.profile, "terms", None)):
            return self._with(coefficients=plain_of(self.profile))
        if terms is not None and terms > MOST_TERMS:
            raise ValueError(
                f"{terms} terms are more than a page computes; give at most {MOST_TERMS}"
            )
        profile = profile_of(name, self.task, terms)
        return self._with(profile=profile, coefficients=plain_of(profile), front=None)

    def solve(self) -> MoveByHand:
        """Take the gradient's motion in hand; it raises what `plan_move` does."""
        settings: dict[str, Any] = {"residual_limit": self.residual_limit, "bound": self.bound}
        plan = plan_move(self.task, self.profile, solver=self.solver, **settings)
        return self._with(coefficients=plan.coefficients, plan=plan)

    def find_front(self, report: Progress = no_report) -> Front:
        """Trace the front of this move; it raises what `epsilon_front` does."""
        settings: dict[str, Any] = {"bound": self.bound, "points": FRONT_POINTS, "report": report}
        return epsilon_front(self.task, self.profile, solver=self.solver, **settings)

    def pick(self, front: Front, coefficients: Sequence[float]) -> MoveByHand:
        """Take the motion of a point of this move's front in hand."""
        now = self._with(coefficients=coefficients, front=front)
        record = front.record
        plan = now.motion.restated(method=record.method, settings=record.settings)
        return replace(now, plan=plan)

    @property
    def is_of_front(self) -> bool:
        """Return whether the motion is a point of the front."""
        return self.front is not None and self.motion.record.method == self.front.record.method

    def file(self, name: str) -> str:
        """The text of one of `FILES`."""
        if name not in FILES:
            raise ValueError(unknown("file", name, FILES))
        with tempfile.TemporaryDirectory(prefix="quietarm-") as folder:
            path = Path(folder, name)
            FILES[name](self.motion, path)
            return path.read_text(encoding="utf-8")


def _dial(group: str, label: str, unit: str, *ends: float) -> Dial:
    """Make a dial in the unit that is shown for one of SI, as its ends are; limits share ends."""
    shown, factor = _SHOWN.get(unit, (unit, 1.0))
    low, high = [factor * end for end in ends] or (_LEAST * (label != "residual"), _MOST)
    return Dial(label if unit == "-" else f"{label} [{shown}]", low, high, factor, group)


def plain_of(profile: JointProfile) -> tuple[float, ...]:
    """Return the coefficients from which the gradient starts first: a motion like the cycloid's."""
    return tuple(map(float, profile.plain))


def open_plant(plant: Plant) -> MoveByHand:
    """Take the plain cycloid of a plant in hand, with the coefficients of six terms to be set."""
    # the paper's first move, and 300 mm of a linear axis
    targets = {ROTARY: pi / 6, LINEAR: 0.3}
    duration = 0.8
    task = PointToPoint(plant, targets[plant.joint], duration)
    profile = CycloidPolynomial()
    return MoveByHand(task, profile, plain_of(profile))


def words_of_plant(plant: Plant) -> str:
    """Name a plant with its parameters, in letters that come back from the page as they are."""
    return one_line(plant_words(plant))


def menu(plant: Plant) -> dict[str, Plant]:
    """List a plant, and those of its kind of joint that have a value for every parameter, by words.

    Joints that follow a path have no other plants: their moves are along it.
    """
    plants = {words_of_plant(plant): plant}
    for kind in {} if plant.has_path else known_plants().values():
        with suppress(TypeError):  # a parameter without a value
            plant_of_kind = kind()
            if plant_of_kind.joint == plant.joint:
                plants.setdefault(words_of_plant(plant_of_kind), plant_of_kind)
    return plants
