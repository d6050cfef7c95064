"""One value of several parts: the interval of their mean, and that of the next swing.

Parts differ by their own uncertainty and by how the machine varies, within a recording and from one
to the next: a random-effects model, whose variances are Paule and Mandel's (J. Res. NBS 87, 1982).
The interval of a further one is Higgins, Thompson and Spiegelhalter's (J. R. Stat. Soc. A 172,
2009), its degrees of freedom Satterthwaite's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.studies.identify.machine import Estimate, Part

Array = NDArray[np.float64]
_LEVEL = 0.95
_OWN_FREEDOM = 30.0
"""Degrees of freedom of a part's own uncertainty."""


def combine(names: Sequence[str], parts: Sequence[Part]) -> tuple[list[Estimate], dict[str, str]]:
    """The estimates of parameters from parts, and those with an interval as wide as their value."""
    estimates = list[Estimate]()
    wide = dict[str, str]()
    recordings = np.unique([part.recording for part in parts], return_inverse=True)[1]
    for name in names:
        values = np.array([part.values[name] for part in parts])
        deviations = np.array([part.deviations[name] for part in parts])
        spreads = [part.spread[name] for part in parts if name in part.spread]
        combined = _widened(estimate(name, values, deviations, recordings), spreads)
        if combined.value == 0 or combined.error >= 1:
            low, high = combined.widest
            wide[name] = f"its interval, {low:.3g} to {high:.3g}, is as wide as its value"
        else:
            estimates.append(combined)
    return estimates, wide


def estimate(
    name: str, values: Array, deviations: Array, recordings: NDArray[np.int64]
) -> Estimate:
    """Mean and intervals of one parameter, of parts of some recordings (by number)."""
    from scipy.special import stdtrit  # not at the top: it takes long to load

    own = np.maximum(deviations, 1e-12 * np.abs(values) + 1e-300) ** 2
    groups = [recordings == k for k in np.unique(recordings)]
    within = _between([(values[g], own[g]) for g in groups])
    means, of_means = np.array([_mean(values[g], own[g] + within) for g in groups]).T
    among = _between([(means, of_means)])
    mean, of_mean = _mean(means, of_means + among)

    count, files = len(values), len(groups)
    between = np.array([among, within, 0.0])
    of_parts = between / [files, count, 1.0]
    of_parts[2] = max(of_mean - of_parts.sum(), of_mean / 1e6)  # their own
    freedom = np.array([max(files - 1, 1), max(count - files, 1), _OWN_FREEDOM * count])

    def ends(variances: Array) -> tuple[float, float]:
        total = variances.sum()
        level = stdtrit(total**2 / (variances**2 / freedom).sum(), (1 + _LEVEL) / 2)
        half = float(level * total**0.5)
        return mean - half, mean + half

    next_swing = ends(of_parts + between) if count > 1 else ()
    return Estimate(name, mean, *ends(of_parts), *next_swing)


def _widened(estimated: Estimate, spreads: Sequence[tuple[float, float]]) -> Estimate:
    """An estimate whose intervals hold what the parameter is at every amplitude as well."""
    lowest = min((low for low, _ in spreads), default=np.inf)
    highest = max((high for _, high in spreads), default=-np.inf)
    low = min(estimated.low, lowest)
    high = max(estimated.high, highest)
    if estimated.next_low is None or estimated.next_high is None:
        return replace(estimated, low=low, high=high)
    next_low = min(estimated.next_low, lowest)
    next_high = max(estimated.next_high, highest)
    return replace(estimated, low=low, high=high, next_low=next_low, next_high=next_high)


def _mean(values: Array, variances: Array) -> tuple[float, float]:
    """The weighed mean and its variance."""
    weight = 1 / variances
    return float((weight * values).sum() / weight.sum()), 1 / float(weight.sum())


def _between(groups: Sequence[tuple[Array, Array]]) -> float:
    """Variance within groups beyond their own: with it weighed squares are as many as free."""
    from scipy.optimize import brentq  # not at the top: it takes long to load

    def excess(between: float) -> float:
        return sum(
            float(((values - _mean(values, own + between)[0]) ** 2 / (own + between)).sum())
            - (len(values) - 1)
            for values, own in groups
        )

    if all(len(values) == 1 for values, _ in groups) or excess(0.0) <= 0:
        return 0.0
    solve: Any = brentq
    return float(solve(excess, 0.0, 1e3 * max(np.ptp(values) for values, _ in groups) ** 2))
