"""The cycloid whose input is a network of radial basis functions, in this project's reading."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np
from quietarm.models import Expression
from quietarm.ocp.profiles.units import REACH, CycloidOfUnits, Range, side_by_side

_WIDEST, _SHARPEST = 0.3, 3.0
"""Inverse widths: from nearly a parabola over the whole move to a sixth of it."""


@dataclass(frozen=True)
class CycloidGaussians(CycloidOfUnits):
    """A cycloid whose input is a sum of Gaussians: ref. [24], as this project reads it.

    U = t/TE + (1 - T^2) (w_0 + sum_j w_j exp(-(k_j (T - c_j))^2)), T = -1 + 2 t/TE. The
    coefficients are w_0 to w_n, the centres c_1 to c_n, and the inverse widths k_1 to k_n, which
    may be any number up to 200 either way, also zero. Every centre keeps to a cell of its own, so
    that no two Gaussians can change places.

    Parameters
    ----------
    terms : int
        How many Gaussians, n, 1 to 32; the profile has 1 + 3 n coefficients.

    Raises
    ------
    ValueError
        When `terms` is not a whole number in that range.
    """

    name: ClassVar[str] = "cycloid-gaussians"
    term: ClassVar[str] = "Gaussian"
    sharpness: ClassVar[str] = "the inverse width of a Gaussian"
    terms: int = 5

    @property
    def ranges(self) -> tuple[Range, Range]:
        """Centres, then inverse widths."""
        one = np.ones(self.terms)
        middle, half = REACH * side_by_side(self.terms), REACH / self.terms * one
        return (
            Range(middle, half, middle - half, middle + half),
            Range(2.0 * one, 0.25 * one, _WIDEST * one, _SHARPEST * one),
        )

    @staticmethod
    def unit(
        x: Expression, y: Expression, T: Expression
    ) -> tuple[Expression, Expression, Expression]:
        """A Gaussian of centre x and inverse width y, and its derivatives."""
        z = y * (T - x)
        g = ca.exp(-z * z)
        return g, -2 * y * z * g, y * y * (4 * z * z - 2) * g
