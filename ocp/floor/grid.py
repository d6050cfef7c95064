"""The grid of a free motion: fine where the speed jumps, and finer from level to level."""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.profiles.free_motion import FreeMotion
from quietarm.ocp.simulation.collocation import mesh

_AT_AN_END, _SHRINK = 3, 4.0
"""The first and last interval are cut at 1/4, 1/16 and 1/64 of their length: without a limit
against it, the motion of least energy starts and stops the joint with a jolt."""
_JOLT, _PARTS_OF_A_JOLT = 0.02, 4
"""An interval that changes the speed by more than this share of its largest is cut in four."""
_SHORTEST = 4e-5
"""Intervals shorter than this share of the move are left alone."""


def first_grid(steps: int) -> NDArray[np.float64]:
    """Boundaries of about `steps` intervals, as fractions of the move, finer at the ends."""
    even = max(2, steps - 2 * _AT_AN_END)
    boundaries = mesh(ca.DM(np.arange(even + 1)), even)[0].full().ravel()
    boundaries[-1] = 1.0
    cuts = boundaries[1] * _SHRINK ** -np.arange(_AT_AN_END, 0.0, -1)
    return np.concatenate([[0.0], cuts, boundaries[1:-1], 1 - cuts[::-1], [1.0]])


def finer(free: FreeMotion) -> FreeMotion:
    """The motion on a grid of twice the intervals, and more where its speed jumps."""
    h = free.lengths
    change = np.abs(h * (free.acceleration + h * free.jerk / 2))
    jolt = change > _JOLT * np.abs(free.boundaries(0.0)[1]).max()
    parts = np.where(jolt, _PARTS_OF_A_JOLT, 2)
    parts[h < _SHORTEST * free.times[-1]] = 1
    return free.split(parts)
