"""Whether what a fit leaves is noise; and if it is not, the likely cause."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.studies.identify.recording import noise_of

Array = NDArray[np.float64]
_STANDS_OUT = 14.0
"""A line of a spectrum has so many times the noise's power beside it."""
_MATTERS = 0.03
"""Share of the swing that lines together have; less changes no plan."""
_MUCH = 0.1
"""Share of the swing, from which on what is left is doubted even where it looks like noise."""
_AT_LIMIT = 6
"""Samples at the same extreme value, from which on a sensor may be saturated."""


def spectrum_of(time: Array, left: Array) -> tuple[Array, Array]:
    """Frequencies [Hz], and the amplitude of what is left in each, of the signal with most."""
    column = left[:, int(left.std(axis=0).argmax())]
    even = np.linspace(time[0], time[-1], len(time))
    values = np.interp(even, time, column)
    step = float(even[1] - even[0])
    amplitudes: Array = 2 * np.abs(np.fft.rfft(values)) / len(even)
    return np.asarray(np.fft.rfftfreq(len(even), step), dtype=float), amplitudes


def cause_of(
    time: Array, left: Array, swinging: Array, frequency: float, noise: float
) -> tuple[str, str]:
    """What is left beside noise: a word for the cause and a sentence; empty where it is noise.

    Parameters
    ----------
    time : array, shape (rows,)
        [s].
    left, swinging : array, shape (rows, signals)
        What is left, and the fitted swing.
    frequency : float
        Of the swing [Hz].
    noise : float
        The recording's own, as a share of the swing.
    """
    at, size = spectrum_of(time, left)
    power, whole = size**2 / 2, float((swinging**2).mean(axis=0).max()) + 1e-300
    misfit = float((left**2).mean(axis=0).max() / whole) ** 0.5
    stands_out = power > _STANDS_OUT * _beside(power)
    lines = np.convolve(stands_out[1:], np.ones(5), "same") > 0
    excess = np.append(0.0, power[1:] * lines)
    share = float(excess.sum() / whole) ** 0.5
    if share < _MATTERS:
        if misfit < max(_MUCH, 4 * noise):
            return "", ""
        return "misfit", (
            f"the misfit is {misfit:.0%} of the swing, and its noise {noise:.0%}: it is no free "
            "decay of one mode; look at the picture, and name the part that is by --part"
        )
    band = np.digitize(at, [0.6 * frequency, 1.5 * frequency])
    most = int(np.bincount(band, excess).argmax())
    peak = float(at[(excess * (band == most)).argmax()])
    ratio = peak / frequency
    misfit_words = f"a misfit of {share:.1%} of the swing beside the noise"
    if most == 0:
        return "drift", (
            f"{misfit_words}, below the swing at {peak:.3g} Hz: the sensor drifts, the base sways, "
            "or the hub moves; fix them, or name the joint's angle by --angle"
        )
    if most == 1:
        return "amplitude", (
            f"{misfit_words}, at the swing's own frequency: frequency or damping change with the "
            f"amplitude, a second mode is near ({peak:.3g} Hz), or the hub gives way; name its "
            "angle by --angle, or push as hard as your moves do"
        )
    if abs(ratio - round(ratio)) < 0.04 and round(ratio) in (2, 3, 5):
        return "harmonic", (
            f"{misfit_words}, at {round(ratio)} times the swing's frequency ({peak:.4g} Hz): the "
            "sensor or the link is not linear, as one that saturates; push less"
        )
    return "mode", (
        f"{misfit_words}, at {peak:.4g} Hz: a second mode; plan with it (--set mode_count=2, where "
        "the plant has it), or keep to a band below it"
    )


def _beside(power: Array) -> Array:
    """The noise's power in each bin, by the median of those beside it: two octaves or 40 bins."""
    from scipy.ndimage import median_filter

    count = len(power)
    width = min(40, max(8, count // 2))
    local = median_filter(power[1:], width, mode="nearest") / np.log(2)
    high = float(np.median(power[count // 2 :])) / np.log(2)
    return np.concatenate([[local[0]], np.maximum(local, 0.2 * high)]) + 1e-30 * power.max()


def _limits_of(values: Array) -> Array:
    """Least and largest value of every signal that is there many times, else none (infinity)."""
    extremes = np.stack([values.min(axis=0), values.max(axis=0)])
    there = np.abs(values - extremes[:, None]) <= 1e-9 * np.ptp(values, axis=0)
    return np.where(there.sum(axis=1) >= _AT_LIMIT, extremes, [[-np.inf], [np.inf]])


def saturated(values: Array, fitted: Array | None = None) -> NDArray[np.bool_]:
    """Samples at a signal's limits; by a fit, those where it comes near them by the noise."""
    low, high = _limits_of(values)
    near = 0.0 if fitted is None else 2 * noise_of(values)
    at = values if fitted is None else fitted
    cut: Any = (at <= low + near) | (at >= high - near)
    return cut.any(axis=1)


def exceeds(values: Array, fitted: Array, flat: NDArray[np.bool_]) -> bool:
    """Whether a swing fitted to the other samples passes what the flat ones show by far."""
    side = np.sign(values - np.median(values, axis=0))
    further = ((fitted - values) * side)[flat].mean(axis=0)
    return bool((further > 2 * noise_of(values)).any())
