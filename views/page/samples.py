"""Curves and moving figures in few numbers: samples where they are needed, in 16 bits."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_FULL = 32767
"""The largest whole number of 16 bits."""


def packed(rows: Array) -> dict[str, Any]:
    """Rows of numbers as 16-bit integers, little-endian in base64.

    Parameters
    ----------
    rows : ndarray, shape (motions, lines, samples)
        The numbers; each line has a unit of its own, common to all motions.

    Returns
    -------
    dict
        `data`, the `units` that the integers count, one for each line, and the samples of a row.
    """
    _, lines, samples = rows.shape
    peaks = np.abs(rows).max(axis=(0, 2), initial=0.0)
    units = np.where(peaks > 0, peaks / _FULL, 1.0)
    whole = np.rint(rows / units[:, None]).astype("<i2")
    data = base64.b64encode(whole.tobytes()).decode()
    return {"data": data, "units": units.tolist(), "lines": lines, "samples": samples}


def unpacked(block: dict[str, Any]) -> Array:
    """The rows that the page reads, shape (motions, lines, samples)."""
    whole = np.frombuffer(base64.b64decode(block["data"]), "<i2").astype(float)
    shaped = whole.reshape(-1, block["lines"], block["samples"])
    return shaped * np.array(block["units"])[:, None]


def needed_samples(
    times: Array, rows: Array, always: NDArray[np.intp], tolerance: float
) -> NDArray[np.intp]:
    """Return which samples keep straight lines between them close to all rows.

    Parameters
    ----------
    times : ndarray, shape (samples,)
        Times of the fine samples, increasing.
    rows : ndarray, shape (rows, samples)
        Curves, each as a share of the peak that its error is measured by.
    always : ndarray of int
        Samples that are needed in any case, as that of the arrival; the ends are, too.
    tolerance : float
        Largest distance of a line from its curve.
    """
    is_chosen = np.zeros(len(times), dtype=bool)
    is_chosen[[0, len(times) - 1, *always]] = True
    while True:
        chosen = np.flatnonzero(is_chosen)
        distance = np.zeros(len(times))
        for row in rows:
            straight = np.interp(times, times[chosen], row[chosen])
            distance = np.maximum(distance, np.abs(row - straight))
        farthest = [
            begin + int(np.argmax(distance[begin : end + 1])) for begin, end in pairwise(chosen)
        ]
        added = [place for place in farthest if distance[place] > tolerance]
        if not added:
            return chosen
        is_chosen[added] = True


@dataclass(frozen=True)
class Shapes:
    """Moving points as sums of a few shapes: points = mean + sum of scores * shapes.

    Attributes
    ----------
    mean : ndarray, shape (coordinates,)
        The points on average, x and y in turn [m].
    shapes : ndarray, shape (shapes, coordinates)
        Directions in which they move.
    scores : ndarray, shape (samples, shapes)
        How far [m].
    """

    mean: Array
    shapes: Array
    scores: Array


def shapes_of(coordinates: Array, tolerance: float) -> Shapes:
    """The fewest shapes that give coordinates, shape (samples, coordinates), within a distance [m].

    They are principal components, so that a straight link that turns has two, one that bends as
    well has four.
    """
    mean = coordinates.mean(axis=0)
    moved = coordinates - mean
    shapes = _fewest(moved, _principal(moved, _SOME), tolerance)
    if not _is_close(moved, shapes, tolerance):
        shapes = _fewest(moved, _principal(moved, len(moved)), tolerance)
    return Shapes(mean, shapes, moved @ shapes.T)


def _fewest(moved: Array, directions: Array, tolerance: float) -> Array:
    """The first directions that give rows within a distance, or all of them."""
    for count in range(len(directions)):
        if _is_close(moved, directions[:count], tolerance):
            return directions[:count]
    return directions


def _is_close(moved: Array, shapes: Array, tolerance: float) -> bool:
    """Return whether rows are within a distance of sums of shapes."""
    return bool(np.abs(moved - moved @ shapes.T @ shapes).max() <= tolerance)


_SOME = 40
"""Frames whose span mostly has all shapes; principal components of all coordinates take longer."""


def _principal(moved: Array, frames: int) -> Array:
    """Principal components of rows within the span of some of them, the largest first."""
    places = np.unique(np.linspace(0, len(moved) - 1, frames).astype(int))
    basis = np.linalg.qr(moved[places].T)[0]
    within = moved @ basis
    _, turns = np.linalg.eigh(within.T @ within)
    return (basis @ turns[:, ::-1]).T
