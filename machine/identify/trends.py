"""Test values in order for a trend, such as that of a machine that warms up or wears."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Trend(NamedTuple):
    """A trend of values beyond chance: a line.

    Attributes
    ----------
    first, last : float
        The line at the first and at the last of the values.
    low, high : float
        Ends of an interval that covers what is measured from the first to the last with 95 %.
    next_low, next_high : float
        The same, for one value more, to which the line goes on.
    """

    first: float
    last: float
    low: float
    high: float
    next_low: float
    next_high: float


def trend_of(values: Array, variances: Array, chance: float) -> Trend | None:
    """The trend of values in their order; None where chance makes a line as steep.

    Values are weighed by their variances; their scatter beside the line is the measure of Student's
    test of its slope, so that a machine that varies at random from one to the next has no trend.
    Five values or more that only rise or only fall have one, too: a curve passes no test of a line.
    """
    from scipy.special import stdtrit  # not at the top: it takes long to load

    matters = 1e-6  # share of the value, below which a trend is one of the arithmetic
    count = len(values)
    freedom = count - 2
    if freedom < 1:
        return None
    weights = variances.mean() / variances
    place = np.arange(count, dtype=float)
    place -= np.average(place, weights=weights)
    mean = float(np.average(values, weights=weights))
    leverage = float((weights * place**2).sum())
    slope = float((weights * place * values).sum()) / leverage
    residual = values - mean - slope * place
    variance = float((weights * residual**2).sum()) / freedom
    steep = stdtrit(freedom, 1 - chance / 2) * (variance / leverage) ** 0.5
    by_chance = abs(slope) <= steep and not _in_order(values)
    if by_chance or abs(slope) * count <= matters * abs(mean):
        return None
    places = np.array([place[0], place[-1], place[-1] + 1])
    line = mean + slope * places
    # of a value there: of the line, and beside it
    deviations = (variance * (1 / weights.sum() + places**2 / leverage + 1)) ** 0.5
    reach = stdtrit(freedom, 0.975) * deviations
    lower = line - reach
    upper = line + reach
    # a curve ends beside its line: there the values themselves tell
    unsure = 2 * variances**0.5
    certain = unsure <= reach.max()
    low = min(float(lower[:2].min()), float((values - unsure)[certain].min(initial=np.inf)))
    high = max(float(upper[:2].max()), float((values + unsure)[certain].max(initial=-np.inf)))
    return Trend(
        first=float(line[0]),
        last=float(line[1]),
        low=low,
        high=high,
        next_low=min(low, float(lower[2])),
        next_high=max(high, float(upper[2])),
    )


def _in_order(values: Array) -> bool:
    """Return whether five values or more only rise or fall: chance does so in 1.7 % at most."""
    steps = np.diff(values)
    return len(values) >= 5 and bool((steps > 0).all() or (steps < 0).all())
