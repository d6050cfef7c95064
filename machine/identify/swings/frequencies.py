"""Find the frequencies at which recordings swing, and doubt their units."""

from __future__ import annotations

from collections.abc import Sequence
from math import tau

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.swings.ring_downs import rests
from quietarm.machine.recordings.clocks import LONG
from quietarm.machine.recordings.envelope import envelope, evenly
from quietarm.machine.recordings.recording import LEAST_ROWS, Recording
from quietarm.machine.recordings.signal_spectra import highest_peaks, spectrogram
from quietarm.models.joint_motion import ROTARY

Array = NDArray[np.float64]
_GOOD_SAMPLES = 20
FASTEST = 500.0
"""No arm swings at more hertz: a wrong unit of the time is more likely."""
LEAST_SAMPLES = 6.0
"""In a swing. Evenly spaced samples are the same for a frequency and for those that are mirrored
about the rate: with so many samples the next one is five times as fast, which whoever pushed the
machine saw not to be so. With fewer it is nearer, and nothing in the recording tells them apart."""
Candidates = dict[float, float]
"""How loud a recording swings, by frequency [Hz]."""


def find_frequencies(recordings: Sequence[Recording]) -> list[float]:
    """The frequency of every recording's swing [Hz]: that of all, where it is a candidate.

    0 where nothing swings; ValueError where one swings as no arm does.
    """
    slowest = 0.02  # Hz; no arm swings as slowly
    least_share = 0.05  # of the loudest, that a candidate near the common frequency has
    tables = [_candidates_of(recording) for recording in recordings]
    if not any(any(table.values()) for table in tables):
        return [0.0] * len(recordings)
    common = _common_frequency(tables)
    frequencies = list[float]()
    for recording, table in zip(recordings, tables):
        loudest = max(table.values(), default=0.0)
        among = _near(table, common)
        if max(among.values(), default=0.0) <= least_share * loudest:
            among = table
        frequency = max(among, key=lambda candidate: among[candidate]) if loudest else 0.0
        if frequency and not slowest <= frequency <= FASTEST:
            raise ValueError(
                f"{recording.name} swings at {frequency:.3g} Hz, as no arm does; is its time in "
                "another unit? say so by --units, as time:ms"
            )
        frequencies.append(frequency)
    return frequencies


def may_be_alias(recording: Recording, frequency: float) -> str:
    """Say which other frequencies [Hz] the samples may be of; nothing where they are dense."""
    rate = 1 / recording.step
    if not frequency or rate >= LEAST_SAMPLES * frequency:
        return ""
    mirrored = (frequency, rate - frequency, rate + frequency)
    return (
        f"{rate / frequency:.2g} samples a swing: the true frequency may be "
        f"{', '.join(f'{one:.3g}' for one in mirrored)} Hz; record at {_GOOD_SAMPLES} samples a "
        "swing or more"
    )


def _near(table: Candidates, frequency: float) -> Candidates:
    """The candidates that may be of the same machine: within 30 %."""
    same = 0.3
    return {f: loudness for f, loudness in table.items() if abs(f / frequency - 1) < same}


def _common_frequency(tables: Sequence[Candidates]) -> float:
    """The candidate at which all recordings together are loudest, each counting the same."""

    def loudness(frequency: float) -> float:
        total = 0.0
        for table in tables:
            of_all = sum(table.values()) or 1.0
            total += max(_near(table, frequency).values(), default=0.0) / of_all
        return total

    return max((frequency for table in tables for frequency in table), key=loudness)


def doubt_units(
    recordings: Sequence[Recording], frequencies: Sequence[float], joint: str
) -> list[str]:
    """Name units that may be wrong, for a kind of joint."""
    coarse_step = 0.2  # s; and a frequency [Hz], that may come from a time in milliseconds
    slow = 0.1
    most_turns = 2 * tau  # a joint that turns further may be in degrees
    sentences = list[str]()
    for recording, frequency in zip(recordings, frequencies):
        angle = recording.angle
        turns = 0.0 if angle is None else float(np.ptp(angle))
        if recording.step >= coarse_step or 0 < frequency < slow:
            sentences.append(
                f"{recording.name}: {frequency:.3g} Hz by samples {recording.step:.3g} s apart; "
                "is its time in milliseconds? say so by --units time:ms"
            )
        if frequency > FASTEST / 2:
            sentences.append(
                f"{recording.name}: {frequency:.4g} Hz is fast for an arm; is its time in seconds? "
                "say so by --units time:s"
            )
        if joint == ROTARY and turns > most_turns:
            sentences.append(
                f"{recording.name}: its joint turns by {turns:.3g} rad, more than two turns; is it "
                "in degrees? say so by --units angle:deg, or rename a column whose name says rad"
            )
    return sentences


def _candidates_of(recording: Recording) -> Candidates:
    """Candidates of the longest rest of the joint, if it is a fifth of the recording.

    Where nothing swings there, those of all of it without a hole.
    """
    frequency = 10 / float(np.ptp(recording.time))
    hole = LONG * recording.step * frequency  # in periods
    whole = recording.stretches
    for stretches in (rests(recording, frequency, hole), whole):
        longest = max(stretches, key=lambda rows: rows.stop - rows.start, default=slice(0, 0))
        if longest.stop - longest.start >= max(len(recording.time) / 5, LEAST_ROWS):
            candidates = _candidates(recording.part(longest))
            if any(candidates.values()):
                return candidates
    together = Candidates()
    for rows in whole if len(whole) > 1 else ():
        for frequency, loudness in _candidates(recording.part(rows)).items():
            together[frequency] = together.get(frequency, 0.0) + loudness
    return together


def _candidates(recording: Recording) -> Candidates:
    """Frequencies [Hz] at which a recording swings and how loud, by spectra of stretches of it.

    Peaks of displacement and of speed: the one is steep beside a slow motion, the other is not.
    """
    stands_out = 1.5  # how far a peak is above what is beside it, as a logarithm
    most_peaks = 4
    least_apart = 0.05
    time, values = evenly(recording, 1 / (32 * recording.step))
    rate = 1 / float(time[1] - time[0])
    candidates = Candidates()
    lengths = [len(time) // share for share in (1, 4, 16, 64)]
    for length in lengths:
        if length < 32:
            continue
        at = np.fft.rfftfreq(4 * length, 1 / rate)
        loudest = spectrogram(values, length).max(axis=1)
        known = slice(int(np.searchsorted(at, 1.5 * rate / length)), None)
        levels = np.log(loudest[known] + 1e-300)
        for order in (0, 2):
            steep = levels + order * np.log(at[known])
            for k in highest_peaks(steep, most_peaks, stands_out):
                peak = float(at[known][k])
                if all(abs(peak / before - 1) > least_apart for before in candidates):
                    candidates[peak] = _prominence(recording, peak)
    return candidates


def _prominence(recording: Recording, frequency: float) -> float:
    """Return how much a recording rings at a frequency: squared amplitude, summed over periods.

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
