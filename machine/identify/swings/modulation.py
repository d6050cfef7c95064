"""Test for a change of frequency or damping along a swing, by what its fit leaves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.fits.fitting import Fit, deviation_of, power_near

Array = NDArray[np.float64]


def changes_along(fitted: Fit, frequency: float, chance: float) -> bool:
    """Return whether the residual has a part that is the swing times a curve over time.

    The chance is that of noise to pass for it.


    A frequency that drifts, a damping that changes with the amplitude and a second mode nearby all
    leave such a part. The first half of a period does not count, in which the
    swing may be held yet. It is told from noise by the F test's limit for many rows (a score test).
    """
    from scipy.special import chdtri  # not at the top: it takes long to load

    nothing = 1e-6  # share of the swing, below which a change is one of the arithmetic
    if fitted.misfit < nothing:
        return False
    model = fitted.model
    residual = fitted.residual.T
    x = model.start(fitted.p)
    time = model.time[model.counts]
    after_release = time >= time[0] + 0.5 / frequency
    residual = residual[:, after_release]
    slopes = model.jacobian(x)[:, after_release]
    deviation = deviation_of(residual)
    clipped = np.clip(residual, -4 * deviation, 4 * deviation)
    explained = 0.0
    left_over = np.zeros_like(clipped)
    curves = model.curved_swings(fitted.p)[:, after_release]
    for signal, values in enumerate(clipped):
        by_fit = slopes[signal]
        both = np.hstack([by_fit, curves[min(signal, len(curves) - 1)]])
        before = values - _nearest(by_fit, values)
        after = values - _nearest(both, values)
        explained += float(before @ before - after @ after) / float(deviation[signal, 0]) ** 2
        left_over[signal] = after / deviation[signal]
    count = curves.shape[-1] * len(residual)
    power = power_near(time[after_release], left_over, frequency, len(x) + count)
    return explained > power * chdtri(count, chance)


def _nearest(columns: Array, values: Array) -> Array:
    """Return the combination of some columns that is nearest to values."""
    size = np.linalg.norm(columns, axis=0)
    scaled = columns[:, size > 0] / size[size > 0]
    share, *_ = np.linalg.lstsq(scaled, values, rcond=None)
    return scaled @ share
