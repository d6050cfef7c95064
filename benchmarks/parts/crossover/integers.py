"""An integer beside the coefficients: what it chooses, and who takes each of its values in turn."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

import quietarm as qa
from quietarm.metaheuristics import search
from quietarm.metaheuristics.methods.gradient_methods import gradient_front
from quietarm.metaheuristics.named_method import NamedMethod
from quietarm.ocp.front.points import Mark
from quietarm.ocp.profiles.joint_profile import JointProfile


class IntegerProfile(JointProfile):
    """A profile whose first coefficient is an integer, rounded: 1 to `most`."""

    @property
    @abstractmethod
    def most(self) -> int:
        """The largest integer."""

    @abstractmethod
    def alone(self, number: int) -> JointProfile:
        """The profile of one integer, whose coefficients are numbers alone."""

    def bound_of(self, number: int, bound: float) -> float:
        """Bound of the coefficients of one integer."""
        del number
        return bound

    def rows_of(self, number: int, coefficients: NDArray[np.float64]) -> NDArray[np.float64]:
        """Coefficients of one integer's profile as those of this one."""
        return np.column_stack([np.full(len(coefficients), number), coefficients])


def front_of_every_number(
    task: qa.PointToPoint, profile: IntegerProfile, bound: float, points: int
) -> qa.Front:
    """The gradient's fronts of all numbers as one front, whose effort is that of all of them."""
    fronts = [
        gradient_front(
            task,
            profile.alone(number),
            NamedMethod("epsilon"),
            bound=profile.bound_of(number, bound),
            seed=0,
            settings={"points": points},
        )
        for number in range(1, profile.most + 1)
    ]
    return with_effort_of_all(merged(task, profile, bound, fronts), fronts)


def search_of_every_number(
    task: qa.PointToPoint,
    profile: IntegerProfile,
    bound: float,
    method: str,
    budget: int,
    seed: int,
) -> qa.Front:
    """A method's fronts of all numbers as one front, each with an equal part of the budget."""
    rehearsal = 20  # candidates: what is compiled first is no part of the effort

    def front_of(number: int, evaluations: int) -> qa.Front:
        return search(
            task,
            profile.alone(number),
            algorithm=method,
            bound=profile.bound_of(number, bound),
            evaluations=evaluations,
            seed=seed,
        )

    fronts = list[qa.Front]()
    for number in range(1, profile.most + 1):
        front_of(number, rehearsal)
        fronts.append(front_of(number, budget // profile.most))
    return with_effort_of_all(merged(task, profile, bound, fronts, method), fronts)


def with_effort_of_all(front: qa.Front, fronts: Sequence[qa.Front]) -> qa.Front:
    """A front with the effort of several as its only mark."""
    efforts = [each.history[-1] for each in fronts]
    effort = Mark(
        sum(mark.evaluations for mark in efforts),
        seconds=sum(mark.seconds for mark in efforts),
        gradients=sum(mark.gradients for mark in efforts),
        hessians=sum(mark.hessians for mark in efforts),
    )
    return replace(front, history=(effort,))


def scale_of_every_number(
    task: qa.PointToPoint, profile: IntegerProfile, bound: float, effort: Mapping[str, Any]
) -> qa.Front:
    """The quick front that fixes a problem's scale."""
    fronts = [
        qa.epsilon_front(
            task, profile.alone(number), bound=profile.bound_of(number, bound), **effort
        )
        for number in range(1, profile.most + 1)
    ]
    return merged(task, profile, bound, fronts)


def merged(
    task: qa.PointToPoint,
    profile: IntegerProfile,
    bound: float,
    fronts: Sequence[qa.Front],
    method: str = "epsilon",
) -> qa.Front:
    """Fronts of the integers 1, 2 and so on as one front."""
    rows = [
        profile.rows_of(number, front.coefficients)
        for number, front in enumerate(fronts, start=1)
        if len(front.points)
    ]
    lower, upper = profile.box(bound)
    options: Any = {"method": method, "profile": profile, "bound": bound}
    return qa.Front.from_coefficients(task, np.clip(np.vstack(rows), lower, upper), **options)
