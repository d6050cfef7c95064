"""A swing that dry friction damps: its amplitude falls by the same amount each period.

Of a mode with Coulomb friction the amplitude loses four times the friction's displacement a period
(Den Hartog, Trans. ASME 53, 1931), beside what viscous damping takes; its frequency stays.
"""

from __future__ import annotations

from math import tau

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.fits.columns import BasisColumns, parts
from quietarm.machine.identify.fits.fitting import Fit, fit
from quietarm.machine.identify.fits.swing_model import SwingModel
from quietarm.machine.recordings.recording import Recording

Array = NDArray[np.float64]


class DryDecay(BasisColumns):
    """The columns of one decay: frequency [rad/s], damping, share of the amplitude lost a radian.

    The share is of the first amplitude, and of dry friction alone.
    """

    driven = False
    count = 3

    def __init__(self, time: Array) -> None:
        self._time = time - time[0]

    def __call__(self, p: Array, derivatives: bool = True) -> tuple[Array, Array]:
        """Columns (1, rows, 2), and their derivatives (parameters, 1, rows, 2)."""
        columns = parts(self._swing(p)[:, None])[None]
        slopes = np.zeros((self.count, *columns.shape))
        for k, size in enumerate(np.maximum(np.abs(p), 1e-3)):
            change = np.zeros(self.count)
            change[k] = 1e-6 * size
            by_p = (self._swing(p + change) - self._swing(p - change)) / (2 * change[k])
            slopes[k] = parts(by_p[:, None])
        return columns, slopes if derivatives else slopes[:0]

    def _swing(self, p: Array) -> NDArray[np.complex128]:
        frequency, damping, lost = p
        angle = frequency * self._time
        exponent = damping * angle
        # the integral of exp(-damping angle), of no damping the angle
        small = np.abs(exponent) < 1e-6
        safe = np.where(small, 1.0, exponent)
        whole = angle * np.where(small, 1 - exponent / 2, -np.expm1(-safe) / safe)
        amplitude = np.maximum(np.exp(-exponent) - lost * whole, 0.0)
        return amplitude * np.exp(1j * np.sqrt(1 - damping**2) * angle)


def fit_dry(piece: Recording, frequency: float, damping: float) -> Fit:
    """A decay by dry friction fitted to a swing at a frequency [Hz], from an equivalent damping."""
    most_damping = 0.3
    model = SwingModel(piece, DryDecay(piece.time))
    omega = tau * frequency
    lower = np.array([0.5 * omega, -0.02, -0.02])
    upper = np.array([2.0 * omega, most_damping, 0.3])
    # the amplitude is lost in so many radians, at the latest
    whole = 1 / max(omega * float(np.ptp(piece.time)), 1.0)
    shares = (0.0, 0.3, 0.6, 0.9)
    starts = [np.array([omega, (1 - share) * damping, share * whole]) for share in shares]
    best = min(starts, key=model.cost)
    return fit(model, np.clip(best, lower, upper), lower, upper, frequency)
