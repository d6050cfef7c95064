"""Input shapers: impulses in time whose convolution with a motion leaves a vibration out.

Formulas and their sources: docs/physics.md, 'Input shaping'.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
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


def _decay(damping_ratio: float) -> float:
    """K: what is left of an amplitude after half a damped period."""
    return math.exp(-math.pi * damping_ratio / math.sqrt(1 - damping_ratio**2))


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


def _fitted(
    name: str,
    most: float,
    times: Sequence[Sequence[float]],
    amplitudes: Sequence[Sequence[float]],
    frequency: float,
    damping_ratio: float,
) -> Impulses:
    """Of every impulse the time over the undamped period and the amplitude, by powers of damping.

    They leave `TOLERATED` or less over a wider range than EI: Klipper's definitions since September
    2025.
    """
    if damping_ratio > most:
        raise ValueError(
            f"damping ratio is {damping_ratio:g}; the {name} shaper goes up to {most:g}: take zv "
            "or zvd"
        )

    def at(powers: Sequence[float]) -> float:
        return sum(one * damping_ratio**k for k, one in enumerate(powers))

    total, period = sum(map(at, amplitudes)), 2 * math.pi / frequency
    return Impulses(
        tuple(at(one) / total for one in amplitudes), tuple(at(one) * period for one in times)
    )


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
    return _apart(1.0, [1 + V, 2 * (1 - V), 1 + V], frequency, damping_ratio)


_OUTER = 1 - math.sqrt(0.5)
SHAPERS: Mapping[str, Callable[[float, float], Impulses]] = {
    "zv": partial(_apart, 1.0, [1.0, 1.0]),
    "mzv": partial(_apart, 0.75, [_OUTER, 1 - 2 * _OUTER, _OUTER]),
    "zvd": partial(_apart, 1.0, [1.0, 2.0, 1.0]),
    "ei": ei,
    "2hump-ei": partial(
        _fitted, "2hump-ei", 0.3,
        ((0.0, 0.0, 0.0, 0.0), (0.49890, 0.16270, -0.54262, 6.16180),
         (0.99748, 0.18382, -1.58270, 8.17120), (1.49920, -0.09297, -0.28338, 1.85710)),
        ((0.16054, 0.76699, 2.26560, -1.22750), (0.33911, 0.45081, -2.58080, 1.73650),
         (0.34089, -0.61533, -0.68765, 0.42261), (0.15997, -0.60246, 1.00280, -0.93145)),
    ),
    "3hump-ei": partial(
        _fitted, "3hump-ei", 0.2,
        ((0.0, 0.0, 0.0, 0.0), (0.49974, 0.23834, 0.44559, 12.4720),
         (0.99849, 0.29808, -2.36460, 23.3990), (1.49870, 0.10306, -2.01390, 17.0320),
         (1.99960, -0.28231, 0.61536, 5.40450)),
        ((0.11275, 0.76632, 3.29160, -1.44380), (0.23698, 0.61164, -2.57850, 4.85220),
         (0.30008, -0.19062, -2.14560, 0.13744), (0.23775, -0.73297, 0.46885, -2.08650),
         (0.11244, -0.45439, 0.96382, -1.46000)),
    ),
}  # fmt: skip
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
