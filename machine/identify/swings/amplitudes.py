"""Changes of frequency and damping with the amplitude along one swing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.identified import Part

Array = NDArray[np.float64]


def spread_of(pieces: Sequence[Part], name: str) -> tuple[float, float] | None:
    """Ends of what a parameter is along a swing, by fits of its pieces in order of time.

    None where the pieces agree within their own uncertainty. The ends of the swing are half a piece
    beyond the middle of the first and last pieces: the change goes on there as it was.
    """
    from scipy.special import chdtri  # not at the top: it takes long to load

    chance = 1e-2  # of pieces that agree to differ as much
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
    before = _beyond(values, deviations)
    after = _beyond(values[::-1], deviations[::-1])
    candidates = [*zip(values, deviations), *before, *after]
    low = float(min(value - sure * deviation for value, deviation in candidates))
    high = float(max(value + sure * deviation for value, deviation in candidates))
    if high - low <= least:
        return None
    # what neither line nor parabola has: of four simulated pendulums from 0.4 to 1.35 rad the first
    # frequency was beyond them by 5 % at most
    curved = 0.05 * (high - low)
    return low - curved, high + curved


def _beyond(values: Array, deviations: Array) -> list[tuple[float, float]]:
    """Extrapolate values half a step before the first, by line and parabola, with deviations."""
    weights = [np.array([1.5, -0.5])]
    if len(values) > 2:
        weights.append(np.array([1.875, -1.25, 0.375]))
    return [
        (float(w @ values[: len(w)]), float(np.linalg.norm(w * deviations[: len(w)])))
        for w in weights
    ]
