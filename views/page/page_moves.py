"""Contents of the page: moves, the motions to choose from for each, and what lies beside them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from quietarm.ocp import (
    Front,
    FrontPoint,
    Plan,
    PointToPoint,
    SolveStatus,
    evaluate_coefficients,
    task_difference,
)
from quietarm.ocp.checks import instance
from quietarm.ocp.objectives import refuse_peaks
from quietarm.ocp.rest import is_at_rest
from quietarm.ocp.simulation.mesh import default_steps
from quietarm.views.pictures import KnownPoint
from quietarm.views.report.method_rows import described, is_gradient
from quietarm.views.report.words import title_of_picture

MOST_MOTIONS = 60
"""Of a move: of a front with more points so many are chosen, evenly along it."""
Answers = Mapping[str, Front | Plan]
"""Fronts and plans by what they are called."""
KnownPoints = Callable[[PointToPoint, Collection[int]], Sequence[KnownPoint]]
"""Known points of a task's fronts with some numbers of terms."""


@dataclass(frozen=True)
class Choice:
    """A motion that can be chosen.

    Attributes
    ----------
    plan : Plan
        Its motion.
    residual, energy : float
        Residual [m] and energy [J] as its front states them; of a plan the plan's.
    price : float or None
        What a wider residual limit saves [J/m], where that is known.
    name : str
        Of a plan that stands alone; empty of a point of a front.
    """

    plan: Plan
    residual: float
    energy: float
    price: float | None = None
    name: str = ""

    @property
    def at_rest(self) -> bool:
        """Return whether the tip is at rest on arrival, or as the task asks."""
        return is_at_rest(self.residual, self.plan.task)


@dataclass(frozen=True)
class Beside:
    """Points of another method, or known ones, beside which the choices lie.

    Attributes
    ----------
    label, kind : str
        What the key calls them; `search`, `gradient`, `plan` or `known`, which says their look.
    points : tuple of (float or None, float)
        Residual [m] and energy [J]; None where a residual is not known.
    """

    label: str
    kind: str
    points: tuple[tuple[float | None, float], ...]
    meaning: str
    """Its look in the grammar of pictures."""


@dataclass(frozen=True)
class Move:
    """A move of the page: its choices by increasing residual, and the plain cycloid."""

    label: str
    task: PointToPoint
    choices: tuple[Choice, ...]
    cycloid: Plan
    method: str
    """What the key calls the choices."""
    joined: bool
    """Whether motions between the choices are known to lie on the line between them."""
    left_out: int
    """Points of the front that are not among the choices."""
    beside: tuple[Beside, ...]

    @property
    def title(self) -> str:
        """The plant, the move and its limits."""
        return title_of_picture(self.task)

    @property
    def meaning(self) -> str:
        """Meaning of the choices in the grammar of pictures: their colour says it."""
        if self.is_front and not is_gradient(self.choices[0].plan.record.method):
            return "search"
        return _plan_of(self.task)

    @property
    def motions(self) -> list[Plan]:
        """All motions that are shown, the plain cycloid last."""
        return [*(choice.plan for choice in self.choices), self.cycloid]

    @property
    def is_front(self) -> bool:
        """Return whether the choices are a front's points: each trades residual for energy."""
        return self.choices[0].name == ""


def moves_of(answers: Answers, known_points: KnownPoints | None = None) -> list[Move]:
    """Answers by their moves: of each a front that is dragged along, or its plans.

    Further fronts and plans of the same move, and known points of it, lie beside the first front.
    ValueError where a front has no point, or a move has too many plans.
    """
    fronts = {label: answer for label, answer in answers.items() if isinstance(answer, Front)}
    plans = {label: answer for label, answer in answers.items() if isinstance(answer, Plan)}
    groups = list[dict[str, Front | Plan]]()
    for label, answer in (fronts | plans).items():
        if isinstance(answer, Front) and not answer.points:
            raise ValueError(f"{label}: {answer.why_empty()}")
        if isinstance(answer, Front):
            instance("task", answer.task, PointToPoint)  # a front of a function has none
            refuse_peaks(label, answer.objectives)
        for group in groups:
            if _belong_together(next(iter(group.values())), answer):
                group[label] = answer
                break
        else:
            groups.append({label: answer})
    return [_move_of(group, known_points) for group in groups]


def move_by_hand(plan: Plan, cycloid: Plan) -> Move:
    """Show the one motion in hand, over the plain cycloid of its move."""
    name = "this motion"
    return Move(
        label=name,
        task=plan.task,
        choices=(Choice(plan, *_place(plan), name=name),),
        cycloid=cycloid,
        method=name,
        joined=False,
        left_out=0,
        beside=(),
    )


def _belong_together(first: Front | Plan, answer: Front | Plan) -> bool:
    """Return whether two answers mean the same by residual, energy and a front's limits."""
    tasks = [first.task, answer.task]
    if not (isinstance(first, Front) and isinstance(answer, Front)):
        tasks = [replace(task, bounds={}, torque_speed=None) for task in tasks]
    return not task_difference(*tasks)


def _move_of(group: Answers, known_points: KnownPoints | None) -> Move:
    fronts = {label: answer for label, answer in group.items() if isinstance(answer, Front)}
    plans = {label: answer for label, answer in group.items() if isinstance(answer, Plan)}
    label = next(iter(group))
    if not fronts:
        return _move_of_plans(label, plans)
    first, *_ = fronts
    front = fronts.pop(first)
    points = _along(front.points)
    method = front.record.method
    beside = [_beside_front(further) for further in fronts.values()]
    meaning = _plan_of(front.task)
    beside += [Beside(name, "plan", (_place(plan),), meaning) for name, plan in plans.items()]
    if known_points:
        beside += [
            Beside(point.label, "known", ((point.residual, point.energy),), "paper")
            for point in known_points(front.task, [front.profile.size])
        ]
    return Move(
        label=label,
        task=front.task,
        choices=tuple(_choice(front, point) for point in points),
        cycloid=evaluate_coefficients(front.task, []),
        method=described(method),
        joined=is_gradient(method) and not front.gaps,
        left_out=len(front.points) - len(points),
        beside=tuple(beside),
    )


def _move_of_plans(label: str, plans: Mapping[str, Plan]) -> Move:
    if len(plans) > MOST_MOTIONS:
        raise ValueError(
            f"{len(plans)} plans of one move are given, of which a page shows {MOST_MOTIONS} at "
            "most; give fewer"
        )
    choices = [Choice(plan, *_place(plan), name=name) for name, plan in plans.items()]
    task = choices[0].plan.task
    return Move(
        label=label,
        task=task,
        choices=tuple(sorted(choices, key=lambda choice: (choice.residual, choice.energy))),
        cycloid=evaluate_coefficients(task, []),
        method="plan" if len(plans) == 1 else "plans",
        joined=False,
        left_out=0,
        beside=(),
    )


def _place(plan: Plan) -> tuple[float, float]:
    return plan.residual, plan.energy


def _choice(front: Front, point: FrontPoint) -> Choice:
    plan = Plan(
        task=front.task,
        profile=front.profile,
        coefficients=point.coefficients,
        status=SolveStatus.NOT_OPTIMISED,
        record=front.record,
        steps=default_steps(front.task),
    )
    return Choice(plan, point.residual, point.energy, point.shadow_prices.get("residual"))


def _beside_front(front: Front) -> Beside:
    method = front.record.method
    places = tuple((point.residual, point.energy) for point in _along(front.points))
    if is_gradient(method):
        return Beside(described(method), "gradient", places, _plan_of(front.task))
    return Beside(described(method), "search", places, "search")


def _plan_of(task: PointToPoint) -> str:
    """Return the meaning of a task's plan in the grammar of pictures."""
    return "robust plan" if task.ranges else "plan"


def _along(points: Sequence[FrontPoint]) -> list[FrontPoint]:
    """Return at most so many points as are shown, evenly along the front, its ends among them."""
    if len(points) <= MOST_MOTIONS:
        return list(points)
    places = np.array([(point.residual, point.energy) for point in points])
    spans = np.ptp(places, axis=0)
    steps = np.abs(np.diff(places, axis=0) / np.where(spans > 0, spans, 1.0)).sum(axis=1)
    length = np.append(0.0, np.cumsum(steps))
    wanted = np.linspace(0.0, length[-1], MOST_MOTIONS)
    nearest = {int(np.abs(length - place).argmin()) for place in wanted}
    return [points[place] for place in sorted(nearest)]
