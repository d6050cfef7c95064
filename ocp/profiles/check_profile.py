"""The one check of profiles: from rest to rest, by derivatives that are those of the angle."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache, partial
from typing import NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.models.compiled import Compiled
from quietarm.ocp.checks import hashable, instance
from quietarm.ocp.profiles.joint_profile import JointProfile

_FRACTIONS = np.array([0.0, 1.0, *np.random.default_rng(0).uniform(0.02, 0.98, 15)])
"""Where motions are compared: at both ends, then anywhere between."""

Array = NDArray[np.float64]


class _Comparison(NamedTuple):
    """A motion at `_FRACTIONS`, and what it has to be: by CasADi's derivatives of the angle."""

    angle: Array
    speed: Array
    acceleration: Array
    exact_angle: Array
    exact_speed: Array
    exact_acceleration: Array


def check_profile(profile: JointProfile) -> None:
    """Refuse a profile whose motion is not from rest to rest, or whose derivatives are not.

    The derivatives of the angle are CasADi's, at random coefficients.

    Raises
    ------
    TypeError
        When it is no profile, or one that may change.
    ValueError
        With the value, where it is, and what it has to be.
    """
    instance("profile", profile, JointProfile)
    hashable("profile", profile)
    _check_at_random(profile)


@lru_cache(maxsize=256)
def _check_at_random(profile: JointProfile) -> None:
    """Refuse a profile by a move none of whose numbers is 0 or 1: a missing factor then shows."""
    bounds = profile.start_box(profile.default_bound)
    coefficients = np.random.default_rng(1).uniform(*bounds)
    start = -0.3
    target = 0.9
    duration = max(1.3, 2 * profile.least_duration)
    comparison = _compare(profile, coefficients, start, target, duration)
    _refuse_difference(profile, comparison, start, target, duration)


def check_motion(
    profile: JointProfile,
    coefficients: ArrayLike,
    start: float,
    target: float,
    duration: float,
) -> None:
    """Refuse one motion likewise, at its own coefficients, as every answer's is.

    One that overflows is left to the integrator, which says so.
    """
    values = np.asarray(coefficients, float)
    comparison = _compare(profile, values, start, target, duration)
    if np.isfinite(comparison).all():
        _refuse_difference(profile, comparison, start, target, duration)


def _refuse_difference(
    profile: JointProfile, motion: _Comparison, start: float, target: float, duration: float
) -> None:
    """Refuse a motion that is not at rest at the ends, or whose derivatives are wrong.

    What cruises may have no acceleration at any of the fractions: the move's own scale counts too.
    """
    span = abs(target - start)
    scales = {"angle": span, "speed": span / duration, "acceleration": span / duration**2}
    refuse = partial(_refuse_wrong, getattr(profile, "name", type(profile).__name__), scales)
    ends = np.array([start, target])
    what = f"its end of a move from {start:.4g} to {target:.4g}"
    remedy = "let angle, or input of a cycloid, go from 0 to 1"
    refuse("angle", motion.exact_angle, ends, what, remedy)
    what = "rest at both ends"
    remedy = "let angle have no slope there"
    refuse("speed", motion.exact_speed, np.zeros(2), what, remedy)
    remedy = "check the factors and signs in derivatives, which are by the fraction"
    what = "that of the method angle"
    refuse("angle", motion.angle, motion.exact_angle, what, remedy)
    what = "the derivative of the angle"
    refuse("speed", motion.speed, motion.exact_speed, what, remedy)
    what = "the derivative of the speed"
    refuse(
        "acceleration",
        motion.acceleration,
        motion.exact_acceleration,
        what,
        remedy,
    )


def _refuse_wrong(
    name: str,
    scales: Mapping[str, float],
    quantity: str,
    values: Array,
    expected: Array,
    what: str,
    remedy: str,
) -> None:
    """Refuse values of which the first, those at the ends first, are not as expected."""
    # Share of a quantity's largest value by which it may differ from what it has to be.
    tolerance = 1e-6
    allowed = tolerance * max(float(np.abs(values).max()), scales[quantity], 1e-9)
    compared = values[: len(expected)]
    wrong = ~(np.abs(compared - expected) <= allowed)  # nan is wrong as well
    if wrong.any():
        k = int(wrong.argmax())
        raise ValueError(
            f"profile {name!r}: its {quantity} is {compared[k]:.4g} at "
            f"{_FRACTIONS[k]:.3g} of the duration, where {what} is {expected[k]:.4g}; "
            f"{remedy}"
        )


def _compare(profile: JointProfile, coefficients: Array, *move: float) -> _Comparison:
    """One motion, and what it has to be."""
    function = _comparison_function(profile)
    columns = np.tile([*coefficients, *move], (len(_FRACTIONS), 1)).T
    (rows,) = function(np.vstack([_FRACTIONS, columns]))
    return _Comparison(*rows)


@lru_cache(maxsize=256)
def _comparison_function(profile: JointProfile) -> Compiled:
    """The rows of a `_Comparison`, of columns of a fraction, coefficients and a move."""
    return Compiled(lambda: _build_comparison(profile))


def _build_comparison(profile: JointProfile) -> ca.Function:
    symbols = ca.SX.sym("x", 1 + profile.size + 3)
    fraction, *numbers = ca.vertsplit(symbols)
    coefficients = numbers[: profile.size]
    start, target, duration = numbers[profile.size :]
    motion = profile.motion(coefficients, fraction, start, target, duration)
    share = profile.at_duration(duration).angle(coefficients, fraction)
    angle = ca.SX(start + (target - start) * share)
    speed = ca.jacobian(angle, fraction) / duration
    acceleration = ca.jacobian(speed, fraction) / duration
    rows = ca.vertcat(*motion[:3], angle, speed, acceleration)
    return ca.Function("motion", [symbols], [ca.densify(rows)]).map(len(_FRACTIONS))
