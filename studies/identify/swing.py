"""A swing by a plant's own modes: with the joint at rest they are exponentials of its eigenvalues.

A moving hub adds what the modes answer to its recorded angle, whose second derivative is integrated
by parts, so that no noise is differentiated (docs/plants.md, 'A hub that gives way').
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from quietarm.models import JointMotion, Plant
from quietarm.ocp.simulation.collocation import modal_system
from quietarm.ocp.uncertainty import with_values
from quietarm.studies.identify.recording import Recording

Array = NDArray[np.float64]
_PER_PERIOD = 64
"""Samples a period of the fastest mode; more are averaged."""
_HUBER = 2.5
"""Residuals beyond so many deviations count by their size alone (Huber's)."""
_ROUNDS = 3
"""Of deviations, by which the residuals are weighed."""
MOST_DAMPING = 0.9


class Eigenvalues:
    """Eigenvalues of a plant with its joint at rest, and their derivatives by parameters."""

    def __init__(self, plant: Plant, names: Sequence[str]) -> None:
        p = ca.SX.sym("p", len(names))
        changed = with_values(plant, dict(zip(names, ca.vertsplit(p), strict=True)))
        system = modal_system(changed, JointMotion(0.0, 0.0, 0.0))
        modes = plant.modes
        K, D = (ca.vertcat(*(ca.horzcat(*row) for row in M)) for M in (system.K, system.D))
        A = ca.blockcat([[ca.SX(modes, modes), ca.SX.eye(modes)], [-K, -D]])
        self._matrix = ca.Function("A", [p], [ca.densify(A), ca.densify(ca.jacobian(ca.vec(A), p))])

    def __call__(self, p: Array) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """The eigenvalues that oscillate, slowest first, and their derivatives, a row each."""
        A, dA = (entry.full() for entry in self._matrix(p))
        values: Any
        values, right = np.linalg.eig(A)
        left = np.linalg.inv(right)
        order = [k for k in np.argsort(values.imag) if values[k].imag > 0]
        slopes = np.array([
            [left[k] @ dA[:, j].reshape(A.shape, order="F") @ right[:, k] for j in range(len(p))]
            for k in order
        ]).reshape(len(order), len(p))  # fmt: skip
        return values[order], slopes


@dataclass(frozen=True, eq=False)
class Window:
    """A part of a recording, thinned to what its modes need; its time is from its begin [s]."""

    begin: float
    time: Array
    values: Array
    angle: Array | None
    trend: Array

    @classmethod
    def of(
        cls, recording: Recording, fastest: float = 0.0, trend: float = 0.0, hub: bool = False
    ) -> Window:
        """The window of a recording.

        Parameters
        ----------
        recording : Recording
            The part of it.
        fastest : float, optional
            Frequency of the fastest mode [Hz], by which samples are averaged; by default none are.
        trend : float, optional
            Up to this frequency [Hz] a slow motion of the signal is left out by cosines.
        hub : bool, optional
            Whether what the modes answer to the joint is part of the model.
        """
        columns = [recording.time[:, None] - recording.time[0], recording.values]
        if hub and recording.angle is not None:
            columns.append(recording.angle[:, None] - recording.angle.mean())
        table = averaged(np.hstack(columns), _PER_PERIOD * fastest * recording.step)
        time, angle = table[:, 0], table[:, -1] if len(columns) == 3 else None
        basis = steady(time, time, int(2 * trend * np.ptp(time)))
        return cls(
            float(recording.time[0]),
            time,
            table[:, 1 : 1 + recording.values.shape[1]],
            angle,
            basis,
        )

    def columns(self, eigenvalues: Any, slopes: Any) -> tuple[Array, Array]:
        """What a signal is made of (rows, columns), and its derivatives (parameters, ...)."""
        t, made, changes = self.time, list[Array](), list[Array]()
        for value, slope in zip(eigenvalues, slopes, strict=True):
            swing = np.exp(value * t)
            made += [swing.real, swing.imag]
            by_p = slope[:, None] * (t * swing)
            changes += [by_p.real, by_p.imag]
            if self.angle is not None:
                answer, by_value = self._answer(value)
                made.append(answer)
                changes.append((slope[:, None] * by_value).real)
        still = np.zeros((slopes.shape[1], self.trend.shape[1], len(t)))
        B = np.hstack([np.stack(made, axis=1), self.trend])
        dB = np.concatenate([np.stack(changes, axis=1), still], axis=1)
        return B, dB.transpose(0, 2, 1)

    def _answer(self, value: complex) -> tuple[Array, Any]:
        """What a mode answers to the hub, and its derivative by the eigenvalue.

        The derivative is that factor whose product with a change of the eigenvalue has the change
        as its real part.
        """
        from scipy.signal import lfilter  # not at the top: it takes long to load

        assert self.angle is not None
        h = float(np.median(np.diff(self.time)))
        even = np.arange(round(float(np.ptp(self.time)) / h) + 1) * h + self.time[0]
        theta = np.interp(even, self.time, self.angle)
        grown = np.exp(value * h)
        late = (grown - 1 - value * h) / (value**2 * h)  # weight of the sample at the step's end
        early = (grown - 1) / value - late
        z: Any = lfilter([late, early], [1, -grown], theta)
        dz: Any = lfilter([late, early], [1, -grown], z)
        gain = value**2 / (2j * value.imag)
        on_time = lambda x: np.interp(self.time, even, x)  # noqa: E731
        answer = theta + 2 * (gain * z).real
        # d(2 Re(gain z)) = Re((2 dgain z + 2 gain dz) dvalue) + the part by Im(value) alone
        along = 2 * (value / (1j * value.imag)) * z + 2 * gain * dz
        of_imaginary = -2 * (gain * z).real / value.imag
        total = along - 1j * of_imaginary
        return on_time(answer), on_time(total.real) + 1j * on_time(total.imag)


def averaged(table: Array, share: float) -> Array:
    """Rows averaged by blocks, so that a share (below 1) of them stays; all of them for 0."""
    count = max(1, int(1 / share)) if share else 1
    return table[: len(table) // count * count].reshape(-1, count, table.shape[1]).mean(axis=1)


def steady(time: Array, among: Array, cosines: int = 0) -> Array:
    """Offset, slope and slow cosines at times, of the window among which they are scaled."""
    share = (time - among[0]) / max(float(np.ptp(among)), 1e-300)
    slow = [np.cos(k * np.pi * share) for k in range(1, cosines + 1)]
    return np.stack([np.ones_like(time), share - 0.5, *slow], axis=1)


@dataclass(frozen=True, eq=False)
class Swing:
    """A window met by least squares.

    Attributes
    ----------
    p : array
        The parameters.
    covariance : array
        Of the parameters, by the residuals' power near the swing's frequency.
    window : Window
        What was fitted.
    fitted : array, shape (rows, signals)
        The nearest signals.
    swinging : array, likewise
        Of these, what swings: without offset and trend.
    eigenvalues : array
        Of the modes.
    amplitudes : array, shape (columns, signals)
        Of the window's columns.
    """

    p: Array
    covariance: Array
    window: Window
    fitted: Array
    swinging: Array
    eigenvalues: NDArray[np.complex128]
    amplitudes: Array

    def at(self, time: Array) -> Array:
        """The signals at other times of the recording, without the hub's motion."""
        time = time - self.window.begin
        swings = [np.exp(value * time) for value in self.eigenvalues]
        B = np.stack([part for one in swings for part in (one.real, one.imag)], axis=1)
        cosines = self.window.trend.shape[1] - 2
        return np.hstack([B, steady(time, self.window.time, cosines)]) @ self.amplitudes

    @property
    def frequency(self) -> float:
        """Of the slowest mode [Hz]."""
        return float(self.eigenvalues[0].imag) / (2 * np.pi)

    @property
    def residual(self) -> Array:
        """What is left."""
        return self.window.values - self.fitted

    @property
    def misfit(self) -> float:
        """What is left, as a share of the swing; of several signals the largest."""
        size = np.sqrt((self.swinging**2).mean(axis=0))
        return float((self.residual.std(axis=0) / np.maximum(size, 1e-300)).max())


def cost_of(window: Window, eigenvalues: Eigenvalues, p: Array) -> float:
    """Share of the signals' power that the best amplitudes leave, the trend not counted."""
    B, _ = window.columns(*eigenvalues(p))
    return float((_left(B, window.values) / _left(window.trend, window.values)).sum())


def _left(B: Array, y: Array) -> Array:
    share, *_ = np.linalg.lstsq(B, y, rcond=None)
    return ((y - B @ share) ** 2).sum(axis=0) + 1e-300


def fit_swing(
    window: Window, eigenvalues: Eigenvalues, start: Array, lower: Array, upper: Array
) -> Swing:
    """Least squares of parameters and amplitudes, robust against single samples (Huber's loss)."""
    from scipy.optimize import least_squares  # not at the top: it takes long to load

    y, count = window.values, len(start)
    B, _ = window.columns(*eigenvalues(start))
    size = np.linalg.norm(B, axis=0) + 1e-300
    amplitudes, *_ = np.linalg.lstsq(B / size, y, rcond=None)
    least = 1e-9 * y.std(axis=0) + 1e-300
    scale = np.where(start != 0, np.abs(start), 1e-2)
    x = np.concatenate([start / scale, amplitudes.ravel(order="F")])
    bounds = [np.full(len(x), sign * np.inf) for sign in (-1, 1)]
    bounds[0][:count], bounds[1][:count] = lower / scale, upper / scale
    deviation = np.maximum((y - B / size @ amplitudes).std(axis=0), least)

    def residuals(x: Array) -> Array:
        B, _ = window.columns(*eigenvalues(x[:count] * scale))
        shares = x[count:].reshape(-1, y.shape[1], order="F")
        return ((B / size @ shares - y) / deviation).ravel(order="F")

    def jacobian(x: Array) -> Array:
        B, dB = window.columns(*eigenvalues(x[:count] * scale))
        shares = x[count:].reshape(-1, y.shape[1], order="F")
        J = np.zeros((y.shape[1], len(y), len(x)))
        for k in range(y.shape[1]):
            J[k, :, :count] = np.tensordot(dB, shares[:, k] / size, axes=(2, 0)).T * scale
            own = slice(count + k * len(shares), count + (k + 1) * len(shares))
            J[k, :, own] = B / size
        return (J / deviation[:, None, None]).reshape(-1, len(x))

    for round_ in range(_ROUNDS):
        loss, most = ("huber", 20) if round_ else ("linear", 40)
        solve: Any = least_squares
        found = solve(
            residuals, x, jacobian, bounds=bounds, x_scale="jac", loss=loss, f_scale=_HUBER,
            xtol=1e-12, ftol=1e-9, gtol=1e-14, max_nfev=most,
        )  # fmt: skip
        x = found.x
        left = residuals(x).reshape(-1, y.shape[1], order="F") * deviation
        spread, robust = left.std(axis=0), 1.4826 * np.median(np.abs(left), axis=0)
        before, deviation = (
            deviation,
            np.clip(robust, np.maximum(0.1 * spread, least), spread + least),
        )
        if round_ and np.allclose(before, deviation, rtol=0.02):
            break
    p = x[:count] * scale
    values, slopes = eigenvalues(p)
    B, _ = window.columns(values, slopes)
    shares = x[count:].reshape(-1, y.shape[1], order="F")
    fitted = B / size @ shares
    own = B.shape[1] - window.trend.shape[1]
    swinging = (B / size)[:, :own] @ shares[:own]
    J = jacobian(x)
    inverse: Any = np.linalg.pinv(J.T @ J, hermitian=True)[:count, :count] * np.outer(scale, scale)
    power = _power_near(window.time, (y - fitted) / deviation, values[0].imag / (2 * np.pi), len(x))
    return Swing(p, inverse * power, window, fitted, swinging, values, shares / size[:, None])


def _power_near(time: Array, left: Array, frequency: float, parameters: int) -> float:
    """Mean power of residuals, or of those within an octave of a frequency where that is more."""
    rows = len(left)
    free = max(left.size - parameters, 1)
    white = float((left**2).sum()) / free
    at = np.fft.rfftfreq(rows, float(np.median(np.diff(time))))
    power = (np.abs(np.fft.rfft(left, axis=0)) ** 2).mean(axis=1) / rows
    near = (at > frequency / 2) & (at < 2 * frequency)
    bins = np.count_nonzero(near)
    if bins < 4:
        return white
    return max(white, float(power[near].sum() / (bins - 2)))
