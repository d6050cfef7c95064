"""Steps and variances of least squares, within bounds."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def variances_of(slopes: Array) -> Array:
    """Variances of parameters by the derivatives of residuals of unit variance."""
    covariance: Any = np.linalg.pinv(slopes.T @ slopes, hermitian=True)
    return np.diag(covariance)


def bounded_step(p: Array, curvature: Array, gradient: Array, bounds: tuple[Array, Array]) -> Array:
    """A step by a curvature, along the bounds at which it would leave them.

    The curvature may be singular, where a parameter shows nowhere.
    """
    lower, upper = bounds
    size = np.sqrt(np.maximum(np.diag(curvature), 1e-300))
    matrix = curvature / np.outer(size, size)
    target = gradient / size
    inside = np.ones(len(p), bool)
    while True:
        step = np.zeros(len(p))
        among = np.ix_(inside, inside)
        step[inside], *_ = np.linalg.lstsq(matrix[among], target[inside], rcond=None)
        below = (p <= lower) & (step < 0)
        above = (p >= upper) & (step > 0)
        leaves = inside & (below | above)
        if not leaves.any():
            return step / size
        inside &= ~leaves
