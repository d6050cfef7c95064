"""What a plant's equations are given of the joint."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

Expression = Any
"""An SX scalar, an MX matrix or a number: casadi gives these no common base class."""
Modes = Sequence[Expression]
"""A value for each mode: amplitudes W [m], rates [m/s], accelerations [m/s^2]."""


class JointMotion(NamedTuple):
    """Angle, speed, acceleration and jerk of the joint: entries of the same shape.

    Attributes
    ----------
    angle : Expression
        theta [rad].
    speed : Expression
        theta' [rad/s].
    acceleration : Expression
        theta'' [rad/s^2].
    jerk : Expression or None
        theta''' [rad/s^3]; None where it is not asked for. No plant's equations may use it.
    """

    angle: Expression
    speed: Expression
    acceleration: Expression
    jerk: Expression = None
