"""The cycloid whose input is a weighted sum of units that have parameters of their own."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.models import Expression
from quietarm.ocp.profiles.cycloid import Cycloid, with_bump

REACH = 1.25
"""At first the units lie in even cells of T between plus and minus this: the outermost have their
middle beyond the ends of the move, where they act most."""
_LIGHT = 0.1
"""Random starts have weights within this share of their bound: with large ones the joint swings
back and forth, and IPOPT runs out of iterations."""

SHARPEST = 200.0
"""Largest inverse width or gain. CVODES has the energy of such a unit within 0.1 %; one that is ten
times as sharp can lie between its steps, as it can between the fixed steps, which then agree."""


class Range(NamedTuple):
    """Values of one kind of parameter, one for each unit, each of shape (units,).

    Attributes
    ----------
    first : ndarray
        Where the first start has them.
    spread : ndarray
        Random starts lie within this of the first.
    least, most : ndarray
        Where they must stay.
    """

    first: NDArray[np.float64]
    spread: NDArray[np.float64]
    least: NDArray[np.float64]
    most: NDArray[np.float64]


@dataclass(frozen=True)
class CycloidOfUnits(Cycloid):
    """U = t/TE + (1 - T^2) (v_0 + sum_j v_j g(x_j, y_j, T)), T = -1 + 2 t/TE.

    The coefficients are v_0 to v_n, then x_1 to x_n, then y_1 to y_n: 1 + 3 n of them. A bound is
    for the weights v, x and y have `ranges` of their own; all are numbers of order one.

    Units can swap places, or almost cancel each other with ever larger weights. So weights are
    always bounded, by `default_bound` where no bound is given, and starts are near the plain
    cycloid, with the units side by side.
    """

    default_bound: ClassVar[float | None] = 0.5
    sharp: ClassVar[bool] = True
    random_starts: ClassVar[int] = 4
    sharpness: ClassVar[str]
    """What y is called in a message."""

    @property
    def size(self) -> int:
        """How many coefficients the profile has: a constant, and three for each unit."""
        return 1 + 3 * self.terms

    @classmethod
    def of_size(cls, size: int) -> Self:
        """The family's member that has so many coefficients; ValueError where none has."""
        terms, rest = divmod(size - 1, 3)
        if rest or not cls.least_terms <= terms <= cls.most_terms:
            most = 1 + 3 * cls.most_terms
            raise ValueError(
                f"got {size} coefficients; {cls.name} has one and three for each unit: give 4, 7, "
                f"10, ... or {most} numbers"
            )
        return cls(terms)

    def checked(self, coefficients: ArrayLike, duration: float | None = None) -> tuple[float, ...]:
        """As every profile's; ValueError, too, where a unit is sharper than `SHARPEST`."""
        values = super().checked(coefficients, duration)
        for place, value in enumerate(values[1 + 2 * self.terms :], start=2 + 2 * self.terms):
            if abs(value) > SHARPEST:
                raise ValueError(
                    f"coefficient {place} is {value:g}, {self.sharpness}; give at most "
                    f"{SHARPEST:g}: a sharper one acts between the integrators' steps"
                )
        return values

    @property
    @abstractmethod
    def ranges(self) -> tuple[Range, Range]:
        """Where the units' own parameters x and y may be."""

    @staticmethod
    @abstractmethod
    def unit(
        x: Expression, y: Expression, T: Expression
    ) -> tuple[Expression, Expression, Expression]:
        """One unit g and its first two derivatives by T; finite for all x and y."""

    @property
    def plain(self) -> NDArray[np.float64]:
        """No weight, and the units side by side."""
        return np.concatenate([np.zeros(1 + self.terms), *(kind.first for kind in self.ranges)])

    def box(self, bound: float | None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """`bound` for the weights, `ranges` for the rest."""
        weights = np.full(1 + self.terms, self.default_bound if bound is None else bound)
        return (
            np.concatenate([-weights, *(kind.least for kind in self.ranges)]),
            np.concatenate([weights, *(kind.most for kind in self.ranges)]),
        )

    def start_box(self, bound: float | None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Small weights, and the units nearly in their even cells."""
        lower, upper = self.box(bound)
        weights = _LIGHT * upper[: 1 + self.terms]
        around = np.concatenate([weights, *(kind.spread for kind in self.ranges)])
        return np.maximum(lower, self.plain - around), np.minimum(upper, self.plain + around)

    def input(
        self, coefficients: Sequence[Expression], fraction: Expression
    ) -> tuple[Expression, Expression, Expression]:
        """U and its derivatives; the weights alone enter linearly."""
        n, T = self.terms, 2 * fraction - 1  # eq (7)
        constant, *weights = coefficients[: 1 + n]
        p, dp, ddp = constant + 0 * T, 0 * T, 0 * T
        own = zip(coefficients[1 + n : 1 + 2 * n], coefficients[1 + 2 * n :], strict=True)
        for v, (x, y) in zip(weights, own, strict=True):
            g, dg, ddg = self.unit(x, y, T)
            p, dp, ddp = p + v * g, dp + v * dg, ddp + v * ddg
        return with_bump(fraction, p, dp, ddp)


def side_by_side(units: int) -> NDArray[np.float64]:
    """Middles of even cells between -1 and 1, shape (units,)."""
    return (2 * np.arange(units) + 1 - units) / units
