"""How frequency and damping change with the amplitude along one swing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from quietarm.studies.identify.machine import Part

Array = NDArray[np.float64]
_SURE = 2.0
"""Deviations that a piece's value may be off."""
_CHANCE = 1e-4
"""Of pieces that agree to differ as much: rarer is a change."""
_MATTERS = 1e-5
"""Share of a value, below which a change is one of the arithmetic."""


def spread_of(pieces: Sequence[Part], name: str) -> tuple[float, float] | None:
    """Ends of what a parameter is along a swing, by fits of its pieces in order of time.

    None where the pieces agree within their own uncertainty. The ends of the swing are half a piece
    beyond the middle of the first and last pieces: the change goes on there as it was.
    """
    from scipy.special import chdtri  # not at the top: it takes long to load

    if len(pieces) < 2:
        return None
    values = np.array([piece.values[name] for piece in pieces])
    deviations = np.array([piece.deviations[name] for piece in pieces])
    deviations = np.maximum(deviations, 1e-12 * np.abs(values) + 1e-300)
    weights = 1 / deviations**2
    mean = float((weights * values).sum() / weights.sum())
    squares = float((weights * (values - mean) ** 2).sum())
    limit = chdtri(len(values) - 1, _CHANCE)
    if squares <= limit:
        return None
    # pieces that are less certain than the change tell nothing of it
    between = max(squares - (len(values) - 1), 0.0) / weights.sum()
    certain = deviations**2 <= max(between, float(np.sort(deviations)[1]) ** 2)
    values, deviations = values[certain], deviations[certain]
    first, last = (values[0] - values[1]) / 2, (values[-1] - values[-2]) / 2
    values = np.append(values, [values[0] + first, values[-1] + last])
    deviations = np.append(deviations, deviations[[0, -1]])
    low = float((values - _SURE * deviations).min())
    high = float((values + _SURE * deviations).max())
    return (low, high) if high - low > _MATTERS * abs(mean) else None
