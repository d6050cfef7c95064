"""Fit a robot's springs, the load at its tip and its dampers to what was measured at postures.

One frequency scales all springs. Several, at postures or of modes in which springs and load count
otherwise, tell the load from the springs; where they do not, the load stays as it was given.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from quietarm.models.joint_motion import Array
from quietarm.models.robot.dynamics.equations_of_motion import Dynamics
from quietarm.models.robot.dynamics.modes import modes_at
from quietarm.models.robot.elastic.flexibility import Measured

MOST_STIFFER = 25.0
"""So many times stiffer, or softer, may a measured frequency make the springs."""
_MOST_HEAVIER = 5.0
"""The same of the load."""
_NEAR = 0.5
"""Half the width of the search for the factor of the stiffness (natural logarithm)."""
_TOLD = 0.1
"""Half the width of the interval of a load (natural logarithm) that is told."""
_WORTH = 1.0
"""The same before the load is fitted, up to which it is worth a try."""
_FAR = 0.1
"""Share of a frequency, beyond which no stiffness and no load explain it."""
_STEP = 1e-4
"""Of differences (natural logarithm)."""
Load = tuple[float, Dynamics]
"""Mass at the end of the beam as given [kg], and the equations of 1 kg there."""


@dataclass(frozen=True)
class MeasuredFit:
    """Multiples of what a robot's file has, and how well they meet what was measured.

    Attributes
    ----------
    stiffness, payload, damping : float
        Of all springs, of the mass at the end of the beam, of all dampers beside what keeps the
        damping ratio.
    misfits : tuple of float
        By what share each measured frequency is above the robot's.
    unsure : (float, float)
        Half of the widths of the intervals of stiffness and payload that cover them in 95 of 100
        cases, as shares.
    tells_payload : bool
        Whether the frequencies tell the load from the springs.
    """

    stiffness: float
    payload: float
    damping: float
    misfits: tuple[float, ...]
    unsure: tuple[float, float]
    tells_payload: bool


def fit_measured(
    dynamics: Dynamics,
    measurements: Sequence[Measured],
    load: Load | None,
    weighed: tuple[float, float] | None = None,
) -> MeasuredFit:
    """Return the multiples by which a robot swings as it was measured.

    Parameters
    ----------
    dynamics : Dynamics
        The equations, with springs and load as they were given.
    measurements : sequence of Measured
        At least one.
    load : (float, Dynamics), optional
        The load that may be another; none by default.
    weighed : (float, float), optional
        The load's multiple as it is known otherwise, and its standard deviation as a share.

    Raises
    ------
    ValueError
        When frequencies contradict each other, or are far from the robot's.
    """
    search = _Search(dynamics, measurements, load, weighed)
    begin = search.scaled()
    x, unsure, tells = begin, np.zeros(2), False
    if load is not None and (weighed is not None or len(measurements) > 1):
        x, unsure, tells = search.with_load(begin)
    if not tells:
        x = begin if len(measurements) == 1 else search.met(begin, (0,))
        unsure = np.append(search.unsure(x, (0,)), math.inf)
    misfits = tuple(np.expm1(search.above(x)).tolist())
    _refuse_far(measurements, misfits)
    return MeasuredFit(
        stiffness=math.exp(x[0]),
        payload=math.exp(x[1]),
        damping=search.damping(x),
        misfits=misfits,
        unsure=(float(unsure[0]), float(unsure[1])),
        tells_payload=tells,
    )


class _Search:
    """The frequencies of a robot by logarithms of the multiples of its springs and its load."""

    def __init__(
        self,
        dynamics: Dynamics,
        measurements: Sequence[Measured],
        load: Load | None,
        weighed: tuple[float, float] | None,
    ) -> None:
        self._dynamics = dynamics
        self._measurements = measurements
        self._load = load
        self._weighed = weighed
        self._logarithms = np.log([one.frequency for one in measurements])
        self._deviations = np.array([one.within / 2 for one in measurements])

    def dynamics_at(self, x: Array) -> Dynamics:
        """The equations with these multiples."""
        dynamics = self._dynamics
        if self._load is not None and x[1] != 0:
            mass, of_one = self._load
            dynamics = dynamics.loaded(mass * math.expm1(x[1]), of_one)
        return dynamics.stiffened(math.exp(x[0]))

    def logarithms(self, x: Array) -> Array:
        """Return the logarithm of each frequency that was measured, as the robot has it."""
        dynamics = self.dynamics_at(x)
        by_posture = dict[tuple[float, ...], Array]()
        found = list[float]()
        for one in self._measurements:
            if one.at not in by_posture:
                by_posture[one.at], _ = modes_at(dynamics, np.array(one.at))
            found.append(math.log(by_posture[one.at][one.mode - 1]))
        return np.array(found)

    def above(self, x: Array) -> Array:
        """Return by how much the measured frequencies are above the robot's (logarithms)."""
        return self._logarithms - self.logarithms(x)

    def scaled(self) -> Array:
        """Return the logarithms by which the first frequency is met: of the springs alone."""
        from scipy.optimize import brentq  # takes a quarter of a second to load

        measured = self._measurements[0]
        q = np.array(measured.at)

        def excess(logarithm: float) -> float:
            values, _ = modes_at(self._dynamics.stiffened(math.exp(logarithm)), q)
            return math.log(values[measured.mode - 1] / measured.frequency)

        stated, _ = modes_at(self._dynamics, q)
        guess = 2 * math.log(measured.frequency / stated[measured.mode - 1])
        if abs(guess) > math.log(MOST_STIFFER):
            raise ValueError(
                f"measured frequency is {measured.frequency / math.tau:.4g} Hz, and the robot's is "
                f"{stated[measured.mode - 1] / math.tau:.4g} Hz; check its springs, masses and "
                "where it was measured"
            )
        solved: Any = brentq(excess, guess - _NEAR, guess + _NEAR, xtol=1e-13)
        return np.array([float(solved), 0.0])

    def met(self, begin: Array, places: tuple[int, ...]) -> Array:
        """Return the logarithms that meet all frequencies best: of the springs, or of both."""
        from scipy.optimize import least_squares

        most = np.log([MOST_STIFFER, _MOST_HEAVIER])
        free = [*places]

        def residuals(values: Array) -> Array:
            x = begin.copy()
            x[free] = values
            return self._weighted(x)

        bounds = (-most[free] - 1e-6, most[free] + 1e-6)
        solved: Any = least_squares(
            residuals, begin[free], bounds=bounds, diff_step=1e-6, xtol=1e-12, ftol=1e-12,
            x_scale=0.1,
        )  # fmt: skip
        x = begin.copy()
        x[free] = solved.x
        return x

    def with_load(self, begin: Array) -> tuple[Array, Array, bool]:
        """Return both logarithms, halves of their intervals, and whether the load is told."""
        before = self.unsure(self.met(begin, (0,)), (0, 1))
        if not before[1] < _WORTH:  # a search would end anywhere
            return begin, before, False
        x = self.met(begin, (0, 1))
        unsure = self.unsure(x, (0, 1))
        inside = abs(x[1]) < math.log(_MOST_HEAVIER)
        return x, unsure, bool(unsure[1] < _TOLD and inside)

    def unsure(self, x: Array, places: tuple[int, ...]) -> Array:
        """Return halves of the intervals of the multiples (logarithms), by what is left as well."""
        steps = _STEP * np.eye(2)[[*places]]
        slopes = np.stack(
            [(self._weighted(x + step) - self._weighted(x - step)) / (2 * _STEP) for step in steps],
            axis=1,
        )
        left = self._weighted(x)
        freedom = len(left) - len(places)
        grown = max(1.0, float((left**2).sum()) / freedom) if freedom > 0 else 1.0
        powers, directions = np.linalg.eigh(slopes.T @ slopes)
        told = np.maximum(powers, 1e-12 * powers.max())  # less is what differences round
        variances: Array = (directions**2 / told).sum(axis=1)
        return 2 * np.sqrt(grown * variances)

    def _weighted(self, x: Array) -> Array:
        """Return what is left of each measurement, in its deviations."""
        left = self.above(x) / self._deviations
        if self._weighed is None:
            return left
        multiple, deviation = self._weighed
        return np.append(left, (math.log(multiple) - x[1]) / deviation)

    def damping(self, x: Array) -> float:
        """Return the multiple of the dampers by which the damping ratios are met in the mean."""
        logarithms = list[float]()
        dynamics = self.dynamics_at(x)
        for one in self._measurements:
            if one.damping is None:
                continue
            stated = damping_ratios(dynamics, np.array(one.at))[one.mode - 1]
            if not stated > 0:
                raise ValueError(
                    f"measured damping is {100 * one.damping:.3g} %, and the robot has none that "
                    "could be scaled; give the beam, gears, springs or the base some damping"
                )
            logarithms.append(math.log(one.damping / stated))
        return math.exp(float(np.mean(logarithms))) if logarithms else 1.0


def damping_ratios(dynamics: Dynamics, q: Array) -> Array:
    """Damping ratio of each mode with the driven joints held at q."""
    frequencies, shapes = modes_at(dynamics, q)
    damping = shapes.T @ (dynamics.mechanism.damping[:, None] * shapes)
    ratios: Array = np.diag(damping) / (2 * frequencies)
    return ratios


def _refuse_far(measurements: Sequence[Measured], misfits: Sequence[float]) -> None:
    """Refuse frequencies that no stiffness and no load meet."""
    worst = int(np.abs(misfits).argmax())
    if abs(misfits[worst]) <= _FAR:
        return
    one = measurements[worst]
    places = ", ".join(f"{place:.4g}" for place in one.at)
    meant = one.frequency / math.tau / (1 + misfits[worst])
    raise ValueError(
        f"measured frequency {worst + 1} of {len(measurements)} is {one.frequency / math.tau:.4g} "
        f"Hz at [{places}], and with springs that meet the others best it is {meant:.4g} Hz; "
        "check its posture, its mode and its load"
    )
