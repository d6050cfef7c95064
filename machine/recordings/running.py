"""Largest value, median and mean of so many samples around each, as filters of images have them.

These few lines take no time to load; the filters of scipy take a fifth of a second.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def running_maximum(values: Array, size: int) -> Array:
    """The largest of so many values around each; beyond the ends are their nearest."""
    largest = _padded(values, size)
    reach = 1
    while reach < size:  # the largest of 1, of 2, of 4 and so on
        further = min(reach, size - reach)
        largest = np.maximum(largest[:-further], largest[further:])
        reach += further
    return largest


def running_minimum(values: Array, size: int) -> Array:
    """The least of so many values around each."""
    return -running_maximum(-values, size)


def running_median(values: Array, size: int) -> Array:
    """The median of so many values around each; of an even number the upper one."""
    windows = np.lib.stride_tricks.sliding_window_view(_padded(values, size), size)
    middle = size // 2
    return np.partition(windows, middle, axis=1)[:, middle]


def running_mean(values: Array, size: int) -> Array:
    """The mean of so many values around each."""
    weights: Any = np.full(size, 1 / size)
    means: Any = np.convolve(_padded(values, size), weights, "valid")
    return means


def _padded(values: Array, size: int) -> Array:
    before = size // 2
    return np.pad(values, (before, size - 1 - before), "edge")
