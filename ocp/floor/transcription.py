"""A free motion on a grid as a sparse nonlinear program, which IPOPT solves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache

import casadi as ca
import numpy as np
from quietarm.models import Expression, JointMotion, Plant
from quietarm.ocp.energy import Energy, power_of
from quietarm.ocp.profiles.free_motion import joint_after
from quietarm.ocp.simulation.collocation import GAUSS_NODES, GAUSS_WEIGHTS, NODES, NodeState, Step
from quietarm.ocp.solvers.nlp import OPTIONS, compile_nlp
from quietarm.ocp.task import QUANTITIES

_COLD = {**OPTIONS, "tol": 1e-8, "max_iter": 400, "mumps_pivot_order": 0}
"""The systems are sparse and have no dense columns: minimum degree makes them a quarter faster."""
_WARM = {**_COLD, "mu_strategy": "monotone", "mu_init": 1e-6, "max_iter": 150}
"""From a coarser grid's solution; with a larger barrier the solver would move away from it."""
POWER, SMOOTH = "power", "smooth"


def parts_of(energy: Energy) -> int:
    """Rows of unknowns for the positive and the negative part of the power at the nodes."""
    return 2 * NODES if energy.absolute else 0


def of_joint(
    names: Sequence[str] | Mapping[str, float], smooth: bool, states: int
) -> dict[str, int]:
    """Quantities that are derivatives of the joint: their rows among the unknowns."""
    orders = {name: QUANTITIES[name].derivative for name in names}
    return {
        name: order if order < 2 + smooth else states
        for name, order in orders.items()
        if order is not None
    }


def values_at_nodes(
    plant: Plant,
    joints: Sequence[JointMotion],
    nodes: Sequence[NodeState],
    names: Sequence[str],
    energy: Energy,
) -> dict[str, list[Expression]]:
    """Power, smooth part of the energy and what else follows from the modes, at the nodes."""
    values: dict[str, list[Expression]] = {POWER: [], SMOOTH: []}
    for joint, node in zip(joints, nodes, strict=True):
        torque, tips = (
            plant.torque(joint, node.W, node.dW, node.ddW),
            plant.tip_displacements(node.W),
        )
        values[POWER].append(power_of(torque, joint.speed))
        values[SMOOTH].append(energy.smooth(torque, joint.speed))
        for name in names:
            if QUANTITIES[name].derivative is None:
                values.setdefault(name, []).extend(QUANTITIES[name].of(joint, tips, torque))
    return values


def _interval(plant: Plant, smooth: bool, names: tuple[str, ...], energy: Energy) -> ca.Function:
    """(unknowns, length) -> state after, collocation equations, values at the nodes."""
    modes, joint = plant.modes, 2 + smooth
    states = joint + 2 * modes
    x, h = ca.SX.sym("x", states + 1 + NODES * modes), ca.SX.sym("h")
    W, dW = (ca.vertsplit(part) for part in ca.vertsplit(x[joint:states], modes))
    ddW = [ca.vertsplit(part) for part in ca.vertsplit(x[states + 1 :], modes)]
    derivatives = [*ca.vertsplit(x[:joint]), x[states]]
    joints = [joint_after(derivatives, share * h) for share in GAUSS_NODES]
    one = Step(h, [], modes)
    nodes = one.nodes(W, dW, ddW)
    equations = [
        given - by_plant
        for at, node in zip(joints, nodes, strict=True)
        for given, by_plant in zip(
            node.ddW, plant.modal_accelerations(at, node.W, node.dW), strict=True
        )
    ]
    W_after, dW_after = one.end(W, dW, ddW)
    after = [*joint_after(derivatives, h)[:joint], *W_after, *dW_after]
    values = values_at_nodes(plant, joints, nodes, names, energy).values()
    outputs = [ca.vertcat(*rows) for rows in (after, equations, *values)]
    return ca.Function("interval", [x, h], outputs, {"cse": True})


@lru_cache(maxsize=16)
def solver_of(
    plant: Plant, smooth: bool, steps: int, names: tuple[str, ...], energy: Energy, warm: bool
) -> ca.Function:
    """IPOPT for the program, from anywhere or from a coarser grid's solution.

    Unknowns are peaks and intervals; parameters are lengths, scales, state at the end, and weights
    of the mean of what is spent and of the peaks.
    """
    interval, parts = _interval(plant, smooth, names, energy), parts_of(energy)
    rows, states = interval.size1_in(0), interval.size1_out(0)
    sizes = [steps, rows, 1 + len(names), states, 1 + len(names)]
    p = ca.MX.sym("p", sum(sizes))
    lengths, scale, measures, arrived, weights = ca.vertsplit(p, [0, *np.cumsum(sizes).tolist()])
    peaks, columns = ca.MX.sym("peaks", len(names)), ca.MX.sym("x", rows + parts, steps)
    unknowns, forward, backward = ca.vertsplit(columns, [0, rows, rows + parts // 2, rows + parts])
    wide = ca.repmat(scale, 1, steps)
    after, equations, power, rest, *values = interval.map(steps)(unknowns * wide, lengths.T)
    following = ca.horzcat(unknowns[:states, 1:], arrived)
    rows_of_joint = of_joint(names, smooth, states)
    at_nodes = dict(zip((n for n in names if n not in rows_of_joint), values, strict=True))
    constraints = [
        after / wide[:states, :] - following,
        equations / wide[states + 1 :, :],
        *([forward - backward - power / measures[0]] if parts else []),
    ]
    for i, name in enumerate(names):
        row = rows_of_joint.get(name)
        value = at_nodes[name] / measures[1 + i] if row is None else unknowns[row, :]
        constraints += [peaks[i] - value, peaks[i] + value]
    spent = rest / measures[0] + (energy.absolute * (forward + backward) if parts else 0.0)
    mean = ca.dot(lengths, (ca.DM(GAUSS_WEIGHTS).T @ spent).T) / ca.sum1(lengths)
    problem = {
        "x": ca.vertcat(peaks, ca.vec(columns)),
        "p": p,
        "f": ca.dot(weights, ca.vertcat(mean, peaks)),
        "g": ca.vertcat(*map(ca.vec, constraints)),
    }
    return compile_nlp(problem, _WARM if warm else _COLD)
