"""The least and the largest value of a smooth function between its samples."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_POINTS = 7
"""Samples of the polynomial through an extreme and its neighbours."""
_NEWTON = 3
_SMOOTH = 0.02
"""If the polynomial's two highest terms exceed this share of the range of its samples, the function
jumps or bends sharply there, and the largest sample is taken instead."""


def extremes(times: NDArray[np.float64], rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Least and largest value of each row, where the derivative is zero between the samples.

    A polynomial of degree six goes through the extreme sample and its neighbours; Newton's method
    finds the root of its derivative. Where a row jumps or bends sharply, its extreme sample is
    returned. A function in pieces may jump from one to the next.

    Parameters
    ----------
    times : ndarray, shape (samples,)
        Times of the samples of a piece, increasing.
    rows : ndarray, shape (rows, pieces * samples)
        Values, one piece after another.

    Returns
    -------
    ndarray, shape (rows, 2)
        Least and largest value.
    """
    signed = np.concatenate([-rows, rows])
    at = np.argmax(signed, axis=1)
    largest = np.take_along_axis(signed, at[:, None], axis=1)[:, 0]
    if len(times) >= _POINTS:
        found = np.fmax(largest, _between(times, signed, at))
        largest = np.where(np.isfinite(found), found, largest)
    low, high = np.split(largest, 2)
    return np.column_stack([-low, high])


def _between(
    times: NDArray[np.float64], rows: NDArray[np.float64], at: NDArray[np.intp]
) -> NDArray[np.float64]:
    """The largest value beside a sample of each row; minus infinity where it is not smooth."""
    piece, at = np.divmod(at, len(times))
    first = np.clip(at - _POINTS // 2, 0, len(times) - _POINTS)
    near = first[:, None] + np.arange(_POINTS)
    centre = times[at][:, None]
    width = (times[near[:, -1]] - times[near[:, 0]])[:, None]
    values = np.take_along_axis(rows, piece[:, None] * len(times) + near, axis=1)
    x = (times[near] - centre) / width
    powers = np.arange(_POINTS)
    by_power = np.linalg.solve(x[:, :, None] ** powers, values[:, :, None])[:, :, 0]
    below = ((times[np.maximum(at - 1, 0)])[:, None] - centre) / width
    above = ((times[np.minimum(at + 1, len(times) - 1)])[:, None] - centre) / width
    root = np.zeros_like(centre)
    slope, bend = powers[1:], powers[2:] * powers[1:-1]
    for _ in range(_NEWTON):
        first_derivative = (by_power[:, 1:] * slope * root ** powers[:-1]).sum(axis=1)
        second = (by_power[:, 2:] * bend * root ** powers[:-2]).sum(axis=1)
        step = np.divide(first_derivative, second, where=second < 0, out=np.zeros_like(second))
        root = np.clip(root - step[:, None], below, above)
    peak = (by_power * root**powers).sum(axis=1)
    finest = np.abs(by_power[:, -2:] * 0.5 ** powers[-2:]).sum(axis=1)
    return np.where(finest <= _SMOOTH * np.ptp(values, axis=1), peak, -np.inf)
