"""The energy of a motion, from its powers at the nodes of steps."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import casadi as ca
import numpy as np

from quietarm.models import Expression
from quietarm.ocp.energy import Energy
from quietarm.ocp.sample import Sample, total
from quietarm.ocp.simulation.collocation import GAUSS_WEIGHTS, NODES, TO_QUADRATIC
from quietarm.ocp.simulation.mesh import Mesh


def spent(
    energy: Energy, nodes: Sequence[Sample], h: Expression, unbroken: bool = True
) -> Expression:
    """Energy, the sum over the joints, from the Gauss nodes of every step; a row a candidate."""
    by_joint = zip(*(sample.powers for sample in nodes))
    resolved = [_resolved(power, h, unbroken) for power in by_joint]
    smooth = integrated([smooth_power(energy, sample) for sample in nodes], h)
    return energy.absolute * total(resolved) + smooth


def smooth_power(energy: Energy, sample: Sample) -> Expression:
    """The smooth integrand of an energy [W], the sum over the joints."""
    pairs = zip(sample.torques, sample.joints)
    return total([energy.smooth(torque, joint.speed) for torque, joint in pairs])


def _resolved(power: Sequence[Expression], h: Expression, unbroken: bool) -> Expression:
    """Integral of the absolute power of one joint."""
    beyond = list[Expression]()
    if unbroken:  # across a break neighbours say nothing
        beyond = [ca.horzcat(*power) @ weights for weights in beyond_quadratic(h.shape[1])]
    return resolved_energy(power, h, *beyond)


def integrated(at_nodes: Sequence[Expression], h: Expression) -> Expression:
    """The integral of a smooth quantity from its values at the Gauss nodes of every step."""
    return ca.sum2(h * sum(w * x for w, x in zip(GAUSS_WEIGHTS, at_nodes)))


def resolved_energy(
    power: Sequence[Expression], h: Expression, cubic: Expression = 0.0, quartic: Expression = 0.0
) -> Expression:
    """Integral of |power|, split at the zeros of the quadratic through each step's nodes.

    Where the power keeps its sign, a split changes nothing. Terms of third and fourth degree vanish
    at the nodes: they move work across a zero and add none to the step.
    """
    c = quadratic(power)
    return ca.sum2(h * _parted_energy(c, cubic, quartic, quadratic_zeros(c)))


def quadratic(power: Sequence[Expression]) -> list[Expression]:
    """Coefficients, lowest first, of the quadratic through the values at a step's nodes."""
    return [sum(w * p for w, p in zip(row, power)) for row in TO_QUADRATIC]


def quadratic_zeros(c: Sequence[Expression]) -> list[Expression]:
    """The zeros of that quadratic on a step, in order; without zeros its extreme's place, twice."""
    discriminant = c[1] * c[1] - 4 * c[0] * c[2]
    tiny = 1e-300
    root = ca.sqrt(ca.fmax(discriminant, tiny))  # at 0 its derivative is infinite
    half = -(c[1] + ca.copysign(root, c[1])) / 2  # no cancellation
    first, second = (
        ca.fmin(ca.fmax(zero, 0), 1) for zero in (half / (c[2] + tiny), c[0] / (half + tiny))
    )
    second = first + (discriminant > 0) * (second - first)
    return [ca.fmin(first, second), ca.fmax(first, second)]


def _parted_energy(
    c: Sequence[Expression], cubic: Expression, quartic: Expression, breaks: Sequence[Expression]
) -> Expression:
    """Mean of |power| on a step whose work is counted separately between two breaks."""
    work = []
    for x in breaks:
        u = x - 0.5
        bump = x * (1 - x)
        beyond = bump * (cubic * (bump - 0.2) / 4 - quartic * (u * u * u) / 5)
        work.append(x * (c[0] + x * (c[1] / 2 + x * (c[2] / 3))) + beyond)
    whole = c[0] + c[1] / 2 + c[2] / 3
    return ca.fabs(work[0]) + ca.fabs(work[1] - work[0]) + ca.fabs(whole - work[1])


@lru_cache(maxsize=4)  # of a long recording they take 160 bytes a step
def beyond_quadratic(steps: int) -> tuple[ca.DM, ca.DM]:
    """Return the correction of a step's power that the neighbouring steps give.

    The quartic through five nodes in a row, the step's own three in the middle, is the quadratic
    through these plus (x - node 1)(x - node 2)(x - node 3) (cubic + quartic (x - 1/2)).
    """
    if steps == 1:
        return ca.DM(NODES, 1), ca.DM(NODES, 1)  # no neighbour
    mesh = Mesh(steps)
    nodes = mesh.nodes.T.ravel()
    step = np.arange(steps)[:, None]
    five = np.clip(NODES * step - 1, 0, len(nodes) - 5) + np.arange(5)
    x = (nodes[five] - mesh.boundaries[:-1, None]) / mesh.lengths[:, None]
    to_quartic = np.linalg.inv(x[:, :, None] ** np.arange(5))
    # lists: casadi takes twenty times as long over arrays here
    at = (five % NODES * steps + five // NODES).ravel().tolist(), np.repeat(step, 5).tolist()
    cubic = to_quartic[:, 3] + 2 * to_quartic[:, 4]
    quartic = to_quartic[:, 4]
    return (
        ca.DM.triplet(*at, cubic.ravel().tolist(), len(nodes), steps),
        ca.DM.triplet(*at, quartic.ravel().tolist(), len(nodes), steps),
    )
