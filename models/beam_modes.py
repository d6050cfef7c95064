"""Modes of an Euler-Bernoulli beam that is clamped at its root and has a mass at its tip.

Nothing has dimensions: lengths are shares of the beam's, masses of its mass. See Meirovitch,
Fundamentals of Vibrations (2001), ch. 8; docs/physics.md derives the integrals.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi, prod
from typing import NamedTuple

import casadi as ca
import numpy as np

from quietarm.models.joint_motion import Expression

_NODES, _WEIGHTS = ((part / 2).tolist() for part in np.polynomial.legendre.leggauss(24))
_PLACES = [0.5 + node for node in _NODES]
"""Places along the beam, whose weights in integrals are `_WEIGHTS`."""


class BeamModes(NamedTuple):
    """Modes of a beam with a tip mass; each is 1 at the tip.

    Wave numbers k, whose squares are as the frequencies; modal masses; integrals of distance from
    the axis times mode shape, by which a turning hub excites each; and stiffening of two modes by
    the centrifugal tension, for a joint speed of 1.
    """

    wave_numbers: list[Expression]
    masses: list[Expression]
    pushes: list[Expression]
    stiffenings: list[list[Expression]]


def beam_modes(count: int, ratio: Expression, radius: Expression) -> BeamModes:
    """The first modes of a beam, by its tip's mass and the radius of the hub it is clamped to."""
    waves = [_wave_number(i, ratio) for i in range(count)]
    shapes = [[mode_shape(k, place) for place in _PLACES] for k in waves]
    values = [[value for value, _ in shape] for shape in shapes]
    slopes = [[slope for _, slope in shape] for shape in shapes]
    end = ratio * (radius + 1)
    arms = [radius + place for place in _PLACES]
    tension = [(1 - place) * (radius + (1 + place) / 2) + end for place in _PLACES]
    return BeamModes(
        waves,
        masses=[ratio + _integral(shape, shape) for shape in values],
        pushes=[end + _integral(arms, shape) for shape in values],
        stiffenings=[[_integral(tension, first, second) for second in slopes] for first in slopes],
    )


def mode_shape(k: Expression, place: Expression) -> tuple[Expression, Expression]:
    """A mode and its slope at a place, by its wave number; 1 at the tip."""
    sigma = (ca.cosh(k) + ca.cos(k)) / (ca.sinh(k) + ca.sin(k))

    def value(x: Expression) -> Expression:
        return ca.cosh(x) - ca.cos(x) - sigma * (ca.sinh(x) - ca.sin(x))

    x = k * place
    slope = k * (ca.sinh(x) + ca.sin(x) - sigma * (ca.cosh(x) - ca.cos(x)))
    return value(x) / value(k), slope / value(k)


def _wave_number(index: int, ratio: Expression) -> Expression:
    """The root of 1 + cos k cosh k + ratio k (cos k sinh k - sin k cosh k) = 0 of a mode.

    It lies between those of a mode with a pinned and with a free tip.
    """
    if index == 0:  # Rayleigh's estimate, within 2 % for any mass
        k: Expression = ca.sqrt(ca.sqrt(3 / (ratio + 33 / 140)))
    else:
        free = (index + 0.5) * pi
        pinned = (index + 0.25) * pi
        k = pinned + (free - pinned) / (1 + 4 * index * ratio)
    # Newton's method, which takes six iterations from these bounds, for the equation over cosh k:
    # that keeps its numbers small.
    for _ in range(12):
        sine = ca.sin(k)
        cosine = ca.cos(k)
        tangent = ca.tanh(k)
        of_mass = cosine * tangent - sine
        value = 1 / ca.cosh(k) + cosine + ratio * k * of_mass
        by_mass = ratio * of_mass - ratio * k * tangent * (sine + cosine * tangent)
        k = k - value / (by_mass - tangent / ca.cosh(k) - sine)
    return k


def _integral(*factors: Sequence[Expression]) -> Expression:
    """Integrate a product of factors along the beam, each given at the places of the quadrature."""
    return sum(prod(at) for at in zip(_WEIGHTS, *factors))
