"""The motion of candidates with first and second derivatives: the equations of docs/engine.md.

Arrays have a row for each candidate and a column for each step; along the coefficients the columns
of all steps stand once for each coefficient.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from quietarm.models import Plant
from quietarm.ocp.energy import Energy
from quietarm.ocp.limits import Quantity, ask_for_jerk
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.collocation import NODES, Step, step
from quietarm.ocp.simulation.grid import Grid
from quietarm.ocp.simulation.rollout import march, symbolic_rollout
from quietarm.ocp.solvers.energy import energy_with_derivatives
from quietarm.ocp.solvers.node import Node, Path, product, repeat, repeat_table, transpose
from quietarm.ocp.uncertainty import perturb_plant

_STEPS_OF_CSE = 48
"""Common terms are looked for up to these steps, where many rows gain by it: that takes a fifth off
a call, but a time that grows with the square of the steps."""


class Kind(NamedTuple):
    """What candidates of one batch have in common.

    Attributes
    ----------
    quantities : tuple of Quantity
        Limited quantities.
    errors : tuple of str
        What may differ from the plant in a row, as by `perturb_plant`.
    breaks : tuple of float
        Where the motion is not smooth; of values alone.
    """

    plant: Plant
    profile: JointProfile
    steps: int
    quantities: tuple[Quantity, ...]
    errors: tuple[str, ...]
    energy: Energy
    breaks: tuple[float, ...] = ()


def compile_values(kind: Kind, rows: int) -> ca.Function:
    """The values of so many candidates.

    (coefficients, rows of tasks, errors) -> energy, arrival, limited quantities; a row a candidate.
    """
    plant, profile, steps, quantities, names, energy, breaks = kind
    counts = profile.size, 3 + 2 * plant.modes, len(names)
    inputs = [ca.MX.sym("x", rows, count) for count in counts]
    columns = len(Grid(steps, breaks).lengths)
    a, row, errors = (_widen(one, columns) for one in inputs)
    perturbed = perturb_plant(plant, dict(zip(names, errors, strict=True)))
    rollout = symbolic_rollout(
        perturbed, profile, a, row[:3], steps, rows, ask_for_jerk(quantities), breaks,
        initial=ca.horzsplit(inputs[1], 1)[3:], energy=energy,
    )  # fmt: skip
    at_nodes = [
        [
            value
            for quantity in quantities
            for value in quantity.of(joint, perturbed.tip_displacements(state.W), torque)
        ]
        for joint, state, torque in zip(rollout.joints, rollout.states, rollout.torque, strict=True)
    ]
    found = [[rollout.energy], [rollout.arrival], _by_value(at_nodes)]
    options = {"cse": steps <= _STEPS_OF_CSE}
    return ca.Function("values", inputs, [_join(one, rows) for one in found], options)


def compile_derivatives(kind: Kind, rows: int) -> ca.Function:
    """The values of so many candidates with their derivatives.

    (coefficients, rows of tasks, errors, width over which |power| is rounded off, multipliers of
    energy, arrival and limited quantities) -> energy, arrival, limited quantities, their
    derivatives by the coefficients, two factors whose product is the Hessian of the Lagrangian, and
    what the path's own curvature adds to it where it is not linear.
    """
    return _Differentiated(kind, rows).compile()


class _Differentiated:
    """The expressions of `compile_derivatives`, from the motion to the Hessian."""

    def __init__(self, kind: Kind, rows: int) -> None:
        plant, profile, steps, quantities, names, self.definition, _ = kind
        self.size, self.modes, self.shape = profile.size, plant.modes, (rows, steps)
        self.path = Path(profile, steps, ask_for_jerk(quantities), self.shape)
        self.node = Node(plant, self.path, quantities, names, self.definition, self.shape)
        self.point = self.path.count + 3 * plant.modes
        limited = (self.node.count - self.node.own) * NODES * steps
        counts = [self.size, 3 + 2 * plant.modes, len(names), 1, 1, 2 * plant.modes, limited]
        self.inputs = [ca.MX.sym("x", rows, count) for count in counts]
        self.a, row, errors, (self.width,), (self.of_energy,) = (
            _widen(one, steps) for one in self.inputs[:5]
        )
        self.move, self.initial = row[:3], ca.horzsplit(self.inputs[1], 1)[3:]
        self.times, self.length = Grid(steps).columns(rows)
        self.h = self.move[2] * self.length
        self.simulate(perturb_plant(plant, dict(zip(names, errors, strict=True))), errors)
        self.differentiate()

    def simulate(self, plant: Plant, errors: list[ca.MX]) -> None:
        """The motion, and what happens at its nodes with first derivatives."""
        y = [self.path.value(self.a, at, self.move) for at in self.times]
        joints = [self.path.motion(values, self.move) for values in y]
        self.step = step(plant, joints, self.h, forced=True)
        constant, self.columns = self.step.transition()
        W, dW, self.arrival = march(constant, self.columns, self.shape, self.initial)
        modes = _modes_at_nodes(self.step, W, dW)
        self.points = [[*y[j], *modes[j], *self.move, *errors] for j in range(NODES)]
        self.outputs, self.f_y, self.o_v = zip(*map(self.node.evaluate, self.points), strict=True)

    def differentiate(self) -> None:
        """Forward sensitivities: the same steps for each coefficient, driven by f_y y_a."""
        y_a = [self.path_sensitivity(at) for at in self.times]
        along = self.steps_along_coefficients().driven_by([
            force
            for j in range(NODES)
            for force in product(repeat_table(self.f_y[j], self.size), y_a[j], self.modes)
        ])  # fmt: skip
        W, dW, arrival = self.march_along(along)
        modes = _modes_at_nodes(along, W, dW)
        self.arrival_a = ca.horzcat(
            *(ca.reshape(state, self.shape[0], self.size) for state in ca.horzsplit(arrival, 1))
        )
        self.v_a = [[*y_a[j], *modes[j]] for j in range(NODES)]
        self.o_a = [
            product(repeat_table(self.o_v[j], self.size), self.v_a[j], self.node.count)
            for j in range(NODES)
        ]

    def path_sensitivity(self, at: ca.DM) -> list[ca.MX]:
        """Derivatives of y at a node by one coefficient after another, a value each."""
        table, zero = self.path.jacobian(self.a, at, self.move), ca.MX.zeros(*self.shape)
        return [
            ca.horzcat(*(ca.densify(table.get((k, n), zero)) for n in range(self.size)))
            for k in range(self.path.count)
        ]

    def steps_along_coefficients(self) -> Step:
        """The steps once for each coefficient."""
        response, forced = (
            [repeat(row, self.size) for row in rows]
            for rows in (self.step.response, self.step.forced)
        )
        return Step(ca.repmat(self.h, 1, self.size), response, self.modes, forced)

    def march_along(self, along: Step) -> tuple[list[ca.MX], list[ca.MX], ca.MX]:
        """States before every step, from rest, with a column for each step of each coefficient.

        The march goes step by step: there a row stands for each coefficient of each candidate.
        """
        (rows, steps), size = self.shape, self.size
        places = np.arange(rows * steps * size).reshape(size, steps, rows).transpose(1, 0, 2)
        by_step = places.ravel().tolist()
        back = np.argsort(by_step).tolist()
        constant = [ca.reshape(x.nz[by_step], rows * size, steps) for x in along.transition()[0]]
        again = list(range(rows)) * size
        columns = [
            [x[again, :] if isinstance(x, ca.MX) else x for x in column] for column in self.columns
        ]
        *states, arrival = march(constant, columns, (size * rows, steps))
        W, dW = ([ca.reshape(x.nz[back], rows, steps * size) for x in half] for half in states)
        return W, dW, arrival

    def forcing_multipliers(self, of_outputs: list[list[ca.MX]]) -> list[list[ca.MX]]:
        """Backward multipliers of what forces the modes at the nodes: CasADi's reverse sweep."""
        forcing = ca.MX.sym("f", self.shape[0], NODES * self.modes * self.shape[1])
        driven = self.step.driven_by(ca.horzsplit(forcing, self.shape[1]))
        W, dW, arrival = march(driven.transition()[0], self.columns, self.shape)
        lagrangian = ca.dot(self.inputs[5], arrival)
        for j, modes in enumerate(_modes_at_nodes(driven, W, dW)):
            of_modes = self.point_multipliers(j, of_outputs[j])[self.path.count :]
            lagrangian += sum(ca.dot(w, x) for w, x in zip(of_modes, modes, strict=True))
        multipliers = ca.horzsplit(ca.gradient(lagrangian, forcing), self.shape[1])
        return [multipliers[j * self.modes : (j + 1) * self.modes] for j in range(NODES)]

    def point_multipliers(self, j: int, of_outputs: Sequence[ca.MX]) -> list[ca.MX]:
        """Multipliers of the point v at a node, from those of the outputs there."""
        return product(transpose(self.o_v[j]), of_outputs, self.point)

    def hessian_factors(
        self,
        energy_pp: list[list[ca.MX]],
        of_outputs: list[list[ca.MX]],
        of_forcing: list[list[ca.MX]],
    ) -> tuple[list[ca.MX], list[Any]]:
        """Sensitivities, and what second derivatives make of them: their product is the Hessian."""
        left, right = list[ca.MX](), list[Any]()
        for j in range(NODES):
            l_vv = self.node.hessian(self.points[j], [*of_forcing[j], *of_outputs[j]])
            turned = product(repeat_table(l_vv, self.size), self.v_a[j], self.point)
            for i in sorted({row for row, _ in l_vv}):
                left.append(self.v_a[j][i])
                right.append(turned[i])
        power_a = [outputs[0] for outputs in self.o_a]
        for j in range(NODES):
            weights = repeat([self.of_energy * x for x in energy_pp[j]], self.size)
            left.append(power_a[j])
            right.append(sum(w * x for w, x in zip(weights, power_a, strict=True)))
        return left, right

    def path_hessian(
        self, of_outputs: list[list[ca.MX]], of_forcing: list[list[ca.MX]]
    ) -> list[ca.MX]:
        """What the path's own second derivatives add to the Hessian."""
        if self.path.linear:
            return []
        count, total = self.path.count, [ca.MX.zeros(*self.shape)] * self.size**2
        for j in range(NODES):
            by_outputs = self.point_multipliers(j, of_outputs[j])[:count]
            by_forcing = product(transpose(self.f_y[j]), of_forcing[j], count)
            of_y = [x + y for x, y in zip(by_outputs, by_forcing, strict=True)]
            y_aa = self.path.hessian(self.a, self.times[j], self.move, of_y)
            for (i, k), entry in y_aa.items():
                total[i * self.size + k] += entry
        return [ca.sum2(x) for x in total]

    def compile(self) -> ca.Function:
        """All of it as a function."""
        (rows, steps), own = self.shape, self.node.own
        energy, energy_o, energy_pp = energy_with_derivatives(
            self.definition, [o[:own] for o in self.outputs], self.h, self.length, self.width
        )
        of_limited = ca.horzsplit(self.inputs[6], steps)  # value by value, node by node
        of_outputs = [
            [*(self.of_energy * x for x in energy_o[j]), *of_limited[j::NODES]]
            for j in range(NODES)
        ]
        of_forcing = self.forcing_multipliers(of_outputs)
        energy_a = sum(
            by * x
            for j in range(NODES)
            for by, x in zip(repeat(energy_o[j], self.size), self.o_a[j][:own], strict=True)
        )
        found = [
            [energy],
            [self.arrival],
            _by_value([o[own:] for o in self.outputs]),
            [ca.sum2(x) for x in ca.horzsplit(energy_a, steps)],
            [self.arrival_a],
            _by_value([o[own:] for o in self.o_a]),
            *self.hessian_factors(energy_pp, of_outputs, of_forcing),
            self.path_hessian(of_outputs, of_forcing),
        ]
        options = {"cse": rows > 1 and steps <= _STEPS_OF_CSE}
        return ca.Function("derivatives", self.inputs, [_join(x, rows) for x in found], options)


def _widen(matrix: ca.MX, steps: int) -> list[ca.MX]:
    """Its columns, each repeated for every step."""
    return [ca.repmat(column, 1, steps) for column in ca.horzsplit(matrix, 1)]


def _join(columns: Sequence[Any], rows: int) -> ca.MX:
    return ca.densify(ca.horzcat(ca.MX(rows, 0), *columns))


def _by_value(at_nodes: Sequence[Sequence[ca.MX]]) -> list[ca.MX]:
    """From values at each node to nodes for each value."""
    return [x for of_value in zip(*at_nodes, strict=True) for x in of_value]


def _modes_at_nodes(one: Step, W: list[ca.MX], dW: list[ca.MX]) -> list[list[ca.MX]]:
    """W, W' and W'' at every node, from those before the steps."""
    nodes = one.nodes(W, dW, one.accelerations(W, dW))
    return [[*node.W, *node.dW, *node.ddW] for node in nodes]
