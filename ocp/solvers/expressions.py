"""The motion of candidates in rows, as casadi expressions with first and second derivatives.

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
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.collocation import NODES, Step, step
from quietarm.ocp.simulation.grid import Grid
from quietarm.ocp.simulation.rollout import march, symbolic_rollout
from quietarm.ocp.solvers.energy import energy_parts
from quietarm.ocp.solvers.node import NodeFunctions, PathFunctions, Places, elementwise
from quietarm.ocp.task import QUANTITIES, ask_for_jerk
from quietarm.ocp.uncertainty import perturb_plant

_STEPS_OF_CSE = 48
"""Common terms are looked for up to these steps: that takes a fifth off a call, but a time that
grows with the square of the steps."""


class Kind(NamedTuple):
    """What rows have in common.

    Attributes
    ----------
    quantities : tuple of str
        Limited quantities.
    errors : tuple of str
        What may differ from the plant in a row, as by `perturb_plant`.
    breaks : tuple of float
        Where the motion is not smooth; of values alone.
    """

    plant: Plant
    profile: JointProfile
    steps: int
    quantities: tuple[str, ...]
    errors: tuple[str, ...]
    energy: Energy
    breaks: tuple[float, ...] = ()


def function_of_values(kind: Kind, rows: int) -> ca.Function:
    """Compile the values of so many candidates.

    (coefficients, rows of tasks, errors) -> energy, arrival, limited quantities; a row a candidate.
    """
    plant, profile, steps, quantities, names, energy, breaks = kind
    counts = profile.size, 3 + 2 * plant.modes, len(names)
    inputs = [ca.MX.sym("x", rows, count) for count in counts]
    columns = len(Grid(steps, breaks).lengths)
    a, row, errors = (_wide(one, columns) for one in inputs)
    moving = perturb_plant(plant, dict(zip(names, errors, strict=True)))
    rollout = symbolic_rollout(
        moving, profile, a, row[:3], steps, rows, ask_for_jerk(quantities), breaks,
        initial=ca.horzsplit(inputs[1], 1)[3:], energy=energy,
    )  # fmt: skip
    at_nodes = [
        [
            value
            for name in quantities
            for value in QUANTITIES[name].of(joint, moving.tip_displacements(state.W), torque)
        ]
        for joint, state, torque in zip(rollout.joints, rollout.states, rollout.torque, strict=True)
    ]
    found = [[rollout.energy], [rollout.arrival], _in_order(at_nodes)]
    options = {"cse": steps <= _STEPS_OF_CSE}
    return ca.Function("values", inputs, [_beside(one, rows) for one in found], options)


def function_of_derivatives(kind: Kind, rows: int) -> ca.Function:
    """Compile the values of candidates with their derivatives.

    (coefficients, rows of tasks, errors, width over which |power| is rounded off, weights of
    energy, arrival and limited quantities) -> energy, arrival, limited quantities, gradient,
    arrival by the coefficients, limited quantities by them, two factors whose product is the
    curvature of the weighted sum, and what the path's own curvature adds where it is not linear.
    """
    return _Differentiated(kind, rows).function()


class _Differentiated:
    """The expressions of `function_of_derivatives`, from the motion to its curvature."""

    def __init__(self, kind: Kind, rows: int) -> None:
        plant, profile, steps, quantities, names, self.definition, _ = kind
        self.size, self.modes, self.shape = profile.size, plant.modes, (rows, steps)
        self.path = PathFunctions(profile, steps, ask_for_jerk(quantities))
        self.node = NodeFunctions(plant, self.path, quantities, names, self.definition)
        self.outputs, self.own = sum(self.node.rows), self.node.rows[0]
        values = (self.outputs - self.own) * NODES * steps
        counts = [self.size, 3 + 2 * plant.modes, len(names), 1, 1, 2 * plant.modes, values]
        self.inputs = [ca.MX.sym("x", rows, count) for count in counts]
        self.a, row, errors, (self.width,), (self.of_energy,) = (
            _wide(one, steps) for one in self.inputs[:5]
        )
        self.move, self.initial = row[:3], ca.horzsplit(self.inputs[1], 1)[3:]
        self.times, self.length = Grid(steps).columns(rows)
        self.h = self.move[2] * self.length
        self._move(perturb_plant(plant, dict(zip(names, errors, strict=True))), errors)
        self._go_along()

    def _move(self, plant: Plant, errors: list[ca.MX]) -> None:
        """The motion, and what happens at its nodes with first derivatives."""
        inner = [elementwise(self.path.value, self.a, [at], self.move)[0] for at in self.times]
        joints = [self.path.profile.outer(values[:3], *self.move) for values in inner]
        self.step = step(plant, joints, self.h, forced=True)
        constant, self.columns = self.step.transition()
        W, dW, self.arrival = march(constant, self.columns, self.shape, self.initial)
        at_nodes = _modes_at(self.step, W, dW)
        self.points = [(inner[j], at_nodes[j], self.move, errors) for j in range(NODES)]
        self.firsts = [elementwise(self.node.first, *point) for point in self.points]

    def _go_along(self) -> None:
        """Derivatives along the coefficients: the same steps, driven by those of the forcing."""
        (rows, steps), size, node = self.shape, self.size, self.node
        slopes = [self._slopes(at) for at in self.times]
        firsts = [[self._along(entries) for entries in first[1:]] for first in self.firsts]
        one = self.step
        response, forced = ([self._along(row) for row in of] for of in (one.response, one.forced))
        along = Step(self._along([one.h])[0], response, self.modes, forced).driven_by([
            force
            for j in range(NODES)
            for force in _product(node.by_inner, firsts[j][0], slopes[j], self.modes)
        ])  # fmt: skip
        # the march goes step by step: a row for each coefficient of each candidate
        places = np.arange(rows * steps * size).reshape(size, steps, rows).transpose(1, 0, 2)
        by_step = places.ravel().tolist()
        back = np.argsort(by_step).tolist()
        constant = [ca.reshape(x.nz[by_step], rows * size, steps) for x in along.transition()[0]]
        again = list(range(rows)) * size
        columns = [
            [x[again, :] if isinstance(x, ca.MX) else x for x in column] for column in self.columns
        ]
        *halves, arrival = march(constant, columns, (size * rows, steps))
        W, dW = ([ca.reshape(x.nz[back], rows, steps * size) for x in half] for half in halves)
        modes = _modes_at(along, W, dW)
        self.by_arrival = ca.horzcat(
            *(ca.reshape(state, rows, size) for state in ca.horzsplit(arrival, 1))
        )
        self.tangents = [[*slopes[j], *modes[j]] for j in range(NODES)]
        self.outputs_along = [
            _product(node.by_point, firsts[j][1], self.tangents[j], self.outputs)
            for j in range(NODES)
        ]

    def _along(self, entries: Sequence[Any]) -> list[Any]:
        """What holds for every coefficient, beside one another."""
        return [ca.repmat(x, 1, self.size) if isinstance(x, ca.MX) else x for x in entries]

    def _slopes(self, at: ca.DM) -> list[ca.MX]:
        """Derivatives of inner at a node by one coefficient after another, a value each."""
        path = self.path
        if path.linear:
            of_all = zip(*path.slopes(at[0, :]), strict=True)
            return [ca.MX(ca.repmat(ca.horzcat(*of), self.shape[0], 1)) for of in of_all]
        entries = elementwise(path.first, self.a, [at], self.move)[0]
        return [ca.horzcat(*entries[i :: path.count]) for i in range(path.count)]

    def _of_forcing(self, weights: Sequence[Sequence[ca.MX]]) -> list[list[ca.MX]]:
        """Multipliers of what forces the modes at the nodes: the steps backwards, by casadi."""
        rows, steps = self.shape
        forcing = ca.MX.sym("f", rows, NODES * self.modes * steps)
        driven = self.step.driven_by(ca.horzsplit(forcing, steps))
        W, dW, arrival = march(driven.transition()[0], self.columns, self.shape)
        lagrangian, count = ca.dot(self.inputs[5], arrival), self.path.count
        for j, modes in enumerate(_modes_at(driven, W, dW)):
            of_point = self._of_point(j, weights[j])[count:]
            lagrangian += sum(ca.dot(w, x) for w, x in zip(of_point, modes, strict=True))
        multipliers = ca.horzsplit(ca.gradient(lagrangian, forcing), steps)
        return [multipliers[j * self.modes : (j + 1) * self.modes] for j in range(NODES)]

    def _of_point(self, j: int, weights: Sequence[ca.MX]) -> list[ca.MX]:
        """Multipliers of inner and modes at a node, from those of the outputs there."""
        count = self.path.count + 3 * self.modes
        return _product(_transposed(self.node.by_point), self.firsts[j][2], weights, count)

    def _curvature(
        self, bends: list[ca.MX], weights: list[list[ca.MX]], of_forcing: list[list[ca.MX]]
    ) -> tuple[list[ca.MX], list[ca.MX]]:
        """Tangents, and what second derivatives make of them: their product is the curvature."""
        left, right, count = list[ca.MX](), list[ca.MX](), self.path.count + 3 * self.modes
        bent = sorted({row for row, _ in self.node.bends})
        for j in range(NODES):
            second = elementwise(self.node.second, *self.points[j], of_forcing[j], weights[j])[0]
            turned = _product(self.node.bends, self._along(second), self.tangents[j], count)
            left += [self.tangents[j][row] for row in bent]
            right += [turned[row] for row in bent]
        moved = [outputs[0] for outputs in self.outputs_along]
        weighted = self._along([self.of_energy * x for x in bends])
        for j in range(NODES):
            left.append(moved[j])
            right.append(ca.MX(sum(weighted[NODES * i + j] * moved[i] for i in range(NODES))))
        return left, right

    def _of_path(self, weights: list[list[ca.MX]], of_forcing: list[list[ca.MX]]) -> list[ca.MX]:
        """What the path's own second derivatives add to the curvature."""
        if self.path.linear:
            return []
        total, count = None, self.path.count
        for j in range(NODES):
            by_outputs = self._of_point(j, weights[j])[:count]
            places = _transposed(self.node.by_inner)
            by_forcing = _product(places, self.firsts[j][1], of_forcing[j], count)
            of_inner = [one + other for one, other in zip(by_outputs, by_forcing, strict=True)]
            bends = elementwise(self.path.second, self.a, [self.times[j]], self.move, of_inner)[0]
            total = bends if total is None else [x + y for x, y in zip(total, bends, strict=True)]
        return [ca.sum2(x) for x in total or []]

    def function(self) -> ca.Function:
        """All of it, compiled."""
        (rows, steps), own = self.shape, [first[0][: self.own] for first in self.firsts]
        energy, by_own, bends = energy_parts(self.definition, own, self.h, self.length, self.width)
        blocks = ca.horzsplit(self.inputs[6], steps)  # quantity by quantity, node by node
        weights = [
            [*(self.of_energy * x for x in by_own[j]), *blocks[j::NODES]] for j in range(NODES)
        ]
        of_forcing = self._of_forcing(weights)
        along = sum(
            by * x
            for j, outputs in enumerate(self.outputs_along)
            for by, x in zip(self._along(by_own[j]), outputs[: self.own], strict=True)
        )
        gradient = [ca.sum2(x) for x in ca.horzsplit(along, steps)]
        left, right = self._curvature(bends, weights, of_forcing)
        found = [
            [energy],
            [self.arrival],
            _in_order([first[0][self.own :] for first in self.firsts]),
            gradient,
            [self.by_arrival],
            _in_order([outputs[self.own :] for outputs in self.outputs_along]),
            left,
            right,
            self._of_path(weights, of_forcing),
        ]
        outputs = [_beside(one, rows) for one in found]
        return ca.Function("derivatives", self.inputs, outputs)


def _wide(matrix: ca.MX, steps: int) -> list[ca.MX]:
    """Its columns, each repeated for every step."""
    return [ca.repmat(column, 1, steps) for column in ca.horzsplit(matrix, 1)]


def _beside(columns: Sequence[Any], rows: int) -> ca.MX:
    return ca.densify(ca.horzcat(ca.MX(rows, 0), *columns))


def _in_order(at_nodes: Sequence[Sequence[ca.MX]]) -> list[ca.MX]:
    """From values at each node to nodes for each value."""
    return [x for of_value in zip(*at_nodes, strict=True) for x in of_value]


def _modes_at(one: Step, W: list[ca.MX], dW: list[ca.MX]) -> list[list[ca.MX]]:
    """W, W' and W'' at every node, from those before the steps."""
    nodes = one.nodes(W, dW, one.accelerations(W, dW))
    return [[*node.W, *node.dW, *node.ddW] for node in nodes]


def _product(
    places: Places, entries: Sequence[ca.MX], by: Sequence[ca.MX], rows: int
) -> list[ca.MX]:
    """A small sparse matrix times a column, entry by entry."""
    found: list[Any] = [ca.MX.zeros(*by[0].shape)] * rows
    seen = set[int]()
    for (row, column), entry in zip(places, entries, strict=True):
        term = entry * by[column]
        found[row] = found[row] + term if row in seen else term
        seen.add(row)
    return found


def _transposed(places: Places) -> Places:
    return [(column, row) for row, column in places]
