"""Noise of residual and energy, as of a simulator with errors or of a machine that is measured."""

from __future__ import annotations

from dataclasses import dataclass
from math import log, sqrt
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp import Front
from quietarm.ocp.checks import whole

Array = NDArray[np.float64]
NOISY = 2
"""Objectives that have noise, the first ones: residual and energy."""


def noise_share(value: object) -> float:
    """A standard deviation of noise, as a share of the value; ValueError unless from 0 to 1."""
    number: Any = value
    is_number = isinstance(value, Real) and not isinstance(value, bool)
    if not (is_number and 0 <= number <= 1):  # nor NaN
        raise ValueError(
            f"noise is {value!r}, not a share from 0 to 1; give the standard deviation as a "
            "number, such as 0.01 for 1 %"
        )
    return float(number)


def times_evaluated(value: object, noise: float) -> int:
    """Check how often a candidate that is kept is evaluated; ValueError if nothing would differ."""
    times = whole("reevaluate", value, 1, 1000)
    if times > 1 and not noise:
        raise ValueError(
            f"reevaluate is {times}, and without noise every evaluation gives the same; give a "
            "noise, or leave it out"
        )
    return times


@dataclass(frozen=True)
class Belief:
    """The errors of a search with noise about the candidates that it took for the best.

    Attributes
    ----------
    points : int
        How many there are: none dominates another by what it believed.
    residual, energy : float
        Medians of the believed values, less 1, as shares of the true ones.
    dominated : int
        How many others of them dominate in truth.
    """

    points: int
    residual: float
    energy: float
    dominated: int


def belief_of(front: Front) -> Belief | None:
    """Compare a noisy search's values with the true ones; None without noise or candidates."""
    import moocore  # not at the top: it takes long to load

    entries = front.entries
    if not entries.believed:
        return None
    best = np.flatnonzero(moocore.is_nondominated(entries.beliefs()))
    true = entries.objectives()[best]
    shares = np.median(entries.beliefs()[best] / true, axis=0) - 1
    remaining = int(moocore.is_nondominated(true, keep_weakly=True).sum())
    return Belief(len(best), float(shares[0]), float(shares[1]), len(best) - remaining)


class Noise:
    """Factors that every evaluation of residual and energy gets, independent of each other.

    They are lognormal: positive, of mean 1, so that an average of many evaluations is the true
    value. With `sigma` the standard deviation of the logarithm, that of a factor is
    sqrt(exp(sigma^2) - 1), which is the share.

    Parameters
    ----------
    share : float
        Standard deviation as a share of the value.
    seed : int
        Seed of its random numbers, which are others than those of a search of the same seed.
    """

    def __init__(self, share: float, seed: int) -> None:
        self.share = noise_share(share)
        stream = 52
        self._random = np.random.default_rng([seed, stream])
        self._sigma = sqrt(log(1 + self.share**2))

    def of(self, objectives: Array, failed: NDArray[np.bool_]) -> Array:
        """Objectives, shape (n, objectives), of one evaluation each; what has failed stays."""
        if not self.share:
            return objectives
        shape = len(objectives), NOISY
        normal = self._random.standard_normal(shape)
        factors = np.exp(self._sigma * normal - self._sigma**2 / 2)
        factors[failed] = 1.0
        noisy = objectives.copy()
        noisy[:, :NOISY] *= factors
        return noisy
