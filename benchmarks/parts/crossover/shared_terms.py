"""An integer beside the coefficients: the number of the polynomial's terms, which share a box."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
from numpy.typing import NDArray

import quietarm as qa
from quietarm.metaheuristics.methods.gradient_methods import gradient_front
from quietarm.metaheuristics.named_method import NamedMethod
from quietarm.models import Expression
from quietarm.ocp.front.points import LEVELS, Mark
from quietarm.ocp.profiles.cycloid import Cycloid
from quietarm.ocp.profiles.joint_profile import Values

SHARED = 3.0
"""Boxes that the terms share: with one, few moves come to rest, and one number is best throughout;
with three, fronts have motions of two to four numbers."""


@dataclass(frozen=True)
class SharedTerms(Cycloid):
    """The paper's polynomial; the first coefficient is the number of its terms, rounded."""

    name = "shared-terms"
    terms: int = 5

    @property
    def size(self) -> int:
        """The number and the most coefficients."""
        return 1 + self.terms

    @property
    def plain(self) -> NDArray[np.float64]:
        """The cycloid."""
        return np.append(1.0, np.zeros(self.terms))

    def box(self, bound: float | None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Every number has the same share of the box."""
        lower, upper = qa.CycloidPolynomial(self.terms).box(bound)
        return np.append(0.51, lower), np.append(self.terms + 0.49, upper)

    def input(self, coefficients: Values, fraction: Expression) -> Expression:
        """U of as many terms, each the smaller the more there are."""
        number = ca.floor(coefficients[0] + 0.5)
        shares = [
            (place <= number) * SHARED * coefficient / number
            for place, coefficient in enumerate(coefficients[1:], start=1)
        ]
        return qa.CycloidPolynomial(self.terms).input(shares, fraction)


def front_of_every_number(task: qa.PointToPoint, terms: int, bound: float, points: int) -> qa.Front:
    """The gradient's fronts of all numbers as one front, whose effort is that of all of them."""
    fronts = [
        gradient_front(
            task,
            qa.CycloidPolynomial(number),
            NamedMethod("epsilon"),
            bound=SHARED * bound / number,
            seed=0,
            settings={"points": points},
        )
        for number in range(1, terms + 1)
    ]
    efforts = [front.history[-1] for front in fronts]
    effort = Mark(
        sum(mark.evaluations for mark in efforts),
        seconds=sum(mark.seconds for mark in efforts),
        gradients=sum(mark.gradients for mark in efforts),
        hessians=sum(mark.hessians for mark in efforts),
    )
    return replace(merged(task, terms, bound, fronts), history=(effort,))


def scale_of_every_number(task: qa.PointToPoint, terms: int, bound: float) -> qa.Front:
    """The quick front that fixes a problem's scale."""
    fronts = [
        qa.epsilon_front(
            task,
            qa.CycloidPolynomial(number),
            bound=SHARED * bound / number,
            points=40,
            at=LEVELS,
            starts=12,
        )
        for number in range(1, terms + 1)
    ]
    return merged(task, terms, bound, fronts)


def merged(task: qa.PointToPoint, terms: int, bound: float, fronts: Sequence[qa.Front]) -> qa.Front:
    """Fronts of one term, two and so on as one front."""
    rows = list[NDArray[np.float64]]()
    for number, front in enumerate(fronts, start=1):
        shares = np.clip(front.coefficients * number / SHARED, -bound, bound)
        padded = np.pad(shares, ((0, 0), (0, terms - number)))
        rows.append(np.column_stack([np.full(len(padded), number), padded]))
    return qa.Front.from_coefficients(
        task, np.vstack(rows), method="epsilon", profile=SharedTerms(terms), bound=bound
    )
