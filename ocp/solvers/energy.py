"""An energy with first and second derivatives by what happens at the nodes of a step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
from quietarm.ocp.energy import Energy
from quietarm.ocp.simulation.collocation import GAUSS_WEIGHTS, NODES
from quietarm.ocp.simulation.objective import integrated, power_zeros, quadratic, resolved_energy

_LEAST_SLOPE = 1e-4
"""Smaller slopes of the power at its zeros count as this share of its root mean square."""
_TINY = 1e-300


def energy_with_derivatives(
    energy: Energy, at_nodes: Sequence[Sequence[ca.MX]], h: ca.MX, length: ca.DM, width: ca.MX
) -> tuple[ca.MX, list[list[ca.MX]], list[list[ca.MX]]]:
    """The energy, its derivatives by power and smooth part at each node, and second ones by power.

    Steps are `h` long [s], of the move `length`. Where the width is positive, |p| is rounded off:
    the root of p^2 + width^2, taken at the nodes.
    """
    power, share = [values[0] for values in at_nodes], energy.absolute
    mean = ca.sqrt(ca.sum2(sum(p * p for p in power)) / (NODES * h.shape[1])) + _TINY
    least = _LEAST_SLOPE * ca.repmat(mean, 1, h.shape[1]) * length
    sharp, bends = power_derivatives(power, least)
    is_rounded, rounded = width > 0, [ca.sqrt(p * p + width * width) for p in power]
    absolute = ca.if_else(is_rounded[:, 0], integrated(rounded, h), resolved_energy(power, h))
    smooth = zip(*(values[1:] for values in at_nodes), strict=True)
    value = share * absolute + sum(integrated(one, h) for one in smooth)
    first, second = list[list[ca.MX]](), list[list[ca.MX]]()
    for j, (w, p, r) in enumerate(zip(GAUSS_WEIGHTS, power, rounded, strict=True)):
        by_power = ca.if_else(is_rounded, w * p / (r + _TINY), sharp[j])
        first.append([share * h * by_power, *([w * h] * len(at_nodes[j][1:]))])
        own = w * width**2 / (r**3 + _TINY)
        second.append([
            share * h * ca.if_else(is_rounded, own if k == j else 0.0, bends[j][k])
            for k in range(NODES)
        ])  # fmt: skip
    return value, first, second


def power_derivatives(
    power: Sequence[ca.MX], least_slope: ca.MX
) -> tuple[list[Any], list[list[Any]]]:
    """Derivatives by the power at its nodes of the mean of |power| on a step.

    The gradient is that with the zeros held fixed, since the power is zero there, and continuous.
    Second derivatives come from the zeros that move: 2 q q' / |slope| for each, with q the gradient
    of the power there, never negative; the rest is linear in the power. Where zeros meet, that
    curvature is without bound, though only there: the slope counts as `least_slope` at least.
    """
    c, zeros, nodes = quadratic(power), power_zeros(power), range(NODES)
    to_quadratic: Any = [quadratic([float(j == k) for k in nodes]) for j in nodes]
    ends = [0.0, *zeros, 1.0]
    areas = [x * (c[0] + x * (c[1] / 2 + x * (c[2] / 3))) for x in ends]
    signs = [ca.sign(areas[i + 1] - areas[i]) for i in nodes]
    integrals = [[x, x * x / 2, x * x * x / 3] for x in ends]
    of_c = [
        sum(s * (integrals[i + 1][n] - integrals[i][n]) for i, s in enumerate(signs)) for n in nodes
    ]
    gradient = [sum(q * x for q, x in zip(row, of_c, strict=True)) for row in to_quadratic]
    hessian: list[list[Any]] = [[0.0] * NODES for _ in nodes]
    real = c[1] * c[1] > 4 * c[0] * c[2]  # else both stand at the quadratic's extreme
    for x in zeros:
        inside = real * (x > 0) * (x < 1)
        bend = inside * 2 / ca.fmax(ca.fabs(c[1] + 2 * x * c[2]), least_slope)
        at_zero = [row[0] + x * (row[1] + x * row[2]) for row in to_quadratic]
        for j in nodes:
            for k in nodes:
                hessian[j][k] = hessian[j][k] + bend * at_zero[j] * at_zero[k]
    return gradient, hessian
