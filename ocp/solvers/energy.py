"""An energy with first and second derivatives by what happens at the nodes of a step."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
from quietarm.ocp.energy import Energy
from quietarm.ocp.simulation.collocation import GAUSS_WEIGHTS, NODES
from quietarm.ocp.simulation.objective import energy_derivatives, integrated, resolved_energy
from quietarm.ocp.solvers.node import elementwise

_LEAST_SLOPE = 1e-4
"""Smaller slopes of the power at its zeros count as this share of its root mean square."""
_TINY = 1e-300


def energy_parts(
    energy: Energy, at_nodes: Sequence[Sequence[ca.MX]], h: ca.MX, length: ca.DM, width: ca.MX
) -> tuple[ca.MX, list[list[ca.MX]], list[ca.MX]]:
    """The energy, by power and smooth part at each node, and its second derivatives by the power.

    Steps are `h` long [s], of the move `length`. Where the width is positive, |p| is rounded off:
    the root of p^2 + width^2, taken at the nodes.
    """
    power, share = [values[0] for values in at_nodes], energy.absolute
    mean = ca.sqrt(ca.sum2(sum(p * p for p in power)) / (NODES * h.shape[1])) + _TINY
    least = _LEAST_SLOPE * ca.repmat(mean, 1, h.shape[1]) * length
    sharp, bends = elementwise(energy_derivatives(), power, [least])
    rounded = [ca.sqrt(p * p + width * width) for p in power]
    is_rounded, either = width > 0, list(zip(GAUSS_WEIGHTS, rounded, strict=True))
    absolute = ca.if_else(is_rounded[:, 0], integrated(rounded, h), resolved_energy(power, h))
    smooth = zip(*(values[1:] for values in at_nodes), strict=True)
    by_power = [
        share * h * ca.if_else(is_rounded, w * p / (r + _TINY), s)
        for (w, r), p, s in zip(either, power, sharp, strict=True)
    ]
    first = [
        [of_power, *([w * h] * len(values[1:]))]
        for w, of_power, values in zip(GAUSS_WEIGHTS, by_power, at_nodes, strict=True)
    ]
    own = [w * width**2 / (r**3 + _TINY) for w, r in either]
    second = [
        share * h * ca.if_else(is_rounded, own[i] if i == j else 0.0, bends[NODES * i + j])
        for i in range(NODES)
        for j in range(NODES)
    ]
    return share * absolute + sum(integrated(one, h) for one in smooth), first, second
