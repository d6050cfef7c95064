"""Where a recording rings down by itself: found by how its swing grows and decays."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from quietarm.studies.identify.recording import LEAST_ROWS, Recording, noise_of
from quietarm.studies.identify.running import running_maximum, running_minimum

Array = NDArray[np.float64]

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
_FLICKERS = 8.0
"""Deviations of an encoder's noise, within which it stands."""


class Envelope(NamedTuple):
    """Times, the amplitude of all signals together in units of their noise, and the noise of it."""

    time: Array
    size: Array
    noise: float


def envelope(recording: Recording, frequency: float) -> Envelope | None:
    """The amplitude at a frequency over time, free of offset and slope; None where none fits in.

    Cosine, sine, offset and slope are fitted to three periods at a time by weighted least squares:
    that is two filters.
    """
    even, y = evenly(recording, frequency)
    h = float(even[1] - even[0])
    count = min(round(_WINDOW / (frequency * h)), len(even))
    if frequency * h * _LEAST_SAMPLES > 1 or count < 8:
        return None
    t = (np.arange(count) - (count - 1) / 2) * h
    phase = 2 * np.pi * frequency * t
    X = np.stack([np.cos(phase), np.sin(phase), np.ones(count), t], axis=1)
    weight = np.hanning(count + 2)[1:-1]
    kernel = np.linalg.solve(X.T @ (weight[:, None] * X), X.T * weight)[:2]
    parts = [_weighed(y, weights) for weights in kernel]
    size = np.sqrt(sum((part**2).sum(axis=1) for part in parts))
    return Envelope(even[: len(size)] + (count - 1) / 2 * h, size, float(np.linalg.norm(kernel[0])))


def _weighed(values: Array, weights: Array) -> Array:
    """Sums of every run of rows by weights (rows, signals), by Fourier transforms."""
    from scipy.fft import irfft, next_fast_len, rfft  # not at the top: it takes long to load

    transform: Any = rfft
    back: Any = irfft
    count = len(values)
    size = next_fast_len(count, real=True)
    spectrum = transform(values, size, axis=0)
    of_weights = np.conj(transform(weights, size))
    sums = back(spectrum * of_weights[:, None], size, axis=0)
    return sums[: count - len(weights) + 1]


def evenly(recording: Recording, frequency: float) -> tuple[Array, Array]:
    """Times with the same step, 32 a period, and the signals there in units of their noise."""
    values = recording.values
    least = 1e-9 * np.ptp(values, axis=0) + 1e-12 * np.abs(values).max(axis=0) + 1e-300
    noise = np.maximum(noise_of(values), least)
    thin = recording.averaged(1 / (32 * frequency * recording.step))
    count = round(float(np.ptp(thin.time)) / thin.step) + 1
    even = np.linspace(thin.time[0], thin.time[-1], count)
    columns = [np.interp(even, thin.time, column) for column in (thin.values / noise).T]
    return even, np.stack(columns, axis=1)


def find_ring_downs(recording: Recording, frequency: float) -> list[slice]:
    """The rows of every free decay of two periods or more, while the joint is at rest."""
    sizes, found = list[float](), list[slice]()
    for rest in rests(recording, frequency, _GAP):
        part = recording.part(rest)
        swing = envelope(part, frequency)
        for begin, end in [] if swing is None else _decays(swing, part, frequency):
            rows, long = recording.rows(begin, end), 0.9 * LEAST_PERIODS / frequency
            if swing and end - begin > long and rows.stop - rows.start >= LEAST_ROWS:
                among = (swing.time >= begin) & (swing.time <= end)
                sizes.append(float(swing.size[among].max(initial=0.0)))
                found.append(rows)
    return [rows for rows, size in zip(found, sizes) if size >= _SMALLEST * max(sizes)]


def rests(recording: Recording, frequency: float, gap: float = np.inf) -> list[slice]:
    """The stretches of some rows in which the joint rests, without a gap of so many periods."""
    at_rest = standing(recording, frequency)
    breaks = np.diff(at_rest) | (np.diff(recording.time) * frequency > gap)
    runs = np.split(np.arange(len(at_rest)), np.flatnonzero(breaks) + 1)
    long = [run for run in runs if at_rest[run[0]] and len(run) >= LEAST_ROWS]
    return [slice(run[0], run[-1] + 1) for run in long]


def _decays(swing: Envelope, part: Recording, frequency: float) -> list[tuple[float, float]]:
    """Begin and end of each stretch in which the amplitude does not grow and is above the noise."""
    time, size, noise = swing
    half, count = _WINDOW / 2 / frequency, len(size)
    least = max(3 * noise, 1e-6 * float(size.max()))
    reach = max(1, round(half / max(float(np.ptp(time)) / max(count - 1, 1), 1e-300)))
    found, top = list[tuple[float, float]](), 0
    while top < count:
        if size[top] < least:
            top += 1
            continue
        # up to the top: where it has not been surpassed for half a window
        while ahead := int(np.argmax(size[top : top + reach + 1])):
            top += ahead
        rest = size[top:]
        grows = rest > _GROWS * np.minimum.accumulate(rest) + 2 * noise
        last = top + int(np.argmax(np.append((rest < least) | grows, True)))
        begin = part.time[0] if top == 0 else time[top]
        end = part.time[-1] if last == count else time[last - 1]
        if last < count and size[last] >= least:  # what pushed it again is in the windows before
            end = time[top + int(np.argmin(size[top:last]))] - half / 3
        if end > begin:
            found.append((float(begin), float(end)))
        top = max(last, top + 1)
    return found


def standing(recording: Recording, frequency: float) -> NDArray[np.bool_]:
    """Where the joint is at rest: it moves no more in a period than its noise, or creeps."""
    angle = recording.angle
    if angle is None:
        return np.ones(len(recording.time), bool)
    size = max(3, round(1 / (frequency * recording.step)))
    moved = running_maximum(angle, size) - running_minimum(angle, size)
    return moved <= max(_flicker(angle), _CREEPS * float(np.ptp(angle)))


def moves(recording: Recording) -> bool:
    """Whether the joint moves more than its encoder flickers."""
    angle = recording.angle
    return angle is not None and float(np.ptp(angle)) > _flicker(angle)


def _flicker(angle: Array) -> float:
    return _FLICKERS * float(noise_of(angle)[0])
