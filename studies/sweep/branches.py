"""Where neighbouring cells of a grid are different motions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_JUMP = 4.0
"""Coefficients that change so many times as much as on either side belong to another motion."""
_LITTLE = 0.05
"""Unless they change by less than this share of their size: so well is a flat minimum known."""


def jumps(coefficients: Array) -> NDArray[np.int32]:
    """Marks of the cells after which coefficients jump: bit k where they do along axis k."""
    shape = coefficients.shape[:-1]
    marks = np.zeros(shape, np.int32)
    sizes = np.linalg.norm(coefficients, axis=-1)
    little = _LITTLE * np.median(sizes[np.isfinite(sizes)]) if np.isfinite(sizes).any() else 0.0
    for axis, length in enumerate(shape):
        steps = np.linalg.norm(np.diff(coefficients, axis=axis), axis=-1)
        found = np.moveaxis(_stand_out(np.moveaxis(steps, axis, 0)), 0, axis) & (steps > little)
        cells = [slice(None)] * len(shape)
        cells[axis] = slice(length - 1)
        marks[tuple(cells)] |= found.astype(np.int32) << axis
    return marks


def _stand_out(steps: Array) -> NDArray[np.bool_]:
    """Steps along the first axis that are much larger than those before and after them.

    Of a grid with fewer than three steps, and beside cells without a plan, none does.
    """
    beside = np.full_like(steps, np.nan)
    beside[1:] = steps[:-1]
    beside[:-1] = np.fmax(beside[:-1], steps[1:])
    return steps > _JUMP * beside  # NaN is no jump
