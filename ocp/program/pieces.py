"""The pieces of a motion as casadi functions: every node and every step at once, side by side.

Matrices are given transposed: rows of derivatives are multiplied from the left, columns of
multipliers from the right.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import casadi as ca
import numpy as np

from models import JointMotion, Plant
from ocp.profiles.joint_profile import JointProfile
from ocp.program.step_model import Group, quantities_at, solve
from ocp.program.symbols import over_columns
from ocp.simulation.collocation import GAUSS_NODES, NODES, NodeState, Step, end_to_end, mesh
from ocp.simulation.objective import energy_derivatives, resolved_energy

_INNER = 3
"""Values by `JointProfile.inner` at a node."""
Pattern = tuple[tuple[int, ...], tuple[int, ...]]
"""Rows and columns of a matrix's entries, by columns."""
_LEAST_SLOPE = 1e-3
"""Smaller slopes of the power at its zeros count as this one [peak power / duration]."""


class ProfilePieces:
    """What `JointProfile.inner` gives at the nodes.

    Where the jerk is asked for, also what it gives at the times of `end_to_end`, and its rates.

    Attributes
    ----------
    inner : int
        How many values that are at a node.
    fractions : DM, shape (1, nodes)
        When the nodes come, as shares of the duration.
    value, first : Function
        (coefficients, fractions, move) -> inner (inner, nodes); its derivatives (coefficients,
        inner * nodes).
    second : Function or None
        (coefficients, fractions, move, multipliers of inner) -> second derivatives (coefficients,
        coefficients * nodes); None where inner is linear.
    """

    def __init__(self, profile: JointProfile, steps: int, jerk: bool = False) -> None:
        begin, length = (x.full().ravel() for x in mesh(ca.DM(np.arange(steps)), steps))
        fractions = begin[:, None] + length[:, None] * np.array(GAUSS_NODES)
        self.fractions = ca.DM(fractions.ravel()).T
        a, fraction, move = ca.SX.sym("a", profile.size), ca.SX.sym("t"), ca.SX.sym("move", 3)
        of, moves = ca.vertsplit(a), ca.vertsplit(move)
        inner = ca.vertcat(*profile.inner(of, fraction, *moves))
        if jerk:
            at = end_to_end(fraction, steps)
            inner = ca.vertcat(inner, *profile.inner_with_rates(of, at, *moves))
        self.inner = inner.numel()
        first = ca.densify(ca.jacobian(inner, a)).T
        inputs, nodes = [a, fraction, move], NODES * steps
        self.value = _over("inner", inputs, [inner], nodes, [0, 2])
        self.first = _over("inner_first", inputs, [first], nodes, [0, 2])
        self.second = None
        if not ca.is_linear(inner, a):
            weights = ca.SX.sym("w", self.inner)
            second = ca.densify(ca.hessian(ca.dot(weights, inner), a)[0])
            self.second = _over("inner_second", [*inputs, weights], [second], nodes, [0, 2])
        self._profile = profile

    def joint(self, inner: ca.SX, move: ca.SX) -> JointMotion:
        """The joint's motion at a node, with its jerk where that is asked for."""

        def outer(values: ca.SX) -> JointMotion:
            return self._profile.outer(ca.vertsplit(values), *ca.vertsplit(move))

        joint, values, rates = outer(inner[:_INNER]), inner[_INNER:-_INNER], inner[-_INNER:]
        if not values.numel():
            return joint
        return joint._replace(jerk=ca.jtimes(outer(values).acceleration, values, rates))


class NodePieces:
    """What the plant does at a node: how its modes are forced, and the outputs.

    All take inner and modes (W and W') at the nodes, move and scales.

    Attributes
    ----------
    linear : Function
        (inner, move) -> forcing W'' of modes that are zero (modes, nodes); its derivatives by the
        modes, all that are not zero for good (entries, nodes).
    by_modes : Pattern
        Where these stand in (modes, states).
    value : Function
        Outputs (rows, nodes), scaled.
    first : Function
        Derivatives: of the forcing by inner, of the outputs by inner and by the modes.
    second : Function
        (..., multipliers of forcing and of outputs) -> half the second derivatives by inner;
        those by modes and inner; half those by the modes.
    """

    def __init__(
        self, plant: Plant, profile: ProfilePieces, nodes: int, groups: Sequence[Group]
    ) -> None:
        states, rows = 2 * plant.modes, sum(group.rows for group in groups[1:])
        inner, modes = ca.SX.sym("inner", profile.inner), ca.SX.sym("modes", states)
        move, scale = ca.SX.sym("move", 3), ca.SX.sym("scale", states + len(groups) - 1)
        joint = profile.joint(inner, move)
        W, dW = (ca.vertsplit(part) for part in ca.vertsplit(modes, plant.modes))
        ddW = list(plant.modal_accelerations(joint, W, dW))
        still = [0.0] * plant.modes
        at_rest = ca.vertcat(*plant.modal_accelerations(joint, still, still))
        values = quantities_at(plant, joint, NodeState(W, dW, ddW))
        forcing, outputs = ca.vertcat(*ddW), ca.vertcat(
            *(
                ca.vertcat(*values[group.name]) / scale[states + i]
                for i, group in enumerate(groups[1:])
            )
        )  # fmt: skip
        by_modes = ca.jacobian(forcing, modes)
        rows_of, columns_of = by_modes.sparsity().get_triplet()
        self.by_modes = tuple(rows_of), tuple(columns_of)
        entries = by_modes.nz[:]
        self.linear = _over("linear", [inner, move], [at_rest, entries], nodes, [1])
        inputs, shared = [inner, modes, move, scale], [2, 3]
        self.value = _over("node", inputs, [ca.densify(outputs)], nodes, shared)
        first = [
            ca.jacobian(forcing, inner).T,
            ca.jacobian(outputs, inner).T,
            ca.jacobian(outputs, modes).T,
        ]
        self.first = _over("node_first", inputs, first, nodes, shared)
        of_forcing, of_outputs = ca.SX.sym("nu", plant.modes), ca.SX.sym("w", rows)
        lagrangian = ca.dot(of_forcing, forcing) + ca.dot(of_outputs, outputs)
        hessian, of = ca.hessian(lagrangian, ca.vertcat(inner, modes))[0], profile.inner
        second = [
            hessian[:of, :of] / 2, hessian[of:, :of], hessian[of:, of:] / 2
        ]  # fmt: skip
        inputs += [of_forcing, of_outputs]
        self.second = _over("node_second", inputs, second, nodes, shared)


@lru_cache(maxsize=32)
def linear_steps(modes: int, by_modes: Pattern, steps: int) -> ca.Function:
    """Matrices of the steps, from state and forcing at the nodes to modes and state.

    With L the collocation's linear map to the modes at the nodes from the state before the step
    and W'' at the nodes, W'' = forcing + F L (state, W'') is a small linear system for W''.

    Parameters
    ----------
    modes : int
        Number of modes.
    by_modes : Pattern
        Where F has entries at a node.
    steps : int
        Number of steps.

    Returns
    -------
    Function
        (entries of F at a step's nodes, length of the step [s]) -> matrices (state to state, state
        to modes, forcing to state, forcing to modes).
    """
    state, accelerations = ca.SX.sym("z", 2 * modes), ca.SX.sym("ddW", NODES * modes)
    h, entries = ca.SX.sym("h"), ca.SX.sym("F", NODES * len(by_modes[0]))
    W, dW = (ca.vertsplit(part) for part in ca.vertsplit(state, modes))
    ddW = [ca.vertsplit(at_node) for at_node in ca.vertsplit(accelerations, modes)]
    step = Step(h, [], modes)
    at_nodes = [x for at in step.nodes(W, dW, ddW) for x in (*at.W, *at.dW)]
    after = [x for part in step.end(W, dW, ddW) for x in part]
    moved = ca.vertcat(*after, *at_nodes)
    by_state, by_accelerations = (ca.jacobian(moved, x) for x in (state, accelerations))
    at_node = ca.Sparsity.triplet(modes, 2 * modes, *by_modes)
    force = ca.SX(ca.diagcat(*[at_node] * NODES), entries)
    one = ca.SX.eye(NODES * modes)
    matrix = one - force @ by_accelerations[len(after) :, :]
    right = ca.horzcat(force @ by_state[len(after) :, :], one)
    response = by_accelerations @ solve(matrix, right)
    from_state = (by_state + response[:, : len(after)]).T
    from_forcing = response[:, len(after) :].T
    outputs = [
        part
        for matrix in (from_state, from_forcing)
        for part in (matrix[:, : len(after)], matrix[:, len(after) :])
    ]
    return _over("step", [entries, h], outputs, steps, [])


class EnergyPieces:
    """F2 by `resolved_energy`, scaled by duration and power, and its derivatives by the power.

    It leaves out the terms beyond the quadratic that neighbouring steps would give: they make the
    energy a little more exact, but bend it sharply wherever a zero of the power leaves a step or
    meets another, and the solver gets stuck there.

    Attributes
    ----------
    lengths : DM, shape (1, steps)
        The steps' lengths as shares of the duration.
    value : Function
        Power at the nodes (1, nodes) -> energy.
    first : Function
        Power at the nodes -> derivatives of the energy (nodes, 1); second derivatives where the
        zeros of the power move (NODES, NODES * steps).
    """

    def __init__(self, steps: int) -> None:
        self.lengths = lengths = mesh(ca.DM(np.arange(steps)).T, steps)[1]
        at_nodes = ca.MX.sym("power", 1, NODES * steps)
        by_step = ca.reshape(at_nodes, NODES, steps)
        value = resolved_energy(ca.vertsplit(by_step), lengths)
        self.value = ca.Function("energy", [at_nodes], [value])
        gradient, bends = over_columns(energy_derivatives(), steps)(by_step, _LEAST_SLOPE * lengths)
        gradient *= ca.repmat(lengths, NODES, 1)
        weights = ca.kron(lengths, ca.DM.ones(NODES, NODES))
        self.first = ca.Function("energy_first", [at_nodes], [ca.vec(gradient), bends * weights])


@lru_cache(maxsize=16)
def energy_pieces(steps: int) -> EnergyPieces:
    """Those of every plant and profile that are marched in so many steps."""
    return EnergyPieces(steps)


def _over(
    name: str,
    inputs: list[ca.SX],
    outputs: Sequence[ca.SX],
    columns: int,
    shared: Sequence[int],
) -> ca.Function:
    return over_columns(ca.Function(name, inputs, outputs, {"cse": True}), columns, shared)
