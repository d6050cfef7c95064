"""Find where a recording rings down by itself, by how its swing grows and decays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.recordings.envelope import WINDOW, Envelope, envelope
from quietarm.machine.recordings.recording import LEAST_ROWS, Recording, noise_of

Array = NDArray[np.float64]
LEAST_PERIODS = 2.0


def find_ring_downs(recording: Recording, frequency: float) -> list[slice]:
    """The rows of every free decay of two periods or more, while the joint is at rest.

    A gap of a period without a sample ends one. Swings below a twentieth of the largest are none.
    """
    sizes = list[float]()
    ring_downs = list[slice]()
    for rest in rests(recording, frequency, gap=1.0):
        part = recording.part(rest)
        swing = envelope(part, frequency)
        if swing is None:
            continue
        for begin, end in _decays(swing, part, frequency):
            rows = recording.rows(begin, end)
            is_long = end - begin > 0.9 * LEAST_PERIODS / frequency
            if is_long and rows.stop - rows.start >= LEAST_ROWS:
                inside = (swing.time >= begin) & (swing.time <= end)
                sizes.append(float(swing.size[inside].max(initial=0.0)))
                ring_downs.append(rows)
    largest = max(sizes, default=0.0)
    return [rows for rows, size in zip(ring_downs, sizes) if size >= 0.05 * largest]


def find_swings(recording: Recording, frequency: float) -> list[slice]:
    """The rows of every rest from its largest swing on, to where it is lost in the noise."""
    swings = list[slice]()
    for rest in rests(recording, frequency, gap=1.0):
        part = recording.part(rest)
        swing = envelope(part, frequency)
        if swing is None:
            continue
        above = swing.time[swing.size > _least(swing)]
        if not len(above):
            continue
        begin = float(swing.time[int(swing.size.argmax())])
        rows = recording.rows(begin, float(above[-1]))
        if rows.stop - rows.start >= LEAST_ROWS:
            swings.append(rows)
    return swings


def rests(recording: Recording, frequency: float, gap: float = np.inf) -> list[slice]:
    """The stretches of some rows in which the joint rests, without a gap of so many periods."""
    at_rest = standing(recording, frequency)
    breaks = np.diff(at_rest) | (np.diff(recording.time) * frequency > gap)
    runs = np.split(np.arange(len(at_rest)), np.flatnonzero(breaks) + 1)
    long_runs = [run for run in runs if at_rest[run[0]] and len(run) >= LEAST_ROWS]
    return [slice(run[0], run[-1] + 1) for run in long_runs]


def _least(swing: Envelope) -> float:
    """The amplitude from which on a swing is above the noise."""
    return max(3 * swing.noise, 1e-6 * float(swing.size.max()))


def _decays(swing: Envelope, part: Recording, frequency: float) -> list[tuple[float, float]]:
    """Begin and end of each stretch in which the amplitude does not grow and is above the noise."""
    time, size, noise = swing
    most_growth = 1.15  # beside the noise a free decay never grows by more
    count = len(size)
    half_window = WINDOW / 2 / frequency
    least = _least(swing)
    step = max(float(np.ptp(time)) / max(count - 1, 1), 1e-300)
    reach = max(1, round(half_window / step))
    decays = list[tuple[float, float]]()
    top = 0
    while top < count:
        if size[top] < least:
            top += 1
            continue
        top = _top(size, top, reach)
        rest = size[top:]
        lowest = np.minimum.accumulate(rest)
        grows = rest > most_growth * lowest + 2 * noise
        ends = np.append((rest < least) | grows, True)
        last = top + int(np.argmax(ends))
        begin = part.time[0] if top == 0 else time[top]
        end = part.time[-1] if last == count else time[last - 1]
        if last < count and size[last] >= least:
            # what pushed it again is in the windows before
            lowest_place = top + int(np.argmin(size[top:last]))
            end = time[lowest_place] - half_window / 3
        if end > begin:
            decays.append((float(begin), float(end)))
        top = max(last, top + 1)
    return decays


def _top(size: Array, place: int, reach: int) -> int:
    """The next place that is not surpassed for so many samples."""
    while ahead := int(np.argmax(size[place : place + reach + 1])):
        place += ahead
    return place


def standing(recording: Recording, frequency: float) -> NDArray[np.bool_]:
    """Return where the joint is at rest: it moves no more in a period than its noise, or creeps.

    A joint that creeps moves less than 3 % of its whole way in a period.
    """
    angle = recording.angle
    if angle is None:
        return np.ones(len(recording.time), bool)
    from scipy.ndimage import maximum_filter1d, minimum_filter1d  # slow to load

    size = max(3, round(1 / (frequency * recording.step)))
    highest: Array = maximum_filter1d(angle, size, mode="nearest")
    lowest: Array = minimum_filter1d(angle, size, mode="nearest")
    moved = highest - lowest
    return moved <= max(_flicker(angle), 0.03 * float(np.ptp(angle)))


def moves(recording: Recording) -> bool:
    """Return whether the joint moves more than its encoder flickers."""
    angle = recording.angle
    return angle is not None and float(np.ptp(angle)) > _flicker(angle)


def _flicker(angle: Array) -> float:
    """Largest range that an encoder may show of a joint at rest: eight deviations of its noise."""
    return 8.0 * float(noise_of(angle)[0])
