"""The size of the swing at a frequency over time."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.recordings.recording import Recording, noise_of

Array = NDArray[np.float64]
WINDOW = 3.0
"""Periods that the swing is weighed over, by Hann's window."""


class Envelope(NamedTuple):
    """Times, the amplitude of all signals together in units of their noise, and the noise of it."""

    time: Array
    size: Array
    noise: float


class _Filters(NamedTuple):
    """Weights of samples for cosine and sine, the samples' step, and the signals they are for."""

    weights: Array
    time: Array
    values: Array


def envelope(recording: Recording, frequency: float) -> Envelope | None:
    """The amplitude at a frequency [Hz], free of offset and slope; None where no window fits in."""
    filters = _filters(recording, frequency)
    if filters is None:
        return None
    parts = [_weighed(filters.values, weights) for weights in filters.weights]
    size = np.sqrt(sum((part**2).sum(axis=1) for part in parts))
    noise = float(np.linalg.norm(filters.weights[0]))
    return Envelope(_middles(filters), size, noise)


def phasor(recording: Recording, frequency: float) -> tuple[Array, Any] | None:
    """Times, and the swing there as a complex signal (times, signals) that turns as it swings."""
    filters = _filters(recording, frequency)
    if filters is None:
        return None
    cosine, sine = (_weighed(filters.values, weights) for weights in filters.weights)
    return _middles(filters), cosine - 1j * sine


def _filters(recording: Recording, frequency: float) -> _Filters | None:
    """Cosine, sine, offset and slope are fitted to three periods by weighted least squares.

    That is a filter for each; two are of use.
    """
    least_samples = 4
    time, values = evenly(recording, frequency)
    step = float(time[1] - time[0])
    count = min(round(WINDOW / (frequency * step)), len(time))
    if frequency * step * least_samples > 1 or count < 8:
        return None
    place = (np.arange(count) - (count - 1) / 2) * step
    phase = 2 * np.pi * frequency * place
    shapes = np.stack([np.cos(phase), np.sin(phase), np.ones(count), place], axis=1)
    hann = np.hanning(count + 2)[1:-1]
    products = shapes.T @ (hann[:, None] * shapes)
    weights: Any = np.linalg.solve(products, shapes.T * hann)[:2]
    return _Filters(weights, time, values)


def _middles(filters: _Filters) -> Array:
    """The times of the windows' middles."""
    count = filters.weights.shape[1]
    step = float(filters.time[1] - filters.time[0])
    begins = filters.time[: len(filters.time) - count + 1]
    return begins + (count - 1) / 2 * step


def _weighed(values: Array, weights: Array) -> Array:
    """Sums of every run of rows by weights (rows, signals), by Fourier transforms."""
    from scipy.fft import irfft, next_fast_len, rfft  # not at the top: it takes long to load

    transform: Any = rfft
    transform_back: Any = irfft
    count = len(values)
    size = next_fast_len(count, real=True)
    spectrum = transform(values, size, axis=0)
    of_weights = np.conj(transform(weights, size))
    sums = transform_back(spectrum * of_weights[:, None], size, axis=0)
    return sums[: count - len(weights) + 1]


def evenly(recording: Recording, frequency: float) -> tuple[Array, Array]:
    """Times with the same step, 32 a period, and the signals there in units of their noise."""
    values = recording.values
    largest = np.abs(values).max(axis=0)
    least = 1e-9 * np.ptp(values, axis=0) + 1e-12 * largest + 1e-300
    noise = np.maximum(noise_of(values), least)
    thin = recording.averaged(1 / (32 * frequency * recording.step))
    count = round(float(np.ptp(thin.time)) / thin.step) + 1
    even = np.linspace(thin.time[0], thin.time[-1], count)
    scaled = (thin.values / noise).T
    columns = [np.interp(even, thin.time, column) for column in scaled]
    return even, np.stack(columns, axis=1)
