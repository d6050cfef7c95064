"""What a plant answers to the recorded motion of its joint, met by least squares.

What is unknown of a recording, its state at the start, offsets and the scale of its sensors, is
linear in the signals and eliminated by projection (Golub and Pereyra, SIAM J. Numer. Anal. 10,
1973, with the derivatives of Kaufman, BIT 15, 1975).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.models import Plant
from quietarm.studies.identify.answer import Part
from quietarm.studies.identify.diagnosis import cause_of
from quietarm.studies.identify.parameters import bounds_of, values_of
from quietarm.studies.identify.recording import Recording, noise_of
from quietarm.studies.identify.response import Joint, Response

Array = NDArray[np.float64]
_HUBER = 2.5
_DEPENDENT = 1e-3
"""Parameters cannot be told apart where others explain all but this share of what one does."""
_MORE = 2.0
"""Times the noise that is left, from which on a delay of the angle matters."""
_LATE = 5.0
"""An angle is called late where that many deviations of the delay do not reach none."""


@dataclass(frozen=True, eq=False)
class Forced:
    """A recording whose joint moves, met by least squares.

    Attributes
    ----------
    p, covariance : array
        The parameters.
    time, fitted, residual : array
        The nearest signals, and what is left.
    delay : float
        By which the angle seems to be late [s]; 0 where it does not.
    """

    p: Array
    covariance: Array
    time: Array
    fitted: Array
    residual: Array
    delay: float

    @property
    def misfit(self) -> float:
        """What is left, as a share of the signal; of several the largest."""
        size = np.maximum((self.fitted + self.residual).std(axis=0), 1e-300)
        return float((self.residual.std(axis=0) / size).max())


class ForcedModel:
    """Residuals of a recording by a plant's parameters, and their derivatives."""

    def __init__(self, response: Response, recording: Recording, scaled: bool) -> None:
        self._response, self._recording, self._scaled = response, recording, scaled
        self.joint = Joint.of(recording)
        self.time, self.values = recording.time, recording.values
        self._kept: tuple[bytes, tuple[Array, Array, Array]] | None = None

    def __call__(self, p: Array) -> tuple[Array, Array, Array]:
        """Residual (rows, signals), its derivatives by parameters, and by the joint's time."""
        if self._kept is None or self._kept[0] != p.tobytes():
            self._kept = p.tobytes(), self._evaluated(p)
        return self._kept[1]

    def _evaluated(self, p: Array) -> tuple[Array, Array, Array]:
        columns, slopes = self._response.over(self._recording, self.joint, p)
        y, driven = self.values, columns[:, :, 0]
        scaled = self._scaled and bool(driven.any())
        unknown = [*np.moveaxis(columns[:, :, 0 if scaled else 1 :], 2, 0)]
        among = len(unknown)
        of_signal = np.eye(y.shape[1])
        unknown += [np.broadcast_to(row, y.shape) for row in of_signal]
        if driven.any():  # how far from the axis an accelerometer is
            turning = self.joint.at(self._recording.time)[2][:, None]
            unknown += [turning * row for row in of_signal[self._response.kinds == "acceleration"]]
        A = np.stack([one.ravel() for one in unknown], axis=1)
        scale = np.linalg.norm(A, axis=0) + 1e-300
        Q, R = np.linalg.qr(A / scale)
        target = (y - driven * (not scaled)).ravel()
        share = (np.linalg.pinv(R, rcond=1e-9) @ (Q.T @ target) / scale)[:among]
        change = np.tensordot(slopes[..., 0 if scaled else 1 :], share, axes=(3, 0))
        change = change + slopes[..., 0] * (not scaled)
        driving = driven * (share[0] if scaled else 1.0)
        later = np.gradient(driving, self._recording.time, axis=0).ravel()
        project = lambda x: x - Q @ (Q.T @ x)  # noqa: E731
        left = project(target).reshape(y.shape)
        J = -project(change.reshape(len(p), -1).T).T.reshape(-1, *y.shape)
        return left, J, project(later).reshape(y.shape)


def fit_forced(model: ForcedModel, plants: Sequence[Plant], names: Sequence[str]) -> Forced:
    """Least squares with Huber's loss, from several plants; the best is taken."""
    from scipy.optimize import least_squares  # not at the top: it takes long to load

    starts = [values_of(plant, names) for plant in plants]
    bounds = np.array([bounds_of(plants[0], names, start) for start in starts])
    lower, upper = bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)
    scale = np.where(starts[0] != 0, np.abs(starts[0]), 1e-2)

    def fitted(p: Array, deviation: Array, loss: str) -> Any:
        solve: Any = least_squares
        return solve(
            lambda x: (model(x * scale)[0] / deviation).ravel(),
            np.clip(p, lower, upper) / scale,
            lambda x: (model(x * scale)[1] / deviation).reshape(len(x), -1).T * scale,
            bounds=(lower / scale, upper / scale), x_scale="jac", loss=loss, f_scale=_HUBER,
            ftol=1e-9, xtol=1e-10, max_nfev=60,
        )  # fmt: skip

    size = model.values.std(axis=0) + 1e-300
    p = min((fitted(p, size, "linear") for p in starts), key=lambda one: one.cost).x * scale
    deviation = _deviation(model(p)[0])
    p = fitted(p, deviation, "huber").x * scale
    deviation = _deviation(model(p)[0])
    left, J, later = (entry / deviation for entry in model(p))
    flat, later = J.reshape(len(p), -1).T, later.ravel()
    power = _correlated_power(left)
    covariance: Any = np.linalg.pinv(flat.T @ flat, hermitian=True) * power
    delay = _delay(left.ravel(), flat, later, power)
    residual = left * deviation
    return Forced(p, covariance, model.time, model.values - residual, residual, delay)


def described(recording: Recording, names: Sequence[str], fit: Forced, frequency: float) -> Part:
    """The part that a recording is, with what a fit of it says."""
    swinging = fit.fitted - fit.fitted.mean(axis=0)
    size = np.maximum(np.sqrt((swinging**2).mean(axis=0)), 1e-300)
    noise = float((noise_of(recording.values) / size).max())
    cause, warning = cause_of(fit.time, fit.residual, swinging, frequency, noise)
    if fit.delay and (cause or fit.misfit > _MORE * noise):
        side = "late" if fit.delay > 0 else "early"
        cause, warning = (
            "delay",
            (
                f"{fit.misfit:.1%} of the signal is left, less if the angle were not "
                f"{abs(fit.delay) * 1e3:.3g} ms {side}: record both by one clock"
            ),
        )
    deviations = np.sqrt(np.diag(fit.covariance))
    return Part(
        recording.name, float(fit.time[0]), float(fit.time[-1]),
        dict(zip(names, map(float, fit.p), strict=True)),
        dict(zip(names, map(float, deviations), strict=True)),
        float(np.abs(swinging).max()), fit.misfit,
        noise, cause, warning, hub="equations",
    )  # fmt: skip


def _deviation(left: Array) -> Array:
    """Of every signal's residuals, robustly."""
    robust, spread = 1.4826 * np.median(np.abs(left), axis=0), left.std(axis=0)
    return np.clip(robust, 0.1 * spread, spread) + 1e-300


def _correlated_power(left: Array) -> float:
    """Variance of residuals, with what neighbours have in common (Newey and West's weights)."""
    rows, total = len(left), 0.0
    for column in left.T:
        power = np.abs(np.fft.rfft(column, 2 * rows)) ** 2
        lags = np.fft.irfft(power)[: rows // 8] / rows
        weight = 1 - np.arange(len(lags)) / len(lags)
        total += max(lags[0], float(lags[0] + 2 * (weight[1:] * lags[1:]).sum()))
    return total / left.shape[1]


def _delay(left: Array, J: Array, later: Array, power: float) -> float:
    """By how much the angle is late: another parameter, beside those that were fitted."""
    share, *_ = np.linalg.lstsq(J, later, rcond=None)
    own = later - J @ share
    told = float(own @ own)
    if told <= 1e-12 * float(later @ later):
        return 0.0
    delay = float(own @ left) / told
    return -delay if abs(delay) > _LATE * (power / told) ** 0.5 else 0.0


def not_identifiable(
    models: Sequence[ForcedModel], names: Sequence[str], p: Array
) -> dict[str, str]:
    """The parameters that recordings cannot tell, in their order, and why."""
    J = np.concatenate([(m(p)[1] / m.values.std(axis=0)).reshape(len(p), -1).T for m in models])
    J = J * np.where(p != 0, np.abs(p), 1e-2)
    largest = np.linalg.norm(J, axis=0).max()
    kept: list[int] = []
    cannot: dict[str, str] = {}
    for k, name in enumerate(names):
        size = np.linalg.norm(J[:, k])
        if size <= 1e-9 * largest:
            cannot[name] = "nothing that was recorded depends on it"
            continue
        if kept:
            share, *_ = np.linalg.lstsq(J[:, kept], J[:, k], rcond=None)
            if np.linalg.norm(J[:, k] - J[:, kept] @ share) < _DEPENDENT * size:
                like = names[kept[int(np.abs(share).argmax())]]
                cannot[name] = f"it does what {like} does"
                continue
        kept.append(k)
    return cannot
