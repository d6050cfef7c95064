"""At which frequency recordings swing, and whether their units can be right."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import tau

import numpy as np
from quietarm.studies.identify.recording import LEAST_ROWS, Recording
from quietarm.studies.identify.ring_downs import envelope, evenly, runs_of, standing

_SLOWEST, _FASTEST = 0.02, 500.0
"""Frequencies [Hz] that no arm has: a wrong unit of the time is more likely."""
_COARSE, _DOUBTFUL = 0.2, 0.1
"""A step [s] and a frequency [Hz] that may come from a time in milliseconds."""
_TURNS = 2 * tau
"""A joint that turns further may be in degrees."""
_STRETCHES = (1, 4, 16, 64)
_STANDS_OUT = 1.5
"""How far a peak of a spectrum is above what is beside it, as a logarithm."""
_CANDIDATES, _APART = 4, 0.05
_SAME, _LOUD = 0.3, 0.05
"""Recordings of one machine swing within this share of each other; and a candidate there is taken
where it has this share of the loudest."""


def find_frequencies(recordings: Sequence[Recording]) -> list[float]:
    """The frequency of every recording's swing [Hz]: that of all, where it is a candidate.

    0 where nothing swings; ValueError where nothing does in any, or as no arm does.
    """
    tables = [_candidates_of(one) for one in recordings]
    if not any(any(table.values()) for table in tables):
        raise ValueError(
            f"{recordings[0].name}: no swing stands out of the noise; push harder, or record "
            "longer and with more samples"
        )
    shares = [
        {f: loud / (sum(table.values()) or 1) for f, loud in table.items()} for table in tables
    ]
    common = max(
        (f for table in tables for f in table),
        key=lambda f: sum(max(_near(share, f).values(), default=0.0) for share in shares),
    )
    found: list[float] = []
    for one, share in zip(recordings, shares, strict=True):
        near, loudest = _near(share, common), max(share.values(), default=0.0)
        among = near if max(near.values(), default=0.0) > _LOUD * loudest else share
        best = max(among, key=lambda f: among[f]) if loudest else 0.0
        if best and not _SLOWEST <= best <= _FASTEST:
            raise ValueError(
                f"{one.name} swings at {best:.3g} Hz, as no arm does; is its time in another "
                "unit? say so by --units, as time:ms"
            )
        found.append(best)
    return found


def _near(table: Mapping[float, float], frequency: float) -> dict[float, float]:
    """The candidates near a frequency."""
    return {one: loud for one, loud in table.items() if abs(one / frequency - 1) < _SAME}


def doubt_units(recordings: Sequence[Recording], frequencies: Sequence[float]) -> list[str]:
    """What units may be wrong."""
    found: list[str] = []
    for one, frequency in zip(recordings, frequencies, strict=True):
        turns = 0.0 if one.angle is None else float(np.ptp(one.angle))
        slow = f"{frequency:.3g} Hz by samples {one.step:.3g} s apart; is its time in milliseconds?"
        fast = f"{frequency:.4g} Hz is fast for an arm; is its time in seconds?"
        turned = f"its joint turns by {turns:.3g} rad, more than two turns; is it in degrees?"
        doubts = [
            (one.step >= _COARSE or 0 < frequency < _DOUBTFUL, slow, "time:ms"),
            (frequency > _FASTEST / 2, fast, "time:s"),
            (turns > _TURNS, turned, "angle:deg"),
        ]
        found += [
            f"{one.name}: {text} say so by --units {unit}" for is_so, text, unit in doubts if is_so
        ]
    return found


def _longest_rest(recording: Recording) -> Recording:
    """The longest stretch in which the joint is at rest; all where there is no fifth of it."""
    at_rest = standing(recording, 10 / float(np.ptp(recording.time)))
    runs = runs_of(at_rest)
    first, last = max(runs, key=lambda run: run[1] - run[0], default=(0, 0))
    long = last - first >= max(len(at_rest) / 5, LEAST_ROWS)
    return recording.part(slice(first, last)) if long else recording


def _candidates_of(recording: Recording) -> dict[float, float]:
    """Candidates of the longest rest, or where nothing swings there of the whole recording."""
    at_rest = _candidates(_longest_rest(recording))
    return at_rest if any(at_rest.values()) else _candidates(recording)


def _candidates(recording: Recording) -> dict[float, float]:
    """Frequencies [Hz] at which a recording swings and how loud, by spectra of stretches of it.

    Peaks of displacement and of speed: the one is steep beside a slow motion, the other is not.
    """
    from scipy.signal import find_peaks, spectrogram  # not at the top: it takes long to load

    even, y = evenly(recording, 1 / (32 * recording.step))
    rate, total = 1 / float(even[1] - even[0]), len(even)
    found: dict[float, float] = {}
    for length in (total // share for share in _STRETCHES if total // share >= 32):
        at, _, power = spectrogram(
            y, rate, "hann", length, length // 2, 4 * length, detrend="linear", axis=0
        )
        known = slice(int(np.searchsorted(at, 1.5 * rate / length)), None)
        levels = np.log(power.sum(axis=1).max(axis=-1)[known] + 1e-300)
        for order in (0, 2):
            steep = levels + order * np.log(at[known])
            peaks, _ = find_peaks(steep, prominence=_STANDS_OUT)
            for k in peaks[np.argsort(steep[peaks])[::-1][:_CANDIDATES]]:
                one = float(at[known][k])
                if all(abs(one / other - 1) > _APART for other in found):
                    found[one] = _prominence(recording, one)
    return found


def _prominence(recording: Recording, frequency: float) -> float:
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
