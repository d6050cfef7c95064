"""Where a recording rings down by itself: found by how its swing grows and decays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from quietarm.studies.identify.recording import LEAST_ROWS, Recording, noise_of

Array = NDArray[np.float64]
Run = tuple[int, int]

LEAST_PERIODS = 2.0
_WINDOW = 3.0
"""Periods that the swing is weighed over, by Hann's window."""
_LEAST_SAMPLES = 4
"""A period has to have."""
_GAP = 1.0
"""Periods without a sample, after which another part begins."""
_GROWS = 1.15
"""Factor by which a free decay never grows, beside the noise."""
_SMALLEST = 0.05
"""Of the largest swing: smaller ones are not called ring-downs."""
_CREEPS = 0.03
"""Of its whole way, what a joint may move in a period and be called at rest."""
_CANDIDATES, _APART = 4, 0.05
_STRETCHES = (1, 4, 16, 64)
_STANDS_OUT = 1.5
"""How far a peak of a spectrum is above what is beside it, as a logarithm."""


@dataclass(frozen=True, eq=False)
class Envelope:
    """How much a recording swings at a frequency.

    Attributes
    ----------
    frequency : float
        [Hz].
    time, size : array
        Amplitude, of several signals together, in units of their noise.
    noise : float
        Of it.
    """

    frequency: float
    time: Array
    size: Array
    noise: float


def envelope(
    recording: Recording, frequency: float, values: Array | None = None
) -> Envelope | None:
    """The amplitude at a frequency over time, free of offset and slope; None where none fits in.

    Cosine, sine, offset and slope are fitted to three periods at a time by weighted least squares:
    that is two filters.
    """
    from scipy.signal import fftconvolve  # not at the top: it takes long to load

    even, y = _evenly(recording, frequency, recording.values if values is None else values)
    h = float(even[1] - even[0])
    count = min(round(_WINDOW / (frequency * h)), len(even))
    if frequency * h * _LEAST_SAMPLES > 1 or count < 8:
        return None
    t = (np.arange(count) - (count - 1) / 2) * h
    phase = 2 * np.pi * frequency * t
    X = np.stack([np.cos(phase), np.sin(phase), np.ones(count), t], axis=1)
    weight = np.hanning(count + 2)[1:-1]
    kernel = np.linalg.solve(X.T @ (weight[:, None] * X), X.T * weight)[:2]
    parts = [fftconvolve(y, k[::-1, None], mode="valid", axes=0) for k in kernel]
    noise = float(np.linalg.norm(kernel[0]))
    size = np.sqrt(sum((part**2).sum(axis=1) for part in parts))
    return Envelope(frequency, even[: len(size)] + (count - 1) / 2 * h, size, noise)


def _evenly(recording: Recording, frequency: float, values: Array) -> tuple[Array, Array]:
    """Times with the same step, and the signals there in units of their noise."""
    time = recording.time
    least = 1e-9 * np.ptp(values, axis=0) + 1e-12 * np.abs(values).max(axis=0) + 1e-300
    noise = np.maximum(noise_of(values), least)
    thin = max(1, int(1 / (32 * frequency * recording.step)))
    rows = len(time) // thin * thin
    mean = lambda x: x[:rows].reshape(-1, thin, *x.shape[1:]).mean(axis=1)  # noqa: E731
    time, y = mean(time), mean(values / noise)
    count = round(float(np.ptp(time)) / float(np.median(np.diff(time)))) + 1
    even = np.linspace(time[0], time[-1], count)
    return even, np.stack([np.interp(even, time, column) for column in y.T], axis=1)


def candidates(recording: Recording) -> list[float]:
    """Frequencies [Hz] at which a recording swings, by spectra of long and short stretches of it.

    Peaks of displacement and of speed: the one is steep beside a slow motion, the other is not.
    """
    from scipy.signal import find_peaks, spectrogram  # not at the top: it takes long to load

    even, y = _evenly(recording, 1 / (32 * recording.step), recording.values)
    rate, total = 1 / float(even[1] - even[0]), len(even)
    found: list[float] = []
    for share in _STRETCHES:
        length = total // share
        if length < 32:
            break
        at, _, power = spectrogram(
            y, rate, "hann", length, length // 2, 4 * length, detrend="linear", axis=0
        )
        known = slice(int(np.searchsorted(at, 1.5 * rate / length)), None)
        levels = np.log(power.sum(axis=1).max(axis=-1)[known] + 1e-300)
        for order in (0, 2):
            steep = levels + order * np.log(at[known])
            peaks, _ = find_peaks(steep, prominence=_STANDS_OUT)
            best = peaks[np.argsort(steep[peaks])[::-1][:_CANDIDATES]]
            found += [float(at[known][k]) for k in best]
    apart: list[float] = []
    for one in found:
        if all(abs(one / other - 1) > _APART for other in apart):
            apart.append(one)
    return apart


def prominence(recording: Recording, frequency: float) -> float:
    """How much a recording rings at a frequency: the square of the amplitude, summed over periods.

    Of an accelerometer as a displacement, so that a fast mode does not hide a slow one.
    """
    swing = envelope(recording, frequency)
    if swing is None:
        return 0.0
    loud = swing.size > 4 * swing.noise
    step = float(swing.time[1] - swing.time[0]) if len(swing.time) > 1 else recording.step
    accelerates = "acceleration" in recording.signals and "tip" not in recording.signals
    order = -4 if accelerates else 0
    return float((swing.size[loud] ** 2).sum()) * step * frequency ** (1 + order)


def ring_downs(recording: Recording, frequency: float, standing: NDArray[np.bool_]) -> list[slice]:
    """The rows of every free decay of two periods or more, while the joint is at rest."""
    found: list[tuple[float, slice]] = []
    for run in _runs(_between_gaps(recording, frequency), standing):
        if run[1] - run[0] < LEAST_ROWS:
            continue
        part = recording.part(slice(*run))
        if (swing := envelope(part, frequency)) is None:
            continue
        for begin, end in _decays(swing, part):
            rows = recording.rows(begin, end)
            if (
                end - begin
            ) * frequency > 0.9 * LEAST_PERIODS and rows.stop - rows.start >= LEAST_ROWS:
                among = (swing.time >= begin) & (swing.time <= end)
                found.append((float(swing.size[among].max(initial=0.0)), rows))
    largest = max((size for size, _ in found), default=0.0)
    return [rows for size, rows in found if size >= _SMALLEST * largest]


def _between_gaps(recording: Recording, frequency: float) -> list[Run]:
    edges = np.flatnonzero(np.diff(recording.time) * frequency > _GAP) + 1
    ends = [0, *edges.tolist(), len(recording.time)]
    return list(pairwise(ends))


def _runs(between: Sequence[Run], yes: NDArray[np.bool_]) -> list[Run]:
    found: list[Run] = []
    for first, last in between:
        edges = np.flatnonzero(np.diff(np.concatenate([[0], yes[first:last].astype(int), [0]])))
        found += [
            (first + int(a), first + int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)
        ]
    return found


def _decays(swing: Envelope, part: Recording) -> list[tuple[float, float]]:
    """Begin and end of each stretch in which the amplitude does not grow and is above the noise."""
    size, half = swing.size, _WINDOW / 2 / swing.frequency
    least = max(3 * swing.noise, 1e-6 * float(size.max()))
    found: list[tuple[float, float]] = []
    k, count = 0, len(size)
    while k < count:
        if size[k] < least:
            k += 1
            continue
        # up to the top: where it has not been surpassed for half a window
        top = k
        reach = max(
            1, round(half / max(float(swing.time[-1] - swing.time[0]) / max(count - 1, 1), 1e-300))
        )
        while True:
            ahead = top + int(np.argmax(size[top : top + reach + 1]))
            if ahead == top:
                break
            top = ahead
        low, last = size[top], top
        for last in range(top, count):
            low = min(low, size[last])
            if size[last] < least or size[last] > _GROWS * low + 2 * swing.noise:
                break
        else:
            last = count
        grew = last < count and size[last] >= least
        begin = part.time[0] if top == 0 else swing.time[top]
        end = part.time[-1] if last == count else swing.time[last - 1]
        if grew:  # what pushed it again is in the windows before
            bottom = top + int(np.argmin(size[top:last]))
            end = swing.time[bottom] - half / 3
        if end > begin:
            found.append((float(begin), float(end)))
        k = max(last, top + 1)
    return found


def standing(recording: Recording, frequency: float) -> NDArray[np.bool_]:
    """Where the joint is at rest: it moves no more in a period than its noise, or creeps."""
    from scipy.ndimage import maximum_filter1d, minimum_filter1d

    angle = recording.angle
    if angle is None:
        return np.ones(len(recording.time), bool)
    noise = 8 * float(noise_of(angle)[0])
    size = max(3, round(1 / (frequency * recording.step)))
    moved = maximum_filter1d(angle, size) - minimum_filter1d(angle, size)
    return moved <= max(noise, _CREEPS * float(np.ptp(angle)))


def longest_rest(recording: Recording) -> Recording:
    """The longest stretch in which the joint is at rest; all where there is no fifth of it."""
    at_rest = standing(recording, 10 / float(np.ptp(recording.time)))
    runs = _runs([(0, len(at_rest))], at_rest)
    first, last = max(runs, key=lambda run: run[1] - run[0], default=(0, 0))
    long = last - first >= max(len(at_rest) / 5, LEAST_ROWS)
    return recording.part(slice(first, last)) if long else recording


def moves(recording: Recording) -> bool:
    """Whether the joint moves more than its encoder flickers."""
    angle = recording.angle
    return angle is not None and float(np.ptp(angle)) > 8 * float(noise_of(angle)[0])
