"""The signals of a recording as what a plant's modes make of it, and a slow trend."""

from __future__ import annotations

from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.fits.columns import BasisColumns
from quietarm.machine.recordings.recording import Recording

Array = NDArray[np.float64]


class SwingModel:
    """The signals of a recording as what a plant's modes make of it, and a slow trend.

    Unknown are the plant's parameters and the amplitudes of all columns, for each signal by itself:
    together x.

    Parameters
    ----------
    recording : Recording
        The part of it, thinned to what the modes need.
    columns : BasisColumns
        What the signals consist of, by the parameters.
    cosines : int, optional
        How many of a slow motion, beside an offset and a slope.
    scaled : bool, optional
        Whether the sensors' scale is unknown; else the joint's motion acts as the plant says.

    Attributes
    ----------
    counts : array of bool, shape (rows,)
        The rows that count.
    """

    def __init__(
        self, recording: Recording, columns: BasisColumns, cosines: int = 0, scaled: bool = True
    ) -> None:
        self.time = recording.time
        self.values = recording.values
        self.driven = columns.driven
        self.count = columns.count
        self.counts = np.ones(len(self.time), bool)
        self.fixed = int(columns.driven and not scaled)
        self.trend = self._trend(cosines)
        self._of_plant = columns
        self._columns_of = lru_cache(maxsize=1)(self._columns)

    def _trend(self, cosines: int) -> Array:
        """Offset, slope and cosines over time (rows, columns)."""
        share = (self.time - self.time[0]) / np.ptp(self.time)
        shapes = [np.ones_like(share), share - 0.5]
        shapes += [np.cos(k * np.pi * share) for k in range(1, cosines + 1)]
        return np.stack(shapes, axis=1)

    def _columns(self, p: bytes, derivatives: bool) -> tuple[Array, Array]:
        """Columns (signals or 1, rows, columns), and their derivatives (parameters, as these)."""
        swings, slopes = self._of_plant(np.frombuffer(p), derivatives)
        trend = np.broadcast_to(self.trend, (len(swings), *self.trend.shape))
        of_trend = np.zeros((*slopes.shape[:-1], trend.shape[-1]))
        columns = np.concatenate([swings, trend], axis=-1)
        return columns, np.concatenate([slopes, of_trend], axis=-1)

    def amplitudes(
        self, columns: Array, rows: NDArray[np.bool_], weights: Array | None = None
    ) -> Array:
        """Return the columns' amplitudes that leave the least of some rows (signals, columns)."""
        best = np.ones((self.values.shape[1], columns.shape[-1]))
        for signal, values in enumerate(self.values.T):
            of_signal = columns[min(signal, len(columns) - 1), rows]
            fixed, free = np.split(of_signal, [self.fixed], axis=1)
            target = values[rows] - fixed.sum(axis=1)
            if weights is not None:
                root = weights[signal] ** 0.5
                free = root[:, None] * free
                target = root * target
            best[signal, self.fixed :], *_ = np.linalg.lstsq(free, target, rcond=None)
        return best

    def fitted(self, p: Array, rows: NDArray[np.bool_] | None = None) -> Array:
        """The signals that are nearest to some rows by some parameters (rows, signals)."""
        columns, _ = self._columns_of(p.tobytes(), False)
        amplitudes = self.amplitudes(columns, self.counts if rows is None else rows)
        return _products(columns, amplitudes).T

    def cost(self, p: Array) -> float:
        """Share of the signals' power that these parameters leave, the trend not counted."""
        residual = self.values - self.fitted(p)
        return float(((residual**2).sum(axis=0) / self._power).sum())

    @cached_property
    def _power(self) -> Array:
        """Power of every signal, the trend not counted."""
        of_trend = np.linalg.lstsq(self.trend, self.values, rcond=None)[0]
        swing = self.values - self.trend @ of_trend
        return (swing**2).sum(axis=0) + 1e-300

    def start(self, p: Array, weights: Array | None = None) -> Array:
        """The parameters with their best amplitudes, by weights (signals, rows that count): x."""
        columns, _ = self._columns_of(p.tobytes(), True)
        best = self.amplitudes(columns, self.counts, weights)[:, self.fixed :]
        return np.concatenate([p, best.ravel()])

    def _evaluate(self, x: Array) -> tuple[Array, Array, Array]:
        """Columns of the rows that count, their derivatives by the parameters, amplitudes."""
        columns, slopes = self._columns_of(x[: self.count].tobytes(), True)
        free = x[self.count :].reshape(self.values.shape[1], -1)
        amplitudes = np.pad(free, ((0, 0), (self.fixed, 0)), constant_values=1.0)
        if self.counts.all():  # no copies
            return columns, slopes, amplitudes
        return columns[:, self.counts], slopes[:, :, self.counts], amplitudes

    def residual(self, x: Array) -> Array:
        """Return the residual of x on the rows that count (signals, rows)."""
        columns, _, amplitudes = self._evaluate(x)
        return self.values[self.counts].T - _products(columns, amplitudes)

    def jacobian(self, x: Array) -> Array:
        """Derivatives of what x makes of the signals (signals, rows, x)."""
        columns, slopes, amplitudes = self._evaluate(x)
        by_p = np.moveaxis(_products(slopes, amplitudes), 0, -1)
        free = columns[:, :, None, self.fixed :]
        of_signal = np.eye(len(amplitudes))[:, None, :, None] * free
        by_amplitudes = of_signal.reshape(*by_p.shape[:2], -1)
        return np.concatenate([by_p, by_amplitudes], axis=-1)

    def swinging(self, x: Array) -> tuple[Array, Array]:
        """Return the swing by x, and its part from the joint's motion (signals, rows)."""
        columns, _, amplitudes = self._evaluate(x)
        swings = columns.shape[-1] - self.trend.shape[1]
        whole = _products(columns[..., :swings], amplitudes[:, :swings])
        by_joint = _products(columns[..., :1], amplitudes[:, :1])
        return whole, by_joint

    def curved_swings(self, p: Array) -> Array:
        """The swings times curves over time, of the second and third order (signals or 1, rows, n).

        They are what a change along the swing leaves.
        """
        columns, _ = self._columns_of(p.tobytes(), True)
        first = int(self.driven)
        last = columns.shape[-1] - self.trend.shape[1]
        swings = columns[:, self.counts, first:last]
        time = self.time[self.counts]
        place = 2 * (time - time[0]) / np.ptp(time) - 1
        parabola = (3 * place**2 - 1) / 2
        cubic = (5 * place**3 - 3 * place) / 2
        bent = [swings * curve[:, None] for curve in (parabola, cubic)]
        return np.concatenate(bent, axis=-1)


def _products(columns: Array, amplitudes: Array) -> Array:
    """The signals (..., signals, rows) of columns by their amplitudes (signals, columns)."""
    return (columns @ amplitudes[:, :, None])[..., 0]
