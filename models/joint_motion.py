"""What a plant's equations are given of the joint."""

from __future__ import annotations

import math
from collections.abc import Sequence
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


def is_zero(entry: Expression) -> bool:
    """Whether an expression is nothing whatever the symbols are: so that it costs nothing."""
    return isinstance(entry, float) and entry == 0.0


def joint_unit(unit: str, joint: str) -> str:
    """A unit of a rotary joint's quantity as it is of a kind of joint: rad/s is m/s, N m is N."""
    return unit if joint == ROTARY else unit.replace("N m", "N").replace("rad", "m")


def joint_label(label: str, joint: str) -> str:
    """A label of a rotary joint's quantity likewise: joint torque is drive force, torque force."""
    if joint == ROTARY:
        return label
    label = label.replace("joint torque", "drive force").replace("torque", "force")
    return label.replace("angle", "position")


def deg(degrees: float) -> float:
    """An angle in degrees as radians: `PointToPoint(..., target=deg(30))`."""
    if isinstance(degrees, bool) or not isinstance(degrees, Real):
        raise TypeError(f"degrees are {degrees!r}; give a number, as deg(30)")
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
