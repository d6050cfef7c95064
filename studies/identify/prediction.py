"""Whether an identified machine predicts a recording that it was not identified from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from quietarm.models import Plant
from quietarm.ocp.checks import takes
from quietarm.studies.identify.frequencies import find_frequencies
from quietarm.studies.identify.machine import Part, is_modal, values_of
from quietarm.studies.identify.mending import without_glitches
from quietarm.studies.identify.part_fitter import PartFitter
from quietarm.studies.identify.recording import Recording
from quietarm.studies.identify.recording_parts import fit_parts
from quietarm.studies.identify.swing_model import Model

Array = NDArray[np.float64]
PERIODS = 5.0
"""That are predicted."""
_KNOWN = 2.0
"""Periods from which a swing's state is known."""


@dataclass(frozen=True)
class Prediction:
    """How much of a recording's swing a machine predicts.

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
    """

    recording: str
    begin: float
    end: float
    share: float
    worst: float
    worst_at: float
    frequency: float


@takes(plant=Plant)
def predict(plant: Plant, recordings: Sequence[Recording]) -> list[Prediction]:
    """How much of each ring-down of recordings a plant predicts, with nothing of it fitted.

    Raises
    ------
    ValueError
        When there is no ring-down of three periods.
    """
    names = [name for name in plant.measured if is_modal(plant, name)]
    p, found = values_of(plant, names), list[Prediction]()
    recordings, _ = without_glitches(recordings)
    for one, frequency in zip(recordings, find_frequencies(recordings)):
        fitter = PartFitter(plant, names, one, frequency)
        parts, why = fit_parts(fitter)
        if not parts:
            raise ValueError(f"{one.name}: {why}")
        for part in parts:
            ends, hub = (part.begin, part.end), part.hub if part.hub == "moves" else ""
            model = fitter.model(Part(one.name, *ends, hub=hub))
            model.trend = model.trend[:, :1]  # a slope of two periods leads astray
            if shares := _shares(model, p, 1 / fitter.frequency_of(p)):
                share, own = np.median([share for share, _ in shares]), part.vector
                found.append(Prediction(
                    one.name, *ends, float(share), *min(shares), fitter.frequency_of(own)
                ))  # fmt: skip
    if not found:
        raise ValueError(f"{recordings[0].name}: no ring-down of three periods; record longer")
    return found


def _shares(model: Model, p: Array, period: float) -> list[tuple[float, float]]:
    """How much of the swing is predicted, and where the predicted periods begin."""
    time, y, found = model.time, model.values, list[tuple[float, float]]()
    last = max(float(np.ptp(time)) - (_KNOWN + 1) * period, 0.0)
    for start in time[0] + np.arange(0, last + 1e-9, period):
        begin = start + _KNOWN * period
        known = (time >= start) & (time < begin)
        ahead = (time >= begin) & (time < begin + PERIODS * period)
        if np.count_nonzero(ahead) >= 4 and np.count_nonzero(known) >= 8:
            left = y[ahead] - model.fitted(p, known)[ahead]
            swing = y[ahead] - y[ahead].mean(axis=0)
            found.append((1 - float(np.linalg.norm(left) / np.linalg.norm(swing)), float(begin)))
    return found
