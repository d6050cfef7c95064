"""The cycloid whose input is a neural network of one hidden layer, in this project's reading."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np
from quietarm.models import Expression
from quietarm.ocp.profiles.units import REACH, CycloidOfUnits, Range, side_by_side

_STRAIGHTEST, _STEEPEST = 0.3, 4.0
"""Gains: from nearly a straight line over the whole move to a step that takes a quarter of it."""
_FIRST_GAIN = 1.5


@dataclass(frozen=True)
class CycloidNetwork(CycloidOfUnits):
    """A cycloid whose input is a network of one hidden layer: ref. [23], as this project reads it.

    U = t/TE + (1 - T^2) (v_0 + sum_j v_j tanh(b_j + k_j T)), T = -1 + 2 t/TE. The coefficients are
    v_0 to v_n, the biases b_1 to b_n, and the gains k_1 to k_n. Gains are positive: a negative one
    is the same as other signs of its weight and bias. They may be up to 200.

    Parameters
    ----------
    terms : int
        How many hidden nodes, n, 1 to 32; the profile has 1 + 3 n coefficients.

    Raises
    ------
    ValueError
        When `terms` is not a whole number in that range.
    """

    name: ClassVar[str] = "cycloid-network"
    term: ClassVar[str] = "node"
    sharpness: ClassVar[str] = "the gain of a hidden node"
    terms: int = 5

    @property
    def ranges(self) -> tuple[Range, Range]:
        """Biases, then gains."""
        one = np.ones(self.terms)
        biases = _FIRST_GAIN * REACH * side_by_side(self.terms)
        return (
            Range(biases, 0.5 * one, -_STEEPEST * one, _STEEPEST * one),
            Range(_FIRST_GAIN * one, 0.5 * one, _STRAIGHTEST * one, _STEEPEST * one),
        )

    @staticmethod
    def unit(
        x: Expression, y: Expression, T: Expression
    ) -> tuple[Expression, Expression, Expression]:
        """A hidden node of bias x and gain y, and its derivatives."""
        g = ca.tanh(x + y * T)
        slope = y * (1 - g * g)
        return g, slope, -2 * y * g * slope
