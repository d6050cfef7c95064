"""At which frequency recordings swing, and whether their units can be right."""

from __future__ import annotations

from collections.abc import Sequence
from math import tau

import numpy as np
from numpy.typing import NDArray

from quietarm.models.joint_motion import ROTARY
from quietarm.studies.identify.envelope import envelope, evenly
from quietarm.studies.identify.recording import LEAST_ROWS, Recording
from quietarm.studies.identify.ring_downs import rests
from quietarm.studies.identify.spectra import highest_peaks, spectrogram

Array = NDArray[np.float64]
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

    0 where nothing swings; ValueError where one swings as no arm does.
    """
    tables = [np.array([*_candidates_of(one).items()]).reshape(-1, 2).T for one in recordings]
    if not any(loud.any() for _, loud in tables):
        return [0.0] * len(recordings)
    shares = [(f, loud / (loud.sum() or 1.0)) for f, loud in tables]

    def near(f: Array, frequency: float) -> NDArray[np.bool_]:
        return np.abs(f / frequency - 1) < _SAME

    def loudness(frequency: float) -> float:
        return sum(float(share[near(f, frequency)].max(initial=0.0)) for f, share in shares)

    common = max(np.concatenate([f for f, _ in tables]), key=loudness)
    found = list[float]()
    for one, (f, share) in zip(recordings, shares):
        among = share * near(f, common)
        if among.max(initial=0.0) <= _LOUD * share.max(initial=0.0):
            among = share
        best = float(f[among.argmax()]) if share.any() else 0.0
        if best and not _SLOWEST <= best <= _FASTEST:
            raise ValueError(
                f"{one.name} swings at {best:.3g} Hz, as no arm does; is its time in another unit? "
                "say so by --units, as time:ms"
            )
        found.append(best)
    return found


def doubt_units(
    recordings: Sequence[Recording], frequencies: Sequence[float], joint: str
) -> list[str]:
    """What units may be wrong, of a kind of joint."""
    doubts = list[str]()
    for recording, frequency in zip(recordings, frequencies):
        turns = 0.0 if recording.angle is None else float(np.ptp(recording.angle))
        if recording.step >= _COARSE or 0 < frequency < _DOUBTFUL:
            doubts.append(
                f"{recording.name}: {frequency:.3g} Hz by samples {recording.step:.3g} s apart; "
                "is its time in milliseconds? say so by --units time:ms"
            )
        if frequency > _FASTEST / 2:
            doubts.append(
                f"{recording.name}: {frequency:.4g} Hz is fast for an arm; is its time in seconds? "
                "say so by --units time:s"
            )
        if joint == ROTARY and turns > _TURNS:
            doubts.append(
                f"{recording.name}: its joint turns by {turns:.3g} rad, more than two turns; is it "
                "in degrees? say so by --units angle:deg, or rename a column whose name says rad"
            )
    return doubts


def _candidates_of(recording: Recording) -> dict[float, float]:
    """Candidates of the longest rest of the joint, if it is a fifth of the recording.

    Where nothing swings there, those of all of it.
    """
    stretches = rests(recording, 10 / float(np.ptp(recording.time)))
    longest = max(stretches, key=lambda rows: rows.stop - rows.start, default=slice(0, 0))
    if longest.stop - longest.start >= max(len(recording.time) / 5, LEAST_ROWS):
        found = _candidates(recording.part(longest))
        if any(found.values()):
            return found
    return _candidates(recording)


def _candidates(recording: Recording) -> dict[float, float]:
    """Frequencies [Hz] at which a recording swings and how loud, by spectra of stretches of it.

    Peaks of displacement and of speed: the one is steep beside a slow motion, the other is not.
    """
    time, values = evenly(recording, 1 / (32 * recording.step))
    rate, total = 1 / float(time[1] - time[0]), len(time)
    found = dict[float, float]()
    for length in (total // share for share in _STRETCHES if total // share >= 32):
        at = np.fft.rfftfreq(4 * length, 1 / rate)
        loudest = spectrogram(values, length).max(axis=1)
        known = slice(int(np.searchsorted(at, 1.5 * rate / length)), None)
        levels = np.log(loudest[known] + 1e-300)
        for order in (0, 2):
            steep = levels + order * np.log(at[known])
            for k in highest_peaks(steep, _CANDIDATES, _STANDS_OUT):
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
    windows = len(swing.size) / 32 + 1  # a window has some hundred samples, and they overlap
    level = max(4.0, 1 + (2 * np.log(windows)) ** 0.5)  # noise passes it in few recordings
    loud = swing.size[swing.size > level * swing.noise]
    step = float(swing.time[1] - swing.time[0]) if len(swing.time) > 1 else recording.step
    accelerates = "acceleration" in recording.signals and "tip" not in recording.signals
    return float((loud**2).sum()) * step * frequency ** (-3 if accelerates else 1)
