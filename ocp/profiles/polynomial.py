"""The cycloid whose input is a polynomial, eqs (1)-(7) of the paper."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np

from models import Expression, JointMotion
from ocp.profiles.joint_profile import JointProfile

MAX_TERMS = 32
"""Most terms of the polynomial. The condition number of the powers of T on [-1, 1] grows like (1 +
sqrt 2)^N: 4e11 at 32 terms, where double precision leaves four digits of a coefficient. The solver
works along other axes, in which that does not matter."""


@dataclass(frozen=True)
class CycloidPolynomial(JointProfile):
    """A cycloid whose input is a polynomial, eqs (1)-(7), with eq (3) mended.

    Parameters
    ----------
    terms : int
        N of eq (6), 0 (the plain cycloid) to `MAX_TERMS`.

    Raises
    ------
    ValueError
        When `terms` is not a whole number in that range.
    """

    name: ClassVar[str] = "cycloid-polynomial"
    terms: int = 6

    def __post_init__(self) -> None:
        terms: object = self.terms
        if isinstance(terms, bool) or not isinstance(terms, int | np.integer):
            raise ValueError(f"terms is {self.terms!r}; give a whole number from 0 to {MAX_TERMS}")
        if not 0 <= self.terms <= MAX_TERMS:
            raise ValueError(
                f"terms is {self.terms}; give 0 (the plain cycloid) to {MAX_TERMS}: beyond that "
                "double precision no longer tells the powers of T apart"
            )
        object.__setattr__(self, "terms", int(self.terms))

    @property
    def size(self) -> int:
        """How many coefficients the profile has: the number of terms."""
        return self.terms

    def derivatives(
        self,
        coefficients: Sequence[Expression],
        fraction: Expression,
        start: Expression,
        target: Expression,
        duration: Expression,
    ) -> tuple[Expression, ...]:
        """Theta by eq (1), theta' by eq (2), theta'' by eq (3) mended."""
        inputs = self.inner(coefficients, fraction, start, target, duration)
        return self.outer(inputs, start, target, duration)[:3]

    def inner(
        self,
        coefficients: Sequence[Expression],
        fraction: Expression,
        start: Expression,
        target: Expression,
        duration: Expression,
    ) -> Sequence[Expression]:
        """U of eq (6), U', U'': linear in the coefficients."""
        del start, target
        T = 2 * fraction - 1  # eq (7)
        p = dp = ddp = 0 * T
        for a in reversed(coefficients):  # Horner's rule, differentiated as it goes
            ddp = ddp * T + 2 * dp
            dp = dp * T + p
            p = p * T + a
        bump = 1 - T * T
        rate = 2 / duration  # dT/dt
        return (
            fraction + bump * p,
            1 / duration + rate * (bump * dp - 2 * T * p),
            rate**2 * (bump * ddp - 4 * T * dp - 2 * p),
        )

    def outer(
        self,
        inner: Sequence[Expression],
        start: Expression,
        target: Expression,
        duration: Expression,
    ) -> JointMotion:
        """The cycloid of U: eqs (1), (2) and (3), the latter mended."""
        del duration
        U, dU, ddU = inner
        sine, cosine = ca.sin(math.pi * U), ca.cos(math.pi * U)
        span, pi = target - start, math.pi
        return JointMotion(
            start + span * (U - sine * cosine / pi),
            2 * span * (sine * sine) * dU,
            2 * span * sine * (2 * pi * cosine * dU * dU + sine * ddU),
        )
