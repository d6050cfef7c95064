"""Decide whether a hub swings with the tip: it shifts the frequency (docs/soft_hub.md)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from quietarm.machine.identify.fits.columns import FreeDecay
from quietarm.machine.identify.fits.part_fitter import PartFitter
from quietarm.machine.identify.fits.whole_recording import fit_whole
from quietarm.machine.identify.identified import Part
from quietarm.machine.recordings.recording import noise_of


def with_hub(fitter: PartFitter, parts: Sequence[Part], rows: slice) -> list[Part]:
    """The parts, or all of these rows where the hub swings with them and that meets it all."""
    if parts and not any(_hub_swings(fitter, part) for part in parts):
        return list(parts)
    whole = fit_whole(fitter, rows)
    fails = whole.cause in ("bound", "hub")
    well_met = whole.misfit < max(0.05, 2 * whole.noise)
    if well_met and not fails and whole.cause != "delay":
        return [whole]
    with_hub_at_rest = fitter.frequency_of(whole.vector)
    return [_doubted(fitter, part, with_hub_at_rest, fails) for part in parts]


def _doubted(fitter: PartFitter, part: Part, frequency: float, fails: bool) -> Part:
    """A part, with a doubt where its frequency is not that of a hub at rest [Hz]."""
    most_shift = 0.015
    shift = abs(fitter.frequency_of(part.vector) / frequency - 1)
    if part.warning or part.hub or not (fails or shift > most_shift):
        return part
    warning = (
        "the hub swings with the tip, so that the frequency is not that of a held one: hold it, by "
        "a brake or a stiffer controller"
    )
    return replace(part, cause="hub", warning=warning)


def _hub_swings(fitter: PartFitter, part: Part) -> bool:
    """Return whether the hub swings as the tip does in a part, by more than an encoder's noise."""
    piece = fitter.piece(part)
    assert piece.angle is not None
    swing = FreeDecay(fitter.response, piece)(part.vector)[0][0, :, :2]
    line = np.vander(piece.time - piece.time[0], 2)
    share, *_ = np.linalg.lstsq(np.hstack([swing, line]), piece.angle, rcond=None)
    noise = float(noise_of(piece.angle)[0])
    amplitude = float(np.hypot(*share[:2]))
    return amplitude > max(8 * noise / len(piece.time) ** 0.5, noise / 2)
