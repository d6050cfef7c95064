"""Least squares of a plant's parameters to a part of a recording, robust against single samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.fits.bounded_steps import bounded_step, variances_of
from quietarm.machine.identify.fits.swing_model import SwingModel

Array = NDArray[np.float64]
Box = tuple[Array, Array]


@dataclass(frozen=True, eq=False)
class Fit:
    """A part of a recording met by least squares.

    Attributes
    ----------
    p, deviations : array
        The parameters; theirs by the residuals' power near the swing's frequency.
    model : SwingModel
        What was fitted.
    swinging, residual : array, shape (rows, signals)
        What swings of the nearest signals, without the trend; and what is left.
    delay : float
        By which the angle seems to be late [s]; 0 where it does not.
    inflation : array
        By what factor each parameter's deviation grows because the size of the response to the
        joint's motion is unknown.
    """

    p: Array
    deviations: Array
    model: SwingModel
    swinging: Array
    residual: Array
    delay: float
    inflation: Array

    @property
    def misfit(self) -> float:
        """Misfit as a share of the swing; of several signals the largest."""
        size = np.sqrt((self.swinging**2).mean(axis=0))
        shares = self.residual.std(axis=0) / np.maximum(size, 1e-300)
        return float(shares.max())


def fit(model: SwingModel, start: Array, lower: Array, upper: Array, frequency: float) -> Fit:
    """Least squares of parameters and amplitudes of a swing at a frequency [Hz].

    First all residuals count by their square, then by Huber's weights.
    """
    x, deviation = _by_huber(model, start, (lower, upper))
    residual = model.residual(x)
    time = model.time[model.counts]
    weighed = residual / deviation
    slopes = (model.jacobian(x) / deviation[..., None]).reshape(-1, len(x))
    size = np.linalg.norm(slopes, axis=0)
    size[size == 0] = 1.0
    slopes /= size  # units apart: else the pseudo-inverse takes a small one for none
    variances = variances_of(slopes)
    power = power_near(time, weighed, frequency, len(x))
    deviations = np.sqrt(variances * power) / size
    swinging, by_joint = model.swinging(x)
    delay = 0.0
    inflation = np.ones(model.count)
    if model.driven:
        later = np.gradient(by_joint, time, axis=1) / deviation
        delay = _delay(weighed.ravel(), later.ravel(), slopes)
        if not model.fixed:
            inflation = _inflation(slopes, variances, model.count, len(residual))
    p = x[: model.count]
    of_p = deviations[: model.count]
    return Fit(p, of_p, model, swinging.T, residual.T, delay, inflation)


def _by_huber(model: SwingModel, start: Array, bounds: Box) -> tuple[Array, Array]:
    """Parameters and amplitudes, and the deviation of each signal's residuals (signals, 1)."""
    beyond = 2.5  # deviations, from which on residuals count by their size alone (Huber's)
    settled = 0.02  # a change of the weights that changes nothing more
    least = 1e-9 * model.values.std(axis=0)[:, None] + 1e-300
    weights = np.ones((model.values.shape[1], int(model.counts.sum())))
    x = _search(model, start, weights, bounds, most_steps=40)
    residual = model.residual(x)
    deviation = deviation_of(residual, least)
    for _ in range(8):
        size = np.maximum(np.abs(residual), 1e-300)
        huber = np.minimum(1.0, beyond * deviation / size)
        before = weights
        weights = huber / (deviation / deviation.min()) ** 2
        if np.abs(weights - before).max() < settled:
            break
        x = _search(model, x[: model.count], weights, bounds, most_steps=10)
        residual = model.residual(x)
        deviation = deviation_of(residual, least)
    return x, deviation


def deviation_of(residual: Array, least: Array | float = 1e-300) -> Array:
    """The robust deviation of each signal's residuals (signals, 1)."""
    spread = residual.std(axis=1, keepdims=True)
    robust = 1.4826 * np.median(np.abs(residual), axis=1, keepdims=True)
    return np.clip(robust, np.maximum(0.1 * spread, least), spread + least)


def _inflation(slopes: Array, variances: Array, count: int, signals: int) -> Array:
    """Return the factors by which the unknown size of the joint's response widens deviations."""
    amplitudes = (slopes.shape[1] - count) // signals
    of_joint = count + np.arange(signals) * amplitudes
    known = np.delete(slopes, of_joint, axis=1)
    return np.sqrt(variances[:count] / variances_of(known)[:count])


def _search(model: SwingModel, p: Array, weights: Array, bounds: Box, most_steps: int) -> Array:
    """Parameters and amplitudes of the least weighted squares, by Levenberg and Marquardt's steps.

    Amplitudes are the best of the parameters at every step (variable projection), so that steps are
    of the parameters alone.
    """
    x, cost = _projected(model, p, weights)
    damping = 1e-4
    for _ in range(most_steps):
        p = x[: model.count]
        gradient, curvature = _slopes(model, x, weights)
        while damping < 1e8:
            diagonal = np.diag(curvature) + 1e-300
            damped = curvature + damping * np.diag(diagonal)
            new_p = np.clip(p + bounded_step(p, damped, gradient, bounds), *bounds)
            new_x, new_cost = _projected(model, new_p, weights)
            if new_cost < cost or np.array_equal(new_p, p):
                break
            damping *= 8
        else:
            break
        if new_cost >= cost:
            break
        damping /= 8
        small_step = (np.abs(new_p - p) <= 1e-12 * (np.abs(new_p) + 1e-6)).all()
        small_gain = cost - new_cost <= 1e-9 * cost
        x = new_x
        cost = new_cost
        if small_step or small_gain:
            break
    return x


def _projected(model: SwingModel, p: Array, weights: Array) -> tuple[Array, float]:
    """The parameters with the amplitudes that leave the least, and the squares that are left."""
    x = model.start(p, weights)
    return x, float((weights * model.residual(x) ** 2).sum())


def _slopes(model: SwingModel, x: Array, weights: Array) -> tuple[Array, Array]:
    """Gradient and Gauss and Newton's curvature by the parameters, amplitudes following them."""
    slopes = model.jacobian(x)
    residual = model.residual(x)
    count = model.count
    gradient = np.zeros(count)
    curvature = np.zeros((count, count))
    width = (slopes.shape[-1] - count) // len(residual)
    for signal, root in enumerate(weights**0.5):
        first = count + signal * width
        of_signal = root[:, None] * slopes[signal]
        columns = of_signal[:, first : first + width]
        by_p = of_signal[:, :count]
        of_columns, *_ = np.linalg.lstsq(columns, by_p, rcond=None)
        by_p = by_p - columns @ of_columns
        gradient += by_p.T @ (root * residual[signal])
        curvature += by_p.T @ by_p
    return gradient, curvature


def power_near(time: Array, residual: Array, frequency: float, parameters: int) -> float:
    """Mean power of residuals, or of those within an octave of a frequency where that is more."""
    rows = len(time)
    white = float((residual**2).sum()) / max(residual.size - parameters, 1)
    frequencies = np.fft.rfftfreq(rows, float(np.median(np.diff(time))))
    spectra = np.fft.rfft(residual, axis=1)
    power = (np.abs(spectra) ** 2).mean(axis=0) / rows
    near = (frequencies > frequency / 2) & (frequencies < 2 * frequency)
    bins = np.count_nonzero(near)
    if bins < 4:
        return white
    return max(white, float(power[near].sum() / (bins - 2)))


def _delay(residual: Array, later: Array, slopes: Array) -> float:
    """Return how late the angle is: another parameter, if it explains much of what is left."""
    much = 0.25  # share of the power that is left
    share, *_ = np.linalg.lstsq(slopes, later, rcond=None)
    apart = later - slopes @ share
    along = float(apart @ residual)
    size = float(apart @ apart)
    explains_little = along**2 <= much * size * float(residual @ residual)
    if explains_little or size <= 1e-12 * float(later @ later):
        return 0.0
    return along / size
