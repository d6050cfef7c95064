"""How a structure looks from above: bodies in the plane, flexible links bent as their mode is.

Lengths are metres; the joint, or what carries the structure, is at the origin. Pictures only: no
equation of motion uses this.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

_ROOT = 1.8751040687119611
"""The first root k of cosh(k) cos(k) = -1."""
_SIGMA = (np.cosh(_ROOT) + np.cos(_ROOT)) / (np.sinh(_ROOT) + np.sin(_ROOT))
_POINTS = 25
"""Of a bent link: at a thousand pixels the corners between them cannot be seen."""


def cantilever(share: ArrayLike) -> Array:
    """First mode shape of a beam that is clamped at one end and free at the other, 1 at the tip.

    A uniform Euler-Bernoulli beam (Blevins, Formulas for Natural Frequency and Mode Shape, 1979,
    table 8-1), by the distance from the clamp as a share of the length. A mass at the tip makes it
    straighter: one of many times the beam's gives s^2 (3 - s) / 2, which differs by 0.03 at most.
    """
    x = _ROOT * np.asarray(share, dtype=float)
    return (np.cosh(x) - np.cos(x) - _SIGMA * (np.sinh(x) - np.sin(x))) / 2


TIP_SLOPE = float(_ROOT * (np.sinh(_ROOT) + np.sin(_ROOT)
                           - _SIGMA * (np.cosh(_ROOT) - np.cos(_ROOT))) / 2)  # fmt: skip
"""Slope of `cantilever` at the tip: 1.3765."""


_SHARE = np.linspace(0.0, 1.0, _POINTS)
_BENT = cantilever(_SHARE)


@dataclass(frozen=True, eq=False)
class Body:
    """One part of a structure, seen from above.

    Attributes
    ----------
    points : ndarray, shape (points, 2)
        The line through its length [m]; a single point stands for a disc, as of a hub.
    rigid : bool
        Whether it is drawn as thick as what does not bend.
    tip : bool
        Whether its last point is a tip, whose path is drawn.

    Raises
    ------
    ValueError
        When the points are no finite numbers of this shape.
    """

    points: Array
    rigid: bool = False
    tip: bool = False

    def __post_init__(self) -> None:
        points = np.array(self.points, dtype=float)
        points.setflags(write=False)
        object.__setattr__(self, "points", points)


def rigid_link(
    length: float, angle: float, displacement: float = 0.0, base: Sequence[float] = (0.0, 0.0)
) -> Array:
    """A straight link, whose tip may be displaced across it.

    Parameters
    ----------
    length : float
        From the base to the tip [m].
    angle : float
        Its direction without the displacement [rad].
    displacement : float
        Of the tip, positive to the left of the direction [m].
    base : sequence of float
        Where it begins [m].

    Returns
    -------
    ndarray, shape (2, 2)
        Its ends.
    """
    return _placed(np.array([[0.0, 0.0], [length, displacement]]), angle, base)


def flexible_link(
    length: float, angle: float, displacement: float, base: Sequence[float] = (0.0, 0.0)
) -> Array:
    """A link that is clamped at its base and bent as `cantilever`; arguments as for `rigid_link`.

    Returns
    -------
    ndarray, shape (points, 2)
        Points along it, base and tip among them.
    """
    bent = np.column_stack([length * _SHARE, displacement * _BENT])
    return _placed(bent, angle, base)


def _placed(points: Array, angle: float, base: Sequence[float]) -> Array:
    cosine, sine = np.cos(angle), np.sin(angle)
    return points @ np.array([[cosine, sine], [-sine, cosine]]) + np.asarray(base)
