"""From a task to a nonlinear program over all joint motions.

There is no profile. Unknowns of every interval are its acceleration (or jerk), and the joint's
angle and speed and the modes before it, so that all derivatives are sparse. Lengths of intervals
and limits are parameters of the compiled program. The power has a slack at the three Gauss nodes of
every interval, where it is smooth: sampled only at the grid, the solver would hide energy between
the samples.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from quietarm.models import Plant
from quietarm.ocp.floor.step_model import JOINT, LiftedStep, groups_of
from quietarm.ocp.floor.symbols import split
from quietarm.ocp.profiles.free_motion import joint_after
from quietarm.ocp.program.ipopt import LagrangianHessian, Options, Point, Stop, ipopt, run_ipopt
from quietarm.ocp.simulation.collocation import GAUSS_NODES, GAUSS_WEIGHTS, NODES
from quietarm.ocp.task.quantities import QUANTITIES


class FreeStep:
    """One interval as a small dense casadi function with its first and second derivatives.

    Its inputs are the scaled unknowns of an interval (angle, speed, acceleration, for a smooth
    motion the jerk, and W, W' before it), its length [s] and the scales of the unknowns and of the
    outputs; its outputs are angle, speed (acceleration) and modes after it, scaled likewise, then
    power and limited quantities at the Gauss nodes.
    """

    def __init__(self, plant: Plant, smooth: bool, quantities: tuple[str, ...]) -> None:
        self.joint, modes = (4 if smooth else 3), 2 * plant.modes
        self.unknowns = self.joint + modes
        self.after = [i for i in range(self.unknowns) if i != self.joint - 1]
        """What is handed on to the next interval: all but the last derivative of the joint."""
        groups = groups_of(plant, quantities)
        self.scales = self.unknowns + len(groups) - 1
        self.groups = groups[1:]
        """Power and limited quantities: the outputs at the nodes."""
        self.outputs = {group.name: group.rows for group in self.groups}

        w, h = ca.SX.sym("w", self.unknowns), ca.SX.sym("h")
        scale = ca.SX.sym("scale", self.scales)
        c, modal_state = w[: self.joint], w[self.joint :]
        entries = ca.vertsplit(c * scale[: self.joint])
        q = ca.vertcat(*(ca.vertcat(*joint_after(entries, x * h)[:JOINT]) for x in GAUSS_NODES))
        lifted = LiftedStep(plant, groups, modal_state, h, scale[self.joint :])
        multipliers = ca.SX.sym("lam", lifted.outputs.numel())
        first, second = lifted.derivatives(q, c, modal_state, multipliers)
        end = ca.vertcat(*joint_after(entries, h)[: self.joint - 1]) / scale[: self.joint - 1]
        by_joint = ca.horzcat(ca.jacobian(end, c), ca.SX(end.numel(), modes))
        inputs, options = [w, h, scale], {"cse": True}
        self.value = ca.Function(
            "interval",
            inputs,
            [ca.vertcat(end, lifted.of(q, lifted.outputs))],
            options,
        )
        self.first = ca.Function(
            "interval_first", inputs, [ca.densify(ca.vertcat(by_joint, first))], options
        )
        self.second = ca.Function("interval_second", [*inputs, multipliers], [second], options)


@dataclass(frozen=True)
class FreePoint:
    """Unknowns of the program, scaled."""

    peaks: NDArray[np.float64]
    intervals: NDArray[np.float64]
    slack: NDArray[np.float64]

    @property
    def flat(self) -> NDArray[np.float64]:
        """All unknowns in one vector, as the solver takes them."""
        return np.concatenate([self.peaks, self.intervals.ravel(order="F"), self.slack])


class FreeProgram:
    """A compiled program for a plant, a kind of motion, a number of steps and limited quantities.

    It holds live casadi objects: keep it out of answers.
    """

    def __init__(
        self,
        plant: Plant,
        smooth: bool,
        steps: int,
        quantities: tuple[str, ...],
        options: Options,
    ) -> None:
        self.steps, self.peaks = steps, quantities
        derivatives = {name: QUANTITIES[name].derivative for name in quantities}
        at_nodes = tuple(name for name, order in derivatives.items() if order is None)
        self.of_joint = {name: order for name, order in derivatives.items() if order is not None}
        """Limited quantities that are unknowns, with their place among those of an interval."""
        self.model = model = FreeStep(plant, smooth, at_nodes)
        sizes = [len(quantities), model.unknowns * (steps + 1), NODES * steps]
        x = ca.MX.sym("x", sum(sizes))
        p = ca.MX.sym("p", steps + model.scales + 1 + len(quantities))
        peak, flat, slack = split(x, sizes)
        lengths, scale, weights = split(p, [steps, model.scales, 1 + len(quantities)])
        unknowns = ca.reshape(flat, model.unknowns, steps + 1)
        arguments = (unknowns[:, :-1], lengths.T, scale)
        outputs = self._mapped(model.value)(*arguments)
        of_nodes = ca.vec(ca.DM(GAUSS_WEIGHTS) @ lengths.T) / ca.sum1(lengths)
        objective = weights[0] * ca.dot(of_nodes, slack)
        if quantities:
            objective += ca.dot(weights[1:], peak)
        constraints = self._constraints(outputs, unknowns, slack, peak)
        self.lower, self.upper = np.zeros(constraints.numel()), np.full(constraints.numel(), np.inf)
        self.upper[: len(model.after) * steps] = 0.0
        self._sizes = sizes
        self._solver = ipopt(
            {"x": x, "p": p, "f": objective, "g": constraints},
            self._jacobian(arguments),
            self._hessian(arguments, constraints.numel()),
            options,
        )
        self._march = self._chain()

    def solve(
        self,
        start: FreePoint,
        lower: FreePoint,
        upper: FreePoint,
        parameters: NDArray[np.float64],
    ) -> tuple[FreePoint, Stop]:
        """Run IPOPT: the unknowns where it stopped, and how it ended."""
        bounds, of_constraints = (lower.flat, upper.flat), (self.lower, self.upper)
        stop = run_ipopt(self._solver, Point(start.flat), bounds, of_constraints, parameters)
        peaks, flat, slack = np.split(stop.point.unknowns, np.cumsum(self._sizes)[:-1])
        return FreePoint(peaks, flat.reshape(self.steps + 1, -1).T, slack), stop

    def simulate(
        self,
        initial: NDArray[np.float64],
        inputs: NDArray[np.float64],
        lengths: NDArray[np.float64],
        scale: NDArray[np.float64],
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Scaled unknowns (unknowns, steps + 1) and outputs at the nodes along scaled inputs."""
        size = len(self.model.after)
        ends, outputs = self._march(
            initial, inputs[None, :], lengths[None, :], np.repeat(scale[:, None], self.steps, 1)
        )
        unknowns = np.zeros((self.model.unknowns, self.steps + 1))
        unknowns[self.model.after] = np.hstack([initial[:, None], ends.full()])
        unknowns[self.model.joint - 1, :-1] = inputs
        return unknowns, outputs.full()[size:]

    def _mapped(self, function: ca.Function) -> ca.Function:
        return function.map(f"{function.name()}_all", "serial", self.steps, [2], [])

    def _chain(self) -> ca.Function:
        model = self.model
        state, given = ca.SX.sym("z", len(model.after)), ca.SX.sym("u")
        h, scale = ca.SX.sym("h"), ca.SX.sym("scale", model.scales)
        before = model.joint - 1
        outputs = model.value(ca.vertcat(state[:before], given, state[before:]), h, scale)
        chain = ca.Function(
            "chain", [state, given, h, scale], [outputs[: len(model.after)], outputs]
        )
        return chain.mapaccum(self.steps)

    # -- the program, in the order of its constraints: intervals, power, limited peaks --

    def _constraints(self, outputs: ca.MX, unknowns: ca.MX, slack: ca.MX, peak: ca.MX) -> ca.MX:
        size = len(self.model.after)
        rows = [ca.vec(outputs[:size, :] - unknowns[self.model.after, 1:])]
        first = size
        for name, count in self.model.outputs.items():
            value = ca.vec(outputs[first : first + count, :])
            ceiling = slack if name == "power" else peak[self.peaks.index(name)]
            rows += [ceiling - value, ceiling + value]
            first += count
        for name, row in self.of_joint.items():
            value = unknowns[row, :].T
            ceiling = peak[self.peaks.index(name)]
            rows += [ceiling - value, ceiling + value]
        return ca.vertcat(*rows)

    def _jacobian(self, arguments: tuple[ca.MX, ...]) -> ca.MX:
        model, steps = self.model, self.steps
        n_peaks, columns, n_slack = self._sizes
        blocks = self._mapped(model.first)(*arguments)

        def along(rows: slice, count: int) -> ca.MX:
            inner = _block_diagonal(blocks[rows, :], count, model.unknowns, steps)
            return ca.horzcat(inner, ca.MX(count * steps, model.unknowns))

        size = len(model.after)
        handed_on = ca.DM.eye(columns)[_rows_of(model.after, model.unknowns, steps), :]
        rows = [
            ca.horzcat(
                ca.MX(size * steps, n_peaks),
                along(slice(0, size), size) - handed_on,
                ca.MX(size * steps, n_slack),
            )
        ]

        def two_sided(name: str, of_value: ca.MX) -> None:
            count = of_value.shape[0]
            of_peak, of_slack = ca.MX(count, n_peaks), ca.MX(count, n_slack)
            if name == "power":
                of_slack = ca.MX(ca.DM.eye(count))
            else:
                of_peak = ca.MX(_unit_column(count, n_peaks, self.peaks.index(name)))
            rows.extend(ca.horzcat(of_peak, sign * of_value, of_slack) for sign in (-1, 1))

        first = size
        for name, count in model.outputs.items():
            two_sided(name, along(slice(first, first + count), count))
            first += count
        for name, row in self.of_joint.items():
            places = [row + k * model.unknowns for k in range(steps + 1)]
            two_sided(name, ca.MX(ca.DM.eye(columns)[places, :]))
        return ca.vertcat(*rows)

    def _hessian(self, arguments: tuple[ca.MX, ...], constraints: int) -> LagrangianHessian:
        model, steps = self.model, self.steps
        n_peaks, _, n_slack = self._sizes
        of_objective, multipliers = ca.MX.sym("lam_f"), ca.MX.sym("lam_g", constraints)
        size = len(model.after)
        sizes = [size * steps]
        for count in model.outputs.values():
            sizes += [count * steps] * 2
        *parts, _ = split(multipliers, [*sizes, constraints - sum(sizes)])
        rows = [ca.reshape(parts[0], size, steps)[model.joint - 1 :, :]]
        for i, count in enumerate(model.outputs.values()):
            below, above = parts[1 + 2 * i], parts[2 + 2 * i]
            rows.append(ca.reshape(above - below, count, steps))
        blocks = self._mapped(model.second)(*arguments, ca.vertcat(*rows))
        inner = _block_diagonal(blocks, model.unknowns, model.unknowns, steps)
        rest = model.unknowns + n_slack
        hessian = ca.diagcat(ca.MX(n_peaks, n_peaks), inner, ca.MX(rest, rest))
        return LagrangianHessian(of_objective, multipliers, hessian)


def _rows_of(after: list[int], unknowns: int, steps: int) -> list[int]:
    """Where the values after each interval stand among the intervals' unknowns."""
    return [(k + 1) * unknowns + i for k in range(steps) for i in after]


def _block_diagonal(dense: ca.MX, rows: int, columns: int, blocks: int) -> ca.MX:
    """Lay blocks that stand side by side along the diagonal; the entries stay where they are."""
    pattern = ca.diagcat(*[ca.Sparsity.dense(rows, columns)] * blocks)
    return ca.sparsity_cast(dense, pattern)


def _unit_column(rows: int, columns: int, column: int) -> ca.DM:
    """Zeros but for ones in one column."""
    return ca.horzcat(ca.DM(rows, column), ca.DM.ones(rows, 1), ca.DM(rows, columns - column - 1))
