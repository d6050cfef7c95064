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
    """Least and largest value of each row, by a polynomial around its extreme samples.

    Where a row jumps or bends sharply, it is the sample itself. Rows may be pieces of these times.
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
    by_power = np.linalg.solve(_powers(x, _POINTS), values[:, :, None])[:, :, 0]
    below = ((times[np.maximum(at - 1, 0)])[:, None] - centre) / width
    above = ((times[np.minimum(at + 1, len(times) - 1)])[:, None] - centre) / width
    slope = by_power[:, 1:] * np.arange(1, _POINTS)
    bend = slope[:, 1:] * np.arange(1, _POINTS - 1)
    root = np.zeros_like(centre)
    for _ in range(_NEWTON):
        powers = _powers(root, _POINTS - 1)
        second = (powers[:, :, :-1] @ bend[:, :, None])[:, 0]
        step = np.zeros_like(root)
        np.divide((powers @ slope[:, :, None])[:, 0], second, where=second < 0, out=step)
        root = np.minimum(np.maximum(root - step, below), above)
    peak = (_powers(root, _POINTS) @ by_power[:, :, None])[:, 0, 0]
    finest = np.abs(by_power[:, -2:]) @ 0.5 ** np.arange(_POINTS - 2, _POINTS)
    return np.where(finest <= _SMOOTH * np.ptp(values, axis=1), peak, -np.inf)


def _powers(values: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Powers 0 to count - 1 of values of any shape, along one more axis."""
    factors = np.empty((*values.shape, count))
    factors[..., 0], factors[..., 1:] = 1.0, values[..., None]
    return np.multiply.accumulate(factors, axis=-1)
