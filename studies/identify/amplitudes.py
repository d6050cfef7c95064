"""How frequency and damping change with the amplitude along one swing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from quietarm.studies.identify.machine import Part

Array = NDArray[np.float64]


def spread_of(pieces: Sequence[Part], name: str) -> tuple[float, float] | None:
    """Ends of what a parameter is along a swing, by fits of its pieces in order of time.

    None where the pieces agree within their own uncertainty. The ends of the swing are half a piece
    beyond the middle of the first and last pieces: the change goes on there as it was.
    """
    from scipy.special import chdtri  # not at the top: it takes long to load

    chance = 1e-3  # of pieces that agree to differ as much
    matters = 1e-5  # share of the value, below which a change is one of the arithmetic
    if len(pieces) < 2:
        return None
    values = np.array([piece.values[name] for piece in pieces])
    deviations = np.array([piece.deviations[name] for piece in pieces])
    deviations = np.maximum(deviations, 1e-12 * np.abs(values) + 1e-300)
    weights = 1 / deviations**2
    mean = float((weights * values).sum() / weights.sum())
    squares = float((weights * (values - mean) ** 2).sum())
    freedom = len(values) - 1
    if squares <= chdtri(freedom, chance):
        return None
    # pieces that are less certain than the change tell nothing of it
    change = max(squares - freedom, 0.0) / weights.sum()
    second_best = float(np.sort(deviations)[1]) ** 2
    certain = deviations**2 <= max(change, second_best)
    return _ends(values[certain], deviations[certain], matters * abs(mean))


def _ends(values: Array, deviations: Array, least: float) -> tuple[float, float] | None:
    """The least and the largest of values and of what they go on to; None where all is less."""
    sure = 2.0  # deviations that a value may be off
    before = _beyond(values)
    after = _beyond(values[::-1])
    all_values = np.concatenate([values, before, after])
    of_before = np.full(len(before), deviations[0])
    of_after = np.full(len(after), deviations[-1])
    all_deviations = np.concatenate([deviations, of_before, of_after])
    low = float((all_values - sure * all_deviations).min())
    high = float((all_values + sure * all_deviations).max())
    return (low, high) if high - low > least else None


def _beyond(values: Array) -> list[float]:
    """What is half a step before the first of values: by a line, and by a parabola."""
    line = 1.5 * values[0] - 0.5 * values[1]
    if len(values) < 3:
        return [line]
    return [line, 1.875 * values[0] - 1.25 * values[1] + 0.375 * values[2]]
