"""The map from the arrival states that a machine is told to its swing: a share and a deviation.

Of a linear machine a mode's swing at arrival is what the plant says of the set points, times one
complex number (the servo delays them, the tip moves a little more or less than the plant says),
and a deviation that all moves have, of what the plant lacks. Both are estimated from all moves
together. A large swing is met less exactly, since frequency and damping depend on it, and so
counts less.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
_OF_UNKNOWN_SHARE = 0.3
"""Standard deviation of a share of about 1, where no tip is seen during the move."""
_OF_SEEN_SHARE = 0.1
"""The same of one that is seen: the servo's delay turns it."""
_OF_DEVIATION = 0.1
"""The same of the deviation, as a share of the tip's largest displacement during the move."""
_OF_MOVING = 0.003
"""Share by which a frequency may be another while the joint moves than after arrival: a standing
joint sticks."""
_OF_LARGE_SWINGS = 0.04
"""Share of a swing by which it may differ from what a linear machine would leave."""


@dataclass(frozen=True, eq=False)
class ArrivalMap:
    """The map from what the plant says of the set points to one mode's swing at arrival.

    Attributes
    ----------
    share, deviation : complex
        The swing is share times what the plant says, plus the deviation [m].
    covariance : array, shape (2, 2)
        Of both.
    """

    share: complex
    deviation: complex
    covariance: ComplexArray

    def swing(self, told: complex) -> complex:
        """The swing that is left where the plant says this of the set points."""
        return self.share * told + self.deviation

    def deviation_of(self, told: complex) -> float:
        """Standard deviation of that swing."""
        row = np.array([told, 1.0])
        return float(np.sqrt((row @ self.covariance @ row.conj()).real))

    def told_for(self, swing: complex) -> complex:
        """Return what the plant should say of set points, so that this swing is left."""
        return (swing - self.deviation) / self.share


def map_of(
    told: ComplexArray, left: ComplexArray, noise: Array, size: float, share: float | None = None
) -> ArrivalMap:
    """The map of one mode from moves.

    Parameters
    ----------
    told, left : array of complex, shape (moves,)
        What the plant says of each move's set points, and the swing that was left [m].
    noise : array, shape (moves,)
        Standard deviation of each [m].
    size : float
        The tip's largest displacement during the move [m].
    share : float, optional
        How much of the plant's swing the tip shows during the move, where that is seen.
    """
    guess, covariance = _fitted(
        np.stack([told, np.ones_like(told)], axis=1), left, noise, size, share
    )
    return ArrivalMap(complex(guess[0]), complex(guess[1]), covariance)


def faster_by(
    told: ComplexArray,
    slope: ComplexArray,
    left: ComplexArray,
    noise: Array,
    size: float,
    share: float | None = None,
) -> float:
    """Return by what share a mode is faster during moves than after, as their arrivals tell.

    Arguments are those of `map_of`, and `slope`, what the plant says more by a share of 1.
    """
    columns = np.stack([told, np.ones_like(told), _OF_MOVING * slope], axis=1)
    (of_told, _, of_slope), _ = _fitted(columns, left, noise, size, share)
    most = 3.0  # deviations
    return _OF_MOVING * float(np.clip((of_slope / of_told).real, -most, most))


def _fitted(
    columns: ComplexArray, left: ComplexArray, noise: Array, size: float, share: float | None
) -> tuple[ComplexArray, ComplexArray]:
    """The sizes of columns: of what the plant says, of one, and of another; their covariance."""
    of_share = _OF_UNKNOWN_SHARE if share is None else _OF_SEEN_SHARE
    weights = 1 / (noise**2 + (_OF_LARGE_SWINGS * np.abs(left)) ** 2 + (1e-9 * size) ** 2)
    deviations = np.array([of_share, _OF_DEVIATION * size, 1.0])[: columns.shape[1]]
    before = np.array([1.0 if share is None else share, 0.0, 0.0])[: columns.shape[1]]
    prior = np.diag(deviations**-2.0)
    curvature = (columns.conj().T * weights) @ columns + prior
    gradient = (columns.conj().T * weights) @ left + prior @ before
    # sizes apart: a share is about one, a deviation some millionths
    scale = np.sqrt(np.diag(curvature).real)
    scaled: Any = np.linalg.inv(curvature / np.outer(scale, scale))
    covariance = scaled / np.outer(scale, scale)
    return covariance @ gradient, covariance
