"""Decide whether what a fit leaves is noise; if it is not, name the likely cause."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.recordings.recording import noise_of, resolution_of

Array = NDArray[np.float64]
_STANDS_OUT = 14.0
"""A line of a spectrum has so many times the noise's power beside it."""
_MATTERS = 0.03
"""Share of the swing that lines together have; less changes no plan."""
_MUCH = 0.1
"""Share of the swing, from which on what is left is doubted even where it looks like noise."""
_AT_LIMIT = 6
"""Samples at the same extreme value, from which on a sensor may be saturated."""


def spectrum_of(time: Array, residual: Array) -> tuple[Array, Array]:
    """Frequencies [Hz], and the amplitude of what is left in each, of the signal with most."""
    even = np.linspace(time[0], time[-1], len(time))
    values = np.interp(even, time, residual[:, int(residual.std(axis=0).argmax())])
    amplitudes: Array = 2 * np.abs(np.fft.rfft(values)) / len(even)
    return np.asarray(np.fft.rfftfreq(len(even), even[1] - even[0]), dtype=float), amplitudes


def doubt_of(
    time: Array, residual: Array, swinging: Array, frequency: float, noise: float
) -> dict[str, str]:
    """Name the likely cause of what is left beside noise, with a warning; empty if it is noise.

    Parameters
    ----------
    time : array, shape (rows,)
        [s].
    residual, swinging : array, shape (rows, signals)
        What is left, and the fitted swing.
    frequency : float
        Of the swing [Hz].
    noise : float
        The recording's own, as a share of the swing.
    """
    at, size = spectrum_of(time, residual)
    power = size**2 / 2
    whole = float((swinging**2).mean(axis=0).max()) + 1e-300
    stands_out = power > _STANDS_OUT * _beside(power)
    lines = np.convolve(stands_out[1:], np.ones(5), "same") > 0
    excess = np.append(0.0, power[1:] * lines)
    share = float(excess.sum() / whole) ** 0.5
    if share < _MATTERS:
        misfit = float((residual**2).mean(axis=0).max() / whole) ** 0.5
        large = misfit >= max(_MUCH, 4 * noise)
        warning = (
            f"the misfit is {misfit:.0%} of the swing, and its noise {noise:.0%}: it is no free "
            "decay of one mode; look at the picture, and select the free decay by --part"
        )
        return {"cause": "misfit", "warning": warning} if large else {}
    band = np.digitize(at, [0.6 * frequency, 1.5 * frequency])
    most = int(np.bincount(band, excess).argmax())
    peak = float(at[(excess * (band == most)).argmax()])
    ratio = round(peak / frequency)
    harmonic = ratio in (2, 3, 5) and abs(peak / frequency - ratio) < 0.04
    cause = ("drift", "amplitude", "harmonic" if harmonic else "mode")[most]
    words = {
        "drift": f", below the swing at {peak:.3g} Hz: the sensor drifts, the base sways, or the "
        "hub moves; fix them, or name the joint's angle by --angle",
        "amplitude": ", at the swing's own frequency: frequency or damping change with the "
        f"amplitude, a second mode is near ({peak:.3g} Hz), or the hub gives way; name its angle "
        "by --angle, or push as hard as your moves do",
        "harmonic": f", at {ratio:.0f} times the swing's frequency ({peak:.4g} Hz): the sensor or "
        "the link is not linear, as one that saturates; push less",
        "mode": f", at {peak:.4g} Hz: a second mode; plan with it (--set mode_count=2, where the "
        "plant has it), or keep to a band below it",
    }
    warning = f"a misfit of {share:.1%} of the swing beside the noise{words[cause]}"
    return {"cause": cause, "warning": warning}


def _beside(power: Array) -> Array:
    """The noise's power in each bin, by the median of those beside it: two octaves or 40 bins."""
    from scipy.ndimage import median_filter  # slow to load

    count = len(power)
    local: Array = median_filter(power[1:], min(40, max(8, count // 2)), mode="nearest")
    high = float(np.median(power[count // 2 :]))
    beside = np.maximum(local, 0.2 * high)
    return np.append(local[0], beside) / np.log(2) + 1e-30 * power.max()


def saturated(values: Array, fitted: Array | None = None) -> NDArray[np.bool_]:
    """Samples at a signal's limits; by a fit, those where it comes near them by the noise.

    A limit is a least or largest value that is there many times.
    """
    extremes = np.stack([values.min(axis=0), values.max(axis=0)])
    there = np.abs(values - extremes[:, None]) <= 1e-9 * np.ptp(values, axis=0)
    reached = there.sum(axis=1) >= _AT_LIMIT
    low, high = np.where(reached, extremes, [[-np.inf], [np.inf]])
    near = 0.0 if fitted is None else 2 * noise_of(values)
    at = values if fitted is None else fitted
    cut: Any = (at <= low + near) | (at >= high - near)
    return cut.any(axis=1)


def exceeds(values: Array, fitted: Array, flat: NDArray[np.bool_]) -> bool:
    """Return whether a swing fitted to the other samples passes what the flat ones show by far.

    That is by more than the noise and a step of the sensor: an encoder's peaks are flat, too.
    """
    side = np.sign(values - np.median(values, axis=0))
    further = ((fitted - values) * side)[flat].mean(axis=0)
    steps = np.array([resolution_of(column) for column in values.T])
    return bool((further > np.maximum(2 * noise_of(values), 1.5 * steps)).any())
