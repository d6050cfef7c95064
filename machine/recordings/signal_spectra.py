"""Spectra of stretches of a signal, and their peaks.

`scipy.signal.spectrogram` and `find_peaks` give the same, and take 0.35 s to load.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def spectrogram(values: Array, length: int) -> Array:
    """Power of all signals together, by frequency and stretch.

    Parameters
    ----------
    values : array, shape (rows, signals)
        At an even rate.
    length : int
        Samples of a stretch, of which the next begins halfway.

    Returns
    -------
    array, shape (frequencies, stretches)
        The frequencies are those of four times the length, so that a peak is found closely.
    """
    starts = np.arange(0, len(values) - length + 1, length - length // 2)
    window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(length) / length)
    columns = []
    for start in starts:
        stretch = _without_line(values[start : start + length])
        spectrum = np.fft.rfft(window[:, None] * stretch, 4 * length, axis=0)
        columns.append((np.abs(spectrum) ** 2).sum(axis=1))
    return np.stack(columns, axis=1)


def _without_line(values: Array) -> Array:
    """Columns less the line through each."""
    place = np.linspace(-1.0, 1.0, len(values))
    slope = (place @ values) / (place @ place)
    return values - values.mean(axis=0) - place[:, None] * slope


def highest_peaks(levels: Array, most: int, least_prominence: float) -> list[int]:
    """Places of the highest peaks that stand out of what is beside them, the highest first."""
    peaks = list[int]()
    for place in _maxima_by_height(levels):
        if _prominence(levels, place) >= least_prominence:
            peaks.append(place)
        if len(peaks) == most:
            break
    return peaks


def _maxima_by_height(levels: Array) -> Iterator[int]:
    """Places that are higher than both beside them, the highest first."""
    inner = levels[1:-1]
    is_maximum = (inner > levels[:-2]) & (inner >= levels[2:])
    maxima = np.flatnonzero(is_maximum) + 1
    by_height = np.argsort(levels[maxima])[::-1]
    yield from maxima[by_height].tolist()


def _prominence(levels: Array, place: int) -> float:
    """Return the drop from a place before a higher one is reached, on either side."""
    height = levels[place]
    higher_before = np.flatnonzero(levels[:place] > height)
    higher_after = np.flatnonzero(levels[place + 1 :] > height)
    first = higher_before[-1] if len(higher_before) else 0
    last = place + 1 + higher_after[0] if len(higher_after) else len(levels)
    base = max(levels[first : place + 1].min(), levels[place:last].min())
    return float(height - base)
