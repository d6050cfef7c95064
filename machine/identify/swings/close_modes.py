"""Two modes with frequencies so near that their sum beats: found and fitted together.

The start is the matrix pencil's (Hua and Sarkar, IEEE Trans. Acoust. Speech Signal Process. 38,
1990) of the swing as a slow complex signal; least squares of two free decays follow.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, tau
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.fits.columns import BasisColumns, parts
from quietarm.machine.identify.fits.fitting import Fit, fit
from quietarm.machine.identify.fits.swing_model import SwingModel
from quietarm.machine.identify.swings.dry_friction import fit_dry
from quietarm.machine.recordings.envelope import phasor
from quietarm.machine.recordings.recording import Recording, noise_of

Array = NDArray[np.float64]


class TwoDecays(BasisColumns):
    """The columns of two free decays: parameters are frequency [rad/s] and damping of each."""

    driven = False
    count = 4

    def __init__(self, time: Array) -> None:
        self._time = time - time[0]

    def __call__(self, p: Array, derivatives: bool = True) -> tuple[Array, Array]:
        """Columns (1, rows, 4), and their derivatives (parameters, 1, rows, 4)."""
        columns = np.zeros((1, len(self._time), 4))
        slopes = np.zeros((4, 1, len(self._time), 4))
        for mode in range(2):
            frequency, damping = p[2 * mode : 2 * mode + 2]
            root = np.sqrt(1 - damping**2)
            rate = complex(-damping, root)
            swing = np.exp(frequency * rate * self._time)
            by_frequency = rate * self._time * swing
            by_damping = frequency * complex(-1, -damping / root) * self._time * swing
            own_columns = slice(2 * mode, 2 * mode + 2)
            columns[0, :, own_columns] = parts(swing[:, None])
            slopes[2 * mode, 0, :, own_columns] = parts(by_frequency[:, None])
            slopes[2 * mode + 1, 0, :, own_columns] = parts(by_damping[:, None])
        return columns, slopes if derivatives else slopes[:0]


@dataclass(frozen=True)
class CloseModes:
    """Two modes that beat, the louder first.

    Attributes
    ----------
    frequencies, dampings : array, shape (2,)
        [rad/s], and damping ratios.
    frequency_deviations, damping_deviations : array, shape (2,)
        Their standard deviations.
    amplitude, ratio : float
        Of the louder at the begin, in the signal's unit; and of the other as a share of it.
    misfit, noise : float
        What both leave, and the recording's noise, as shares of the swing.
    """

    frequencies: Array
    dampings: Array
    frequency_deviations: Array
    damping_deviations: Array
    amplitude: float
    ratio: float
    misfit: float
    noise: float


def find_close_modes(recording: Recording, piece: Recording, frequency: float) -> CloseModes | None:
    """Two modes near a frequency [Hz] that meet a swing to its noise; None where there are none.

    Parameters
    ----------
    recording : Recording
        Of the swing alone.
    piece : Recording
        The same, thinned to what the modes need.
    frequency : float
        Of the swing.
    """
    start = _by_matrix_pencil(recording, frequency)
    if start is None:
        return None
    model = SwingModel(piece, TwoDecays(piece.time))
    most_damping = 0.3
    lower = np.array([0.5 * start[0], -0.02, 0.5 * start[2], -0.02])
    upper = np.array([2.0 * start[0], most_damping, 2.0 * start[2], most_damping])
    both = fit(model, np.clip(start, lower, upper), lower, upper, frequency)
    close = _judged(both, recording, piece)
    if close is None or not _beats(close, piece):
        return None
    return close


def _beats(close: CloseModes, piece: Recording) -> bool:
    """Return whether a beat of two modes shows in a swing, as one mode by itself has none.

    Less than a whole beat may be the straight envelope that dry friction has. Of 100 simulated
    swings with dry friction 15 were met by two modes, with 0.65 of a beat at most.
    """
    much_worse = 1.3  # times what two modes leave, that dry friction leaves where they are there
    least_left = 0.05  # of the louder, that the other mode has after half a beat
    apart = abs(float(close.frequencies[0] - close.frequencies[1]))
    seconds = float(np.ptp(piece.time))
    faster = close.frequencies[1] * close.dampings[1] - close.frequencies[0] * close.dampings[0]
    left = close.ratio * np.exp(-faster * min(pi / apart, seconds))
    if left < least_left:
        return False
    if apart * seconds >= tau:
        return True
    dry = fit_dry(piece, close.frequencies[0] / tau, max(float(close.dampings[0]), 1e-3))
    return dry.misfit > much_worse * close.misfit


def _by_matrix_pencil(recording: Recording, frequency: float) -> Array | None:
    """Frequencies and dampings of the two strongest decays near a frequency, one after another."""
    signal = phasor(recording, frequency)
    if signal is None:
        return None
    time, values = signal
    stride = max(1, len(time) // 200)
    time = time[::stride]
    slow = values[::stride] * np.exp(-1j * tau * frequency * (time - time[0]))[:, None]
    half = len(time) // 2
    if half < 4:
        return None
    windows = np.lib.stride_tricks.sliding_window_view(slow, half, axis=0)
    columns = windows.transpose(2, 0, 1).reshape(half, -1)
    strongest: Any = np.linalg.svd(columns, full_matrices=False)[0][:, :2]
    shift = np.linalg.lstsq(strongest[:-1], strongest[1:], rcond=None)[0]
    roots = np.linalg.eigvals(shift)
    rates = np.log(roots) / float(time[1] - time[0]) + 1j * tau * frequency
    if not np.isfinite(rates).all() or (rates.imag <= 0).any():
        return None
    sizes = np.abs(rates)
    dampings = -rates.real / sizes
    return np.ravel(np.stack([sizes, dampings], axis=1))


def _judged(both: Fit, recording: Recording, piece: Recording) -> CloseModes | None:
    """The modes of a fit, if both are there, apart, and all that swings."""
    size = np.maximum(np.sqrt((both.swinging**2).mean(axis=0)), 1e-300)
    thinned = (len(recording.time) / len(piece.time)) ** 0.5
    noise = float((noise_of(recording.values) / thinned / size).max())
    frequencies = both.p[::2]
    dampings = both.p[1::2]
    deviations = both.deviations
    amplitudes = _amplitudes(both)
    order = np.argsort(amplitudes)[::-1]
    seconds = float(np.ptp(piece.time))
    apart = abs(frequencies[0] - frequencies[1])
    met = both.misfit <= 1.5 * noise + 0.003
    # in less than a quarter of a beat their sum has the course of one decay, up to a parabola; of
    # 60 simulated swings of one mode none passed the other tests
    a_quarter = apart * seconds > pi / 2 and apart > 6 * deviations[::2].max()
    two = amplitudes.min() > 0.05 * amplitudes.max()
    decays = (dampings + 2 * deviations[1::2] > 0).all()
    if not (met and a_quarter and two and decays):
        return None
    return CloseModes(
        frequencies[order],
        dampings[order],
        deviations[::2][order],
        deviations[1::2][order],
        float(amplitudes.max()),
        float(amplitudes.min() / amplitudes.max()),
        both.misfit,
        noise,
    )


def _amplitudes(both: Fit) -> Array:
    """Return each mode's amplitude at the begin, of the signal in which it is largest."""
    best = both.model.start(both.p)[both.model.count :]
    by_signal = best.reshape(both.model.values.shape[1], -1)[:, :4]
    return np.hypot(by_signal[:, ::2], by_signal[:, 1::2]).max(axis=0)
