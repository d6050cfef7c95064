"""Test whether an identified machine predicts a recording that it was not identified from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.fits.part_fitter import PartFitter
from quietarm.machine.identify.fits.swing_model import SwingModel
from quietarm.machine.identify.identified import Part, is_modal, values_of
from quietarm.machine.identify.swings.frequencies import find_frequencies
from quietarm.machine.identify.swings.recording_parts import fit_parts
from quietarm.machine.recordings.mending import without_glitches
from quietarm.machine.recordings.recording import Recording, checked_recordings
from quietarm.models import Plant
from quietarm.ocp.checks import takes

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Prediction:
    """The share of a recording's swing that a machine predicts.

    Attributes
    ----------
    recording : str
        Its name.
    begin, end : float
        Of the ring-down [s].
    share : float
        Of the swing over five periods, from two periods before: 1 less the root mean square of
        what is left over that of the swing. The median over the begins.
    worst, worst_at : float
        The least, and where its five periods begin [s].
    frequency : float
        Of the ring-down by itself [Hz].
    why : str
        The likeliest cause of what is not predicted, in words.
    """

    recording: str
    begin: float
    end: float
    share: float
    worst: float
    worst_at: float
    frequency: float
    why: str = ""


@takes(plant=Plant)
def predict(plant: Plant, recordings: Sequence[Recording]) -> list[Prediction]:
    """Return how much of each ring-down of recordings a plant predicts, with nothing of it fitted.

    Raises
    ------
    ValueError
        When there is no ring-down of three periods.
    """
    names = [name for name in plant.measured if is_modal(plant, name)]
    p = values_of(plant, names)
    predictions = list[Prediction]()
    recordings, _ = without_glitches(checked_recordings(recordings))
    for recording, frequency in zip(recordings, find_frequencies(recordings)):
        fitter = PartFitter(plant, names, recording, frequency)
        parts, why = fit_parts(fitter)
        if not parts:
            raise ValueError(f"{recording.name}: {why}")
        for part in parts:
            hub = part.hub if part.hub == "moves" else ""
            model = fitter.model(Part(recording.name, part.begin, part.end, hub=hub))
            model.trend = model.trend[:, :1]  # a slope of two periods leads astray
            shares = _shares(model, p, 1 / fitter.frequency_of(p))
            if not shares:
                continue
            worst, worst_at = min(shares)
            prediction = Prediction(
                recording=recording.name,
                begin=part.begin,
                end=part.end,
                share=float(np.median([share for share, _ in shares])),
                worst=worst,
                worst_at=worst_at,
                frequency=fitter.frequency_of(part.vector),
                why=_why(fitter, part, p),
            )
            predictions.append(prediction)
    if not predictions:
        raise ValueError(f"{recordings[0].name}: no ring-down of three periods; record longer")
    return predictions


def _why(fitter: PartFitter, part: Part, p: Array) -> str:
    """Name the likeliest cause why a ring-down is not that of a machine with some parameters."""
    same = 0.01  # share of a frequency, which in seven periods is a phase of 25 degrees
    alike = 1.5  # times a damping
    frequency = fitter.frequency_of(part.vector)
    expected = fitter.frequency_of(p)
    damping = fitter.damping_of(part)
    damping_expected = float(p[fitter.are_dampings].max(initial=0.0))
    undamped = frequency / np.sqrt(1 - damping**2)
    undamped_expected = expected / np.sqrt(1 - damping_expected**2)
    if abs(undamped / undamped_expected - 1) > same:
        return (
            f"it swings at {frequency:.4g} Hz, and the machine at {expected:.4g} Hz: it carried "
            "another load, or is another machine"
        )
    lower, higher = sorted([damping, damping_expected])
    if higher > alike * max(lower, 0.0):
        return f"its damping is {damping:.3g}, and the machine's {damping_expected:.3g}"
    if part.misfit > 2 * part.noise:
        return (
            f"it is no free decay of its modes: they leave {part.misfit:.0%} of it; look at the "
            "signal"
        )
    return f"its noise is {part.noise:.0%} of the swing: push harder, or record longer"


def _shares(model: SwingModel, p: Array, period: float) -> list[tuple[float, float]]:
    """Return the predicted shares of the swing, each with where its predicted periods begin."""
    periods_known = 2.0  # from which a swing's state is known
    periods_ahead = 5.0
    time = model.time
    values = model.values
    shares = list[tuple[float, float]]()
    last = max(float(np.ptp(time)) - (periods_known + 1) * period, 0.0)
    for start in time[0] + np.arange(0, last + 1e-9, period):
        begin = start + periods_known * period
        known = (time >= start) & (time < begin)
        ahead = (time >= begin) & (time < begin + periods_ahead * period)
        if np.count_nonzero(ahead) < 4 or np.count_nonzero(known) < 8:
            continue
        residual = values[ahead] - model.fitted(p, known)[ahead]
        swing = values[ahead] - values[ahead].mean(axis=0)
        share = 1 - float(np.linalg.norm(residual) / np.linalg.norm(swing))
        shares.append((share, float(begin)))
    return shares
