"""The cycloid of an input U(t), eqs (1)-(7) of the paper: of a polynomial, and of a B-spline."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Self

import casadi as ca
from quietarm.models import Expression, JointMotion
from quietarm.ocp.checks import whole
from quietarm.ocp.profiles.b_splines import spline
from quietarm.ocp.profiles.joint_profile import JointProfile, Values

Input = tuple[Expression, Expression, Expression]
"""U, and its first two derivatives by the fraction of the duration."""

MAX_TERMS, MAX_POWERS = 32, 28
"""Most terms, and of a polynomial: the condition number of the powers of T on [-1, 1] grows like
(1 + sqrt 2)^N, and with 29 and more (5e10) some plans of the paper's plate end nowhere."""

DEGREE = 5
"""With a cubic, fixed steps miss the residual of a move at rest by 1e-5 m where pieces meet."""


@dataclass(frozen=True)
class Cycloid(JointProfile):
    """A cycloid whose input U goes from 0 to 1: the joint is at rest at both ends, eq (5)."""

    term: ClassVar[str] = "term"
    least_terms: ClassVar[int] = 1
    most_terms: ClassVar[int] = MAX_TERMS
    constants: ClassVar[int] = 0
    each: ClassVar[int] = 1
    """Coefficients that every member has, and those of each term."""
    terms: int = 6

    def __post_init__(self) -> None:
        why = "beyond that double precision no longer distinguishes the terms"
        terms = whole("terms", self.terms, self.least_terms, self.most_terms, why)
        object.__setattr__(self, "terms", terms)

    @property
    def amount(self) -> str:
        """As 6 terms."""
        return f"{self.terms} {self.term}{'s' if self.terms != 1 else ''}"

    @classmethod
    def of_size(cls, size: int) -> Self:
        """The family's member that has so many coefficients; ValueError where none has."""
        terms, rest = divmod(size - cls.constants, cls.each)
        if rest:
            raise ValueError(
                f"got {size} coefficients; {cls.name} has {cls.constants}, and {cls.each} for "
                f"every {cls.term}; give so many numbers"
            )
        return cls(terms)

    @property
    def size(self) -> int:
        """How many coefficients the profile has."""
        return self.constants + self.each * self.terms

    @abstractmethod
    def input(self, coefficients: Values, fraction: Expression) -> Input:
        """U, 0 and 1 at the ends, and its first two derivatives by the fraction."""

    def derivatives(self, coefficients: Values, fraction: Expression, *move: Expression) -> Values:
        """Theta by eq (1), theta' by eq (2), theta'' by eq (3) mended."""
        return self.outer(self.input(coefficients, fraction), *move)[:3]

    def inner(self, coefficients: Values, fraction: Expression, *move: Expression) -> Values:
        """U and its derivatives by the fraction, which do not depend on the move."""
        return self.input(coefficients, fraction)

    def outer(self, inner: Values, *move: Expression) -> JointMotion:
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


def with_bump(fraction: Expression, p: Expression, dp: Expression, ddp: Expression) -> Input:
    """U = t/TE + (1 - T^2) p, whose bump holds the ends, and its derivatives by the fraction."""
    T = 2 * fraction - 1  # eq (7)
    bump = 1 - T * T
    return (
        fraction + bump * p,
        1 + 2 * (bump * dp - 2 * T * p),
        4 * (bump * ddp - 4 * T * dp - 2 * p),
    )


@dataclass(frozen=True)
class CycloidPolynomial(Cycloid):
    """A cycloid whose input is a polynomial, eqs (1)-(7), with eq (3) corrected.

    Parameters
    ----------
    terms : int
        N of eq (6), 0 (the plain cycloid) to `MAX_POWERS`; as many coefficients, a_1 to a_N.
    """

    name: ClassVar[str] = "cycloid-polynomial"
    least_terms: ClassVar[int] = 0
    most_terms: ClassVar[int] = MAX_POWERS

    def input(self, coefficients: Values, fraction: Expression) -> Input:
        """U of eq (6) and its derivatives: linear in the coefficients."""
        T = 2 * fraction - 1  # eq (7)
        p = dp = ddp = 0 * T
        for a in reversed(coefficients):  # Horner's rule, differentiated as it goes
            ddp = ddp * T + 2 * dp
            dp = dp * T + p
            p = p * T + a
        return with_bump(fraction, p, dp, ddp)


@dataclass(frozen=True)
class CycloidSpline(Cycloid):
    """A cycloid whose input is a clamped quintic B-spline on even knots.

    U = t/TE + sum_j a_j B_j(t/TE), of all B-splines but the first and the last, which are not zero
    at the ends. a_j is the height of control point j above the straight line: U is linear in them,
    and each coefficient acts on its own part of the move.

    Parameters
    ----------
    terms : int
        How many control points may move, 4 to 32; as many coefficients.
    """

    name: ClassVar[str] = "cycloid-spline"
    term: ClassVar[str] = "control point"
    default_bound: ClassVar[float | None] = 0.5
    least_terms: ClassVar[int] = DEGREE - 1

    def input(self, coefficients: Values, fraction: Expression) -> Input:
        """U and its derivatives: linear in the coefficients."""
        pieces = self.terms + 2 - DEGREE
        knots = [i / pieces for i in range(pieces + 1)]
        rise, rate, bend = spline(knots, DEGREE, [0.0, *coefficients, 0.0], fraction)
        return fraction + rise, 1 + rate, bend
