"""One value of several parts: the interval of their mean, and that of the next swing.

Parts differ by their own uncertainty and by how the machine varies, within a recording and from one
to the next: a random-effects model, whose variances are Paule and Mandel's (J. Res. NBS 87, 1982).
The interval of a further one is Higgins, Thompson and Spiegelhalter's (J. R. Stat. Soc. A 172,
2009), its degrees of freedom Satterthwaite's. A machine that drifts does not vary at random: both
intervals hold its trend as well.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.identified import Estimate, Part
from quietarm.machine.identify.trends import Trend, trend_of

Array = NDArray[np.float64]
Span = tuple[float, float]


class Group(NamedTuple):
    """Values of one parameter by the parts of one recording, and their variances."""

    values: Array
    variances: Array


class Combined(NamedTuple):
    """Parameters that parts identify together, and those that they leave uncertain.

    Attributes
    ----------
    estimates : list of Estimate
        The parameters that they identify.
    wide : dict of str to str
        Those whose interval is as wide as their value, and that in words.
    rough : dict of str to float
        The values of these in which the parts agree all the same: what makes their interval wide is
        how they change along a swing.
    trends : dict of str to Trend
        Those that drift from one recording to the next.
    """

    estimates: list[Estimate]
    wide: dict[str, str]
    rough: dict[str, float]
    trends: dict[str, Trend]


def combine(names: Sequence[str], parts: Sequence[Part]) -> Combined:
    """The estimates of parameters from parts, that are in the order of their recording."""
    estimates = list[Estimate]()
    wide = dict[str, str]()
    rough = dict[str, float]()
    trends = dict[str, Trend]()
    for name in names:
        groups = groups_of(parts, name)
        ranges = [part.spread[name] for part in parts if name in part.spread]
        estimated = covering(estimate(name, groups), ranges, ranges)
        trend = _trend_among(groups)
        if trend:
            trends[name] = trend
            of_next = (trend.next_low, trend.next_high)
            estimated = covering(estimated, [(trend.low, trend.high)], [of_next])
        if estimated.value == 0 or estimated.error >= 1:
            low, high = estimated.widest
            wide[name] = f"its interval, {low:.3g} to {high:.3g}, is as wide as its value"
            if _agree(parts, name, estimated.value):
                rough[name] = estimated.value
        else:
            estimates.append(estimated)
    return Combined(estimates, wide, rough, trends)


def _agree(parts: Sequence[Part], name: str, value: float) -> bool:
    """Return whether all parts by themselves tell about one positive value of a parameter."""
    apart = 0.5  # share of the value that parts may differ, or be unsure of
    values = np.array([part.values[name] for part in parts])
    deviations = np.array([part.deviations[name] for part in parts])
    widest = max(float(np.ptp(values)), float(np.median(deviations)))
    return value > 0 and float(values.min()) > 0 and widest <= apart * value


def groups_of(parts: Sequence[Part], name: str) -> list[Group]:
    """Group the parts' values of a parameter by recording, in the order of the parts."""
    recordings = dict.fromkeys(part.recording for part in parts)
    groups = list[Group]()
    for recording in recordings:
        members = [part for part in parts if part.recording == recording]
        values = np.array([part.values[name] for part in members])
        deviations = np.array([part.deviations[name] for part in members])
        least = 1e-12 * np.abs(values) + 1e-300
        groups.append(Group(values, np.maximum(deviations, least) ** 2))
    return groups


def estimate(name: str, groups: Sequence[Group], sizes: Array | None = None) -> Estimate:
    """Mean and intervals of one parameter, of parts by their recordings.

    Parameters
    ----------
    name : str
        Of the parameter.
    groups : sequence of Group
        What each recording says of it.
    sizes : array, shape (groups,), optional
        How many times as much as the best one each recording may be off by what is random from one
        to the next; 1 of all by default. The next swing is that of a best one.
    """
    from scipy.special import stdtrit  # not at the top: it takes long to load

    level = 0.95
    freedom_of_fit = 30.0  # degrees of freedom of the variance that a part's fit has
    within = _between(groups)
    means = _means_of(groups, within)
    files = len(groups)
    squares = np.ones(files) if sizes is None else sizes**2
    among = _between([means], squares)
    mean, of_mean = _mean(means.values, means.variances + among * squares)

    count = sum(len(group.values) for group in groups)
    of_machine = np.array([among, within, 0.0])
    of_parts = of_machine / [(1 / squares).sum(), count, 1.0]
    of_parts[2] = max(of_mean - of_parts.sum(), of_mean / 1e6)  # that of the fits
    freedom = np.array([max(files - 1, 1), max(count - files, 1), freedom_of_fit * count])

    def ends(variances: Array) -> Span:
        total = variances.sum()
        freedom_of_total = total**2 / (variances**2 / freedom).sum()
        half = float(stdtrit(freedom_of_total, (1 + level) / 2) * total**0.5)
        return mean - half, mean + half

    next_swing = ends(of_parts + of_machine) if count > 1 else ()
    return Estimate(name, mean, *ends(of_parts), *next_swing)


def covering(estimated: Estimate, of_mean: Sequence[Span], of_next: Sequence[Span]) -> Estimate:
    """An estimate whose intervals, of the mean and of the next swing, hold these as well."""
    ends = (estimated.low, estimated.high)
    low, high = _hull([ends, *of_mean])
    if estimated.next_low is None or estimated.next_high is None:
        return replace(estimated, low=low, high=high)
    ends_of_next = (estimated.next_low, estimated.next_high)
    next_low, next_high = _hull([ends_of_next, *of_next])
    return replace(estimated, low=low, high=high, next_low=next_low, next_high=next_high)


def _hull(ranges: Sequence[Span]) -> Span:
    """The least range that holds all."""
    return min(low for low, _ in ranges), max(high for _, high in ranges)


def _trend_among(groups: Sequence[Group]) -> Trend | None:
    """The trend from recording to recording, or of one alone from part to part."""
    chance = 0.01  # of a machine that varies at random to be told to drift
    sequence = _means_of(groups, _between(groups)) if len(groups) > 1 else groups[0]
    return trend_of(sequence.values, sequence.variances, chance)


def _means_of(groups: Sequence[Group], within: float) -> Group:
    """The mean of each recording, whose parts vary within it, and its variance."""
    means = [_mean(values, variances + within) for values, variances in groups]
    values, variances = np.array(means).T
    return Group(values, variances)


def _mean(values: Array, variances: Array) -> tuple[float, float]:
    """The weighed mean and its variance."""
    weight = 1 / variances
    return float((weight * values).sum() / weight.sum()), 1 / float(weight.sum())


def _between(groups: Sequence[Group], sizes: Array | float = 1.0) -> float:
    """Variance within groups beyond their own: with it weighed squares are as many as free.

    It is that of a value of size 1; others have as many times as much.
    """
    from scipy.optimize import brentq  # not at the top: it takes long to load

    def excess(between: float) -> float:
        total = 0.0
        for values, variances in groups:
            total_variances = variances + between * sizes
            mean, _ = _mean(values, total_variances)
            squares = (values - mean) ** 2 / total_variances
            total += float(squares.sum()) - (len(values) - 1)
        return total

    if all(len(group.values) == 1 for group in groups) or excess(0.0) <= 0:
        return 0.0
    most = 1e3 * max(float(np.ptp(group.values)) for group in groups) ** 2
    solve: Any = brentq
    return float(solve(excess, 0.0, most))
