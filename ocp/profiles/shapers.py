"""Input shapers: impulses in time whose convolution with a motion leaves a vibration out.

Formulas and their sources: docs/physics.md, 'Input shaping'.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

TOLERATED = 0.05
"""Share of the unshaped vibration that EI leaves at the frequency that it is made for."""

_LEAST_DECAY_OF_EI = math.sqrt(TOLERATED / (2 - TOLERATED))
"""K at which EI's weight V' reaches 1, so that its middle impulse 2 (1 - V') K vanishes."""
MOST_DAMPING_OF_EI = 1 / math.hypot(1, math.pi / math.log(_LEAST_DECAY_OF_EI))
"""The damping ratio of that decay, about 0.504."""


class Impulses(NamedTuple):
    """A shaper: impulses whose amplitudes sum to one, the first at time 0.

    Attributes
    ----------
    amplitudes : tuple of float
        Shares of the motion.
    times : tuple of float
        When each share begins [s], in order.
    """

    amplitudes: tuple[float, ...]
    times: tuple[float, ...]


def zv(frequency: float, damping_ratio: float) -> Impulses:
    """Zero vibration: two impulses, half a damped period apart; the frequency in rad/s."""
    return _half_periods_apart([1.0, 1.0], frequency, damping_ratio)


def zvd(frequency: float, damping_ratio: float) -> Impulses:
    """Zero vibration and derivative by the frequency: three impulses."""
    return _half_periods_apart([1.0, 2.0, 1.0], frequency, damping_ratio)


def ei(frequency: float, damping_ratio: float) -> Impulses:
    """Extra insensitive: `TOLERATED` of the vibration is left."""
    if damping_ratio > MOST_DAMPING_OF_EI:
        raise ValueError(
            f"damping ratio is {damping_ratio:g}, for which the ei shaper would have a negative "
            f"impulse; it goes up to {MOST_DAMPING_OF_EI:.4g}: take zv or zvd"
        )
    decay = _decay(damping_ratio)
    # So that TOLERATED is left at the frequency itself whatever the damping; undamped V = TOLERATED
    V = TOLERATED * (1 + decay) ** 2 / (4 * decay**2 - TOLERATED * (1 - decay) ** 2)
    return _half_periods_apart([1 + V, 2 * (1 - V), 1 + V], frequency, damping_ratio)


def mzv(frequency: float, damping_ratio: float) -> Impulses:
    """Modified zero vibration: three impulses, three eighths of a damped period apart."""
    outer = 1 - math.sqrt(0.5)
    return _apart(0.75, [outer, 1 - 2 * outer, outer], frequency, damping_ratio)


def two_hump_ei(frequency: float, damping_ratio: float) -> Impulses:
    """Four impulses that leave `TOLERATED` or less over a wider range than EI."""
    V = TOLERATED
    X = (V**2 * (math.sqrt(1 - V**2) + 1)) ** (1 / 3)
    outer = (3 * X**2 + 2 * X + 3 * V**2) / (16 * X)
    inner = 0.5 - outer
    return _half_periods_apart([outer, inner, inner, outer], frequency, damping_ratio)


def three_hump_ei(frequency: float, damping_ratio: float) -> Impulses:
    """Five impulses, for a range that is wider still."""
    V = TOLERATED
    first, second = (1 + 3 * V + 2 * math.sqrt(2 * V * (V + 1))) / 16, (1 - V) / 4
    middle = 1 - 2 * (first + second)
    weights = [first, second, middle, second, first]
    return _half_periods_apart(weights, frequency, damping_ratio)


SHAPERS: Mapping[str, Callable[[float, float], Impulses]] = {
    "zv": zv,
    "mzv": mzv,
    "zvd": zvd,
    "ei": ei,
    "2hump-ei": two_hump_ei,
    "3hump-ei": three_hump_ei,
}
"""Every shaper by its name: from frequency [rad/s] and damping ratio to impulses."""


def convolved(shapers: Sequence[Impulses]) -> Impulses:
    """Several shapers one after another as a single one, as for several modes."""
    impulses = [(0.0, 1.0)]
    for shaper in shapers:
        impulses = [
            (time + later, amplitude * share)
            for time, amplitude in impulses
            for share, later in zip(*shaper, strict=True)
        ]
    times, amplitudes = zip(*sorted(impulses), strict=True)
    return Impulses(amplitudes, times)


def _decay(damping_ratio: float) -> float:
    """K: what is left of an amplitude after half a damped period."""
    return math.exp(-math.pi * damping_ratio / math.sqrt(1 - damping_ratio**2))


def _half_periods_apart(
    undamped: Sequence[float], frequency: float, damping_ratio: float
) -> Impulses:
    return _apart(1.0, undamped, frequency, damping_ratio)


def _apart(
    halves: float, undamped: Sequence[float], frequency: float, damping_ratio: float
) -> Impulses:
    """Impulses for an undamped mode so many half periods apart, later ones less as it decays."""
    decay = _decay(damping_ratio) ** halves
    gap = halves * math.pi / (frequency * math.sqrt(1 - damping_ratio**2))
    weights = [weight * decay**i for i, weight in enumerate(undamped)]
    return Impulses(
        tuple(weight / sum(weights) for weight in weights),
        tuple(gap * i for i in range(len(undamped))),
    )
