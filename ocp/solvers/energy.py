"""An energy with first and second derivatives by what happens at the nodes of a step."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import casadi as ca
from quietarm.models import Expression
from quietarm.ocp.energy import Energy
from quietarm.ocp.simulation.collocation import GAUSS_WEIGHTS, NODES, TO_QUADRATIC
from quietarm.ocp.simulation.objective import quadratic, quadratic_zeros

_LEAST_SLOPE = 1e-4
"""Smaller slopes of the power at its zeros count as this share of its root mean square."""
_TINY = 1e-300


class MovingZero(NamedTuple):
    """A zero of the power: its weights of the power at the nodes; twice the inverse of the slope.

    The second derivatives of the mean of |power| are the sum over the zeros of `bend` times the
    product of two weights.
    """

    weights: list[Expression]
    bend: Expression


class EnergyDerivatives(NamedTuple):
    """An energy, a row a candidate, with derivatives by the power and the smooth part at the nodes.

    Second derivatives are by the power: `by_power_twice` at each node by itself, and zeros whose
    bends have the energy's factor.
    """

    value: ca.MX
    by_power: ca.MX
    by_smooth: ca.MX
    by_power_twice: ca.MX
    zeros: list[MovingZero]


def differentiate_energy(
    energy: Energy, power: ca.MX, smooth: Sequence[ca.MX], h: ca.MX, length: ca.DM, width: ca.MX
) -> EnergyDerivatives:
    """The derivatives of an energy on steps `h` long [s], of the move `length`.

    Where the width is positive, |p| is rounded off: the root of p^2 + width^2, at the nodes.
    """
    steps, share = h.shape[1], energy.absolute
    of_nodes = ca.horzcat(*(w * h for w in GAUSS_WEIGHTS))
    rms = ca.sqrt(ca.sum2(power * power) / power.shape[1]) + _TINY
    of_sharp, zeros = differentiate_absolute(
        ca.horzsplit(power, steps), _LEAST_SLOPE * ca.repmat(rms, 1, steps) * length
    )
    rounded, is_rounded = ca.sqrt(power * power + width * width), width > 0
    sharp_slope = ca.repmat(h, 1, NODES) * ca.horzcat(*of_sharp)
    slope = ca.if_else(is_rounded, of_nodes * power / (rounded + _TINY), sharp_slope)
    # of |p| itself Euler's theorem: it is homogeneous
    absolute = ca.sum2(ca.if_else(is_rounded, of_nodes * rounded, sharp_slope * power))
    factor = ca.if_else(is_rounded[:, :steps], 0.0, share * h)
    return EnergyDerivatives(
        value=share * absolute + sum(ca.sum2(of_nodes * one) for one in smooth),
        by_power=share * slope,
        by_smooth=of_nodes,
        by_power_twice=share * of_nodes * width**2 / (rounded**3 + _TINY),
        zeros=[zero._replace(bend=factor * zero.bend) for zero in zeros],
    )


def differentiate_absolute(
    power: Sequence[Expression], least_slope: Expression
) -> tuple[list[Expression], list[MovingZero]]:
    """Derivatives by the power at its nodes of the mean of |power| on a step.

    The gradient is that with the zeros held fixed, since the power is zero there, and continuous.
    Second derivatives come from the zeros that move; the rest is linear in the power. Where zeros
    meet, that curvature is without bound, though only there: the slope counts as `least_slope` at
    least.
    """
    c, basis = quadratic(power), list(zip(*TO_QUADRATIC, strict=True))
    places = quadratic_zeros(c)
    integrals = [[x * (a + x * (b / 2 + x * (d / 3))) for a, b, d in basis] for x in places]
    gradient: list[Expression] = [0.0] * NODES
    for begin, end in pairwise([[0.0] * NODES, *integrals, GAUSS_WEIGHTS]):
        part = [after - before for before, after in zip(begin, end, strict=True)]
        sign = ca.sign(sum(w * p for w, p in zip(part, power, strict=True)))
        gradient = [old + sign * w for old, w in zip(gradient, part, strict=True)]
    real = c[1] * c[1] > 4 * c[0] * c[2]  # else both stand at the quadratic's extreme
    zeros = [
        MovingZero(
            [a + x * (b + x * d) for a, b, d in basis],
            real * (x > 0) * (x < 1) * 2 / ca.fmax(ca.fabs(c[1] + 2 * x * c[2]), least_slope),
        )
        for x in places
    ]
    return gradient, zeros
