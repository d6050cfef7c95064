"""The motion as a function of the profile's coefficients alone, with exact derivatives.

The modes are linear in the state before a step and in what forces them at its nodes, by matrices
that only the joint determines. So the states follow by a recursion over the steps; the same
matrices carry first derivatives forwards, a row for each coefficient, and multipliers backwards.
All nonlinear terms, forcing and outputs, belong to a single node: they depend on the joint and the
modes there. Their second derivatives are small blocks. The matrices of all steps or nodes are the
diagonal blocks of one sparse matrix.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from models import Plant
from ocp.base.interrupts import keep_interrupts
from ocp.profiles.joint_profile import JointProfile
from ocp.program.pieces import NodePieces, ProfilePieces, energy_pieces, linear_steps
from ocp.program.step_model import grouped
from ocp.program.symbols import split
from ocp.simulation.collocation import NODES
from ocp.task.quantities import ask_for_jerk


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


class March(NamedTuple):
    """The motion, and the matrices of its steps.

    Attributes
    ----------
    inner, modes : MX, shapes (inner, nodes) and (states, nodes)
        What moves the joint at the nodes, as `ProfilePieces` has it, and W and W' there.
    after : MX, shape (states, steps)
        States after every step.
    arrival : MX, shape (states, 1)
        The last of them, scaled.
    outputs : MX, shape (rows, nodes)
        Power and each limited quantity at the nodes, scaled.
    state_to_state : list of MX
        From the state before each step to that after it.
    state_to_modes, forcing_to_state, forcing_to_modes : MX
        The other matrices of all steps.
    """

    inner: ca.MX
    modes: ca.MX
    after: ca.MX
    arrival: ca.MX
    outputs: ca.MX
    state_to_state: list[ca.MX]
    state_to_modes: ca.MX
    forcing_to_state: ca.MX
    forcing_to_modes: ca.MX


class Sensitivities(NamedTuple):
    """First derivatives along a march.

    Attributes
    ----------
    inner, modes : MX, shapes (coefficients, inner * nodes) and (coefficients, states * nodes)
        Of inner and modes at the nodes by the coefficients.
    arrival : MX, shape (coefficients, states)
        Of the scaled state on arrival by the coefficients.
    outputs : MX, shape (coefficients, rows * nodes)
        Of the outputs, node by node, by the coefficients.
    forcing_by_inner, outputs_by_inner, outputs_by_modes : MX
        Of what happens at the nodes.
    """

    inner: ca.MX
    modes: ca.MX
    arrival: ca.MX
    outputs: ca.MX
    forcing_by_inner: ca.MX
    outputs_by_inner: ca.MX
    outputs_by_modes: ca.MX


class Condensed:
    """A plant's motion along a profile in a number of steps, as casadi expressions.

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
    plant : Plant
        As given.
    size, steps, nodes : int
        Number of coefficients, steps and nodes.
    states, rows, scales : int
        Entries of the state; outputs at a node; number of scales.
    groups : list of Group
        The state, then the outputs at a node by name.
    lengths : ndarray, shape (steps,)
        The steps' lengths as shares of the duration.
    energy : EnergyPieces
        The energy of the power at the nodes.
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
        self.plant = plant
        self.size, self.steps, self.states = profile.size, steps, 2 * plant.modes
        self.nodes = NODES * steps
        self.energy = energy_pieces(steps)
        self.lengths = self.energy.lengths.full().ravel()
        self.groups = grouped(plant, quantities, times=1)
        self.rows = sum(group.rows for group in self.groups[1:])
        self.scales = self.states + len(self.groups) - 1
        self._profile = ProfilePieces(profile, steps, ask_for_jerk(quantities))
        self._inner = self._profile.inner
        self._node = NodePieces(plant, self._profile, self.nodes, self.groups)
        self._step = linear_steps(plant.modes, self._node.by_modes, steps)
        self.basis_size = 0 if self._profile.second else self.nodes * self._inner * (1 + self.size)
        a, move, scale = (ca.MX.sym("x", n) for n in (self.size, 3, self.scales))
        march = self._march(self._profile.value(a, self._profile.fractions, move), move, scale)
        after = march.after / ca.repmat(scale[: self.states], 1, steps)
        energy = self.energy.value(march.outputs[0, :])
        self.figures = ca.Function("figures", [a, move, scale], [after, march.outputs, energy])

    def basis(self, move: Sequence[float], axes: NDArray[np.float64]) -> NDArray[np.float64]:
        """`inner` where it is linear in the coefficients: its constant and its slopes.

        Parameters
        ----------
        move : sequence of float
            Start, target, duration.
        axes : ndarray, shape (coefficients, coefficients)
            The program's unknowns are those whose products with `axes` are the coefficients.
        """
        if self._profile.second:
            return np.empty(0)
        constant, slopes = self._linear_inner(move)
        return np.concatenate([constant.ravel(order="F"), (axes.T @ slopes).ravel(order="F")])

    def even_axes(self, move: Sequence[float]) -> NDArray[np.float64]:
        """Axes for `basis` along which the first value of `inner` moves alike and independently.

        The powers of T of a polynomial are nearly the same function from about ten terms on.
        """
        if self._profile.second:
            return np.eye(self.size)
        weights = np.sqrt(np.repeat(self.lengths, NODES))
        slopes: Any = self._linear_inner(move)[1][:, :: self._inner]
        triangle: Any = np.linalg.qr((slopes * weights).T, mode="r")
        return np.linalg.inv(triangle) * triangle[0, 0]

    def _linear_inner(
        self, move: Sequence[float]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        at_zero = ca.DM(self.size, 1), self._profile.fractions, ca.DM(list(move))
        return self._profile.value(*at_zero).full(), self._profile.first(*at_zero).full()

    def _joint(self, inputs: Inputs) -> tuple[ca.MX, ca.MX]:
        """`inner` at the nodes, and its derivatives by the coefficients."""
        if self._profile.second:
            arguments = inputs.a, self._profile.fractions, inputs.move
            return self._profile.value(*arguments), self._profile.first(*arguments)
        count = self._inner * self.nodes
        constant, slopes = split(inputs.basis, [count, count * self.size])
        slopes = ca.reshape(slopes, self.size, count)
        return ca.reshape(ca.mac(inputs.a.T, slopes, constant.T), self._inner, self.nodes), slopes

    def _march(self, inner: ca.MX, move: ca.MX, scale: ca.MX) -> March:
        forcing, entries = self._node.linear(inner, move)
        forcing = ca.vec(forcing).T
        to_state, *others = self._step(
            ca.reshape(entries, -1, self.steps), ca.DM(self.lengths).T * move[2]
        )
        to_state = ca.horzsplit(to_state, self.states)
        to_modes, force_state, force_modes = (_on_diagonal(x, self.steps) for x in others)
        after = _states(to_state, forcing @ force_state)
        modes = _before(after, self.states) @ to_modes + forcing @ force_modes
        modes = ca.reshape(modes, self.states, self.nodes)
        after = ca.reshape(after, self.states, self.steps)
        return March(
            inner, modes, after, after[:, -1] / scale[: self.states],
            self._node.value(inner, modes, move, scale),
            to_state, to_modes, force_state, force_modes,
        )  # fmt: skip

    def linearised(self, inputs: Inputs) -> tuple[March, Sensitivities]:
        """The motion with its first derivatives."""
        inner, slopes = self._joint(inputs)
        march = self._march(inner, inputs.move, inputs.scale)
        firsts = self._node.first(inner, march.modes, inputs.move, inputs.scale)
        forcing_by_inner, by_inner, by_modes = (_on_diagonal(x, self.nodes) for x in firsts)
        forcing = slopes @ forcing_by_inner
        after = _states(march.state_to_state, forcing @ march.forcing_to_state)
        before = _before(after, self.states)
        modes = before @ march.state_to_modes + forcing @ march.forcing_to_modes
        arrival = after[:, -self.states :] / ca.repmat(inputs.scale[: self.states].T, self.size, 1)
        return march, Sensitivities(
            slopes, modes, arrival, slopes @ by_inner + modes @ by_modes,
            forcing_by_inner, by_inner, by_modes,
        )  # fmt: skip

    def curvature(
        self,
        inputs: Inputs,
        linearised: tuple[March, Sensitivities],
        of_arrival: ca.MX,
        of_outputs: ca.MX,
    ) -> ca.MX:
        """Second derivatives by the coefficients of arrival and outputs times their multipliers.

        Parameters
        ----------
        inputs : Inputs
            What the motion depends on.
        linearised : tuple of March and Sensitivities
            By `linearised` of it.
        of_arrival : MX, shape (states, 1)
            Multipliers of the scaled state on arrival.
        of_outputs : MX, shape (rows, nodes)
            Multipliers of the outputs.

        Returns
        -------
        MX, shape (coefficients, coefficients)
            Symmetric.
        """
        march, first = linearised
        of_state = of_arrival / inputs.scale[: self.states]
        of_forcing = _adjoint(march, of_state, first.outputs_by_modes @ ca.vec(of_outputs))
        seconds = self._node.second(
            march.inner, march.modes, inputs.move, inputs.scale,
            ca.reshape(of_forcing, -1, self.nodes), of_outputs,
        )  # fmt: skip
        by_inner, mixed, by_modes = (_on_diagonal(blocks, self.nodes) for blocks in seconds)
        half = (first.inner @ by_inner + first.modes @ mixed) @ first.inner.T
        if by_modes.nnz():
            half += first.modes @ by_modes @ first.modes.T
        hessian = half + half.T
        if self._profile.second:
            weights = first.outputs_by_inner @ ca.vec(of_outputs)
            weights += first.forcing_by_inner @ of_forcing
            blocks = self._profile.second(
                inputs.a, self._profile.fractions, inputs.move,
                ca.reshape(weights, self._inner, self.nodes),
            )  # fmt: skip
            flat = ca.reshape(blocks, self.size**2, self.nodes)
            hessian += ca.reshape(ca.sum2(flat), self.size, self.size)
        return hessian

    def of_bends(self, of_power: ca.MX, bends: ca.MX) -> ca.MX:
        """Second derivatives by the coefficients, from those by the power at the nodes."""
        return of_power @ _on_diagonal(bends, self.steps) @ of_power.T

    def of_group(self, rows: ca.MX, name: str) -> ca.MX:
        """The columns of a quantity among those of all outputs, node by node."""
        group = next(group for group in self.groups if group.name == name)
        first = np.arange(self.nodes)[:, None] * self.rows + group.first - self.states
        return rows[:, (first + np.arange(group.rows)).ravel().tolist()]


def _states(state_to_state: list[ca.MX], added: ca.MX) -> ca.MX:
    """Rows of states after every step, side by side, from rest and what each step adds."""
    first, *rest = ca.horzsplit(added, added.shape[1] // len(state_to_state))
    after = [first]
    for matrix, new in zip(state_to_state[1:], rest, strict=True):
        after.append(ca.mac(after[-1], matrix, new))
    return ca.horzcat(*after)


def _before(after: ca.MX, states: int) -> ca.MX:
    """Rows of states before every step, from those after it: rest at first."""
    return ca.horzcat(ca.DM.zeros(after.shape[0], states), after[:, :-states])


def _adjoint(march: March, of_arrival: ca.MX, of_modes: ca.MX) -> ca.MX:
    """Multipliers of the forcing, by the recursion backwards from those of the arrival."""
    after = [of_arrival]
    added = ca.vertsplit(march.state_to_modes @ of_modes, of_arrival.numel())
    for matrix, new in zip(march.state_to_state[:0:-1], added[:0:-1], strict=True):
        after.append(ca.mac(matrix, after[-1], new))
    of_states = ca.vertcat(*reversed(after))
    return march.forcing_to_state @ of_states + march.forcing_to_modes @ of_modes


def _on_diagonal(blocks: ca.MX, count: int) -> ca.MX:
    """Blocks of one sparsity that stand side by side, on the diagonal of one sparse matrix."""
    block = ca.horzsplit(blocks.sparsity(), blocks.shape[1] // count)[0]
    return ca.sparsity_cast(blocks, ca.diagcat(*[block] * count))


@lru_cache(maxsize=32)
def condensed(
    plant: Plant, profile: JointProfile, steps: int, quantities: tuple[str, ...]
) -> Condensed:
    """The functions of a plant, a profile, a number of steps and the limited quantities."""
    return Condensed(plant, profile, steps, quantities)
