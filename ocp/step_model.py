"""One step of the simulation with its derivatives, as small dense functions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from models import Plant
from ocp.collocation import GAUSS_NODES, NODES, mesh, step
from ocp.profile import JointProfile


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


class StepModel:
    """One step as a small dense casadi function with its first and second derivatives.

    Inputs are the scaled state before the step, the step's index, the coefficients, the move and
    the scales; outputs are the scaled state after it, the power and each limited quantity at the
    Gauss nodes.
    """

    def __init__(
        self, plant: Plant, profile: JointProfile, steps: int, quantities: Sequence[str]
    ) -> None:
        self.size = 2 * plant.modes
        at_nodes = dict.fromkeys(("power", *quantities), NODES)
        if "deflection" in at_nodes:
            at_nodes["deflection"] *= plant.tips
        self.groups = [Group("state", 0, self.size)]
        for name, rows in at_nodes.items():
            last = self.groups[-1]
            self.groups.append(Group(name, last.first + last.rows, rows))
        self.scales = self.size + len(at_nodes)

        state, index = ca.SX.sym("z", self.size), ca.SX.sym("k")
        coefficients, move = ca.SX.sym("a", profile.size), ca.SX.sym("move", 3)
        scale = ca.SX.sym("scale", self.scales)
        outputs = self._outputs(plant, profile, steps, state, index, coefficients, move, scale)
        inputs = [state, index, coefficients, move, scale]
        unknowns = ca.vertcat(coefficients, state)
        multipliers = ca.SX.sym("lam", outputs.numel())
        first = ca.densify(ca.jacobian(outputs, unknowns))
        second = ca.densify(ca.hessian(ca.dot(multipliers, outputs), unknowns)[0])
        n, options = profile.size, {"cse": True}
        self.value = ca.Function("step", inputs, [outputs], options)
        self.first = ca.Function("step_first", inputs, [first[:, :n], first[:, n:]], options)
        self.second = ca.Function(
            "step_second",
            [*inputs, multipliers],
            [second[:n, :n], second[:n, n:], second[n:, n:]],
            options,
        )

    def _outputs(
        self,
        plant: Plant,
        profile: JointProfile,
        steps: int,
        state: ca.SX,
        index: ca.SX,
        coefficients: ca.SX,
        move: ca.SX,
        scale: ca.SX,
    ) -> ca.SX:
        start, target, duration = ca.vertsplit(move)
        physical = ca.vertsplit(state * scale[: self.size])
        W, dW = physical[: plant.modes], physical[plant.modes :]
        begin, length = mesh(index, steps)
        joints = [
            profile.motion(
                ca.vertsplit(coefficients), begin + node * length, start, target, duration
            )
            for node in GAUSS_NODES
        ]
        one = step(plant, joints, duration * length)
        ddW = one.accelerations(W, dW)
        nodes = one.nodes(W, dW, ddW)
        W_after, dW_after = one.end(W, dW, ddW)
        torque = [
            plant.torque(joint, node.W, node.dW, node.ddW)
            for joint, node in zip(joints, nodes, strict=True)
        ]
        values = {
            "power": [t * joint.speed for t, joint in zip(torque, joints, strict=True)],
            "torque": torque,
            "speed": [joint.speed for joint in joints],
            "acceleration": [joint.acceleration for joint in joints],
            "deflection": [tip for node in nodes for tip in plant.tip_displacements(node.W)],
        }
        rows = [ca.vertcat(*W_after, *dW_after) / scale[: self.size]]
        for i, group in enumerate(self.groups[1:]):
            rows.append(ca.vertcat(*values[group.name]) / scale[self.size + i])
        return ca.vertcat(*rows)
