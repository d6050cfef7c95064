"""Samples that recorders and sensors make up: far from all beside them, and left out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.recordings.recording import Recording, noise_of

Array = NDArray[np.float64]


def without_glitches(
    recordings: Sequence[Recording],
) -> tuple[list[Recording], list[str]]:
    """The recordings without the rows of glitches, and in words what was mended in each."""
    most = 0.1  # share of the rows: where more stand out, that is how the sensor is
    mended = list[Recording]()
    notes = list[str]()
    for recording in recordings:
        columns = [values.reshape(len(values), -1) for values in recording.measured.values()]
        glitches = np.zeros(len(recording.time), bool)
        for column in np.hstack(columns).T:
            glitches |= _glitches(recording.time, column)
        count = int(np.count_nonzero(glitches))
        notes += [f"{recording.name}: {change}" for change in recording.mended.values()]
        if 0 < count <= most * len(glitches):
            samples = "1 sample is" if count == 1 else f"{count} samples are"
            notes.append(f"{recording.name}: {samples} left out, far from all beside")
            recording = recording.part(~glitches)
        mended.append(recording)
    return mended, notes


def _glitches(time: Array, values: Array) -> NDArray[np.bool_]:
    """Samples that leave both neighbours on the same side, by far more than is usual nearby."""
    far_from_usual = 8.0  # deviations of what is usual nearby
    glitches = np.zeros(len(values), bool)
    plain = values.copy()
    noise = float(noise_of(values)[0])
    for length in (1, 2, 4):  # samples that a glitch lasts at most
        if len(values) < 8 * length:
            break
        for _ in range(8):
            between, spike = _by_neighbours(time, plain, length)
            usual = np.maximum(_usual(plain - between), 1.4 * noise)
            far = np.abs(spike) > far_from_usual * usual
            far &= ~glitches
            if not far.any():
                break
            # what is beside a larger one is judged once that is replaced
            largest = _largest_nearby(np.abs(plain - between), 2 * length)
            new = far & (np.abs(plain - between) >= 0.8 * largest)
            glitches |= new
            plain[new] = between[new]
            again = glitches & ~new
            between, _ = _by_neighbours(time, plain, length)
            plain[again] = between[again]
    return _that_return(values, glitches)


def _that_return(values: Array, candidates: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Keep the samples that stand out after which the signal is back: a step is no glitch."""
    far_out = 3.0  # times the steps of the signal beside a glitch, by which it begins and ends
    glitches = candidates.copy()
    last = len(values) - 1
    ends = np.flatnonzero(np.diff(np.concatenate([[False], candidates, [False]])))
    for first, after in ends.reshape(-1, 2):
        before = max(first - 1, 0)
        behind = min(after, last)
        jumps = np.abs([values[first] - values[before], values[after - 1] - values[behind]])
        step_before = np.ptp(values[[max(before - 1, 0), before]])
        step_behind = np.ptp(values[[behind, min(behind + 1, last)]])
        if jumps.min() <= far_out * max(step_before, step_behind):
            glitches[first:after] = False
    return glitches


def _by_neighbours(time: Array, values: Array, reach: int) -> tuple[Array, Array]:
    """Each sample by the cubic through two on each side, and how far it is beyond the nearest two.

    A sample at an end or beside a gap is its own neighbour.
    """
    between = values.copy()
    spike = np.zeros(len(values))
    inner = slice(2 * reach, -2 * reach)
    offsets = (-2 * reach, -reach, reach, 2 * reach)
    count = len(values) - 4 * reach
    starts = [2 * reach + offset for offset in offsets]
    t = np.stack([time[k : k + count] - time[inner] for k in starts])
    y = np.stack([values[k : k + count] for k in starts])
    whole = np.ptp(t, axis=0) <= 1.5 * 4 * reach * float(np.median(np.diff(time)))
    weights = np.ones_like(t)
    for i in range(4):
        for j in range(4):
            if i != j:
                weights[i] *= -t[j] / (t[i] - t[j])
    at = values[inner]
    between[inner] = np.where(whole, (weights * y).sum(axis=0), at)
    beyond = at - np.clip(at, np.minimum(y[1], y[2]), np.maximum(y[1], y[2]))
    spike[inner] = np.where(whole, beyond, 0.0)
    return between, spike


def _usual(residual: Array) -> Array:
    """The robust deviation of residuals in each block of samples, or in one beside it."""
    block = 32
    count = max(len(residual) // block, 1)
    sizes = np.abs(residual)
    size = len(residual) // count
    usual = 1.4826 * np.median(sizes[: count * size].reshape(count, size), axis=1)
    blocks = np.minimum(np.arange(len(residual)) // size, count - 1)
    return _largest_nearby(usual, 1)[blocks]


def _largest_nearby(sizes: Array, reach: int) -> Array:
    from scipy.ndimage import maximum_filter1d  # slow to load

    largest: Array = maximum_filter1d(sizes, 2 * reach + 1, mode="nearest")
    return largest
