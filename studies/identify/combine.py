"""One value of several parts: the interval of their mean, and that of the next swing.

Parts differ by their own uncertainty and by how the machine varies: a random-effects model, with
the second by Paule and Mandel (J. Res. NBS 87, 1982), and the interval of a further one by Higgins,
Thompson and Spiegelhalter (J. R. Stat. Soc. A 172, 2009).
Degrees of freedom are Satterthwaite's.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from quietarm.studies.identify.answer import Estimate, Part

Array = NDArray[np.float64]
_LEVEL = 0.95
_OWN_FREEDOM = 30.0
"""Degrees of freedom of a part's own uncertainty."""


def combine(names: Sequence[str], parts: Sequence[Part]) -> tuple[list[Estimate], dict[str, str]]:
    """The estimates of parameters from parts, and those whose interval is as wide as their value."""
    found: list[Estimate] = []
    wide: dict[str, str] = {}
    for name in names:
        values = np.array([part.values[name] for part in parts])
        deviations = np.array([part.deviations[name] for part in parts])
        one = estimate(name, values, deviations)
        if one.value == 0 or one.error >= 1:
            low = one.low if one.next_low is None else one.next_low
            high = one.high if one.next_high is None else one.next_high
            wide[name] = f"its interval, {low:.3g} to {high:.3g}, is as wide as its value"
        else:
            found.append(one)
    return found, wide


def estimate(name: str, values: Array, deviations: Array) -> Estimate:
    """Mean and intervals of one parameter."""
    from scipy.stats import t  # not at the top: it takes long to load

    count = len(values)
    own = np.maximum(deviations, 1e-12 * np.abs(values) + 1e-300) ** 2
    between = _between(values, own)
    weight = 1 / (own + between)
    mean = float((weight * values).sum() / weight.sum())
    of_mean = 1 / float(weight.sum())

    def half(spread: float, of_own: float) -> float:
        if count == 1:
            freedom = _OWN_FREEDOM
        else:
            freedom = (spread + of_own) ** 2 / (
                spread**2 / (count - 1) + of_own**2 / (_OWN_FREEDOM * count)
            )
        return float(t.ppf((1 + _LEVEL) / 2, freedom)) * (spread + of_own) ** 0.5

    by_spread = between / count
    of_mean_half = half(by_spread, max(of_mean - by_spread, 0.0))
    low, high = mean - of_mean_half, mean + of_mean_half
    if count == 1:
        return Estimate(name, mean, low, high)
    of_next = max(half(between + by_spread, max(of_mean - by_spread, 0.0)), of_mean_half)
    return Estimate(name, mean, low, high, mean - of_next, mean + of_next)


def _between(values: Array, own: Array) -> float:
    """Variance between parts beyond their own, by which the weighed squares are as many as free."""
    from scipy.optimize import brentq  # not at the top: it takes long to load

    def excess(between: float) -> float:
        weight = 1 / (own + between)
        mean = (weight * values).sum() / weight.sum()
        return float((weight * (values - mean) ** 2).sum()) - (len(values) - 1)

    if len(values) < 2 or excess(0.0) <= 0:
        return 0.0
    return float(brentq(excess, 0.0, len(values) * float(np.ptp(values)) ** 2))
