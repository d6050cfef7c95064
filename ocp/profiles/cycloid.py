"""The cycloid of an input U(t), eqs (1)-(7) of the paper: of a polynomial, and of a B-spline."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from quietarm.models import Expression, JointMotion
from quietarm.ocp.profiles.b_splines import spline
from quietarm.ocp.profiles.differentiate import Slopes, differentiate
from quietarm.ocp.profiles.joint_profile import JointProfile, Values
from quietarm.ocp.profiles.term_profile import TermProfile


class Cycloid(JointProfile):
    """A cycloid whose input U goes from 0 to 1: the joint is at rest at both ends, eq (5).

    Its input takes the place of its angle: `derivatives` are those of the input.
    """

    @abstractmethod
    def input(self, coefficients: Values, fraction: Expression) -> Expression:
        """U at a fraction of the duration: 0 at its beginning and 1 at its end."""

    def angle(self, coefficients: Values, fraction: Expression) -> Expression:
        """Eq (1)."""
        U = self.input(coefficients, fraction)
        return self.motion_of((U, 0.0, 0.0), 0.0, 1.0, 1.0).angle

    def derivatives(self, coefficients: Values, fraction: Expression) -> Slopes:
        """U, and its first two derivatives by the fraction: CasADi's."""
        U, dU, ddU = differentiate(
            lambda at: [self.input(coefficients, at)], fraction, coefficients, order=2
        )
        return U, dU, ddU

    def motion_of(
        self,
        derivatives: Slopes,
        start: Expression,
        target: Expression,
        duration: Expression,
    ) -> JointMotion:
        """The cycloid of U: eqs (1), (2) and (3), the latter mended."""
        U = derivatives[0]
        dU = derivatives[1] / duration
        ddU = derivatives[2] / duration**2
        pi = math.pi
        sine = ca.sin(pi * U)
        cosine = ca.cos(pi * U)
        span = target - start
        return JointMotion(
            start + span * (U - sine * cosine / pi),
            2 * span * (sine * sine) * dU,
            2 * span * sine * (2 * pi * cosine * dU * dU + sine * ddU),
        )


@dataclass(frozen=True)
class CycloidPolynomial(TermProfile, Cycloid):
    """A cycloid whose input is a polynomial, eqs (1)-(7), with eq (3) corrected.

    Parameters
    ----------
    terms : int
        N of eq (6), 0 (the plain cycloid) to 28; as many coefficients, a_1 to a_N.
    """

    name: ClassVar[str] = "cycloid-polynomial"
    least_terms: ClassVar[int] = 0
    most_terms: ClassVar[int] = 28
    """The condition number of the powers of T on [-1, 1] grows like (1 + sqrt 2)^N, and with 29 and
    more (5e10) some plans of the paper's plate end nowhere."""

    def input(self, coefficients: Values, fraction: Expression) -> Expression:
        """U of eq (6): linear in the coefficients."""
        return self.derivatives(coefficients, fraction)[0]

    def derivatives(self, coefficients: Values, fraction: Expression) -> Slopes:
        """U by Horner's rule, differentiated as it goes: faster than CasADi's."""
        T = 2 * fraction - 1  # eq (7)
        p = dp = ddp = 0 * T
        for a in reversed(coefficients):
            ddp = ddp * T + 2 * dp
            dp = dp * T + p
            p = p * T + a
        return with_bump(fraction, p, dp, ddp)


def with_bump(fraction: Expression, p: Expression, dp: Expression, ddp: Expression) -> Slopes:
    """U = t/TE + (1 - T^2) p, whose bump holds the ends, and its derivatives by the fraction."""
    T = 2 * fraction - 1  # eq (7)
    bump = 1 - T * T
    return (
        fraction + bump * p,
        1 + 2 * (bump * dp - 2 * T * p),
        4 * (bump * ddp - 4 * T * dp - 2 * p),
    )


@dataclass(frozen=True)
class CycloidSpline(TermProfile, Cycloid):
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
    degree: ClassVar[int] = 5
    """With a cubic, fixed steps miss the residual of a move at rest by 1e-5 m where pieces meet."""
    least_terms: ClassVar[int] = degree - 1

    def input(self, coefficients: Values, fraction: Expression) -> Expression:
        """U: linear in the coefficients."""
        return self.derivatives(coefficients, fraction)[0]

    def derivatives(self, coefficients: Values, fraction: Expression) -> Slopes:
        """U and its derivatives, splines of a lower degree."""
        pieces = self.terms + 2 - self.degree
        knots = [i / pieces for i in range(pieces + 1)]
        points = [0.0, *coefficients, 0.0]
        rise, rate, bend = spline(knots, self.degree, points, fraction)
        return fraction + rise, 1 + rate, bend
