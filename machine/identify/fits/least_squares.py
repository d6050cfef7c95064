"""Linear least squares of many rows and few columns."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def least_squares(columns: Array, target: Array) -> Array:
    """What of columns is nearest to a target, or to each of several.

    By the normal equations where the columns are told apart well: that is much faster.
    """
    many_rows = 100
    told_apart = 1e11  # condition of the columns' products
    size = np.linalg.norm(columns, axis=0)
    there = size > 0
    if len(columns) > many_rows and there.any():
        scaled = columns[:, there] / size[there]
        products = scaled.T @ scaled
        if np.linalg.cond(products) < told_apart:
            shares = np.zeros((columns.shape[1], *target.shape[1:]))
            of_scaled = np.linalg.solve(products, scaled.T @ target)
            shares[there] = (of_scaled.T / size[there]).T
            return shares
    solve: Any = np.linalg.lstsq
    return solve(columns, target, rcond=None)[0]


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
