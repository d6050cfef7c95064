"""The motion as a function of the profile's coefficients alone, with exact derivatives.

The modes are linear in the state before a step and in what forces them at its nodes, by matrices
that only the joint determines. So the states follow by a recursion over the steps; the same
matrices carry first derivatives forwards, a row for each coefficient, and multipliers backwards.
What is not linear happens at one node: forcing and outputs by the joint and the modes there. Its
second derivatives are small blocks, mapped over all nodes.

Matrices of the steps or nodes stand transposed, side by side as a map returns them or on the
diagonal of one sparse matrix: rows of derivatives are multiplied from the left, columns of
multipliers from the right.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from models import Expression, JointMotion, Plant
from ocp.collocation import GAUSS_NODES, NODES, NodeState, Step, mesh
from ocp.interrupts import keep_interrupts
from ocp.objective import beyond_quadratic, energy_derivatives, resolved_energy
from ocp.profile import JointProfile
from ocp.step_model import Group, quantities_at, solve
from ocp.symbols import over_columns, split

_INNER = len(JointMotion._fields)
"""Values by `JointProfile.inner` at a node."""
_LEAST_SLOPE = 0.1
"""Least slope of the power that its zeros' curvature counts with, in peak powers a duration."""


class Inputs(NamedTuple):
    """What the motion depends on, as symbols.

    Attributes
    ----------
    a : MX, shape (coefficients, 1)
        Coefficients.
    move : MX, shape (3, 1)
        Start, target, duration.
    scale : MX, shape (scales, 1)
        Scales of every state, then of the power and of each limited quantity.
    basis : MX
        `Condensed.basis` of the move.
    """

    a: ca.MX
    move: ca.MX
    scale: ca.MX
    basis: ca.MX


class Sensitivities(NamedTuple):
    """Values along the steps, with their first derivatives, as expressions; everything scaled.

    Attributes
    ----------
    arrival : MX, shape (states, 1)
        State on arrival.
    outputs : MX, shape (rows, nodes)
        Power and each limited quantity at every node.
    arrival_first : MX, shape (states, coefficients)
        First derivatives of the state on arrival.
    outputs_first : MX, shape (coefficients, rows * nodes)
        Those of the outputs, node by node.
    """

    arrival: ca.MX
    outputs: ca.MX
    arrival_first: ca.MX
    outputs_first: ca.MX


class _March(NamedTuple):
    """The motion: what `inner` gives (_INNER, nodes), modes at the nodes (states, nodes), states
    after every step (states, steps), and the steps' matrices."""

    inner: ca.MX
    modes: ca.MX
    after: ca.MX
    state_to_state: list[ca.MX]
    state_to_nodes: ca.MX
    forcing_to_state: ca.MX
    forcing_to_nodes: ca.MX


class _Directions(NamedTuple):
    """Derivatives by the coefficients, a row for each: of inner and modes at the nodes, of the
    state on arrival; and the nodes' own derivatives: by inner and modes, of forcing and outputs."""

    inner: ca.MX
    modes: ca.MX
    arrival: ca.MX
    forcing_by_inner: ca.MX
    outputs_by_inner: ca.MX
    outputs_by_modes: ca.MX


class Condensed:
    """A plant's motion along a profile in a number of steps, as casadi functions.

    Parameters
    ----------
    plant : Plant
        What moves.
    profile : JointProfile
        How the joint moves.
    steps : int
        Number of steps.
    quantities : tuple of str
        Limited quantities.

    Attributes
    ----------
    states, rows, scales : int
        Entries of the state; outputs of a node; number of scales.
    groups : list of Group
        The state, then a node's outputs by name.
    lengths : ndarray, shape (steps,)
        The steps' lengths as shares of the duration.
    basis_size : int
        Length of `basis`.
    figures : Function
        (coefficients, move, scales) -> states after every step (states, steps), outputs (rows,
        nodes), energy by `resolved_energy`, scaled.
    """

    @keep_interrupts()  # casadi loses a Ctrl-C
    def __init__(
        self, plant: Plant, profile: JointProfile, steps: int, quantities: tuple[str, ...]
    ) -> None:
        self.size, self.steps, self.states = profile.size, steps, 2 * plant.modes
        self.nodes = NODES * steps
        begin, length = (x.full().ravel() for x in mesh(ca.DM(np.arange(steps)), steps))
        self.lengths = length
        self._fractions = ca.DM((begin[:, None] + length[:, None] * GAUSS_NODES).ravel()).T
        self.groups = [Group("state", 0, self.states)]
        for name in ("power", *quantities):
            rows = plant.tips if name == "deflection" else 1
            self.groups.append(Group(name, self.groups[-1].first + self.groups[-1].rows, rows))
        self.rows = sum(group.rows for group in self.groups[1:])
        self.scales = self.states + len(self.groups) - 1
        self._profile_of(profile)
        self._step_of(plant, profile)
        self._node_of(plant, profile)
        self.basis_size = 0 if self._inner_second else self.nodes * _INNER * (1 + self.size)
        a, move, scale = (ca.MX.sym(n, s) for n, s in
                          (("a", self.size), ("move", 3), ("scale", self.scales)))
        inner = self._inner(a, self._fractions, move)
        march, outputs = self._values(inner, move, scale)
        scaled = march.after / ca.repmat(scale[: self.states], 1, steps)
        self.figures = ca.Function(
            "figures", [a, move, scale], [scaled, outputs, self.energy(outputs)]
        )

    # -- what happens at a node and in a step --

    def _profile_of(self, profile: JointProfile) -> None:
        a, fraction, move = ca.SX.sym("a", self.size), ca.SX.sym("t"), ca.SX.sym("move", 3)
        values = profile.inner(ca.vertsplit(a), fraction, *ca.vertsplit(move))
        inner, weights = ca.vertcat(*values), ca.SX.sym("w", _INNER)
        inputs = [a, fraction, move]
        first = ca.densify(ca.jacobian(inner, a)).T
        self._inner = self._over_nodes("inner", inputs, [inner], [0, 2])
        self._inner_first = self._over_nodes("inner_first", inputs, [first], [0, 2])
        self._inner_second = None
        if not ca.is_linear(inner, a):
            second = ca.densify(ca.hessian(ca.dot(weights, inner), a)[0])
            self._inner_second = self._over_nodes(
                "inner_second", [*inputs, weights], [second], [0, 2]
            )

    def _step_of(self, plant: Plant, profile: JointProfile) -> None:
        """The step's matrices, transposed, and the forcing of modes at rest."""
        inner, state = ca.SX.sym("inner", NODES * _INNER), ca.SX.sym("z", self.states)
        accelerations = ca.SX.sym("ddW", NODES * plant.modes)
        h, move = ca.SX.sym("h"), ca.SX.sym("move", 3)
        joints = [
            profile.outer(ca.vertsplit(at_node), *ca.vertsplit(move))
            for at_node in ca.vertsplit(inner, _INNER)
        ]
        ddW = [ca.vertsplit(at_node) for at_node in ca.vertsplit(accelerations, plant.modes)]
        z, one = ca.vertsplit(state), Step(h, [], plant.modes)
        W, dW = z[: plant.modes], z[plant.modes :]
        nodes, (W_after, dW_after) = one.nodes(W, dW, ddW), one.end(W, dW, ddW)
        moved = ca.vertcat(*(x for at in nodes for x in (*at.W, *at.dW)), *W_after, *dW_after)
        forcing = ca.vertcat(
            *(
                x
                for joint, at in zip(joints, nodes, strict=True)
                for x in plant.modal_accelerations(joint, at.W, at.dW)
            )
        )
        # W'' = forcing + F by the modes, and the modes are linear in state and W''.
        matrix = ca.SX.eye(accelerations.numel()) - ca.jacobian(forcing, accelerations)
        right = ca.horzcat(ca.jacobian(forcing, state), ca.SX.eye(accelerations.numel()))
        response = ca.sparsify(solve(matrix, right))
        direct = ca.horzcat(
            ca.jacobian(moved, state), ca.SX(moved.numel(), accelerations.numel())
        )
        total = (direct + ca.jacobian(moved, accelerations) @ response).T
        at_nodes = NODES * self.states
        by_state, by_forcing = total[: self.states, :], total[self.states :, :]
        still = [0.0] * plant.modes
        at_rest = [x for joint in joints for x in plant.modal_accelerations(joint, still, still)]
        outputs = [
            by_state[:, at_nodes:],
            by_state[:, :at_nodes],
            by_forcing[:, at_nodes:],
            by_forcing[:, :at_nodes],
            ca.vertcat(*at_rest),
        ]
        one = ca.Function("step", [inner, h, move], outputs, {"cse": True})
        self._step = over_columns(one, self.steps, [2])

    def _node_of(self, plant: Plant, profile: JointProfile) -> None:
        """Outputs and forcing by inner and modes at a node, and their derivatives."""
        inner, modes = ca.SX.sym("inner", _INNER), ca.SX.sym("modes", self.states)
        move, scale = ca.SX.sym("move", 3), ca.SX.sym("scale", self.scales)
        joint = profile.outer(ca.vertsplit(inner), *ca.vertsplit(move))
        at = ca.vertsplit(modes)
        W, dW = at[: plant.modes], at[plant.modes :]
        ddW = list(plant.modal_accelerations(joint, W, dW))
        values = quantities_at(plant, joint, NodeState(W, dW, ddW))
        forcing, outputs = ca.vertcat(*ddW), ca.vertcat(
            *(
                ca.vertcat(*values[group.name]) / scale[self.states + i]
                for i, group in enumerate(self.groups[1:])
            )
        )
        inputs = [inner, modes, move, scale]
        firsts = [
            ca.jacobian(forcing, inner).T,
            ca.jacobian(outputs, inner).T,
            ca.jacobian(outputs, modes).T,
        ]
        of_forcing, of_outputs = ca.SX.sym("nu", plant.modes), ca.SX.sym("w", self.rows)
        lagrangian = ca.dot(of_forcing, forcing) + ca.dot(of_outputs, outputs)
        second = ca.hessian(lagrangian, ca.vertcat(inner, modes))[0]
        seconds = [
            second[:_INNER, :_INNER] / 2, second[_INNER:, :_INNER], second[_INNER:, _INNER:] / 2
        ]
        outputs = ca.densify(outputs)
        self._node = self._over_nodes("node", inputs, [outputs], [2, 3])
        self._node_first = self._over_nodes("node_first", inputs, [outputs, *firsts], [2, 3])
        self._node_second = self._over_nodes(
            "node_second", [*inputs, of_forcing, of_outputs], seconds, [2, 3]
        )

    def _over_nodes(
        self, name: str, inputs: list[ca.SX], outputs: list[ca.SX], shared: Sequence[int]
    ) -> ca.Function:
        one = ca.Function(name, inputs, outputs, {"cse": True})
        return over_columns(one, self.nodes, shared)

    # -- all steps --

    def basis(self, move: NDArray[np.float64]) -> NDArray[np.float64]:
        """What `inner` is made of where it is linear in the coefficients: constant and slopes."""
        if self._inner_second:
            return np.empty(0)
        parts = [
            function(ca.DM(self.size, 1), self._fractions, move)
            for function in (self._inner, self._inner_first)
        ]
        return np.concatenate([part.full().ravel(order="F") for part in parts])

    def _joint(self, inputs: Inputs) -> tuple[ca.MX, ca.MX]:
        """`inner` at the nodes, and its derivatives (coefficients, _INNER * nodes)."""
        if self._inner_second:
            arguments = inputs.a, self._fractions, inputs.move
            return self._inner(*arguments), self._inner_first(*arguments)
        count = _INNER * self.nodes
        constant, slopes = split(inputs.basis, [count, count * self.size])
        slopes = ca.reshape(slopes, self.size, count)
        return ca.reshape(ca.mac(inputs.a.T, slopes, constant.T), _INNER, self.nodes), slopes

    def _values(self, inner: ca.MX, move: ca.MX, scale: ca.MX) -> tuple[_March, ca.MX]:
        march = self._march(inner, move)
        return march, self._node(inner, march.modes, move, scale)

    def _march(self, inner: ca.MX, move: ca.MX) -> _March:
        lengths = ca.DM(self.lengths).T * move[2]
        by_step = ca.reshape(inner, NODES * _INNER, self.steps)
        to_state, to_nodes, *by_forcing, forcing = self._step(by_step, lengths, move)
        state_to_state = ca.horzsplit(to_state, self.states)
        state_to_nodes, forcing_to_state, forcing_to_nodes = (
            _on_diagonal(blocks, self.steps) for blocks in (to_nodes, *by_forcing)
        )
        forcing = ca.vec(forcing).T
        after = self._recursion(state_to_state, forcing @ forcing_to_state)
        modes = _before(after, self.states) @ state_to_nodes + forcing @ forcing_to_nodes
        return _March(
            inner,
            ca.reshape(modes, self.states, self.nodes),
            ca.reshape(after, self.states, self.steps),
            state_to_state,
            state_to_nodes,
            forcing_to_state,
            forcing_to_nodes,
        )

    def _recursion(self, state_to_state: list[ca.MX], added: ca.MX) -> ca.MX:
        """Rows of states after every step, side by side, from rest and what each step adds."""
        after: list[ca.MX] = []
        for matrix, new in zip(state_to_state, ca.horzsplit(added, self.states), strict=True):
            after.append(ca.mac(after[-1], matrix, new) if after else new)
        return ca.horzcat(*after)

    def _directions(
        self, march: _March, slopes: ca.MX, move: ca.MX, scale: ca.MX
    ) -> tuple[ca.MX, _Directions]:
        outputs, *firsts = self._node_first(march.inner, march.modes, move, scale)
        firsts = [_on_diagonal(blocks, self.nodes) for blocks in firsts]
        forcing = slopes @ firsts[0]
        after = self._recursion(march.state_to_state, forcing @ march.forcing_to_state)
        before = _before(after, self.states)
        modes = before @ march.state_to_nodes + forcing @ march.forcing_to_nodes
        return outputs, _Directions(slopes, modes, after[:, -self.states :], *firsts)

    def values(self, inputs: Inputs) -> tuple[ca.MX, ca.MX]:
        """State on arrival (states, 1) and outputs (rows, nodes), scaled."""
        march, outputs = self._values(self._joint(inputs)[0], inputs.move, inputs.scale)
        return march.after[:, -1] / inputs.scale[: self.states], outputs

    def sensitivities(self, inputs: Inputs) -> Sensitivities:
        """Values and first derivatives."""
        inner, slopes = self._joint(inputs)
        march = self._march(inner, inputs.move)
        outputs, along = self._directions(march, slopes, inputs.move, inputs.scale)
        scale = inputs.scale[: self.states]
        arrival_first = along.arrival.T / ca.repmat(scale, 1, self.size)
        return Sensitivities(
            march.after[:, -1] / scale, outputs, arrival_first, _outputs_first(along)
        )

    def curvature(
        self, inputs: Inputs, of_arrival: ca.MX, of_outputs: ca.MX, bends: ca.MX | None = None
    ) -> ca.MX:
        """Second derivatives by the coefficients of arrival and outputs times their multipliers.

        Parameters
        ----------
        inputs : Inputs
            What the motion depends on.
        of_arrival : MX, shape (states, 1)
            Multipliers of the state on arrival.
        of_outputs : MX, shape (rows, nodes)
            Multipliers of the outputs.
        bends : MX, shape (NODES, NODES * steps), optional
            Second derivatives of what is asked by the power at the nodes, step by step.

        Returns
        -------
        MX, shape (coefficients, coefficients)
            Symmetric.
        """
        inner, slopes = self._joint(inputs)
        march = self._march(inner, inputs.move)
        _, along = self._directions(march, slopes, inputs.move, inputs.scale)
        of_state = of_arrival / inputs.scale[: self.states]
        of_forcing = self._adjoint(march, of_state, along.outputs_by_modes @ ca.vec(of_outputs))
        seconds = self._node_second(
            inner, march.modes, inputs.move, inputs.scale,
            ca.reshape(of_forcing, self.states // 2, self.nodes), of_outputs,
        )  # fmt: skip
        by_inner, mixed, by_modes = (_on_diagonal(blocks, self.nodes) for blocks in seconds)
        half = (slopes @ by_inner + along.modes @ mixed) @ slopes.T
        if by_modes.nnz():
            half += along.modes @ by_modes @ along.modes.T
        hessian = half + half.T
        if bends is not None:
            of_power = self.of_group(_outputs_first(along), "power")
            hessian += of_power @ _on_diagonal(bends, self.steps) @ of_power.T
        if self._inner_second:
            weights = along.outputs_by_inner @ ca.vec(of_outputs)
            weights += along.forcing_by_inner @ of_forcing
            blocks = self._inner_second(
                inputs.a, self._fractions, inputs.move,
                ca.reshape(weights, _INNER, self.nodes),
            )  # fmt: skip
            flat = ca.reshape(blocks, self.size**2, self.nodes)
            hessian += ca.reshape(ca.sum2(flat), self.size, self.size)
        return hessian

    def _adjoint(self, march: _March, of_arrival: ca.MX, of_modes: ca.MX) -> ca.MX:
        """Multipliers of the forcing, by the recursion backwards from those of the arrival."""
        after = [of_arrival]
        added = ca.vertsplit(march.state_to_nodes @ of_modes, self.states)
        for matrix, new in zip(march.state_to_state[:0:-1], added[:0:-1], strict=True):
            after.append(ca.mac(matrix, after[-1], new))
        of_states = ca.vertcat(*reversed(after))
        return march.forcing_to_state @ of_states + march.forcing_to_nodes @ of_modes

    def of_group(self, rows: ca.MX, name: str) -> ca.MX:
        """The columns of a quantity among those of all outputs, node by node."""
        group = next(group for group in self.groups if group.name == name)
        first = np.arange(self.nodes)[:, None] * self.rows + group.first - self.states
        return rows[:, (first + np.arange(group.rows)).ravel().tolist()]

    # -- the energy --

    def _power(self, outputs: ca.MX) -> tuple[list[ca.MX], ca.MX, ca.MX]:
        """Power at the nodes, a row of steps for each, and its terms beyond the quadratic."""
        power = ca.vertsplit(ca.reshape(outputs[0, :], NODES, self.steps))
        flat = ca.horzcat(*power)
        to_cubic, to_quartic = beyond_quadratic(self.steps)
        return power, flat @ to_cubic, flat @ to_quartic

    def energy(self, outputs: ca.MX) -> ca.MX:
        """F2 by `resolved_energy`, scaled by duration and power, of the outputs."""
        power, cubic, quartic = self._power(outputs)
        return resolved_energy(power, ca.DM(self.lengths).T, cubic, quartic)

    def energy_first(self, outputs: ca.MX) -> tuple[ca.MX, ca.MX]:
        """Derivatives of the energy by the power.

        Parameters
        ----------
        outputs : MX, shape (rows, nodes)
            Outputs.

        Returns
        -------
        gradient : MX, shape (1, nodes)
            First derivatives.
        bends : MX, shape (NODES, NODES * steps)
            Second derivatives where the zeros of the power move, step by step.
        """
        power, cubic, quartic = self._power(outputs)
        lengths = ca.DM(self.lengths).T
        derivatives = over_columns(energy_derivatives(), self.steps)
        _, gradients, bends = derivatives(
            ca.vertcat(*power), cubic, quartic, _LEAST_SLOPE * lengths
        )
        gradients *= ca.repmat(lengths, NODES + 2, 1)
        to_cubic, to_quartic = beyond_quadratic(self.steps)
        beyond = to_cubic @ gradients[NODES, :].T + to_quartic @ gradients[NODES + 1, :].T
        gradient = gradients[:NODES, :] + ca.reshape(beyond, self.steps, NODES).T
        weights = ca.DM(np.repeat(self.lengths, NODES)).T
        return ca.vec(gradient).T, bends * ca.repmat(weights, NODES, 1)


def _on_diagonal(blocks: ca.MX, count: int) -> ca.MX:
    """Blocks of one sparsity that stand side by side, on the diagonal of one sparse matrix."""
    block = ca.horzsplit(blocks.sparsity(), blocks.shape[1] // count)[0]
    return ca.sparsity_cast(blocks, ca.diagcat(*[block] * count))


def _before(after: ca.MX, states: int) -> ca.MX:
    """Rows of states before every step, from those after it: rest at first."""
    return ca.horzcat(ca.DM.zeros(after.shape[0], states), after[:, :-states])


def _outputs_first(along: _Directions) -> ca.MX:
    """Derivatives of the outputs by the coefficients, a row for each."""
    return along.inner @ along.outputs_by_inner + along.modes @ along.outputs_by_modes


@lru_cache(maxsize=16)
def condensed(
    plant: Plant, profile: JointProfile, steps: int, quantities: tuple[str, ...]
) -> Condensed:
    """The functions of a plant, a profile, a number of steps and the limited quantities."""
    return Condensed(plant, profile, steps, quantities)
