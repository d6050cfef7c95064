"""Coulomb friction of a joint, smooth about rest."""

from __future__ import annotations

import casadi as ca

from quietarm.models.joint_motion import Expression

CREEP = 0.01
"""Speed [rad/s or m/s] at which Coulomb friction is 1 / sqrt(2) of itself."""


def dry_friction(size: float, speed: Expression) -> Expression:
    """Return Coulomb friction against a speed, less than its size below `CREEP`."""
    turning = 0.0 if size == 0 else speed / ca.sqrt(speed * speed + CREEP**2)
    return size * turning
