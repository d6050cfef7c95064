"""Input shapers, impulses whose convolution with a motion suppresses a vibration, and the cycloid.

Formulas and their sources: docs/physics.md, 'Input shaping'.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field
from functools import partial
from typing import ClassVar, NamedTuple, Self

import casadi as ca

from quietarm.models import Expression
from quietarm.ocp.checks import finite, positive, quoted, several
from quietarm.ocp.profiles.joint_profile import JointProfile, Values

TOLERATED = 0.05
"""Residual of EI at its design frequency, as a share of the unshaped vibration."""
LEAST_SHARE = 0.05
"""Least share of the duration for the cycloid: a shorter one would be a jolt between steps."""


class Impulses(NamedTuple):
    """A shaper: shares of the motion that sum to one, and when each begins [s], in order from 0."""

    amplitudes: tuple[float, ...]
    times: tuple[float, ...]


def _decay(damping_ratio: float) -> float:
    """K: the ratio of amplitudes half a damped period apart."""
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


def _refuse_damping(name: str, damping_ratio: float, most: float) -> None:
    if damping_ratio > most:
        raise ValueError(
            f"damping ratio is {damping_ratio:g}; the {name} shaper goes up to {most:.4g}: take zv "
            "or zvd"
        )


def _fitted(
    name: str,
    most: float,
    times: Sequence[Sequence[float]],
    amplitudes: Sequence[Sequence[float]],
    frequency: float,
    damping_ratio: float,
) -> Impulses:
    """Klipper's fits of September 2025: times over the period and amplitudes by powers of damping.

    Their residual is within `TOLERATED` over a wider range than EI's.
    """
    _refuse_damping(name, damping_ratio, most)

    def polynomial(powers: Sequence[float]) -> float:
        return sum(factor * damping_ratio**k for k, factor in enumerate(powers))

    total = sum(map(polynomial, amplitudes))
    period = 2 * math.pi / frequency
    return Impulses(
        tuple(polynomial(powers) / total for powers in amplitudes),
        tuple(polynomial(powers) * period for powers in times),
    )


def _mzv(frequency: float, damping_ratio: float) -> Impulses:
    """Return three impulses, three eighths of a period apart."""
    outer = 1 - math.sqrt(0.5)
    weights = [outer, 1 - 2 * outer, outer]
    return _apart(0.75, weights, frequency, damping_ratio)


def extra_insensitive(
    frequency: float, damping_ratio: float, tolerated: float = TOLERATED
) -> Impulses:
    """Return the EI shaper, which lets a share of the vibration pass at the design frequency.

    Its residual is within that share over a wider range of frequencies than ZVD's.
    """
    # K at which the weight V below reaches 1, so that the middle impulse 2 (1 - V) K vanishes
    least_decay = math.sqrt(tolerated / (2 - tolerated))
    most_damping = 1 / math.hypot(1, math.pi / math.log(least_decay))  # 5 %: about 0.504
    _refuse_damping("ei", damping_ratio, most_damping)
    decay = _decay(damping_ratio)
    # so that the residual at the frequency is this share for any damping; undamped V is it
    V = tolerated * (1 + decay) ** 2 / (4 * decay**2 - tolerated * (1 - decay) ** 2)
    return _apart(1.0, [1 + V, 2 * (1 - V), 1 + V], frequency, damping_ratio)


SHAPERS: Mapping[str, Callable[[float, float], Impulses]] = {
    "zv": partial(_apart, 1.0, [1.0, 1.0]),
    "mzv": _mzv,
    "zvd": partial(_apart, 1.0, [1.0, 2.0, 1.0]),
    "ei": extra_insensitive,
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
            for share, later in zip(*shaper)
        ]
    times, amplitudes = zip(*sorted(impulses))
    return Impulses(amplitudes, times)


@dataclass(frozen=True)
class ShapedCycloid(JointProfile):
    """The plain cycloid convolved with an input shaper; it has no coefficients.

    A cycloid begins at every impulse, scaled by the impulse, and shorter than the duration by the
    shaper's length.

    Parameters
    ----------
    shaper : str
        A name of `SHAPERS`, such as ``"zv"``.
    frequencies : sequence of float
        Undamped angular frequencies of the modes to suppress [rad/s], one or more.
    damping_ratios : sequence of float
        Their damping ratios, between -1 and 1.

    Raises
    ------
    ValueError
        When the shaper is not known or not for such damping, or a number is out of range.
    """

    name: ClassVar[str] = "shaped-cycloid"
    most_impulses: ClassVar[int] = 243
    """Five modes of three impulses; the motion has a cycloid for every impulse."""
    shaper: str
    frequencies: tuple[float, ...]
    damping_ratios: tuple[float, ...]
    impulses: Impulses = field(init=False, repr=False, compare=False)
    """One shaper for all modes."""
    duration: Expression = field(default=math.nan, init=False, repr=False, compare=False)
    """That of the move [s], as `at_duration` sets it."""

    def __post_init__(self) -> None:
        if self.shaper not in SHAPERS:
            raise ValueError(f"shaper is {quoted(self.shaper)}; give {', '.join(SHAPERS)}")
        numbers = "numbers, one for each mode"
        frequencies = tuple(
            positive("frequency", frequency, "rad/s")
            for frequency in several("frequencies", self.frequencies, numbers)
        )
        damping = tuple(
            finite("damping ratio", ratio)
            for ratio in several("damping_ratios", self.damping_ratios, numbers)
        )
        if not frequencies or len(frequencies) != len(damping):
            raise ValueError(
                f"got {len(frequencies)} frequencies and {len(damping)} damping ratios; give one "
                "of each for every mode"
            )
        for zeta in damping:
            if not -1 < zeta < 1:
                raise ValueError(
                    f"damping ratio is {zeta:g}; give one between -1 and 1: other modes do not "
                    "vibrate"
                )
        shapers = [SHAPERS[self.shaper](*mode) for mode in zip(frequencies, damping)]
        count = math.prod(len(shaper.times) for shaper in shapers)
        if count > self.most_impulses:
            raise ValueError(
                f"{self.shaper} for {len(frequencies)} modes has {count} impulses; quietarm goes "
                f"up to {self.most_impulses}: give the slowest modes only"
            )
        object.__setattr__(self, "frequencies", frequencies)
        object.__setattr__(self, "damping_ratios", damping)
        object.__setattr__(self, "impulses", convolved(shapers))

    @property
    def length(self) -> float:
        """Time from the shaper's first impulse to its last [s]."""
        return self.impulses.times[-1]

    @property
    def size(self) -> int:
        """Number of coefficients: none, as the shaper is known from the plant."""
        return 0

    @property
    def label(self) -> str:
        """The shaper and its design frequencies."""
        hertz = " and ".join(f"{frequency / math.tau:.4g}" for frequency in self.frequencies)
        return f"{self.shaper} shaper for {hertz} Hz"

    @property
    def least_duration(self) -> float:
        """The shaper's length, and the least share of the duration for the cycloid [s]."""
        return self.length / (1 - LEAST_SHARE)

    def breaks(self, duration: float) -> tuple[float, ...]:
        """Fractions of the duration at which a cycloid begins or ends."""
        begins = self.impulses.times
        ends = (begin + duration - self.length for begin in begins)
        return tuple(sorted({at / duration for at in (*begins, *ends) if 0 < at < duration}))

    def at_duration(self, duration: Expression) -> Self:
        """Return this shaper in a move of another duration [s]."""
        timed = copy(self)
        object.__setattr__(timed, "duration", duration)
        return timed

    def angle(self, coefficients: Values, fraction: Expression) -> Expression:
        """Sum of the cycloids, each at rest before it begins and after it ends."""
        cycloid = self.duration - self.length
        turn = 2 * math.pi
        angle = 0 * fraction
        for share, begin in zip(*self.impulses):
            part = (fraction * self.duration - begin) / cycloid
            # Not fmin and fmax, whose derivative is halved where the move begins and ends.
            part = ca.if_else(ca.logic_and(part >= 0, part <= 1), part, part > 1)
            angle += share * (part - ca.sin(turn * part) / turn)
        return angle
