"""One step of the simulation with its derivatives, as casadi expressions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from quietarm.models import Expression, JointMotion, Plant
from quietarm.ocp.simulation.collocation import NODES, NodeState, step
from quietarm.ocp.task.quantities import QUANTITIES

JOINT = 3
"""Numbers that describe the joint to the plant at one time: angle, speed, acceleration."""


@dataclass(frozen=True)
class Group:
    """Outputs of a step that belong together: `rows` of them from row `first`."""

    name: str
    first: int
    rows: int

    @property
    def where(self) -> slice:
        """The rows among a step's outputs."""
        return slice(self.first, self.first + self.rows)


def groups_of(plant: Plant, quantities: Sequence[str]) -> list[Group]:
    """A step's outputs: the state after it, the power, each limited quantity at the nodes."""
    return grouped(plant, quantities, NODES)


def grouped(plant: Plant, quantities: Sequence[str], times: int) -> list[Group]:
    """Groups of the state, and of the power and each limited quantity at so many times."""
    groups = [Group("state", 0, 2 * plant.modes)]
    for name in ("power", *quantities):
        rows = times * (QUANTITIES[name].rows(plant) if name in QUANTITIES else 1)
        groups.append(Group(name, groups[-1].first + groups[-1].rows, rows))
    return groups


def by_group(
    groups: Sequence[Group], outputs: NDArray[np.float64]
) -> dict[str, NDArray[np.float64]]:
    """Rows of outputs by the quantity's name, from the first of these groups on."""
    first = groups[0].first
    return {
        group.name: outputs[group.first - first : group.first - first + group.rows]
        for group in groups
    }


def quantities_at(
    plant: Plant, joint: JointMotion, node: NodeState
) -> dict[str, Sequence[Expression]]:
    """The power and every quantity that can be limited, at one node [SI units]."""
    torque = plant.torque(joint, node.W, node.dW, node.ddW)
    tips = plant.tip_displacements(node.W)
    values = {name: quantity.of(joint, tips, torque) for name, quantity in QUANTITIES.items()}
    return {"power": [torque * joint.speed], **values}


class LiftedStep:
    """A step's outputs and collocation equations in its joint q, state and accelerations W''.

    The joint's motion q and the modes' accelerations W'' at the nodes are symbols of their own,
    with the collocation equations between them: second derivatives are taken in these symbols,
    where the graph is short, and carried over by the chain rule to whatever moves the joint and to
    the state. That takes less than half the time of differentiating through the linear solve.
    """

    def __init__(
        self, plant: Plant, groups: Sequence[Group], state: ca.SX, h: ca.SX, scale: ca.SX
    ) -> None:
        modes, size = plant.modes, 2 * plant.modes
        self.joint = ca.SX.sym("q", NODES * JOINT)
        self.accelerations = ca.SX.sym("ddW", NODES * modes)
        joints = [JointMotion(*ca.vertsplit(q)) for q in ca.vertsplit(self.joint, JOINT)]
        ddW = [ca.vertsplit(at_node) for at_node in ca.vertsplit(self.accelerations, modes)]
        physical = ca.vertsplit(state * scale[:size])
        W, dW = physical[:modes], physical[modes:]
        one = step(plant, joints, h)
        self._solution = ca.vertcat(*(x for at_node in one.accelerations(W, dW) for x in at_node))
        nodes = one.nodes(W, dW, ddW)
        equations = [
            plant.modal_accelerations(joint, node.W, node.dW)
            for joint, node in zip(joints, nodes, strict=True)
        ]
        self.residual = self.accelerations - ca.vertcat(*(x for row in equations for x in row))
        at_nodes = [
            quantities_at(plant, joint, node) for joint, node in zip(joints, nodes, strict=True)
        ]
        W_after, dW_after = one.end(W, dW, ddW)
        rows = [ca.vertcat(*W_after, *dW_after) / scale[:size]]
        for i, group in enumerate(groups[1:]):
            values = [value for at_node in at_nodes for value in at_node[group.name]]
            rows.append(ca.vertcat(*values) / scale[size + i])
        self.outputs = ca.vertcat(*rows)

    def of(self, joint: ca.SX, expression: ca.SX) -> ca.SX:
        """The expression with W'' of the collocation and the joint's motion put in."""
        inner = ca.substitute(expression, self.accelerations, self._solution)
        return ca.densify(ca.substitute(inner, self.joint, joint))

    def derivatives(
        self, joint: ca.SX, by: ca.SX, state: ca.SX, multipliers: ca.SX
    ) -> tuple[ca.SX, ca.SX]:
        """Jacobian of the outputs and Hessian of multipliers . outputs, by `by` and the state.

        `joint` is q as an expression in `by`.

        With r(q, z, W'') = 0 the collocation equations: dW'' = -(dr/dW'')^-1 dr; multipliers mu of
        r that make the Lagrangian stationary in W'' leave its Hessian, between the directions in
        which q, z and W'' move together, as the only second-order term beside that of q itself.
        """
        explicit = ca.vertcat(self.joint, state)
        by_acceleration = ca.jacobian(self.residual, self.accelerations)
        moves = -solve(by_acceleration, ca.jacobian(self.residual, explicit))
        lagrangian = ca.dot(multipliers, self.outputs)
        adjoint = ca.SX.sym("mu", self.residual.numel())
        stationary = -solve(by_acceleration.T, ca.gradient(lagrangian, self.accelerations))
        hessian, gradient = ca.hessian(
            lagrangian + ca.dot(adjoint, self.residual), ca.vertcat(explicit, self.accelerations)
        )
        n, size = by.numel(), state.numel()
        to_explicit = ca.diagcat(ca.jacobian(joint, by), ca.SX.eye(size))
        directions = ca.vertcat(to_explicit, moves @ to_explicit)
        weights = ca.SX.sym("weights", joint.numel())
        bending = ca.hessian(ca.dot(weights, joint), by)[0]
        second = directions.T @ hessian @ directions
        second[:n, :n] += ca.substitute(bending, weights, gradient[: joint.numel()])
        second = ca.triu2symm(ca.triu(ca.substitute(second, adjoint, stationary)))
        first = (
            ca.jacobian(self.outputs, explicit)
            + ca.jacobian(self.outputs, self.accelerations) @ moves
        ) @ to_explicit
        return self.of(joint, first), self.of(joint, second)


def solve(matrix: ca.SX, right: ca.SX) -> ca.SX:
    """`matrix`^-1 `right` by Gaussian elimination without pivoting, as in `collocation.eliminate`.

    Rows that have no entry in the pivot's column are left alone: modes that do not act on each
    other stay apart, and their number costs little.
    """
    size = matrix.shape[0]
    rows = ca.vertsplit(ca.horzcat(matrix, right))
    below = ((k, i) for i in range(size) for k in range(i + 1, size))
    above = ((k, i) for i in reversed(range(size)) for k in range(i))
    for k, i in (*below, *above):
        if rows[k].sparsity().has_nz(0, i):
            rows[k] -= rows[k][i] / rows[i][i] * rows[i]
    return ca.vertcat(*(row[size:] / row[i] for i, row in enumerate(rows)))
