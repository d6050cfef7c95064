"""The joint's motion, as a plant's equations take it."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from numbers import Real
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Expression = Any
"""An SX scalar, an MX matrix or a number: casadi gives these no common base class."""
Modes = Sequence[Expression]
"""A value for each mode: amplitudes W [m], rates [m/s], accelerations [m/s^2]."""

LINEAR = "linear"
ROTARY = "rotary"
"""Kinds of joint."""
MIXED = "mixed"
"""Of several joints that some turn and some slide."""


def is_zero(entry: Expression) -> bool:
    """Return whether an expression is zero whatever the symbols are, so that it costs nothing."""
    return isinstance(entry, float) and entry == 0.0


def kind_of_joints(kinds: Collection[str]) -> str:
    """Return the kind of several joints: theirs, or `MIXED`."""
    return next(iter(kinds)) if len(set(kinds)) == 1 else MIXED


def deg(degrees: float) -> float:
    """An angle in degrees as radians: `PointToPoint(..., target=deg(30))`."""
    if isinstance(degrees, bool) or not isinstance(degrees, Real):
        raise TypeError(f"degrees are {degrees!r}; give a number, such as deg(30)")
    return math.radians(degrees)


class JointMotion(NamedTuple):
    """Angle [rad], speed [rad/s], acceleration [rad/s^2] and jerk [rad/s^3] of the joint.

    Of a linear joint in metres.

    All have the same shape. The jerk is None where it is not asked for; no plant may use it.
    """

    angle: Expression
    speed: Expression
    acceleration: Expression
    jerk: Expression = None
