"""Least squares of a plant's parameters to a part of a recording, robust against single samples."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.studies.identify.recording import Recording
from quietarm.studies.identify.response import Columns

Array = NDArray[np.float64]
_HUBER = 2.5
"""Residuals beyond so many deviations count by their size alone (Huber's)."""
_ROUNDS = 8
"""Of Huber's weights, at most."""
_SETTLED = 0.02
"""A change of these weights that changes nothing more."""
_STEPS, _STEPS_OF_ROUND = 40, 10
"""Of a search, and of one that begins where another ended."""
_MANY, _TOLD_APART = 100, 1e11
"""Rows, and the condition of their columns' products, for normal equations."""
_LATE = 0.25
"""An angle is called late where that explains this share of the power that is left."""


class Model:
    """The signals of a recording as what a plant's modes make of it, and a slow trend.

    Unknown are the plant's parameters and the amplitudes of all columns, for each signal by itself:
    together x.

    Parameters
    ----------
    recording : Recording
        The part of it, thinned to what the modes need.
    response : FreeDecay, Forced or Driven
        The modes' columns.
    cosines : int, optional
        How many of a slow motion, beside an offset and a slope.
    scaled : bool, optional
        Whether the sensors' scale is unknown; else the joint's motion acts as the plant says.

    Attributes
    ----------
    kept : array of bool, shape (rows,)
        The rows that count.
    """

    def __init__(
        self,
        recording: Recording,
        response: Columns,
        cosines: int = 0,
        scaled: bool = True,
    ) -> None:
        self.time, self.values, self.driven = recording.time, recording.values, response.driven
        self.count = response.count
        self.kept, self.fixed = np.ones(len(self.time), bool), int(response.driven and not scaled)
        share = (self.time - self.time[0]) / np.ptp(self.time)
        slow = [np.cos(k * np.pi * share) for k in range(1, cosines + 1)]
        self.trend = np.stack([np.ones_like(share), share - 0.5, *slow], axis=1)
        self._response, self._last = response, lru_cache(maxsize=1)(self._columns)

    def _columns(self, p: bytes, derivatives: bool) -> tuple[Array, Array]:
        """Columns (signals or 1, rows, columns), and their derivatives (parameters, as these)."""
        B, dB = self._response(np.frombuffer(p), derivatives)
        trend = np.broadcast_to(self.trend, (len(B), *self.trend.shape))
        still = np.zeros((*dB.shape[:-1], trend.shape[-1]))
        return np.concatenate([B, trend], axis=-1), np.concatenate([dB, still], axis=-1)

    def amplitudes(self, B: Array, rows: NDArray[np.bool_], weights: Array | None = None) -> Array:
        """Those of columns that leave the least of some rows (signals, columns)."""
        found = np.ones((self.values.shape[1], B.shape[-1]))
        for k, y in enumerate(self.values.T):
            known, free = np.split(B[min(k, len(B) - 1), rows], [self.fixed], axis=1)
            target = y[rows] - known.sum(axis=1)
            if weights is not None:
                root = weights[k] ** 0.5
                free, target = root[:, None] * free, root * target
            found[k, self.fixed :] = least_squares(free, target)
        return found

    def fitted(self, p: Array, rows: NDArray[np.bool_] | None = None) -> Array:
        """The signals that are nearest to some rows by some parameters (rows, signals)."""
        B, _ = self._last(p.tobytes(), False)
        return _products(B, self.amplitudes(B, self.kept if rows is None else rows)).T

    def cost(self, p: Array) -> float:
        """Share of the signals' power that these parameters leave, the trend not counted."""
        residual = self.values - self.fitted(p)
        return float(((residual**2).sum(axis=0) / self._power).sum())

    @cached_property
    def _power(self) -> Array:
        """Of every signal, the trend not counted."""
        trend = self.trend @ np.linalg.lstsq(self.trend, self.values, rcond=None)[0]
        return ((self.values - trend) ** 2).sum(axis=0) + 1e-300

    def start(self, p: Array, weights: Array | None = None) -> Array:
        """The parameters with their best amplitudes, by weights (signals, rows that count): x."""
        B, _ = self._last(p.tobytes(), True)
        best = self.amplitudes(B, self.kept, weights)[:, self.fixed :]
        return np.concatenate([p, best.ravel()])

    def _evaluate(self, x: Array) -> tuple[Array, Array, Array]:
        """Columns of the rows that count, their derivatives by the parameters, amplitudes."""
        B, dB = self._last(x[: self.count].tobytes(), True)
        free = x[self.count :].reshape(self.values.shape[1], -1)
        amplitudes = np.pad(free, ((0, 0), (self.fixed, 0)), constant_values=1.0)
        if self.kept.all():  # no copies
            return B, dB, amplitudes
        return B[:, self.kept], dB[:, :, self.kept], amplitudes

    def left(self, x: Array) -> Array:
        """What x leaves of the rows that count (signals, rows)."""
        B, _, amplitudes = self._evaluate(x)
        return self.values[self.kept].T - _products(B, amplitudes)

    def jacobian(self, x: Array) -> Array:
        """Derivatives of what x makes of the signals (signals, rows, x)."""
        B, dB, amplitudes = self._evaluate(x)
        by_p = np.moveaxis(_products(dB, amplitudes), 0, -1)
        of_signal = np.eye(len(amplitudes))[:, None, :, None] * B[:, :, None, self.fixed :]
        return np.concatenate([by_p, of_signal.reshape(*by_p.shape[:2], -1)], axis=-1)

    def swinging(self, x: Array) -> tuple[Array, Array]:
        """What swings by x, and what of that follows from the joint's motion (signals, rows)."""
        B, _, amplitudes = self._evaluate(x)
        own = B.shape[-1] - self.trend.shape[1]
        whole, first = (_products(B[..., :k], amplitudes[:, :k]) for k in (own, 1))
        return whole, first


@dataclass(frozen=True, eq=False)
class Fit:
    """A part of a recording met by least squares.

    Attributes
    ----------
    p, deviations : array
        The parameters; theirs by the residuals' power near the swing's frequency.
    model : Model
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
    model: Model
    swinging: Array
    residual: Array
    delay: float
    inflation: Array

    @property
    def misfit(self) -> float:
        """What is left, as a share of the swing; of several signals the largest."""
        size = np.sqrt((self.swinging**2).mean(axis=0))
        return float((self.residual.std(axis=0) / np.maximum(size, 1e-300)).max())


def fit(model: Model, start: Array, lower: Array, upper: Array, frequency: float) -> Fit:
    """Least squares of parameters and amplitudes of a swing at a frequency [Hz].

    First all residuals count by their square, then by Huber's weights.
    """
    count, least = len(start), 1e-9 * model.values.std(axis=0)[:, None] + 1e-300
    weights = np.ones((model.values.shape[1], int(model.kept.sum())))
    x = _search(model, start, weights, (lower, upper), _STEPS)
    residual = model.left(x)
    deviation = _deviation(residual, least)
    for _ in range(_ROUNDS):
        huber = np.minimum(1.0, _HUBER * deviation / np.maximum(np.abs(residual), 1e-300))
        before, weights = weights, huber / (deviation / deviation.min()) ** 2
        if np.abs(weights - before).max() < _SETTLED:
            break
        x = _search(model, x[:count], weights, (lower, upper), _STEPS_OF_ROUND)
        residual = model.left(x)
        deviation = _deviation(residual, least)
    J = (model.jacobian(x) / deviation[..., None]).reshape(-1, len(x))
    time, weighed = model.time[model.kept], residual / deviation
    size = np.linalg.norm(J, axis=0)
    size[size == 0] = 1.0
    J /= size  # units apart: else the pseudo-inverse takes a small one for none
    variances = _variances(J)
    power = _power_near(time, weighed, frequency, len(x))
    deviations = (np.sqrt(variances * power) / size)[:count]
    (swinging, by_joint), delay, inflation = model.swinging(x), 0.0, np.ones(count)
    if model.driven:
        later = np.gradient(by_joint, time, axis=1) / deviation
        delay = _delay(weighed.ravel(), later.ravel(), J)
        if not model.fixed:
            signals = len(residual)
            known = np.delete(J, count + np.arange(signals) * ((len(x) - count) // signals), axis=1)
            inflation = np.sqrt(variances[:count] / _variances(known)[:count])
    return Fit(x[:count], deviations, model, swinging.T, residual.T, delay, inflation)


def _deviation(residual: Array, least: Array) -> Array:
    """The robust deviation of each signal's residuals (signals, 1)."""
    spread = residual.std(axis=1, keepdims=True)
    robust = 1.4826 * np.median(np.abs(residual), axis=1, keepdims=True)
    return np.clip(robust, np.maximum(0.1 * spread, least), spread + least)


def _search(
    model: Model, p: Array, weights: Array, bounds: tuple[Array, Array], most: int
) -> Array:
    """Parameters and amplitudes of the least weighted squares, by Levenberg and Marquardt's steps.

    Amplitudes are the best of the parameters at every step (variable projection), so that steps are
    of the parameters alone.
    """
    x, cost = _projected(model, p, weights)
    damping = 1e-4
    for _ in range(most):
        p = x[: model.count]
        gradient, curvature = _slopes(model, x, weights)
        while damping < 1e8:
            scaled = curvature + damping * np.diag(np.diag(curvature) + 1e-300)
            new = np.clip(p + _step_within(p, scaled, gradient, bounds), *bounds)
            tried, tried_cost = _projected(model, new, weights)
            if tried_cost < cost or np.array_equal(new, p):
                break
            damping *= 8
        else:
            break
        step, gain = np.abs(new - p), cost - tried_cost
        if tried_cost >= cost:
            break
        x, damping = tried, damping / 8
        settled = (step <= 1e-12 * (np.abs(new) + 1e-6)).all() or gain <= 1e-9 * cost
        cost = tried_cost
        if settled:
            break
    return x


def _projected(model: Model, p: Array, weights: Array) -> tuple[Array, float]:
    """The parameters with the amplitudes that leave the least, and the squares that are left."""
    x = model.start(p, weights)
    return x, float((weights * model.left(x) ** 2).sum())


def _slopes(model: Model, x: Array, weights: Array) -> tuple[Array, Array]:
    """Gradient and Gauss and Newton's curvature by the parameters, amplitudes following them."""
    J, left, count = model.jacobian(x), model.left(x), model.count
    gradient, curvature = np.zeros(count), np.zeros((count, count))
    width = (J.shape[-1] - count) // len(left)
    for k, (weight, rest) in enumerate(zip(weights**0.5, left)):
        by_p = weight[:, None] * J[k, :, :count]
        columns = weight[:, None] * J[k, :, count + k * width : count + (k + 1) * width]
        by_p = by_p - columns @ least_squares(columns, by_p)
        gradient += by_p.T @ (weight * rest)
        curvature += by_p.T @ by_p
    return gradient, curvature


def least_squares(columns: Array, target: Array) -> Array:
    """What of columns is nearest to a target, or to each of several.

    By the normal equations where the columns are told apart well: that is much faster.
    """
    size = np.linalg.norm(columns, axis=0)
    there = size > 0
    if len(columns) > _MANY and there.any():
        scaled = columns[:, there] / size[there]
        gram = scaled.T @ scaled
        if np.linalg.cond(gram) < _TOLD_APART:
            found = np.zeros((columns.shape[1], *target.shape[1:]))
            found[there] = (np.linalg.solve(gram, scaled.T @ target).T / size[there]).T
            return found
    solve: Any = np.linalg.lstsq
    return solve(columns, target, rcond=None)[0]


def _step_within(p: Array, curvature: Array, gradient: Array, bounds: tuple[Array, Array]) -> Array:
    """A step by a curvature, along the bounds at which it would leave them.

    The curvature may be singular, where a parameter shows nowhere.
    """
    size = np.sqrt(np.maximum(np.diag(curvature), 1e-300))
    matrix, target = curvature / np.outer(size, size), gradient / size
    inside = np.ones(len(p), bool)
    while True:
        step = np.zeros(len(p))
        among = np.ix_(inside, inside)
        step[inside], *_ = np.linalg.lstsq(matrix[among], target[inside], rcond=None)
        leaves = inside & (((p <= bounds[0]) & (step < 0)) | ((p >= bounds[1]) & (step > 0)))
        if not leaves.any():
            return step / size
        inside &= ~leaves


def _variances(J: Array) -> Array:
    """Variances of parameters by the derivatives of residuals of unit variance."""
    covariance: Any = np.linalg.pinv(J.T @ J, hermitian=True)
    return np.diag(covariance)


def _products(B: Array, amplitudes: Array) -> Array:
    """The signals (..., signals, rows) of columns by their amplitudes (signals, columns)."""
    return (B @ amplitudes[:, :, None])[..., 0]


def _power_near(time: Array, left: Array, frequency: float, parameters: int) -> float:
    """Mean power of residuals, or of those within an octave of a frequency where that is more."""
    rows = len(time)
    white = float((left**2).sum()) / max(left.size - parameters, 1)
    at = np.fft.rfftfreq(rows, float(np.median(np.diff(time))))
    power = (np.abs(np.fft.rfft(left, axis=1)) ** 2).mean(axis=0) / rows
    near = (at > frequency / 2) & (at < 2 * frequency)
    bins = np.count_nonzero(near)
    return max(white, float(power[near].sum() / (bins - 2))) if bins >= 4 else white


def _delay(left: Array, later: Array, J: Array) -> float:
    """By how much the angle is late: another parameter, where it explains much of what is left."""
    share, *_ = np.linalg.lstsq(J, later, rcond=None)
    own = later - J @ share
    along, size = float(own @ left), float(own @ own)
    if along**2 <= _LATE * size * float(left @ left) or size <= 1e-12 * float(later @ later):
        return 0.0
    return along / size
