"""Cycloids of a weighted sum of radial basis functions or hidden nodes, the paper's comparators."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.models import Expression
from quietarm.ocp.profiles.cycloid import Cycloid, with_bump
from quietarm.ocp.profiles.differentiate import Slopes
from quietarm.ocp.profiles.joint_profile import Values
from quietarm.ocp.profiles.term_profile import TermProfile


class Range(NamedTuple):
    """The range of one of the units' parameters: of shape (units,), or one number for all."""

    first: NDArray[np.float64] | float
    spread: NDArray[np.float64] | float
    least: NDArray[np.float64] | float
    most: NDArray[np.float64] | float


@dataclass(frozen=True)
class CycloidOfUnits(TermProfile, Cycloid):
    """U = t/TE + (1 - T^2) (v_0 + sum_j v_j g(x_j, y_j, T)), T = -1 + 2 t/TE.

    The coefficients are v_0 to v_n, then x_1 to x_n, then y_1 to y_n. A bound is for the weights v;
    x and y have `ranges`. Units can swap places, or almost cancel each other with ever larger
    weights: so weights are always bounded, and starts have the units side by side.
    """

    largest_weight: ClassVar[float] = 0.5
    """Where no bound is given."""
    default_bound: ClassVar[float | None] = largest_weight
    sharp: ClassVar[bool] = True
    random_starts: ClassVar[int] = 4
    fixed_coefficients: ClassVar[int] = 1
    coefficients_of_term: ClassVar[int] = 3
    reach: ClassVar[float] = 1.25
    """First units lie in even cells of T between plus and minus this, the outermost beyond the
    ends."""
    light: ClassVar[float] = 0.1
    """Random starts have weights within this share of their bound: larger ones swing the joint."""
    sharpest: ClassVar[float] = 200.0
    """Largest inverse width or gain: one ten times as sharp can lie between all integrators'
    steps."""
    terms: int = 5

    def checked(self, coefficients: ArrayLike, duration: float | None = None) -> tuple[float, ...]:
        """Check coefficients, and refuse a unit that is sharper than `sharpest`."""
        values = super().checked(coefficients, duration)
        if (largest := max(map(abs, values[1 + 2 * self.terms :]))) > self.sharpest:
            raise ValueError(
                f"the inverse width or gain of a {self.term} is {largest:g}; give at most "
                f"{self.sharpest:g}: a sharper one acts between the integrators' steps"
            )
        return values

    @property
    @abstractmethod
    def ranges(self) -> tuple[Range, Range]:
        """Ranges of the units' own parameters x and y."""

    @staticmethod
    @abstractmethod
    def unit(x: Expression, y: Expression, T: Expression) -> Slopes:
        """One unit g and its first two derivatives by T; finite for all x and y."""

    def _assemble(self, weight: float, field: str) -> NDArray[np.float64]:
        """Numbers for all coefficients: one for the weights, and one field of the ranges."""
        weights = np.full(1 + self.terms, weight)
        of_units = [
            np.broadcast_to(getattr(parameter, field), self.terms) for parameter in self.ranges
        ]
        return np.concatenate([weights, *of_units])

    @property
    def plain(self) -> NDArray[np.float64]:
        """Coefficients of the plain motion: no weight, and the units side by side."""
        return self._assemble(0.0, "first")

    def box(self, bound: float | None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """`bound` for the weights, `ranges` for the rest."""
        weight = self.largest_weight if bound is None else bound
        return self._assemble(-weight, "least"), self._assemble(weight, "most")

    def start_box(self, bound: float | None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Small weights, and the units nearly in their even cells."""
        lower, upper = self.box(bound)
        around = self._assemble(self.light * upper[0], "spread")
        return np.maximum(lower, self.plain - around), np.minimum(upper, self.plain + around)

    @property
    def cells(self) -> NDArray[np.float64]:
        """Middles of even cells between plus and minus `reach`, one for each unit."""
        return self.reach * (2 * np.arange(self.terms) + 1 - self.terms) / self.terms

    def input(self, coefficients: Values, fraction: Expression) -> Expression:
        """U: the weights alone enter linearly."""
        return self.derivatives(coefficients, fraction)[0]

    def derivatives(self, coefficients: Values, fraction: Expression) -> Slopes:
        """U and its derivatives."""
        T = 2 * fraction - 1  # eq (7)
        constant, *weights = coefficients[: 1 + self.terms]
        places = coefficients[1 + self.terms : 1 + 2 * self.terms]
        widths = coefficients[1 + 2 * self.terms :]
        p = constant + 0 * T
        dp = 0 * T
        ddp = 0 * T
        for v, x, y in zip(weights, places, widths):
            g, dg, ddg = self.unit(x, y, T)
            p = p + v * g
            dp = dp + v * dg
            ddp = ddp + v * ddg
        return with_bump(fraction, p, dp, ddp)


@dataclass(frozen=True)
class CycloidGaussians(CycloidOfUnits):
    """A cycloid whose input is a sum of Gaussians: ref. [24], as this project reads it.

    U = t/TE + (1 - T^2) (w_0 + sum_j w_j exp(-(k_j (T - c_j))^2)), T = -1 + 2 t/TE. The
    coefficients are w_0 to w_n, the centres c_1 to c_n, each in a cell of its own, and the inverse
    widths k_1 to k_n, up to 200 either way, also zero.

    Parameters
    ----------
    terms : int
        How many Gaussians, n, 1 to 32; the profile has 1 + 3 n coefficients.
    """

    name: ClassVar[str] = "cycloid-gaussians"
    term: ClassVar[str] = "Gaussian"

    @property
    def ranges(self) -> tuple[Range, Range]:
        """Centres; inverse widths, from nearly a parabola over the move to a sixth of it."""
        half = self.reach / self.terms
        centres = Range(self.cells, half, self.cells - half, self.cells + half)
        return centres, Range(2.0, 0.25, 0.3, 3.0)

    @staticmethod
    def unit(x: Expression, y: Expression, T: Expression) -> Slopes:
        """A Gaussian of centre x and inverse width y, and its derivatives."""
        z = y * (T - x)
        g = ca.exp(-z * z)
        return g, -2 * y * z * g, y * y * (4 * z * z - 2) * g


@dataclass(frozen=True)
class CycloidNetwork(CycloidOfUnits):
    """A cycloid whose input is a network of one hidden layer: ref. [23], as this project reads it.

    U = t/TE + (1 - T^2) (v_0 + sum_j v_j tanh(b_j + k_j T)), T = -1 + 2 t/TE. The coefficients are
    v_0 to v_n, the biases b_1 to b_n, and the gains k_1 to k_n, up to 200; a negative gain is the
    same as other signs of its weight and bias.

    Parameters
    ----------
    terms : int
        How many hidden nodes, n, 1 to 32; the profile has 1 + 3 n coefficients.
    """

    name: ClassVar[str] = "cycloid-network"
    term: ClassVar[str] = "node"

    @property
    def ranges(self) -> tuple[Range, Range]:
        """Biases; gains, from nearly a straight line to a step that takes a quarter of the move."""
        gain = 1.5
        steepest = 4.0
        biases = Range(gain * self.cells, 0.5, -steepest, steepest)
        return biases, Range(gain, 0.5, 0.3, steepest)

    @staticmethod
    def unit(x: Expression, y: Expression, T: Expression) -> Slopes:
        """A hidden node of bias x and gain y, and its derivatives."""
        g = ca.tanh(x + y * T)
        slope = y * (1 - g * g)
        return g, slope, -2 * y * g * slope
