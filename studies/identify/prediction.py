"""Whether an identified machine predicts a recording that it was not identified from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import tau

import numpy as np
from numpy.typing import NDArray
from quietarm.models import Plant
from quietarm.studies.identify.identification import find_frequencies
from quietarm.studies.identify.parameters import is_modal, values_of
from quietarm.studies.identify.recording import Recording
from quietarm.studies.identify.ring_down import RingDowns
from quietarm.studies.identify.swing import Eigenvalues, Window

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


def predict(plant: Plant, recordings: Sequence[Recording]) -> list[Prediction]:
    """How much of each ring-down of recordings a plant predicts, with nothing of it fitted.

    Raises
    ------
    ValueError
        When there is no ring-down of three periods.
    """
    names = [name for name in plant.measured if is_modal(plant, name)]
    p, eigenvalues = values_of(plant, names), Eigenvalues(plant, names)
    values, _ = eigenvalues(p)
    period = tau / float(values[0].imag)
    found: list[Prediction] = []
    for one, frequency in zip(recordings, find_frequencies(recordings), strict=True):
        parts, why = RingDowns(plant, names).fit(one, frequency)
        if not parts:
            raise ValueError(f"{one.name}: {why}")
        for part in parts:
            piece = one.part(one.rows(part.begin, part.end))
            window = Window.of(piece, float(values[-1].imag) / tau, hub=part.hub == "moves")
            B, _ = window.columns(*eigenvalues(p))
            shares = _shares(window, np.delete(B, B.shape[1] - 1, axis=1), period)
            if not shares:
                continue
            worst = min(shares, key=lambda each: each[1])
            own = RingDowns(plant, names).again(part, one).frequency
            found.append(Prediction(
                one.name, part.begin, part.end, float(np.median([share for _, share in shares])),
                worst[1], part.begin + worst[0], own,
            ))  # fmt: skip
    if not found:
        raise ValueError(
            f"{recordings[0].name}: no ring-down of three periods of {1 / period:.3g} Hz; record "
            "longer"
        )
    return found


def _shares(window: Window, B: Array, period: float) -> list[tuple[float, float]]:
    """Begins of the predicted periods, and how much of the swing there is predicted."""
    time, y = window.time, window.values
    lasts, found = float(np.ptp(time)), list[tuple[float, float]]()
    for begin in np.arange(0, max(lasts - (_KNOWN + 1) * period, 0) + 1e-9, period):
        start = time[0] + begin
        known = (time >= start) & (time < start + _KNOWN * period)
        ahead = (time >= start + _KNOWN * period) & (time < start + (_KNOWN + PERIODS) * period)
        if np.count_nonzero(ahead) < 4 or np.count_nonzero(known) <= B.shape[1]:
            continue
        amplitudes, *_ = np.linalg.lstsq(B[known], y[known], rcond=None)
        left = y[ahead] - B[ahead] @ amplitudes
        swing = y[ahead] - y[ahead].mean(axis=0)
        found.append(
            (
                float(begin + _KNOWN * period),
                1 - float(np.linalg.norm(left) / np.linalg.norm(swing)),
            )
        )
    return found
