"""An integer beside the coefficients: the number of the polynomial's terms, which share a box."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

import quietarm as qa
from quietarm.models import Expression
from quietarm.ocp.profiles.cycloid import Cycloid
from quietarm.ocp.profiles.joint_profile import Values

from .integers import IntegerProfile

SHARED = 3.0
"""Boxes that the terms share: with one, few moves come to rest, and one number is best throughout;
with three, fronts have motions of two to four numbers."""


@dataclass(frozen=True)
class SharedTerms(IntegerProfile, Cycloid):
    """The paper's polynomial; the first coefficient is the number of its terms, rounded."""

    name = "shared-terms"
    terms: int = 5

    @property
    def size(self) -> int:
        """The number and the most coefficients."""
        return 1 + self.terms

    @property
    def most(self) -> int:
        """The most terms."""
        return self.terms

    def alone(self, number: int) -> qa.CycloidPolynomial:
        """The polynomial of so many terms."""
        return qa.CycloidPolynomial(number)

    def bound_of(self, number: int, bound: float) -> float:
        """A term's share of the boxes."""
        return SHARED * bound / number

    def rows_of(self, number: int, coefficients: NDArray[np.float64]) -> NDArray[np.float64]:
        """The number, its coefficients as shares, and nothing for the terms beyond."""
        shares = coefficients * number / SHARED
        return super().rows_of(number, np.pad(shares, ((0, 0), (0, self.terms - number))))

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
