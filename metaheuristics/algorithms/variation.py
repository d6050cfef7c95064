"""Vary parents into offspring, for all at once."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def reflected(X: Array, lower: Array, upper: Array) -> Array:
    """Candidates whose coefficients beyond a bound are mirrored at it, and then clipped."""
    X = np.where(lower > X, 2 * lower - X, X)
    X = np.where(upper < X, 2 * upper - X, X)
    return np.clip(X, lower, upper)


def mutated(X: Array, lower: Array, upper: Array, eta: float, random: Any) -> Array:
    """Candidates after polynomial mutation, at a rate of one coefficient of each.

    Deb and Agrawal, 1999: a large `eta` makes small changes.
    """
    span = upper - lower
    below = (X - lower) / span
    above = (upper - X) / span
    draw = random.random(X.shape)
    power = 1.0 / (eta + 1.0)
    down = (2 * draw + (1 - 2 * draw) * (1 - below) ** (eta + 1)) ** power - 1
    up = 1 - (2 * (1 - draw) + (2 * draw - 1) * (1 - above) ** (eta + 1)) ** power
    change = np.where(draw < 0.5, down, up) * span
    mutates = random.random(X.shape) < 1 / X.shape[1]
    return np.clip(np.where(mutates, X + change, X), lower, upper)
