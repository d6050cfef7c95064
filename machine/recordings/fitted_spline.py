"""The recorded angle of a joint as a smooth function of time."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.recordings.recording import Recording

Array = NDArray[np.float64]
DEGREE = 5
"""Of the splines: their acceleration is a cubic."""


def smooth(recording: Recording) -> Any:
    """The quintic spline of an angle whose number of knots has the least cross-validated error."""
    time = recording.time
    angle = recording.angle
    assert angle is not None
    rows = len(time)
    best = None
    least_error = np.inf
    for count in (12, 24, 48, 96, 192, 384, 768, 1536):
        if count > max(rows / 4, 12):
            break
        even_rows = np.linspace(0, rows - 1, count)[1:-1]
        inner_knots = np.interp(even_rows, np.arange(rows), time)
        spline = fit_spline(time, angle, inner_knots)
        residual = spline(time) - angle
        freedom = rows - len(inner_knots) - DEGREE - 1
        error = float(residual @ residual) / freedom**2
        if error < least_error:
            least_error = error
            best = spline
    return best


def fit_spline(time: Array, values: Array, inner_knots: Array) -> Any:
    """The quintic spline with some knots that is nearest to values at some times.

    By normal equations: they have a narrow band, and splines of this basis are told apart well.
    Every knot has rows on both sides.
    """
    from scipy.interpolate import BSpline  # not at the top: it takes long to load
    from scipy.linalg import solveh_banded

    first = np.full(DEGREE + 1, time[0])
    last = np.full(DEGREE + 1, time[-1])
    knots = np.concatenate([first, inner_knots, last])
    basis = BSpline.design_matrix(time, knots, DEGREE)
    products = (basis.T @ basis).todia()
    size = products.shape[0]
    band = np.zeros((DEGREE + 1, size))
    for offset in range(DEGREE + 1):
        band[offset, : size - offset] = products.diagonal(-offset)
    solve: Any = solveh_banded
    coefficients = solve(band, basis.T @ values, lower=True)
    return BSpline(knots, coefficients, DEGREE)
