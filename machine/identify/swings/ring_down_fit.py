"""A ring-down fitted alone: grown to the rows that it meets, with what helps its model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from quietarm.machine.identify.fits.diagnosis import exceeds, saturated
from quietarm.machine.identify.fits.fitting import Fit
from quietarm.machine.identify.fits.part_fitter import FEW_SAMPLES, PartFitter
from quietarm.machine.identify.identified import Part
from quietarm.machine.identify.swings.ring_downs import moves, standing
from quietarm.machine.recordings.recording import LEAST_ROWS

Fitted = tuple[Part, Fit]


def fit_ring_down(fitter: PartFitter, rows: slice, earliest: int, by_hand: bool) -> Fitted:
    """The part of some rows, fitted; not before the earliest row, where it was not chosen by hand.

    Saturated samples are left out, the hub's motion and a slow drift are added where they help.
    """
    earliest = max(earliest, _begin_of_rest(fitter, rows))
    fitted = _first_fit(fitter, rows)
    for _ in range(0 if by_hand else 2):
        grown = _grown(fitter, rows, fitted[1], earliest)
        if grown == rows:
            break
        rows = grown
        fitted = fitter.fit(fitter.part(rows), fitted[1].p)
    fitted = _without_saturated(fitter, fitted)
    fitted = _with_creeping_hub(fitter, fitted)
    return _without_drift(fitter, fitted)


def _first_fit(fitter: PartFitter, rows: slice) -> Fitted:
    part = fitter.part(rows)
    rough = fitter.model(part, samples=FEW_SAMPLES)
    seconds = float(np.ptp(rough.time))
    near = fitter.frequency + np.linspace(-0.6, 0.6, 9) / seconds
    starts = fitter.starts(np.maximum(near, 0.3 * fitter.frequency))
    return fitter.fit(part, min(starts, key=rough.cost))


def _begin_of_rest(fitter: PartFitter, rows: slice) -> int:
    """The row from which on the joint rests before some rows: its motion drives the tip."""
    at_rest = standing(fitter.recording, fitter.frequency)
    return int(np.flatnonzero(~at_rest[: rows.start]).max(initial=-1)) + 1


def _grown(fitter: PartFitter, rows: slice, best: Fit, earliest: int) -> slice:
    """The rows with those before that the same swing meets, without those it does not.

    A quarter of a period belongs to it where it leaves less than four times the usual.
    """
    quarter = max(2, round(0.25 / (fitter.frequency * fitter.recording.step)))
    first = max(earliest, rows.start - 12 * quarter)
    wide = fitter.model(fitter.part(slice(first, rows.stop)), thin=False)
    inside = np.arange(first, rows.stop) >= rows.start
    residual = wide.values - wide.fitted(best.p, inside)
    count = len(residual) // quarter
    count_inside = (rows.stop - rows.start) // quarter
    squares = (residual[len(residual) - count * quarter :] ** 2).sum(axis=1)
    power = squares.reshape(count, quarter).mean(axis=1)
    usual = 4.0**2 * float(np.median(power[-count_inside:]))
    of_swing = float((best.swinging**2).sum(axis=1).mean())
    far = power >= max(usual, 1e-6 * of_swing)
    latest = count - count_inside + min(8, count_inside // 3)  # at most two periods are lost
    begin = int(np.flatnonzero(far[:latest]).max(initial=-1)) + 1
    return slice(rows.stop - (count - begin) * quarter, rows.stop)


def _without_saturated(fitter: PartFitter, fitted: Fitted) -> Fitted:
    """The fit without the samples at a sensor's limit, where the swing goes beyond it."""
    part, best = fitted
    piece = fitter.piece(part)
    flat = saturated(piece.values)
    not_flat = np.count_nonzero(~flat)
    if not flat.any() or not_flat <= max(LEAST_ROWS, 0.1 * len(flat)):
        return fitted
    cut = replace(part, saturated=int(flat.sum()), values={})
    cut, without = fitter.fit(cut, best.p)
    cut, without = fitter.fit(cut, without.p)
    if exceeds(piece.values, without.model.fitted(without.p), flat):
        return cut, without
    return fitted


def _with_creeping_hub(fitter: PartFitter, fitted: Fitted) -> Fitted:
    """The fit with the hub's motion, where what is left falls by a tenth."""
    part, best = fitted
    if part.saturated or not moves(fitter.piece(part)):
        return fitted
    creeping, with_motion = fitter.fit(replace(part, hub="creeps"), best.p)
    helps = with_motion.residual.std(axis=0) < 0.9 * best.residual.std(axis=0)
    return (creeping, with_motion) if helps.any() else fitted


def _without_drift(fitter: PartFitter, fitted: Fitted) -> Fitted:
    """The fit without a slow drift, where that is all that is left."""
    part, best = fitted
    if part.cause != "drift":
        return fitted
    drifting, without = fitter.fit(replace(part, drifts=True), best.p)
    return fitted if drifting.cause == "drift" else (drifting, without)
