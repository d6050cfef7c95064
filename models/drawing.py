"""Shapes of structures in metres, for pictures alone: no equation of motion uses them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from quietarm.models.beam_modes import beam_modes, mode_shape
from quietarm.models.joint_motion import Array

_POINTS = np.linspace(0.0, 1.0, 25)
"""Of a bent link, as shares of its length: at a thousand pixels no corner can be seen."""
(_FIRST,), *_ = beam_modes(1, 0.0, 0.0)
_BENT = [mode_shape(_FIRST, share)[0] for share in _POINTS]
"""First mode of a beam that is free at its tip. A mass there makes it straighter: one of many times
the beam's gives s^2 (3 - s) / 2, which differs by 0.03 at most."""
TIP_SLOPE: float = mode_shape(_FIRST, 1.0)[1]
"""Its slope at the tip: 1.3765."""


@dataclass(frozen=True, eq=False)
class Body:
    """One part of a structure, as it is seen.

    Attributes
    ----------
    points : ndarray, shape (points, 2) or (points, 3)
        The line through its length [m], of a plant in space in three coordinates; a single point
        stands for a disc or a ball, as of a hub.
    rigid, tip : bool
        Whether it does not bend; whether its last point is a tip, whose path is drawn.
    ground : bool
        Whether it stands on the floor, its first point, and is drawn pale.
    radius : float
        Of the line in space [m].
    """

    points: Array
    rigid: bool = False
    tip: bool = False
    ground: bool = False
    radius: float = 0.0


def rigid_link(
    length: float, angle: float, displacement: float = 0.0, base: Sequence[float] = (0.0, 0.0)
) -> Array:
    """Ends of a straight link, shape (2, 2), from a base and in a direction [m, rad].

    Its tip may be displaced to the left of the direction [m].
    """
    return _placed(np.array([[0.0, 0.0], [length, displacement]]), angle, base)


def flexible_link(
    length: float, angle: float, displacement: float, base: Sequence[float] = (0.0, 0.0)
) -> Array:
    """Points of a link that is bent in its first mode, shape (points, 2); as `rigid_link`."""
    bent = np.column_stack([length * _POINTS, np.multiply(displacement, _BENT)])
    return _placed(bent, angle, base)


def _placed(points: Array, angle: float, base: Sequence[float]) -> Array:
    cosine = np.cos(angle)
    sine = np.sin(angle)
    return points @ np.array([[cosine, sine], [-sine, cosine]]) + np.asarray(base)
