"""The parts of a recording that tell of its machine: ring-downs, each fitted alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.fits.hub_swing import with_hub
from quietarm.machine.identify.fits.part_fitter import PartFitter
from quietarm.machine.identify.fits.whole_recording import wide_range
from quietarm.machine.identify.identified import Part
from quietarm.machine.identify.swings.ring_down_fit import fit_ring_down
from quietarm.machine.identify.swings.ring_downs import (
    LEAST_PERIODS,
    find_ring_downs,
    find_swings,
    moves,
)
from quietarm.machine.identify.swings.swing_changes import (
    fit_close_modes,
    has_changes,
    with_both,
    with_changes,
)
from quietarm.machine.identify.swings.well_damped import find_well_damped
from quietarm.machine.recordings.clocks import holes

Array = NDArray[np.float64]
NO_SWING = "no swing stands out of the noise"
"""Why a recording in which no frequency is found has no part."""
POOR = 0.2
"""Misfit, from which on a swing may be one that is damped well, or of two modes."""


def fit_parts(fitter: PartFitter, by_hand: bool = False) -> tuple[list[Part], str]:
    """The ring-downs of a recording, or why there are none.

    One that was cut out by hand is all of the recording.
    """
    recording = fitter.recording
    parts = list[Part]()
    why = NO_SWING
    if fitter.frequency:
        parts, why = _periodic(fitter, by_hand)
        doubtful = all(part.misfit > POOR or _is_doubted(part) for part in parts)
        if doubtful and not by_hand:
            parts = _with_fast_beats(fitter, parts)
    if all(part.misfit > POOR for part in parts):
        parts = _well_damped(fitter, by_hand) or parts
    if moves(recording):
        parts = with_hub(fitter, parts, slice(None))
    enough = list[Part]()
    for part in parts:
        short = _too_short(fitter, part)
        why = short or why
        if not short:
            enough.append(part)
    return enough, "" if enough else why


def _too_short(fitter: PartFitter, part: Part) -> str:
    """Say of how few swings a part is, to the end of what is recorded; nothing where it has two.

    A fit meets less of a swing with many frequencies. A swing that is damped well is over before.
    """
    frequency = fitter.frequency_of(part.vector)
    swings = (float(fitter.recording.time[-1]) - part.begin) * frequency
    if swings >= LEAST_PERIODS:
        return ""
    return (
        f"{swings:.2g} swings of {frequency:.3g} Hz from {part.begin:.6g} s on; record "
        f"{LEAST_PERIODS:g} at least"
    )


def _periodic(fitter: PartFitter, by_hand: bool) -> tuple[list[Part], str]:
    """Ring-downs of several periods, or why there are none."""
    spans = [slice(0, len(fitter.recording.time))]
    if not by_hand:
        spans = find_ring_downs(fitter.recording, fitter.frequency)
    parts = list[Part]()
    why = _no_ring_down(fitter)
    earliest = 0
    while spans:
        rows = spans[0]
        count = 1
        part, best = fit_ring_down(fitter, rows, earliest, by_hand)
        beat = None
        if has_changes(fitter, part, best):
            beat, count = _longest_beat(fitter, spans, best.p)
            if not beat or count == 1:
                part = with_changes(fitter, part, best, rows)
        earliest = spans[count - 1].stop
        spans = spans[count:]
        last = parts[-1] if parts and not by_hand and not beat else None
        whole = _joined(fitter, last, part) if last else None
        if beat:
            parts.append(with_both(fitter, beat, part) if count == 1 else beat)
        elif whole:
            parts[-1] = whole
        elif part.misfit < 1 or by_hand:
            parts.append(part)
        else:
            span = f"{part.begin:.6g} to {part.end:.6g} s"
            why = f"{span} is no free decay of {fitter.frequency:.3g} Hz"
    return parts, why


def _longest_beat(
    fitter: PartFitter, spans: Sequence[slice], start: Array
) -> tuple[Part | None, int]:
    """The longest swing of two modes from the first span on, and how many spans it takes.

    Where two modes beat, the swing grows again and again without a push: what looks like several
    ring-downs is one. Most often it goes on to the last span; else it is as long as two modes meet
    each further span.
    """
    beat = _beat_over(fitter, spans, start)
    if beat:
        return beat, len(spans)
    longest = _beat_over(fitter, spans[:1], start) if len(spans) > 1 else None
    count = 1
    for further in range(2, len(spans)):
        beat = _beat_over(fitter, spans[:further], start)
        if beat is None:
            break
        longest = beat
        count = further
    return longest, count


def _beat_over(fitter: PartFitter, spans: Sequence[slice], start: Array) -> Part | None:
    """One swing of two modes over all of some spans; None where two modes do not meet it.

    Nor over a hole, in which the beats are not seen.
    """
    rows = slice(spans[0].start, spans[-1].stop)
    if len(holes(fitter.recording.time[rows])):
        return None
    return fit_close_modes(fitter, rows, start)


def _with_fast_beats(fitter: PartFitter, parts: Sequence[Part]) -> list[Part]:
    """The parts, and swings of two modes in whose fast beats no ring-down is found, or a false one.

    A part inside such a swing is no part of its own: what it says is in the swing's intervals.
    """
    starts = fitter.starts(np.array([fitter.frequency]))
    start = min(starts, key=lambda p: abs(fitter.frequency_of(p) - fitter.frequency))
    beats = list[Part]()
    for rows in find_swings(fitter.recording, fitter.frequency):
        beat = fit_close_modes(fitter, rows, start)
        if beat:
            beats.append(beat)
    outside = [part for part in parts if not any(_overlap(part, beat) for beat in beats)]
    for k, beat in enumerate(beats):
        for part in parts:
            if _overlap(part, beat):
                beats[k] = with_both(fitter, beats[k], part)
    return sorted([*outside, *beats], key=lambda part: part.begin)


def _is_doubted(part: Part) -> bool:
    return bool(part.warning) and part.cause != "close"


def _overlap(first: Part, second: Part) -> bool:
    return first.begin < second.end and second.begin < first.end


def _well_damped(fitter: PartFitter, by_hand: bool) -> list[Part]:
    """Swings that are over after a period or two."""
    recording = fitter.recording
    much_damping = 0.06  # from which on a swing is over too soon for an envelope to show it
    usual = fitter.frequency
    parts = list[Part]()
    swings = [] if moves(recording) else find_well_damped(recording)
    if by_hand and len(swings) > 1:  # a part by hand is one ring-down
        swings = []
    for rows, frequency in swings:
        fitter.frequency = frequency
        part = fitter.part(rows)
        starts = fitter.starts(wide_range(frequency))
        part, _ = fitter.fit(part, min(starts, key=fitter.model(part).cost))
        is_damped = fitter.damping_of(part) > much_damping
        if is_damped and part.misfit < max(POOR, 2 * part.noise):
            parts.append(part)
    if not parts:
        fitter.frequency = usual
    return parts


def _joined(fitter: PartFitter, first: Part, second: Part) -> Part | None:
    """Two parts as one ring-down, where one swing meets both: samples between them lack."""
    more = 1.25  # times what is left of parts by themselves, that one swing may leave of them
    if second.amplitude >= first.amplitude:
        return None
    rows = slice(fitter.rows(first).start, fitter.rows(second).stop)
    if moves(fitter.recording.part(rows)):
        return None
    model = fitter.model(fitter.part(rows))
    start = min((first.vector, second.vector), key=model.cost)
    whole, best = fitter.fit(fitter.part(rows), start)
    time = best.model.time
    for part in (first, second):
        alone = fitter.model(part)
        residual = (alone.values - alone.fitted(part.vector)).std(axis=0)
        inside = (time >= part.begin) & (time <= part.end)
        if (best.residual[inside].std(axis=0) > more * residual).any():
            return None
    if has_changes(fitter, whole, best):
        return with_changes(fitter, whole, best, rows)
    return whole


def _no_ring_down(fitter: PartFitter) -> str:
    frequency = fitter.frequency
    recording = fitter.recording
    periods = float(np.ptp(recording.time)) * frequency
    few = ""
    if periods < LEAST_PERIODS:
        few = f": it lasts {periods:.2g} periods of {frequency:.3g} Hz"
    angle = "" if recording.angle is not None else ", or the joint's angle, too"
    return f"no ring-down of two periods{few}; record longer after a push{angle}"
