"""Where a recording rings down by itself, and how fast."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from quietarm.studies.identify.recording import LEAST_ROWS, Recording
from quietarm.studies.identify.response import Joint

Array = NDArray[np.float64]

LEAST_PERIODS = 2.0
_STILL = 0.01
"""Share of its largest speed below which a joint stands."""
_PADDED = 8
_GROWS = 1.1
"""Factor by which the swing of a free decay never grows from one period to the next."""
_LOUD = 3.0
"""A ring-down begins with so many times the noise."""


def standstills(recording: Recording, joint: Joint) -> list[Recording]:
    """The parts of a recording in which its joint stands, at least for a twentieth of its time."""
    if not joint.moves:
        return [recording]
    speed = np.abs(joint.at(recording.time)[1])
    return [
        recording.part(first, last)
        for first, last in _runs(speed < _STILL * speed.max())
        if last - first >= max(LEAST_ROWS, len(speed) / 20)
    ]


def ring_downs(recording: Recording, joint: Joint, frequency: float) -> list[Recording]:
    """The parts of a recording in which it swings freely, for two periods [1/Hz] or more."""
    return [
        decay
        for still in standstills(recording, joint)
        for decay in _decays(still, frequency)
        if decay.periods(frequency) >= LEAST_PERIODS
    ]


def strongest_frequency(recordings: Sequence[Recording]) -> float:
    """Where the spectra of recordings have their highest peak [Hz]."""
    longest = max(one.time[-1] - one.time[0] for one in recordings)
    shortest = min(float(np.median(np.diff(one.time))) for one in recordings)
    count = _PADDED * int(longest / shortest)
    total = np.zeros(count // 2 + 1)
    for one in recordings:
        even = np.arange(one.time[0], one.time[-1], shortest)
        for values in _swings(one).T:
            y = np.interp(even, one.time, values)
            y = (y - np.polynomial.Polynomial.fit(even, y, 1)(even)) * np.hanning(len(y))
            total += np.abs(np.fft.rfft(y, count)) ** 2 / max(float(y @ y), 1e-300)
    at = np.fft.rfftfreq(count, shortest)
    least = 1.5 / longest  # below there is the trend
    return float(at[np.argmax(np.where(at >= least, total, 0.0))])


def _swings(recording: Recording) -> Array:
    """What shows the ringing best."""
    signals = recording.signals
    return next(signals[name] for name in ("tip", "acceleration", "torque") if name in signals)


def _decays(still: Recording, frequency: float) -> list[Recording]:
    """Parts in which the swing over a period does not grow, and begins well above the noise."""
    time, values = still.time, _swings(still)
    period = max(4, round(1 / (frequency * float(np.median(np.diff(time))))))
    hop = max(1, period // 4)
    begins = np.arange(0, len(time) - period + 1, hop)
    if len(begins) == 0:
        return []
    windows = np.array([values[k : k + period] for k in begins])
    swing = windows.std(axis=1).max(axis=1)
    smooth = windows - (np.roll(windows, 1, axis=1) + np.roll(windows, -1, axis=1)) / 2
    noise = float(np.median(np.abs(smooth[:, 1:-1]))) + 1e-12 * float(np.ptp(values))
    found: list[tuple[int, int]] = []
    first = 0
    for k in range(4, len(swing) + 1):
        ends = k == len(swing) or swing[k] > _GROWS * swing[k - 4] + noise
        if ends and k > first:
            found.append((first, k - 1))
        if ends:
            first = k
    kept: list[Recording] = []
    for first, last in found:
        top = first + int(swing[first : last + 1].argmax())
        begin = begins[top] + (period if top > 0 else 0)  # what pushed it may be in this window
        end = begins[last] + period
        if swing[top] > _LOUD * noise and end - begin >= max(period, LEAST_ROWS):
            kept.append(still.part(int(begin), int(end)))
    return kept


def _runs(yes: NDArray[np.bool_]) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], yes.astype(int), [0]])))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
