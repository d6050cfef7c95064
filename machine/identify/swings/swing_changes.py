"""Changes of frequency and damping along a swing: by fits of its pieces, or by two close modes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from math import tau

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.fits.diagnosis import saturated
from quietarm.machine.identify.fits.fitting import Fit
from quietarm.machine.identify.fits.part_fitter import PartFitter
from quietarm.machine.identify.identified import Part
from quietarm.machine.identify.swings.amplitudes import spread_of
from quietarm.machine.identify.swings.close_modes import CloseModes, find_close_modes
from quietarm.machine.identify.swings.dry_friction import fit_dry
from quietarm.machine.identify.swings.modulation import changes_along
from quietarm.machine.identify.swings.ring_downs import moves
from quietarm.machine.recordings.recording import LEAST_ROWS

Array = NDArray[np.float64]
Spreads = dict[str, tuple[float, float]]
MET = 0.1
"""Misfit beside the noise that a swing may have to be called met."""


def has_changes(fitter: PartFitter, part: Part, best: Fit) -> bool:
    """Return whether a swing leaves more than noise, or may change along it.

    A change is one of frequency or damping.
    """
    return _leaves_more(part) or changes_along(best, fitter.frequency, chance=1e-2)


def _leaves_more(part: Part) -> bool:
    return part.misfit > 1.5 * part.noise + 0.003


def with_changes(fitter: PartFitter, part: Part, best: Fit, rows: slice) -> Part:
    """A ring-down with what its parameters are along it, fitted where one value meets it.

    Pieces of it are fitted alone, from the begin of the rows in which it was found, if a swing is
    there; of a saturated signal from where it is saturated no more.
    """
    if part.hub:
        return part
    pieces, spread = _told_apart(fitter, part, rows)
    if not spread:
        return part
    met = part
    if part.unexplained > MET and not part.saturated:
        met = _where_it_fits(fitter, part, pieces)
    certain = _leaves_more(part) or changes_along(best, fitter.frequency, chance=1e-4)
    if certain and met.cause in ("", "amplitude", "misfit") and met.unexplained < MET:
        first = _words(fitter, pieces[0])
        last = _words(fitter, pieces[-1])
        warning = (
            f"a misfit of {part.misfit:.1%} of the swing by one frequency and damping: {first} at "
            f"first, {last} at last; {_cause_of_changes(fitter, part)}. The intervals hold for "
            "this swing, not for a larger one: push as hard as your moves do"
        )
        met = replace(met, cause="amplitude", warning=warning)
    if part.saturated:
        spread = _beyond_the_saturated(part, pieces, spread)
    return replace(met, spread=spread)


def _cause_of_changes(fitter: PartFitter, part: Part) -> str:
    """Say why frequency and damping change along a swing: by dry friction, where that meets it."""
    much_better = 0.7  # times the misfit of one decay
    piece = fitter.thinned(fitter.piece(part))
    dry = fit_dry(piece, fitter.frequency_of(part.vector), max(fitter.damping_of(part), 1e-3))
    _, damping, lost = dry.p.tolist()
    if part.saturated or lost <= 0 or dry.misfit > much_better * part.misfit:
        return "they change with the amplitude, or a second mode is near"
    return (
        f"dry friction damps it: the amplitude loses {tau * lost:.2g} of its first value each "
        f"period, beside a damping of {max(damping, 0.0):.2g}"
    )


def _beyond_the_saturated(part: Part, pieces: Sequence[Part], spread: Spreads) -> Spreads:
    """Extrapolate parameters' ranges from the pieces after saturation to all of a part."""
    seen = pieces[-1].end - pieces[0].begin
    unseen = (pieces[0].begin - part.begin) / seen
    return {
        name: (low - unseen * (high - low), high + unseen * (high - low))
        for name, (low, high) in spread.items()
    }


def with_both(fitter: PartFitter, beat: Part, changes: Part) -> Part:
    """Two modes, and what pieces say as well: two beats or less may be a frequency that drifts.

    Of 60 simulated swings of one mode whose frequency drifts, two modes met 12, up to 1.8 beats.
    """
    most_beats = 2.0
    rates = np.array(fitter.names)[fitter.are_rates].tolist()
    apart = max((beat.spread[name][1] - beat.spread[name][0] for name in rates), default=0.0)
    beats = apart * (beat.end - beat.begin) / tau
    if beats > most_beats:
        return beat
    spread = dict(beat.spread)
    for name, (low, high) in changes.spread.items():
        lowest, highest = spread[name]
        spread[name] = (min(low, lowest), max(high, highest))
    return replace(beat, spread=spread)


def _told_apart(fitter: PartFitter, part: Part, rows: slice) -> tuple[list[Part], Spreads]:
    """Pieces of a swing whose parameters differ, and of each parameter the least and the largest.

    Fewer and longer pieces are more certain: they are tried where many tell nothing.
    """
    pieces = list[Part]()
    for most in (12, 6, 3, 2):
        pieces = _pieces_of(fitter, part, rows, most)
        spread = {name: spread_of(pieces, name) for name in fitter.names}
        changing = {name: ends for name, ends in spread.items() if ends}
        if changing:
            return pieces, changing
    return pieces, {}


def _pieces_of(fitter: PartFitter, part: Part, rows: slice, most: int) -> list[Part]:
    """Pieces of a part, from the begin of some rows on where these swing as well."""
    own_rows = fitter.rows(part)
    if part.saturated:
        flat = np.flatnonzero(saturated(fitter.piece(part).values))
        first = own_rows.start + int(flat.max(initial=-1)) + 1
        return _pieces(fitter, slice(first, own_rows.stop), most)
    pieces = _pieces(fitter, slice(rows.start, own_rows.stop), most)
    if not pieces or pieces[0].begin > part.begin or pieces[0].unexplained > MET:
        return _pieces(fitter, own_rows, most)
    return pieces


def _pieces(fitter: PartFitter, rows: slice, most: int) -> list[Part]:
    """Pieces of some rows in order of time, each fitted alone, that stand out of noise.

    Below an eighth of the largest amplitude friction alone would be seen.
    """
    least_periods = 3
    most_noise = 0.3  # share of the swing, from which on a piece tells nothing
    if rows.stop - rows.start < 2 * LEAST_ROWS:
        return []
    seconds = float(np.ptp(fitter.recording.time[rows]))
    count = min(int(seconds * fitter.frequency / least_periods), most)
    if count < 2:
        return []
    pieces = list[Part]()
    ends = np.linspace(rows.start, rows.stop, count + 1).astype(int)
    start = None
    for first, last in pairwise(ends):
        if last - first < LEAST_ROWS:
            return []
        piece = fitter.part(slice(first, last))
        if start is None:
            near = fitter.frequency * np.linspace(0.85, 1.15, 13)
            start = min(fitter.starts(near), key=fitter.model(piece).cost)
        piece, best = fitter.fit(piece, start)
        if piece.noise < most_noise and piece.cause != "bound":
            pieces.append(piece)
            start = best.p
    largest = max((piece.amplitude for piece in pieces), default=0.0)
    return [piece for piece in pieces if piece.amplitude >= largest / 8]


def _where_it_fits(fitter: PartFitter, part: Part, pieces: Sequence[Part]) -> Part:
    """The longest end of a ring-down that one value of each parameter meets.

    What comes after the pieces is left out, and of these the last where it has to be.
    """
    for last in range(len(pieces), 1, -1):
        end = fitter.rows(pieces[last - 1]).stop
        start = pieces[last - 1].vector
        lowest = 1
        highest = last
        met = None
        while lowest < highest:  # the later it begins, the better it fits
            middle = (lowest + highest) // 2
            begin = fitter.rows(pieces[middle]).start
            shorter, _ = fitter.fit(fitter.part(slice(begin, end)), start)
            if shorter.unexplained <= MET:
                highest = middle
                met = shorter
            else:
                lowest = middle + 1
        if met:
            return replace(met, largest=pieces[0].amplitude)
    return part


def _words(fitter: PartFitter, part: Part) -> str:
    """Describe a part in words: its frequency and damping, and at which amplitude."""
    frequency = fitter.frequency_of(part.vector)
    damping = fitter.damping_of(part)
    return f"{frequency:.4g} Hz and {damping:.2g} at {part.amplitude:.3g}"


def fit_close_modes(fitter: PartFitter, rows: slice, start: Array) -> Part | None:
    """Some rows as two modes that beat; None where they do not. From parameters of one of them."""
    part = fitter.part(rows)
    recording = fitter.piece(part)
    if moves(recording):
        return None
    close = find_close_modes(recording, fitter.thinned(recording), fitter.frequency)
    if close is None:
        return None
    return _of_the_louder(fitter, replace(part, **_figures(close)), close, start)


def _figures(close: CloseModes) -> dict[str, object]:
    """Return the figures that a part tells of two modes."""
    first, second = (
        f"{frequency / tau:.5g} Hz and {damping:.2g}"
        for frequency, damping in zip(close.frequencies, close.dampings)
    )
    return {
        "amplitude": close.amplitude,
        "misfit": close.misfit,
        "noise": close.noise,
        "cause": "close",
        "warning": f"two modes beat, {first}, and {second}: the intervals hold both, since a move "
        "may excite either; plan for both by an error of your own, or damp or lock one of them",
    }


def _of_the_louder(fitter: PartFitter, part: Part, close: CloseModes, start: Array) -> Part:
    """A part with the parameters of the louder mode, and those of both as what they may be."""
    slowest = abs(fitter.response.eigenvalues(start)[0][0])
    values = dict[str, float]()
    deviations = dict[str, float]()
    spread = Spreads()
    for k, name in enumerate(fitter.names):
        factor = start[k] / slowest if fitter.are_rates[k] else 1.0
        is_damping = fitter.are_dampings[k]
        of_modes = factor * (close.dampings if is_damping else close.frequencies)
        unsure = factor * (close.damping_deviations if is_damping else close.frequency_deviations)
        values[name] = float(of_modes[0])
        deviations[name] = float(unsure[0])
        sure = 2 * unsure + 1e-8 * np.abs(of_modes)
        spread[name] = (float((of_modes - sure).min()), float((of_modes + sure).max()))
    return replace(part, values=values, deviations=deviations, spread=spread)
