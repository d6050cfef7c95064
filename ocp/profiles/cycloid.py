"""The cycloid of an input U(t), eqs (1)-(3) of the paper: what its shaped inputs have in common."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self

import casadi as ca
import numpy as np
from quietarm.models import Expression, JointMotion
from quietarm.ocp.profiles.joint_profile import JointProfile


@dataclass(frozen=True)
class Cycloid(JointProfile):
    """A cycloid whose input U goes from 0 to 1 in a way that the coefficients shape.

    Whatever the coefficients, U is 0 at the start
    and 1 on arrival, so the joint is at its ends there, with speed and acceleration zero, eq (5).
    """

    term: ClassVar[str] = "term"
    least_terms: ClassVar[int] = 1
    most_terms: ClassVar[int] = 32
    why_no_more: ClassVar[str] = ""
    terms: int = 6

    def __post_init__(self) -> None:
        terms: object = self.terms
        least, most = self.least_terms, self.most_terms
        if isinstance(terms, bool) or not isinstance(terms, int | np.integer):
            raise ValueError(f"terms is {terms!r}; give a whole number from {least} to {most}")
        if not least <= terms <= most:
            why = self.why_no_more
            raise ValueError(f"terms is {terms}; give {least} to {most}{why and f': {why}'}")
        object.__setattr__(self, "terms", int(terms))

    @property
    def amount(self) -> str:
        """As 6 terms."""
        return f"{self.terms} {self.term}{'s' if self.terms != 1 else ''}"

    @property
    def label(self) -> str:
        """The family and its size."""
        return f"{self.name} of {self.amount}"

    @classmethod
    def of_size(cls, size: int) -> Self:
        """The family's member that has so many coefficients; ValueError where none has."""
        if not cls.least_terms <= size <= cls.most_terms:
            why = cls.why_no_more if size > cls.most_terms else ""
            raise ValueError(
                f"got {size} coefficients; {cls.name} has {cls.least_terms} to {cls.most_terms}"
                f"{why and f': {why}'}; give so many numbers"
            )
        return cls(size)

    @abstractmethod
    def input(
        self, coefficients: Sequence[Expression], fraction: Expression
    ) -> tuple[Expression, Expression, Expression]:
        """U, 0 and 1 at the ends, and its first two derivatives by the fraction."""

    def derivatives(
        self,
        coefficients: Sequence[Expression],
        fraction: Expression,
        start: Expression,
        target: Expression,
        duration: Expression,
    ) -> tuple[Expression, ...]:
        """Theta by eq (1), theta' by eq (2), theta'' by eq (3) mended."""
        return self.outer(self.input(coefficients, fraction), start, target, duration)[:3]

    def inner(
        self, coefficients: Sequence[Expression], fraction: Expression, *move: Expression
    ) -> Sequence[Expression]:
        """U and its derivatives by the fraction, which do not depend on the move."""
        del move
        return self.input(coefficients, fraction)

    def outer(self, inner: Sequence[Expression], *move: Expression) -> JointMotion:
        """The cycloid of U: eqs (1), (2) and (3), the latter mended."""
        start, target, duration = move
        U, dU, ddU = inner[0], inner[1] / duration, inner[2] / duration**2
        sine, cosine = ca.sin(math.pi * U), ca.cos(math.pi * U)
        span, pi = target - start, math.pi
        return JointMotion(
            start + span * (U - sine * cosine / pi),
            2 * span * (sine * sine) * dU,
            2 * span * sine * (2 * pi * cosine * dU * dU + sine * ddU),
        )


def with_bump(
    fraction: Expression, p: Expression, dp: Expression, ddp: Expression
) -> tuple[Expression, Expression, Expression]:
    """U = t/TE + (1 - T^2) p, whose bump holds the ends, and its derivatives by the fraction."""
    T = 2 * fraction - 1  # eq (7)
    bump = 1 - T * T
    return (
        fraction + bump * p,
        1 + 2 * (bump * dp - 2 * T * p),
        4 * (bump * ddp - 4 * T * dp - 2 * p),
    )
