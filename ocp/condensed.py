"""The motion as a function of the profile's coefficients alone, with exact derivatives.

The steps are affine in the state, so that the states follow from the coefficients by a recursion,
their first derivatives by another beside it, and second derivatives by one that runs backwards.
What a step does is differentiated once, by the values that the profile's `inner` gives at its nodes
and by the state before it; its derivatives do not depend on the number of coefficients. They are
mapped over the steps and joined there.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import casadi as ca
import numpy as np

from models import Plant
from ocp.collocation import GAUSS_NODES, NODES, mesh
from ocp.interrupts import keep_interrupts
from ocp.objective import beyond_quadratic, energy_derivatives
from ocp.profile import JointProfile
from ocp.step_model import JOINT, LiftedStep, groups_of
from ocp.symbols import backwards

_INNER = NODES * JOINT
_LEAST_SLOPE = 0.1
"""Least slope of the power that its zeros' curvature counts with, in peak powers a duration."""


class Sensitivities(NamedTuple):
    """Values along the steps, with their first derivatives, as expressions; everything scaled.

    Attributes
    ----------
    arrival : MX, shape (states, 1)
        State on arrival.
    by_step : MX, shape (rows, steps)
        Outputs of every step but the state: the power and each limited quantity at its nodes.
    arrival_first : MX, shape (states, coefficients)
        First derivatives of the state on arrival.
    outputs_first : MX, shape (coefficients, rows * steps)
        Those of the outputs, step by step.
    """

    arrival: ca.MX
    by_step: ca.MX
    arrival_first: ca.MX
    outputs_first: ca.MX


class Condensed:
    """A plant's motion along a profile in a number of steps, as casadi functions.

    All of them take the coefficients, the move (start, target, duration) and the scales (of every
    state, then of the power and of each limited quantity).

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
        Entries of the state; outputs of a step without the state; number of scales.
    groups : list of Group
        The outputs by name, the state first.
    lengths : ndarray, shape (steps,)
        The steps' lengths as shares of the duration.
    simulate : Function
        State on arrival (states, 1) and outputs of every step (rows, steps), scaled.
    figures : Function
        States after every step (states, steps), outputs (rows, steps), energy by
        `resolved_energy`, scaled.
    """

    @keep_interrupts()  # casadi loses a Ctrl-C
    def __init__(
        self, plant: Plant, profile: JointProfile, steps: int, quantities: tuple[str, ...]
    ) -> None:
        self.size, self.steps, self.states = profile.size, steps, 2 * plant.modes
        self.groups = groups_of(plant, quantities)
        self.rows = sum(group.rows for group in self.groups[1:])
        self.scales = self.states + len(self.groups) - 1
        self._index = ca.DM(np.arange(steps)).T
        self.lengths = mesh(self._index, steps)[1].full().ravel()
        self._steps_of(plant, profile)
        self._profile_of(profile)
        inputs = self.inputs()
        after, outputs = self._march(*inputs)[1:]
        self.simulate = ca.Function("simulate", [*inputs], [after[:, -1], outputs])
        self.figures = ca.Function("figures", [*inputs], [after, outputs, self.energy(outputs)[0]])

    def inputs(self) -> tuple[ca.MX, ca.MX, ca.MX]:
        """Fresh symbols for coefficients, move and scales."""
        sizes = {"a": self.size, "move": 3, "scale": self.scales}
        a, move, scale = (ca.MX.sym(name, size) for name, size in sizes.items())
        return a, move, scale

    # -- one step, and the profile at its nodes --

    def _steps_of(self, plant: Plant, profile: JointProfile) -> None:
        inner, state = ca.SX.sym("inner", _INNER), ca.SX.sym("z", self.states)
        h, move, scale = ca.SX.sym("h"), ca.SX.sym("move", 3), ca.SX.sym("scale", self.scales)
        ends = ca.vertsplit(move)
        joint = ca.vertcat(
            *(
                ca.vertcat(*profile.outer(ca.vertsplit(at_node), *ends))
                for at_node in ca.vertsplit(inner, JOINT)
            )
        )
        lifted = LiftedStep(plant, self.groups, state, h, scale)
        multipliers = ca.SX.sym("lam", lifted.outputs.numel())
        value = lifted.of(joint, lifted.outputs)
        first, second = lifted.derivatives(joint, inner, state, multipliers)
        inputs, options = [state, inner, h, move, scale], {"cse": True}
        after, outputs = value[: self.states], value[self.states :]
        self._value = ca.Function("step", inputs, [after, outputs], options)
        self._first = ca.Function("step_first", inputs, [first], options)
        self._second = ca.Function("step_second", [*inputs, multipliers], [second], options)

    def _profile_of(self, profile: JointProfile) -> None:
        a, index, move = ca.SX.sym("a", self.size), ca.SX.sym("k"), ca.SX.sym("move", 3)
        begin, length = mesh(index, self.steps)
        ends = ca.vertsplit(move)
        values = [profile.inner(ca.vertsplit(a), begin + c * length, *ends) for c in GAUSS_NODES]
        inner = ca.vertcat(*(value for at_node in values for value in at_node))
        weights = ca.SX.sym("w", _INNER)
        inputs, options = [a, index, move], {"cse": True}
        first = ca.densify(ca.jacobian(inner, a))
        self._inner = ca.Function("inner", inputs, [inner, ends[2] * length], options)
        self._inner_first = ca.Function("inner_first", inputs, [first], options)
        self._inner_second = None
        if not ca.is_linear(inner, a):
            second = ca.densify(ca.hessian(ca.dot(weights, inner), a)[0])
            self._inner_second = ca.Function("inner_second", [*inputs, weights], [second], options)

    # -- all steps --

    def _along(self, function: ca.Function, shared: Sequence[int], *arguments: ca.MX) -> ca.MX:
        """A function over all steps, side by side; some of its arguments are the same for all."""
        mapped = function.map(f"{function.name()}_all", "serial", self.steps, list(shared), [])
        return mapped(*arguments)

    def _recursion(self, function: ca.Function, first: ca.MX, *arguments: ca.MX) -> list[ca.MX]:
        """A function over all steps, whose first output is its first input at the next."""
        return function.mapaccum(f"{function.name()}_all", self.steps)(first, *arguments)

    def _march(self, a: ca.MX, move: ca.MX, scale: ca.MX) -> tuple[list[ca.MX], ca.MX, ca.MX]:
        """What a step starts from (state, inner, length, move, scale); states after it; outputs."""
        inner, lengths = self._along(self._inner, [0, 2], a, self._index, move)
        same = [ca.repmat(value, 1, self.steps) for value in (move, scale)]
        rest = ca.DM.zeros(self.states)
        after, outputs = self._recursion(self._value, rest, inner, lengths, *same)
        before = ca.horzcat(rest, after[:, :-1])
        return [before, inner, lengths, move, scale], after, outputs

    def _join(self, a: ca.MX, move: ca.MX, firsts: ca.MX) -> tuple[ca.MX, ca.MX, ca.MX]:
        """Derivatives by the coefficients: of inner and state before each step, output, arrival."""
        inner_first = self._along(self._inner_first, [0, 2], a, self._index, move)
        state = ca.MX.sym("S", self.states, self.size)
        of_step = ca.MX.sym("D", self.states + self.rows, _INNER + self.states)
        of_inner = ca.MX.sym("B", _INNER, self.size)
        moves = ca.vertcat(of_inner, state)
        after = of_step @ moves
        join = ca.Function(
            "join",
            [state, of_step, of_inner],
            [after[: self.states, :], moves.T, after[self.states :, :].T],
        )
        rest = ca.DM.zeros(self.states, self.size)
        states, directions, outputs = self._recursion(join, rest, firsts, inner_first)
        return directions, outputs, states[:, -self.size :]

    def sensitivities(self, a: ca.MX, move: ca.MX, scale: ca.MX) -> Sensitivities:
        """Values and first derivatives."""
        begins, after, outputs = self._march(a, move, scale)
        firsts = self._along(self._first, [3, 4], *begins)
        _, of_outputs, of_arrival = self._join(a, move, firsts)
        return Sensitivities(after[:, -1], outputs, of_arrival, of_outputs)

    def curvature(
        self,
        inputs: tuple[ca.MX, ca.MX, ca.MX],
        of_arrival: ca.MX,
        of_outputs: ca.MX,
        bends: ca.MX | None = None,
    ) -> ca.MX:
        """Second derivatives by the coefficients of arrival and outputs times their multipliers.

        Parameters
        ----------
        inputs : tuple of MX
            Coefficients, move, scales.
        of_arrival : MX, shape (states, 1)
            Multipliers of the state on arrival.
        of_outputs : MX, shape (rows, steps)
            Multipliers of the outputs.
        bends : MX, shape (NODES, NODES * steps), optional
            Second derivatives of what is asked by the power at the nodes, step by step.

        Returns
        -------
        MX, shape (coefficients, coefficients)
            Symmetric.
        """
        a, move, scale = inputs
        begins, _, _ = self._march(a, move, scale)
        firsts = self._along(self._first, [3, 4], *begins)
        directions, outputs_first, _ = self._join(a, move, firsts)
        multipliers = ca.vertcat(self._adjoint(firsts, of_arrival, of_outputs), of_outputs)
        seconds = self._along(self._second, [3, 4], *begins, multipliers)
        hessian = self._sandwich(seconds, directions)
        if bends is not None:
            of_power = self._rows_of(outputs_first, 0, NODES)
            hessian += self._sandwich(bends, of_power)
        if self._inner_second is not None:
            of_step = ca.MX.sym("D", self.states + self.rows, _INNER + self.states)
            lam = ca.MX.sym("lam", self.states + self.rows)
            weigh = ca.Function("weigh", [of_step, lam], [of_step[:, :_INNER].T @ lam])
            weights = self._along(weigh, [], firsts, multipliers)
            blocks = self._along(self._inner_second, [0, 2], a, self._index, move, weights)
            flat = ca.reshape(blocks, self.size**2, self.steps)
            hessian += ca.reshape(ca.sum2(flat), self.size, self.size)
        return hessian

    def _adjoint(self, firsts: ca.MX, of_arrival: ca.MX, of_outputs: ca.MX) -> ca.MX:
        """Multipliers of the state after every step, by the recursion backwards from arrival."""
        after, of_rows = ca.MX.sym("lam", self.states), ca.MX.sym("w", self.rows)
        width = _INNER + self.states
        of_step = ca.MX.sym("D", self.states + self.rows, width)
        before = of_step[:, _INNER:].T @ ca.vertcat(after, of_rows)
        adjoint = ca.Function("adjoint", [after, of_rows, of_step], [before, after])
        backward = backwards(of_outputs, 1), backwards(firsts, width)
        return backwards(self._recursion(adjoint, of_arrival, *backward)[1], 1)

    def _sandwich(self, blocks: ca.MX, directions: ca.MX) -> ca.MX:
        """Sum over the steps of directions . block . directions^T, all of them side by side."""
        width = blocks.shape[0]
        block, direction = ca.MX.sym("H", width, width), ca.MX.sym("T", self.size, width)
        times = ca.Function("times", [block, direction], [direction @ block])
        return self._along(times, [], blocks, directions) @ directions.T

    def _rows_of(self, outputs_first: ca.MX, first: int, rows: int) -> ca.MX:
        """The columns of `outputs_first` that belong to some of every step's outputs."""
        places = np.arange(self.steps)[:, None] * self.rows + first + np.arange(rows)
        return outputs_first[:, places.ravel().tolist()]

    def of_group(self, sensitivities: Sensitivities, name: str) -> tuple[ca.MX, ca.MX]:
        """Values of one quantity at all nodes, and their first derivatives, a row a value."""
        group = next(group for group in self.groups if group.name == name)
        first = group.first - self.states
        values = ca.vec(sensitivities.by_step[first : first + group.rows, :])
        return values, self._rows_of(sensitivities.outputs_first, first, group.rows).T

    # -- the energy --

    def energy(self, by_step: ca.MX) -> tuple[ca.MX, ca.MX, ca.MX]:
        """F2 by `resolved_energy`, scaled by duration and power, and its derivatives by the power.

        Parameters
        ----------
        by_step : MX, shape (rows, steps)
            Outputs of the steps.

        Returns
        -------
        energy : MX
            The energy.
        gradient : MX, shape (NODES, steps)
            Its derivatives by the power at the nodes.
        bends : MX, shape (NODES, NODES * steps)
            Its second derivatives where the zeros of the power move, step by step.
        """
        power, lengths = by_step[:NODES, :], ca.DM(self.lengths).T
        to_cubic, to_quartic = beyond_quadratic(self.steps)
        flat = ca.vec(power.T).T
        least = _LEAST_SLOPE * lengths
        energies, gradients, bends = self._along(
            energy_derivatives(), [], power, flat @ to_cubic, flat @ to_quartic, least
        )
        gradients *= ca.repmat(lengths, NODES + 2, 1)
        beyond = to_cubic @ gradients[NODES, :].T + to_quartic @ gradients[NODES + 1, :].T
        gradient = gradients[:NODES, :] + ca.reshape(beyond, self.steps, NODES).T
        weights = ca.DM(np.repeat(self.lengths, NODES)).T
        return ca.sum2(lengths * energies), gradient, bends * ca.repmat(weights, NODES, 1)


@lru_cache(maxsize=16)
def condensed(
    plant: Plant, profile: JointProfile, steps: int, quantities: tuple[str, ...]
) -> Condensed:
    """The functions of a plant, a profile, a number of steps and the limited quantities."""
    return Condensed(plant, profile, steps, quantities)
