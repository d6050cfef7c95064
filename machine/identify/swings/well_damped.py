"""Swings that are over after a period or two: found by how they cross the place of their rest.

Their spectrum has no peak, and their amplitude is below the noise before an envelope shows it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.recordings.recording import LEAST_ROWS, Recording, noise_of

Array = NDArray[np.float64]
_REST = 0.1
"""Share of the rows, the last, that tell where the signal rests."""
_LARGE = 0.3
"""Of the largest, a displacement that may begin a swing."""
_ABOVE = 5.0
"""Times the noise, from which on a displacement counts."""
_RELEASED = 0.85
"""Of its largest displacement, below which a swing is free."""
_LEAST_PERIODS, _LASTS = 0.75, 4.0
"""Periods that are read of a swing."""
_FALLS = 0.85
"""How much of a displacement is left half a period later, at most."""
_SMOOTH = 9


def find_well_damped(recording: Recording) -> list[tuple[slice, float]]:
    """The rows of every swing that is damped well, and its frequency [Hz]."""
    from scipy.ndimage import uniform_filter1d  # slow to load

    time, values = recording.time, recording.values
    noise = noise_of(values)
    column = int((np.ptp(values, axis=0) / np.maximum(noise, 1e-300)).argmax())
    rest = np.median(values[-max(LEAST_ROWS // 2, int(_REST * len(time))) :, column])
    size = min(_SMOOTH, max(1, len(time) // 100))
    away: Array = uniform_filter1d(values[:, column] - rest, size, mode="nearest")
    least = max(_ABOVE * float(noise[column]) / size**0.5, 0.01 * float(np.abs(away).max()))
    # from one side to the other, without what is near the rest
    sides = np.where(np.abs(away) > least, np.sign(away), 0.0)
    there = np.flatnonzero(sides)
    if not len(there):
        return []
    turns = np.flatnonzero(np.diff(sides[there])) + 1
    stretches = np.split(there, turns)
    peaks = [int(run[np.abs(away[run]).argmax()]) for run in stretches]
    heights = np.abs(away[peaks])
    swings = list[tuple[slice, float]]()
    for k in range(len(peaks) - 1):
        begins = k == 0 or heights[k] > heights[k - 1]
        if not begins or heights[k] < _LARGE * heights.max():
            continue
        if heights[k + 1] > _FALLS * heights[k]:
            continue
        later = [j for j in range(k + 1, len(peaks)) if heights[j] > heights[j - 1]]
        end = stretches[later[0]][0] if later else len(time)
        run = stretches[k]
        first = int(run[np.abs(away[run]) >= _RELEASED * heights[k]][-1]) + 1
        crossing = _crossing(time, away, run[-1], stretches[k + 1][0])
        half = 2 * (float(time[peaks[k + 1]]) - crossing)
        if k + 2 < (later[0] if later else len(peaks)):
            half = _crossing(time, away, stretches[k + 1][-1], stretches[k + 2][0]) - crossing
        frequency = 0.5 / max(half, recording.step)
        last = int(np.searchsorted(time, time[first] + _LASTS / frequency))
        rows = slice(first, min(int(end), last))
        lasts = float(time[rows.stop - 1] - time[first]) * frequency
        if rows.stop - rows.start >= LEAST_ROWS and lasts >= _LEAST_PERIODS:
            swings.append((rows, frequency))
    return swings


def _crossing(time: Array, away: Array, before: int, after: int) -> float:
    """Return when a displacement is zero between two rows of different sides."""
    share = away[before] / (away[before] - away[after])
    return float(time[before] + share * (time[after] - time[before]))
