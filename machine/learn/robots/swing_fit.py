"""Fit of the swing after a robot's move: frequencies and dampings of all signals together.

Rings of the arm itself, a base or a gear are fitted beside the plant's modes, as further modes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import tau
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.recordings.recording import noise_of
from quietarm.machine.recordings.robot_recording import RobotRecording

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
SETTLES = 0.1
"""Seconds after arrival that are not read: the controller settles."""
PERIODS = 6.0
"""Of the slowest mode, that are read."""
_RING = ((5.0, 6.0, 7.0, 8.5, 10.0, 12.0, 15.0, 19.0), (0.01, 0.03, 0.1, 0.2, 0.35))
"""Frequencies [Hz] and dampings from which the fit of such a ring begins."""
_RING_BOUNDS = ((3.5, 0.002), (25.0, 0.5))
_FAR = 0.5
"""Share by which the robot's frequencies may be off the plan's."""
_USUAL = 0.15
"""The same, usually (a logarithm)."""
_MOST_DAMPING = 0.05
"""Of a mode of what is carried."""
_CLOSE = 0.06
"""Share of a frequency, within which some periods do not tell two modes apart."""


class SwingingModes(Protocol):
    """Modes of a robot at rest, the slowest first, by what they do to what is recorded.

    Attributes
    ----------
    values : array of complex, shape (modes,)
        Eigenvalues above the real axis [rad/s].
    """

    values: ComplexArray

    @property
    def frequencies(self) -> Array:
        """Frequencies of the modes [Hz]."""
        ...

    @property
    def tip_by_torques(self) -> Array:
        """Acceleration of the tip by torques that accelerate joints (3, signals); 0 if held."""
        ...

    def rows_at(self, values: ComplexArray) -> ComplexArray:
        """Return each mode's effect on each signal (signals, modes), with these eigenvalues."""
        ...


@dataclass(frozen=True, eq=False)
class Window:
    """The part of a recording after arrival that is read: from when, and how long.

    Times are since arrival [s]; periods are those of the slowest mode.
    """

    recording: RobotRecording
    arrival: float
    modes: SwingingModes
    begin: float = SETTLES
    periods: float = PERIODS

    @cached_property
    def rows(self) -> slice:
        """Rows of the recording in the window."""
        end = self.begin + self.periods / float(self.modes.frequencies[0])
        first, last = np.searchsorted(self.recording.time - self.arrival, [self.begin, end])
        return slice(int(first), int(last))

    @cached_property
    def signals(self) -> tuple[Array, Array]:
        """Times and columns, thinned by means where samples are dense."""
        samples = 32  # a period of the fastest mode
        time = self.recording.time[self.rows] - self.arrival
        values = self.recording.swinging[1][self.rows]
        size = int(1 / (samples * self.modes.frequencies[-1] * self.recording.step))
        if size > 1 and len(time) > 4 * size:
            count = len(time) // size * size
            time = time[:count].reshape(-1, size).mean(axis=1)
            values = values[:count].reshape(len(time), size, -1).mean(axis=1)
        return time, values

    @property
    def lasts(self) -> float:
        """Length of the window in periods of the slowest mode."""
        return float(np.ptp(self.signals[0])) * float(self.modes.frequencies[0])


class SwingFit:
    """The swings of a window: frequencies and dampings of all signals, amplitudes of each.

    From where it begins, logarithms of them, those of rings after those of the modes; by default
    the modes alone.
    """

    def __init__(self, window: Window, start: Array | None = None) -> None:
        self.window = window
        self._time, self._values = window.signals
        self._clusters = _clusters(window.modes.frequencies)
        of_modes = [window.modes.values[modes[0]] for modes in self._clusters]
        self._model = np.array([[np.log(abs(v)), np.log(damping_of(v))] for v in of_modes])
        self._size = np.maximum(noise_of(self._values), 1e-3 * self._values.std() + 1e-300)
        x = self._coarse() if start is None else start
        self._ring_count = len(x) // 2 - len(self._model)
        self._coarse_rates = x[0 : 2 * len(self._model) : 2]
        for _ in range(2):
            x = self._fitted(x)
            self._size = self._deviation_of(x)
        self.found = x

    # What was found

    @cached_property
    def left(self) -> float:
        """Mean power that is left, of all signals."""
        residual = self._solved(self.found)[1]
        return float((residual**2).mean())

    @property
    def rings(self) -> list[tuple[float, float]]:
        """Frequency [Hz] and damping of what rings beside the modes."""
        values = self._eigenvalues(self.found)[len(self._model) :]
        return [(float(abs(value)) / tau, damping_of(value)) for value in values]

    @property
    def are_apart(self) -> bool:
        """Return whether all that rings is no mode's swing: damped heavily, or far from each."""
        heavily = 0.08
        modes = np.abs(self.by_mode) / tau
        return all(
            damping > heavily or np.abs(np.log(frequency / modes)).min() > _USUAL
            for frequency, damping in self.rings
        )

    def with_ring(self) -> Array:
        """Return where a fit with one more ring begins."""
        starts = [
            np.append(self.found, [np.log(tau * hertz), np.log(damping)])
            for hertz in _RING[0]
            for damping in _RING[1]
        ]
        return min(starts, key=lambda x: float(((self._solved(x)[1] / self._size) ** 2).sum()))

    @property
    def clearest(self) -> tuple[float, float]:
        """Frequency [Hz] and damping of the mode that stands out most."""
        clearest = int((np.abs(self.at_arrival) / self.deviations).argmax())
        value = self.by_mode[clearest]
        return float(abs(value)) / tau, damping_of(value)

    @cached_property
    def by_mode(self) -> ComplexArray:
        """Eigenvalue of every mode: modes that are not told apart have the same."""
        return self._spread(self._eigenvalues(self.found))

    @cached_property
    def at_arrival(self) -> ComplexArray:
        """Swing of the tip by every mode at arrival."""
        return self._projected(self.found)

    @property
    def other(self) -> float:
        """Ringing of the tip beside its modes, at arrival [m].

        Of torques it is what a ring of the arm itself does, whose joints give by its masses: a
        gear's, or a base's, whose shape is not known.
        """
        values = self._eigenvalues(self.found)[len(self._model) :]
        by_signal = self._solved(self.found)[0][len(self._model) :]
        if self.window.recording.acceleration is None:
            by_signal = by_signal @ self.window.modes.tip_by_torques.T
        sizes = np.linalg.norm(by_signal, axis=1) / np.abs(values) ** 2
        return float((sizes * np.exp(-values.real * self._time[0])).sum())

    @cached_property
    def deviations(self) -> Array:
        """Standard deviation of the two parts of each swing at arrival."""
        steps = 1e-4
        of_rates = np.zeros((len(self.at_arrival), len(self.found)), complex)
        for k, unit in enumerate(np.eye(len(self.found))):
            ahead = self._projected(self.found + steps * unit)
            of_rates[:, k] = (ahead - self.at_arrival) / steps
        by_rates = np.einsum("ij,jk,ik->i", of_rates, self._covariance, of_rates.conj()).real / 2
        design = self._design(self._eigenvalues(self.found))
        inverse: Any = np.linalg.pinv(design.T @ design, hermitian=True)
        by_noise = np.zeros(len(self.at_arrival))
        since = float(self._time[0])
        values = self._eigenvalues(self.found)
        for c, modes in enumerate(self._clusters):
            rows = self.window.modes.rows_at(self._spread(values))[:, modes]
            power = np.linalg.pinv(rows / self._size[:, None])
            of_one = np.sqrt(inverse[2 * c, 2 * c] + inverse[2 * c + 1, 2 * c + 1]) / 2**0.5
            grown = float(np.exp(-values[c].real * since))
            # what is left is no white noise: neighbours have the same
            by_noise[modes] = of_one * grown * np.linalg.norm(power, axis=1) * self._alike**0.5
        return np.sqrt(by_rates + by_noise**2)

    @cached_property
    def rate_deviations(self) -> Array:
        """Standard deviation of each mode's frequency, as a share."""
        shares = np.sqrt(np.diag(self._covariance)[0::2])
        return self._spread(shares)

    @cached_property
    def damping_deviations(self) -> Array:
        """Standard deviation of each mode's damping ratio."""
        shares = np.sqrt(np.diag(self._covariance)[1::2])
        ratios = np.exp(self.found[1::2])
        return self._spread(shares * ratios)

    @property
    def unexplained(self) -> float:
        """Share of the swing that is left, beside the noise."""
        _, left = self._solved(self.found)
        still, *_ = np.linalg.lstsq(self._still, self._values, rcond=None)
        swing = float(((self._values - self._still @ still) ** 2).sum())
        noise = float((noise_of(self._values) ** 2).sum()) * len(self._values)
        beside = max(float((left**2).sum()) - noise, 0.0)
        return (beside / max(swing, 1e-300)) ** 0.5

    # The fit

    def _coarse(self) -> Array:
        """Frequencies from which the fit begins: the plant's, all by the factor that fits best.

        By the shapes of the plant's modes, which tell one mode from another.
        """
        best = (np.inf, self._model.ravel())
        for factor in np.linspace(-np.log(1 + _FAR), np.log(1 + _FAR), 81):
            x = (self._model + np.array([factor, 0.0])).ravel()
            cost = self._cost_by_shapes(x) * (1 + (factor / _USUAL) ** 2 / 50)
            if cost < best[0]:
                best = (cost, x)
        return best[1]

    def _cost_by_shapes(self, x: Array) -> float:
        """Return what is left if the signals swing as the modes' shapes have it."""
        values = self._spread(self._eigenvalues(x))
        rows = self.window.modes.rows_at(values) / self._size[:, None]
        swings = np.exp(np.outer(self._time, values))
        columns = list[Array]()
        for mode in range(len(values)):
            shape: ComplexArray = np.outer(swings[:, mode], rows[:, mode])
            columns += [shape.real.ravel(), -shape.imag.ravel()]
        design = np.column_stack([self._without_mean(column) for column in columns])
        values_left = self._without_mean((self._values / self._size).ravel())
        sizes = _met(design, values_left)
        return float(((values_left - design @ sizes) ** 2).sum())

    def _without_mean(self, column: Array) -> Array:
        """A column of all signals without each signal's mean."""
        by_signal = column.reshape(len(self._time), -1)
        return (by_signal - by_signal.mean(axis=0)).ravel()

    @cached_property
    def _still(self) -> Array:
        """Columns of what does not swing: an offset and a slow drift."""
        return np.column_stack([np.ones_like(self._time), self._time - self._time.mean()])

    def _fitted(self, x: Array) -> Array:
        """Frequencies and dampings that meet the signals best."""
        from scipy.optimize import least_squares  # not at the top: it takes long to load

        rates = np.stack([self._coarse_rates, np.zeros(len(self._model))], axis=1).ravel()
        # a mode that does not swing is not to follow what another does
        lower = rates + np.array([[-_USUAL, np.log(1e-4)]] * len(self._model)).ravel()
        upper = rates + np.array([[_USUAL, np.log(_MOST_DAMPING)]] * len(self._model)).ravel()
        (slow, light), (fast, heavy) = _RING_BOUNDS
        lower = np.append(lower, [np.log(tau * slow), np.log(light)] * self._ring_count)
        upper = np.append(upper, [np.log(tau * fast), np.log(heavy)] * self._ring_count)
        start = np.clip(x, lower + 1e-6, upper - 1e-6)
        anchor = start.copy()
        anchor[1 : 2 * len(self._model) : 2] = self._model[:, 1]

        def residuals(x: Array) -> Array:
            _, left = self._solved(x)
            swings = (left / self._size).ravel() / self._alike**0.5
            return np.concatenate([swings, (x - anchor) / self._usual])

        found: Any = least_squares(residuals, start, bounds=(lower, upper), x_scale=0.01)
        slopes = found.jac
        self._covariance: Any = np.linalg.pinv(slopes.T @ slopes, hermitian=True)
        return np.asarray(found.x, float)

    @property
    def _usual(self) -> Array:
        """Standard deviations of what is sought before anything is recorded."""
        of_modes, of_rings = [_USUAL, 1.0], [0.3, 0.7]
        return np.array(of_modes * len(self._model) + of_rings * self._ring_count)

    @property
    def _alike(self) -> float:
        """Number of neighbours that tell the same: the rest is as fast as the fastest mode."""
        step = float(np.median(np.diff(self._time)))
        return max(1.0, 1 / (8 * float(self.window.modes.frequencies[-1]) * step))

    def _deviation_of(self, x: Array) -> Array:
        """Standard deviation of what is left of each signal."""
        _, left = self._solved(x)
        freedom = max(len(self._time) - 2 * len(x) - 2, 1)
        return np.maximum(np.sqrt((left**2).sum(axis=0) / freedom), 1e-6 * self._size)

    def _eigenvalues(self, x: Array) -> ComplexArray:
        """Return the eigenvalue of every cluster, and then of what rings beside them."""
        rates, dampings = np.exp(x[0::2]), np.exp(x[1::2])
        values: ComplexArray = rates * (-dampings + 1j * np.sqrt(1 - dampings**2))
        return values

    def _design(self, values: ComplexArray) -> Array:
        """Columns by which every signal is met: two a swing, from the first sample on."""
        swings: ComplexArray = np.exp(np.outer(self._time - self._time[0], values))
        columns = np.stack([swings.real, -swings.imag], axis=2).reshape(len(swings), -1)
        return np.column_stack([columns, self._still])

    def _solved(self, x: Array) -> tuple[ComplexArray, Array]:
        """Amplitudes of every swing in every signal (swings, signals), and what is left."""
        values = self._eigenvalues(x)
        design = self._design(values)
        sizes = _met(design, self._values)
        left = self._values - design @ sizes
        of_swings = sizes[: 2 * len(values)]
        return of_swings[0::2] + 1j * of_swings[1::2], left

    def _projected(self, x: Array) -> ComplexArray:
        """Swings of the tip at arrival by mode."""
        values = self._eigenvalues(x)
        by_signal, _ = self._solved(x)
        rows = self.window.modes.rows_at(self._spread(values))
        since = float(self._time[0])
        found = np.zeros(rows.shape[1], complex)
        for c, modes in enumerate(self._clusters):
            shapes = rows[:, modes] / self._size[:, None]
            sizes, *_ = np.linalg.lstsq(shapes, by_signal[c] / self._size, rcond=None)
            found[modes] = sizes * np.exp(-values[c] * since)
        return found

    def _spread(self, of_clusters: NDArray[Any]) -> NDArray[Any]:
        """Spread values of clusters over their modes."""
        by_mode = np.zeros(len(self.window.modes.values), of_clusters.dtype)
        for value, modes in zip(of_clusters, self._clusters):
            by_mode[modes] = value
        return by_mode


def _met(design: Array, values: Array) -> Array:
    """The sizes of some columns that meet values best, fifty times as fast as by their SVD."""
    apart = 1e-6  # of columns that are told apart to nine digits
    scale = np.maximum(np.linalg.norm(design, axis=0), 1e-300)
    columns = design / scale
    try:
        root = np.linalg.cholesky(columns.T @ columns)
    except np.linalg.LinAlgError:
        root = np.zeros((1, 1))
    if np.diag(root).min() < apart:
        sizes, *_ = np.linalg.lstsq(design, values, rcond=None)
        return np.asarray(sizes, float)
    by_root = np.linalg.solve(root.T, np.linalg.solve(root, columns.T @ values))
    return np.asarray((by_root.T / scale).T, float)


def _clusters(frequencies: Array) -> list[list[int]]:
    """Numbers of modes, those together that are too close to be told apart."""
    clusters = [[0]]
    for mode in range(1, len(frequencies)):
        if frequencies[mode] / frequencies[mode - 1] < 1 + _CLOSE:
            clusters[-1].append(mode)
        else:
            clusters.append([mode])
    return clusters


def damping_of(value: complex) -> float:
    """Return the damping ratio of an eigenvalue."""
    return float(-value.real / abs(value))
