"""The cycloid whose input is a polynomial, eqs (1)-(7) of the paper."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from quietarm.models import Expression
from quietarm.ocp.profiles.cycloid import Cycloid, Input, with_bump

MAX_TERMS = 32
"""Most terms of the polynomial. The condition number of the powers of T on [-1, 1] grows like (1 +
sqrt 2)^N: 4e11 at 32 terms, where double precision leaves four digits of a coefficient. The solver
works along other axes, in which that does not matter."""


@dataclass(frozen=True)
class CycloidPolynomial(Cycloid):
    """A cycloid whose input is a polynomial, eqs (1)-(7), with eq (3) mended.

    Parameters
    ----------
    terms : int
        N of eq (6), 0 (the plain cycloid) to `MAX_TERMS`; as many coefficients, a_1 to a_N.

    Raises
    ------
    ValueError
        When `terms` is not a whole number in that range.
    """

    name: ClassVar[str] = "cycloid-polynomial"
    least_terms: ClassVar[int] = 0
    most_terms: ClassVar[int] = MAX_TERMS
    why_no_more: ClassVar[str] = (
        "beyond that double precision no longer tells the powers of T apart"
    )

    def input(self, coefficients: Sequence[Expression], fraction: Expression) -> Input:
        """U of eq (6) and its derivatives: linear in the coefficients."""
        T = 2 * fraction - 1  # eq (7)
        p = dp = ddp = 0 * T
        for a in reversed(coefficients):  # Horner's rule, differentiated as it goes
            ddp = ddp * T + 2 * dp
            dp = dp * T + p
            p = p * T + a
        return with_bump(fraction, p, dp, ddp)
