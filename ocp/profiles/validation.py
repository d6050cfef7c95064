"""A profile is checked as a plant is: once, when something is first planned or judged along it."""

from __future__ import annotations

from functools import lru_cache

import casadi as ca
import numpy as np
from quietarm.ocp.interrupts import keep_interrupts
from quietarm.ocp.profiles.joint_profile import JointProfile

_START, _TARGET, _DURATION = -0.3, 0.9, 1.3
"""A move [rad, s], none of whose numbers is 0 or 1: a factor that is left out then shows."""
_SHARES = np.array([0.0, 1.0, *np.random.default_rng(0).uniform(0.02, 0.98, 15)])
"""Of the duration: both ends, then anywhere between."""
_DIFFERENT = 1e-6
"""Share of a quantity's largest value by which it may differ from what it has to be."""


@lru_cache(maxsize=256)
@keep_interrupts()  # casadi loses a Ctrl-C
def check_profile(profile: JointProfile) -> None:
    """Refuse a profile whose motion is not from rest to rest, or whose derivatives are not.

    The derivatives of the angle are CasADi's, at random coefficients.

    Raises
    ------
    ValueError
        With the value, where it is, and what it has to be.
    """
    duration = max(_DURATION, 2 * profile.least_duration)
    within = profile.start_box(profile.default_bound)
    a = np.random.default_rng(1).uniform(*within).tolist()
    at = ca.SX.sym("fraction")
    motion = [ca.SX(x) for x in profile.derivatives(a, at, _START, _TARGET, duration)[:3]]
    move = _START, _TARGET, duration
    joined = profile.outer(profile.inner(a, at, *move), *move)[:3]
    rates = [ca.jacobian(one, at) / duration for one in motion[:2]]
    every = ca.Function("motion", [at], [ca.densify(ca.horzcat(*motion, *rates, *joined))])
    table = every.map(len(_SHARES))(_SHARES[None]).full().reshape(len(_SHARES), -1)
    angle, speed, acceleration, by_angle, by_speed, *others = table.T
    ends, fastest = np.array([_START, _TARGET]), float(np.abs(speed).max())
    at_ends = f"its end of a move from {_START} to {_TARGET} rad"
    compared = [
        ("angle", angle[:2], ends, at_ends, 0.0),
        ("speed", speed[:2], np.zeros(2), "rest at both ends", fastest),
        ("speed", speed, by_angle, "the derivative of the angle", 0.0),
        ("acceleration", acceleration, by_speed, "the derivative of the speed", 0.0),
    ]
    names = "angle", "speed", "acceleration"
    for name, other, value in zip(names, others, table.T[:3], strict=True):
        words = f"the {name} of derivatives"
        compared.append((f"{name} by outer(inner(...))", other, value, words, 0.0))
    for name, values, wanted, words, scale in compared:
        allowed = _DIFFERENT * max(scale, float(np.abs(wanted).max()), 1e-9)
        wrong = ~(np.abs(values - wanted) <= allowed)  # nan is wrong as well
        if wrong.any():
            k = int(wrong.argmax())
            raise ValueError(
                f"profile {profile.name!r}: its {name} is {values[k]:.4g} at {_SHARES[k]:.3g} of "
                f"the duration, where {words} is {wanted[k]:.4g}; check the factors and signs in "
                "derivatives (d/dt is d/dfraction over the duration)"
            )
