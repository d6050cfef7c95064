"""An integer beside the coefficients: which input shaper the motion passes, or none."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import pi, tau

import casadi as ca
import numpy as np
from numpy.typing import NDArray

import quietarm as qa
from quietarm.models import Expression
from quietarm.ocp.profiles.joint_profile import Values
from quietarm.ocp.profiles.shaped_cycloid import SHAPERS, Impulses
from quietarm.ocp.simulation.free_vibration import FreeVibration

from .integers import IntegerProfile

NO_SHAPER = "none"
CHOICES = ("zv", "mzv", "zvd")
LONGEST = 0.7
"""A longer shaper, as a share of the move, leaves too little of it for the motion itself."""


@dataclass(frozen=True)
class ChosenShaper(IntegerProfile):
    """The paper's polynomial through an input shaper; the first coefficient says which, rounded.

    Parameters
    ----------
    shapers : tuple of str
        What the integers 1, 2 and so on stand for: `NO_SHAPER`, or names of `SHAPERS`. A single
        one is no choice, and the profile has no integer.
    periods : float
        Duration of the move over the undamped period of the mode that is suppressed.
    damping_ratio : float
        Of that mode.
    terms : int
        Coefficients of the polynomial.
    """

    name = "chosen-shaper"
    shapers: tuple[str, ...] = (NO_SHAPER,)
    periods: float = 2.0
    damping_ratio: float = 0.0
    terms: int = 5

    def __post_init__(self) -> None:
        object.__setattr__(self, "shapers", tuple(self.shapers))  # a file has a list

    @property
    def size(self) -> int:
        """The coefficients, and the integer where there is a choice."""
        return self.terms + (self.most > 1)

    @property
    def most(self) -> int:
        """The number of shapers."""
        return len(self.shapers)

    def alone(self, number: int) -> ChosenShaper:
        """The polynomial through one shaper."""
        chosen = (self.shapers[number - 1],)
        return ChosenShaper(chosen, self.periods, self.damping_ratio, self.terms)

    @property
    def plain(self) -> NDArray[np.float64]:
        """The cycloid through the first shaper."""
        return np.append(np.ones(int(self.most > 1)), np.zeros(self.terms))

    def box(self, bound: float | None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The coefficients' box is that of every shaper."""
        lower, upper = qa.CycloidPolynomial(self.terms).box(bound)
        if self.most == 1:
            return lower, upper
        return np.append(0.51, lower), np.append(self.most + 0.49, upper)

    @property
    def impulses(self) -> list[Impulses]:
        """Impulses of each shaper, whose times are shares of the move; all have as many."""
        shapers = [impulses_of(name, self.periods, self.damping_ratio) for name in self.shapers]
        count = max(len(shaper.times) for shaper in shapers)
        return [
            Impulses(
                shaper.amplitudes + (0.0,) * (count - len(shaper.times)),
                shaper.times + shaper.times[-1:] * (count - len(shaper.times)),
            )
            for shaper in shapers
        ]

    def breaks(self, duration: float) -> tuple[float, ...]:
        """Shares of the move at which a polynomial of any shaper begins or ends."""
        del duration
        begins = {begin for shaper in self.impulses for begin in shaper.times}
        ends = {begin + 1 - shaper.times[-1] for shaper in self.impulses for begin in shaper.times}
        apart = 1e-9
        places = sorted(place for place in begins | ends if apart < place < 1 - apart)
        return tuple(place for before, place in pairwise([0.0, *places]) if place - before > apart)

    def angle(self, coefficients: Values, fraction: Expression) -> Expression:
        """Sum of the polynomials that begin at the impulses of the chosen shaper."""
        of_polynomial = coefficients[self.size - self.terms :]
        polynomial = qa.CycloidPolynomial(self.terms)
        number = ca.floor(coefficients[0] + 0.5) if self.most > 1 else 1
        shapers = self.impulses

        def chosen(values: list[float]) -> Expression:
            return sum((number == place) * value for place, value in enumerate(values, start=1))

        length = chosen([shaper.times[-1] for shaper in shapers])
        angle = 0 * fraction
        for i in range(len(shapers[0].times)):
            begin = chosen([shaper.times[i] for shaper in shapers])
            part = (fraction - begin) / (1 - length)
            part = ca.if_else(ca.logic_and(part >= 0, part <= 1), part, part > 1)
            share = chosen([shaper.amplitudes[i] for shaper in shapers])
            angle += share * polynomial.angle(of_polynomial, part)
        return angle


def impulses_of(name: str, periods: float, damping_ratio: float) -> Impulses:
    """Impulses of a shaper in a move of so many periods; times are shares of the move."""
    if name == NO_SHAPER:
        return Impulses((1.0,), (0.0,))
    return SHAPERS[name](tau * periods, damping_ratio)


def chosen_shaper(task: qa.PointToPoint, terms: int) -> ChosenShaper:
    """The shapers of `CHOICES` that leave enough of a task's move, and none.

    They suppress the plant's lowest mode at the target.
    """
    frequency, damping_ratio = min(FreeVibration(task.plant, task.target).modes)
    periods = task.duration * frequency / (2 * pi)
    fitting = [
        name for name in CHOICES if impulses_of(name, periods, damping_ratio).times[-1] <= LONGEST
    ]
    return ChosenShaper((NO_SHAPER, *fitting), periods, damping_ratio, terms)
