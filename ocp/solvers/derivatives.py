"""The motion of candidates with first and second derivatives: the equations of docs/engine.md.

Arrays have a row for each candidate and a column for each step; along the coefficients the columns
of all steps stand once for each coefficient.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from quietarm.models import Expression, Plant
from quietarm.ocp.energy import Energy
from quietarm.ocp.limits import ask_for_jerk
from quietarm.ocp.sample import total
from quietarm.ocp.simulation.collocation import (
    GAUSS_WEIGHTS,
    NODES,
    TO_QUADRATIC,
    Step,
    collocate,
    modal_system,
)
from quietarm.ocp.simulation.evaluator import MOST_STEPS_OF_CSE
from quietarm.ocp.simulation.objective import quadratic, quadratic_zeros
from quietarm.ocp.simulation.rollout import Simulation, march, modes_at_nodes
from quietarm.ocp.simulation.rows import join, widen
from quietarm.ocp.solvers.node import Node, PathTable, path_of, product, transpose
from quietarm.ocp.uncertainty import perturb_plant


class MovingZero(NamedTuple):
    """A zero of the power: its weights of the power at the nodes; twice the inverse of the slope.

    The second derivatives of the mean of |power| are the sum over the zeros of `bend` times the
    product of two weights.
    """

    weights: list[Expression]
    bend: Expression


class EnergyDerivatives(NamedTuple):
    """An energy, a row a candidate, with derivatives by the power and the smooth part at the nodes.

    Second derivatives are by the power: `by_power_twice` at each node by itself, and zeros whose
    bends have the energy's factor.
    """

    value: ca.MX
    by_power: ca.MX
    by_smooth: ca.MX
    by_power_twice: ca.MX
    zeros: list[MovingZero]


def differentiate_energy(
    energy: Energy, power: ca.MX, smooth: Sequence[ca.MX], h: ca.MX, length: ca.DM, width: ca.MX
) -> EnergyDerivatives:
    """The derivatives of an energy on steps `h` long [s], of the move `length`.

    Where the width is positive, |p| is rounded off: the root of p^2 + width^2, at the nodes.
    """
    steps = h.shape[1]
    share = energy.absolute
    of_nodes = ca.horzcat(*(w * h for w in GAUSS_WEIGHTS))
    tiny = 1e-300  # where the power is zero
    rms = ca.sqrt(ca.sum2(power * power) / power.shape[1]) + tiny
    # Smaller slopes of the power at its zeros count as this share of its root mean square.
    least_slope = 1e-4
    of_sharp, zeros = differentiate_absolute(
        ca.horzsplit(power, steps), least_slope * ca.repmat(rms, 1, steps) * length
    )
    rounded = ca.sqrt(power * power + width * width)
    is_rounded = width > 0
    sharp_slope = ca.repmat(h, 1, NODES) * ca.horzcat(*of_sharp)
    slope = ca.if_else(
        is_rounded,
        of_nodes * power / (rounded + tiny),
        sharp_slope,
    )
    # of |p| itself Euler's theorem: it is homogeneous
    absolute = ca.sum2(
        ca.if_else(
            is_rounded,
            of_nodes * rounded,
            sharp_slope * power,
        )
    )
    factor = ca.if_else(is_rounded[:, :steps], 0.0, share * h)
    return EnergyDerivatives(
        value=share * absolute + sum(ca.sum2(of_nodes * value) for value in smooth),
        by_power=share * slope,
        by_smooth=of_nodes,
        by_power_twice=share * of_nodes * width**2 / (rounded**3 + tiny),
        zeros=[zero._replace(bend=factor * zero.bend) for zero in zeros],
    )


def differentiate_absolute(
    power: Sequence[Expression], least_slope: Expression
) -> tuple[list[Expression], list[MovingZero]]:
    """Derivatives by the power at its nodes of the mean of |power| on a step.

    The gradient is that with the zeros held fixed, since the power is zero there, and continuous.
    Second derivatives come from the zeros that move; the rest is linear in the power. Where zeros
    meet, that curvature is without bound, though only there: the slope counts as `least_slope` at
    least.
    """
    c = quadratic(power)
    basis = list(zip(*TO_QUADRATIC))
    places = quadratic_zeros(c)
    integrals = [[x * (a + x * (b / 2 + x * (d / 3))) for a, b, d in basis] for x in places]
    gradient: list[Expression] = [0.0] * NODES
    for begin, end in pairwise([[0.0] * NODES, *integrals, GAUSS_WEIGHTS]):
        part = [after - before for before, after in zip(begin, end)]
        sign = ca.sign(sum(w * p for w, p in zip(part, power)))
        gradient = [old + sign * w for old, w in zip(gradient, part)]
    real = c[1] * c[1] > 4 * c[0] * c[2]  # else both stand at the quadratic's extreme
    zeros = [
        MovingZero(
            [a + x * (b + x * d) for a, b, d in basis],
            real * (x > 0) * (x < 1) * 2 / ca.fmax(ca.fabs(c[1] + 2 * x * c[2]), least_slope),
        )
        for x in places
    ]
    return gradient, zeros


def compile_derivatives(simulation: Simulation, rows: int) -> ca.Function:
    """The values of so many candidates with their derivatives.

    (coefficients, rows of tasks, errors, width over which |power| is rounded off, multipliers of
    energy, arrival and limited quantities) -> energy, arrival, limited quantities, their
    derivatives by the coefficients, two factors whose product is the Hessian of the Lagrangian, and
    what the path's own curvature adds to it where it is not linear.
    """
    return _Differentiated(simulation, rows).compile()


def compile_arrivals(simulation: Simulation, rows: int) -> ca.Function:
    """The states on arrival alone of so many candidates, with their derivatives.

    (coefficients, rows of tasks, errors, multipliers of the arrival) -> arrival, its derivatives by
    the coefficients, and of the weighted sum what `compile_derivatives` gives of the Lagrangian.
    """
    return _Differentiated(simulation, rows, only_arrivals=True).compile_arrivals()


class _Differentiated:
    """The expressions of `compile_derivatives`, from the motion to the Hessian."""

    def __init__(self, simulation: Simulation, rows: int, only_arrivals: bool = False) -> None:
        plant = simulation.plant
        profile = simulation.profile
        names = simulation.errors
        self.definition = simulation.energy
        mesh = simulation.mesh
        steps = len(mesh.lengths)
        nodes = NODES * steps
        self.size = profile.size
        self.modes = plant.modes
        self.shape = (rows, steps)
        self.path = path_of(
            profile,
            mesh,
            ask_for_jerk(simulation.quantities) and not only_arrivals,
            rows,
        )
        self.node = Node(simulation, self.path, (rows, nodes), only_arrivals)
        limited = (self.node.count - self.node.of_energy) * nodes
        counts = [self.size, 3 + 2 * plant.modes, len(names), 1, 1, 2 * plant.modes, limited]
        self.inputs = [ca.MX.sym("x", rows, count) for count in counts]
        self.a, row, errors, (self.width,), (self.of_energy,) = (
            widen(column, nodes) for column in self.inputs[:5]
        )
        self.move = row[:3]
        self.initial = ca.horzsplit(self.inputs[1], 1)[3:]
        _, self.length = mesh.columns(rows)
        self.h = self.move[2][:, :steps] * self.length
        self.simulate(perturb_plant(plant, dict(zip(names, errors))), errors)
        self.differentiate()

    def simulate(self, plant: Plant, errors: list[ca.MX]) -> None:
        """The motion, and what happens at its nodes with first derivatives."""
        y = self.path.value(self.a, self.move)
        system = modal_system(plant, self.path.motion(y, self.move))
        self.step = collocate(system, self.h, forced=True)
        constant, self.columns = self.step.transition()
        W, dW, self.arrival = march(
            constant,
            self.columns,
            self.shape,
            self.initial,
        )
        v = [*y, *_modes_at_nodes(self.step, W, dW)]
        self.count = len(v)
        self.point = [*v, *self.move, *errors]
        self.outputs, self.f_y, self.o_v = self.node.evaluate(self.point)

    def differentiate(self) -> None:
        """Forward sensitivities: the same steps for each coefficient, driven by f_y y_a."""
        y_a = self.path_sensitivity()
        f_y = self.along(self.f_y)
        o_v = self.along(self.o_v)
        along = self.steps_along_coefficients().driven_by(
            [force for j in range(NODES) for force in product(f_y[j], y_a[j], self.modes)]
        )
        W, dW, self.arrival_a = self.march_along(along)
        nodes = along.nodes(W, dW, along.accelerations(W, dW))
        self.v_a = [[*y, *node.W, *node.dW, *node.ddW] for y, node in zip(y_a, nodes)]
        self.o_a = [product(o_v[j], self.v_a[j], self.node.count) for j in range(NODES)]

    def path_sensitivity(self) -> list[list[ca.MX]]:
        """Derivatives of y by one coefficient beside another, of each node a value each."""
        table = self.path.jacobian(self.a, self.move)
        zero = ca.DM.zeros(*self.width.shape)
        by_node = [
            [ca.horzsplit(table.get((k, n), zero), self.shape[1]) for n in range(self.size)]
            for k in range(self.path.count)
        ]
        return [
            [ca.densify(ca.MX(ca.horzcat(*(at[j] for at in value)))) for value in by_node]
            for j in range(NODES)
        ]

    def along(self, table: PathTable) -> list[PathTable]:
        """A table at each node, its entries once for each coefficient, side by side."""
        steps = self.shape[1]
        entries = {place: ca.horzsplit(entry, steps) for place, entry in table.items()}
        return [{place: self.repeat(at[j]) for place, at in entries.items()} for j in range(NODES)]

    def repeat(self, entry: Any) -> Any:
        """An entry once for each coefficient, side by side; numbers as they are."""
        return ca.repmat(entry, 1, self.size) if isinstance(entry, ca.MX) else entry

    def steps_along_coefficients(self) -> Step:
        """The steps once for each coefficient."""
        response, forced = (
            [[self.repeat(entry) for entry in row] for row in rows]
            for rows in (self.step.response, self.step.forced)
        )
        return Step(self.repeat(self.h), response, self.modes, forced)

    def march_along(self, along: Step) -> tuple[list[ca.MX], list[ca.MX], ca.MX]:
        """States before every step, from rest, once for each coefficient."""
        constant = [_swap(x, self.size) for x in along.column(0)]
        W, dW, arrival = march(constant, self.columns, self.shape, width=self.size)
        steps = self.shape[1]
        W, dW = ([_swap(x, steps) for x in half] for half in (W, dW))
        return W, dW, arrival

    def forcing_multipliers(self, of_outputs: list[ca.MX]) -> list[ca.MX]:
        """Backward multipliers of what forces the modes at the nodes.

        What a step changes of the Lagrangian is linear in its state and forcing, so that CasADi's
        gradients are coefficients; that by the state drives the multipliers backwards.
        """
        rows, steps = self.shape
        m = self.modes
        state = ca.MX.sym("z", rows * 2 * m, steps)
        forcing = ca.MX.sym("f", rows, NODES * m * steps)
        z = ca.vertsplit(state, rows)
        driven = self.step.driven_by(ca.horzsplit(forcing, steps))
        here = ca.MX(0)
        if of_outputs:
            of_modes = self.point_multipliers(of_outputs)[self.path.count :]
            modes = _modes_at_nodes(driven, z[:m], z[m:])
            here = sum(ca.dot(w, x) for w, x in zip(of_modes, modes))
        of_state = ca.vertsplit(ca.gradient(here, state), rows)
        transposed = [list(row) for row in zip(*self.columns)]
        W, dW, _ = march(
            [_reverse(x) for x in of_state],
            [[_reverse(x) for x in column] for column in transposed],
            self.shape,
            ca.horzsplit(self.inputs[5], 1),
        )
        of_after = [_reverse(x) for x in (*W, *dW)]
        after = sum(ca.dot(w, x) for w, x in zip(of_after, driven.column(0)))
        by_forcing = ca.horzsplit(ca.gradient(here + after, forcing), steps)
        return [ca.horzcat(*by_forcing[i::m]) for i in range(m)]

    def point_multipliers(self, of_outputs: Sequence[ca.MX]) -> list[ca.MX]:
        """Multipliers of the point v, from those of the outputs there."""
        return product(transpose(self.o_v), of_outputs, self.count)

    def hessian_factors(
        self,
        energies: Sequence[EnergyDerivatives],
        of_outputs: list[ca.MX],
        of_forcing: list[ca.MX],
    ) -> tuple[list[ca.MX], list[ca.MX]]:
        """Sensitivities, and what second derivatives make of them: their product is the Hessian."""
        steps = self.shape[1]
        pairs = list[tuple[Any, Any]]()
        l_vv = self.node.hessian(self.point, [*of_forcing, *of_outputs])
        for v_a, table in zip(self.v_a, self.along(l_vv)):
            by_v = product(table, v_a, self.count)
            pairs += [(v_a[i], by_v[i]) for i in sorted({row for row, _ in table})]
        bends = list[tuple[Any, Any]]()
        for joint, energy in enumerate(energies):
            power_a = [outputs[joint] for outputs in self.o_a]
            at_nodes = ca.horzsplit(self.of_energy * energy.by_power_twice, steps)
            bends += zip(at_nodes, power_a)
            for weights, bend in energy.zeros:
                terms = zip(map(self.repeat, weights), power_a)
                bends.append((self.of_energy[:, :steps] * bend, sum(w * x for w, x in terms)))
        pairs += [(x, self.repeat(bend) * x) for bend, x in bends]
        if not pairs:  # what forces the modes is linear
            return [], []
        factors, turned = zip(*pairs)
        return list(factors), list(turned)

    def path_hessian(self, of_outputs: list[ca.MX], of_forcing: list[ca.MX]) -> list[ca.MX]:
        """Terms of the Hessian from the path's own second derivatives."""
        if self.path.linear:
            return []
        count = self.path.count
        of_y = product(transpose(self.f_y), of_forcing, count)
        if of_outputs:
            by_outputs = self.point_multipliers(of_outputs)[:count]
            of_y = [x + y for x, y in zip(by_outputs, of_y)]
        y_aa = self.path.hessian(self.a, self.move, of_y)
        zero = ca.MX.zeros(self.shape[0], 1)
        places = [(i, k) for i in range(self.size) for k in range(self.size)]
        return [ca.sum2(y_aa[place]) if place in y_aa else zero for place in places]

    def compile(self) -> ca.Function:
        """All of it as a function."""
        _, steps = self.shape
        of_energy = self.node.of_energy
        powers = self.outputs[: self.node.powers]
        smooth = self.outputs[self.node.powers : of_energy]
        energies = [  # the smooth part, of all joints, counts with the first
            differentiate_energy(
                self.definition, power, [] if joint else smooth, self.h, self.length, self.width
            )
            for joint, power in enumerate(powers)
        ]
        energy_o = [*(energy.by_power for energy in energies), energies[0].by_smooth][:of_energy]
        of_outputs = [self.of_energy * x for x in energy_o]
        of_outputs += ca.horzsplit(self.inputs[6], NODES * steps)
        of_forcing = self.forcing_multipliers(of_outputs)
        along = [[self.repeat(x) for x in ca.horzsplit(by, steps)] for by in energy_o]
        energy_a = sum(along[i][j] * self.o_a[j][i] for i in range(of_energy) for j in range(NODES))
        limited_a = zip(*(outputs[of_energy:] for outputs in self.o_a))
        blocks = [
            [total([energy.value for energy in energies])],
            [self.arrival],
            self.outputs[of_energy:],
            [ca.sum2(x) for x in ca.horzsplit(energy_a, steps)],
            [self.arrival_a],
            [x for of_value in limited_a for x in of_value],
            *self.hessian_factors(energies, of_outputs, of_forcing),
            self.path_hessian(of_outputs, of_forcing),
        ]
        return self.function("derivatives", self.inputs, blocks)

    def compile_arrivals(self) -> ca.Function:
        """Compile the function of arrivals and their derivatives, without outputs."""
        of_forcing = self.forcing_multipliers([])
        blocks = [
            [self.arrival],
            [self.arrival_a],
            *self.hessian_factors([], [], of_forcing),
            self.path_hessian([], of_forcing),
        ]
        inputs = [*self.inputs[:3], self.inputs[5]]
        return self.function("arrivals", inputs, blocks)

    def function(
        self, name: str, inputs: Sequence[ca.MX], blocks: Sequence[Sequence[Any]]
    ) -> ca.Function:
        """Blocks of columns as a function."""
        rows, steps = self.shape
        outputs = [join(x, rows) for x in blocks]
        # Common terms are looked for where there are more rows than these.
        options = {"cse": rows > 4 and steps <= MOST_STEPS_OF_CSE}
        return ca.Function(name, [*inputs], outputs, options)


def _swap(entry: ca.MX, groups: int) -> ca.MX:
    """Regroup columns: the first of each group, then the second of each, and so on."""
    return entry[:, np.arange(entry.shape[1]).reshape(groups, -1).T.ravel().tolist()]


def _reverse(by_step: Any) -> Any:
    """Turn the steps round, from the last to the first."""
    several = isinstance(by_step, ca.MX) and by_step.shape[1] > 1
    return by_step[:, ::-1] if several else by_step


def _modes_at_nodes(step: Step, W: list[ca.MX], dW: list[ca.MX]) -> list[ca.MX]:
    """W, W' and W'' at the nodes, from those before the steps."""
    state = modes_at_nodes(step.nodes(W, dW, step.accelerations(W, dW)))
    return [*state.W, *state.dW, *state.ddW]
