"""From a task to a nonlinear program in the profile's coefficients.

Unknowns are the coefficients, the least peak where one is asked for, and the state on arrival where
a residual is limited (its many rows then have few entries). The energy comes in two forms:

- sampled: the power at two samples of every step is the difference of two unknowns that are not
  negative, and their sum is |power| there. The solver decides sample by sample, as in a linear
  program, and finds the minimum from far away in 15 to 40 iterations; but the samples miss a little
  energy between them;
- resolved: the energy with its sign changes resolved, a smooth function of the coefficients. From
  the sampled minimum, or from that of a neighbouring problem, a few iterations lead to its own.

Limits are bounds on the quantities' values at the nodes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from ocp.base.interrupts import keep_interrupts
from ocp.program.condensed import Condensed, Inputs, March, Sensitivities
from ocp.program.ipopt import LagrangianHessian, Options, Point, Stop, ipopt, run_ipopt
from ocp.program.symbols import split
from ocp.simulation.collocation import NODES
from ocp.simulation.objective import two_samples

RESIDUAL = "residual"


class Form(NamedTuple):
    """Which program it is.

    Attributes
    ----------
    energy : {"sampled", "resolved", "free"}
        Whether |power| is taken at samples, or the energy with its sign changes resolved, or none.
    residual_rows : int
        Rows of the residual matrix; 0 asks for rest on arrival.
    least : str or None
        The quantity whose peak is an unknown that is minimised.
    """

    energy: Literal["sampled", "resolved", "free"]
    residual_rows: int
    least: str | None

    @property
    def sampled(self) -> bool:
        """Whether |power| is taken at samples."""
        return self.energy == "sampled"


class NonlinearProgram:
    """One form of the program for a plant, a profile, a number of steps and limited quantities.

    Move, scales, weights, residual matrix and a correction of the state on arrival are its
    parameters; limits are bounds. It holds live
    casadi objects: keep it out of answers.
    """

    @keep_interrupts()  # building, too, loses a Ctrl-C
    def __init__(self, motion: Condensed, form: Form, options: Options) -> None:
        self.motion, self.form = motion, form
        self._samples, self._sampling = 2 * motion.steps, two_samples()
        self.sizes = {
            "coefficients": motion.size,
            "peak": 0 if form.least is None else 1,
            "arrival": motion.states if form.residual_rows else 0,
            "power": 2 * self._samples if form.sampled else 0,
        }
        """How many unknowns of each kind, in their order."""
        x = ca.MX.sym("x", self.unknowns)
        parts = dict(zip(self.sizes, split(x, list(self.sizes.values())), strict=True))
        sizes = [3, motion.scales, 2, motion.states, form.residual_rows * motion.states]
        sizes.append(motion.basis_size)
        p = ca.MX.sym("p", sum(sizes))
        move, scale, weights, offset, residual, basis = split(p, sizes)
        residual = ca.reshape(residual, form.residual_rows, motion.states)
        inputs = Inputs(parts["coefficients"], move, scale, basis)
        linearised = march, first = motion.linearised(inputs)
        f, gradient = self._objective(march, first, parts, weights)
        g = self._constraints(march, parts, offset, residual)
        jacobian = self._jacobian(march, first, residual)
        hessian = self._hessian(weights, inputs, linearised, g.numel())
        self._solver = ipopt(
            {"x": x, "p": p, "f": f, "g": g}, jacobian, hessian, options, gradient=gradient
        )

    @property
    def unknowns(self) -> int:
        """Number of unknowns."""
        return sum(self.sizes.values())

    def part(self, name: str) -> slice:
        """Where unknowns of one kind stand among all."""
        names = list(self.sizes)
        first = sum(self.sizes[other] for other in names[: names.index(name)])
        return slice(first, first + self.sizes[name])

    def solve(
        self,
        start: Point,
        bounds: tuple[NDArray[np.float64], NDArray[np.float64]],
        limits: Mapping[str, float],
        parameters: NDArray[np.float64],
    ) -> Stop:
        """Run IPOPT.

        Parameters
        ----------
        start : Point
            Where to start.
        bounds : tuple of ndarray
            Lower and upper bounds of the unknowns.
        limits : mapping of str to float
            Largest absolute values, scaled; a quantity without an entry is free.
        parameters : ndarray
            Move, scales, weights of energy and peak, correction of the state on arrival, residual
            matrix by columns, `Condensed.basis`.

        Returns
        -------
        Stop
            Where and how it ended.
        """
        return run_ipopt(self._solver, start, bounds, self._constraint_bounds(limits), parameters)

    def _objective(
        self, march: March, first: Sensitivities, parts: Mapping[str, ca.MX], weights: ca.MX
    ) -> tuple[ca.MX, ca.MX]:
        """The weighted sum of energy and least peak, and its gradient."""
        motion, blocks = self.motion, dict[str, ca.MX]()
        f = weights[1] * ca.sum1(parts["peak"])
        if self.form.least is not None:
            blocks["peak"] = weights[1]
        if self.form.energy == "resolved":
            power = march.outputs[0, :]
            gradient = motion.of_group(first.outputs, "power") @ motion.energy.first(power)[0]
            f += weights[0] * motion.energy.value(power)
            blocks["coefficients"] = weights[0] * gradient.T
        if self.form.sampled:
            counts = np.tile(np.repeat(motion.lengths, 2) / 2, 2)
            f += weights[0] * ca.dot(counts, parts["power"])
            blocks["power"] = weights[0] * ca.DM(counts).T
        return f, ca.densify(self._row(1, **blocks)).T

    # -- the constraints, in this order: samples, arrival, limited quantities, residual --

    def _constraints(
        self, march: March, parts: Mapping[str, ca.MX], offset: ca.MX, residual: ca.MX
    ) -> ca.MX:
        motion, power, arrival = self.motion, march.outputs[0, :], march.arrival + offset
        rows: list[ca.MX] = []
        if self.form.sampled:
            above, below = ca.vertsplit(parts["power"], self._samples)
            sampled = self._sampling @ ca.reshape(power, NODES, motion.steps)
            rows.append(ca.vec(sampled) - above + below)
        rows.append(arrival - parts["arrival"] if self.form.residual_rows else arrival)
        for group in self._limited:
            value = motion.of_group(ca.vec(march.outputs).T, group.name).T
            rows += self._within(group.name, value, parts["peak"])
        if self.form.residual_rows:
            rows += self._within(RESIDUAL, residual @ parts["arrival"], parts["peak"])
        return ca.vertcat(*rows)

    def _within(self, name: str, value: ca.MX, peak: ca.MX) -> list[ca.MX]:
        return [value - peak, value + peak] if name == self.form.least else [value]

    @property
    def _limited(self) -> Sequence:
        return self.motion.groups[2:]  # after state and power

    def _constraint_bounds(
        self, limits: Mapping[str, float]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        motion, form = self.motion, self.form
        zeros = (self._samples if form.sampled else 0) + motion.states
        lower, upper = [np.zeros(zeros)], [np.zeros(zeros)]
        counts = {group.name: group.rows * motion.nodes for group in self._limited}
        if form.residual_rows:
            counts[RESIDUAL] = form.residual_rows
        for name, count in counts.items():
            limit, free = np.full(count, limits.get(name, np.inf)), np.full(count, np.inf)
            if name == form.least:
                lower += [-free, np.zeros(count)]
                upper += [np.zeros(count), free]
            else:
                lower.append(-limit)
                upper.append(limit)
        return np.concatenate(lower), np.concatenate(upper)

    # -- derivatives --

    def _row(self, count: int, **blocks: ca.MX | ca.DM) -> ca.MX:
        """Rows of the Jacobian from its blocks by kind of unknown; what is not given is zero."""
        return ca.horzcat(
            *(ca.MX(blocks.get(name, ca.DM(count, size))) for name, size in self.sizes.items())
        )

    def _jacobian(self, march: March, first: Sensitivities, residual: ca.MX) -> ca.MX:
        motion, form = self.motion, self.form
        rows: list[ca.MX] = []
        if form.sampled:
            count = self._samples
            power_first = motion.of_group(first.outputs, "power")
            by_node = ca.reshape(power_first.T, NODES, motion.steps * motion.size)
            of_samples = ca.reshape(self._sampling @ by_node, count, motion.size)
            signs = ca.horzcat(-ca.DM.eye(count), ca.DM.eye(count))
            rows.append(self._row(count, coefficients=of_samples, power=signs))
        arrived = -ca.DM.eye(motion.states) if form.residual_rows else ca.DM(motion.states, 0)
        rows.append(self._row(motion.states, coefficients=first.arrival.T, arrival=arrived))

        def limited(name: str, count: int, **blocks: ca.MX) -> None:
            if name == form.least:
                ones = ca.DM.ones(count, 1)
                rows.extend(self._row(count, **blocks, peak=sign * ones) for sign in (-1, 1))
            else:
                rows.append(self._row(count, **blocks))

        for group in self._limited:
            of_values = motion.of_group(first.outputs, group.name).T
            limited(group.name, of_values.shape[0], coefficients=of_values)
        if form.residual_rows:
            limited(RESIDUAL, form.residual_rows, arrival=residual)
        return ca.vertcat(*rows)

    def _hessian(
        self,
        weights: ca.MX,
        inputs: Inputs,
        linearised: tuple[March, Sensitivities],
        constraints: int,
    ) -> LagrangianHessian:
        motion, form = self.motion, self.form
        of_objective, multipliers = ca.MX.sym("lam_f"), ca.MX.sym("lam_g", constraints)
        sizes = [self._samples if form.sampled else 0, motion.states]
        for group in self._limited:
            sizes += [group.rows * motion.nodes] * (2 if group.name == form.least else 1)
        of_samples, of_arrival, *of_values, _ = split(
            multipliers, [*sizes, constraints - sum(sizes)]
        )
        march, first = linearised
        by_energy = ca.MX(motion.size, motion.size)
        of_power = ca.MX.zeros(1, motion.nodes)  # dense: `mac` keeps what it adds to as sparse
        if form.sampled:
            of_samples = ca.reshape(of_samples, 2, motion.steps)
            of_power = ca.vec(self._sampling.T @ of_samples).T
        if form.energy == "resolved":
            gradient, bends = motion.energy.first(march.outputs[0, :])
            weight = of_objective * weights[0]
            of_power = weight * gradient.T
            by_energy = weight * motion.of_bends(motion.of_group(first.outputs, "power"), bends)
        of_outputs = [ca.MX(of_power)]
        for group in self._limited:
            weight = of_values.pop(0)
            if group.name == form.least:
                weight += of_values.pop(0)
            of_outputs.append(ca.reshape(weight, group.rows, motion.nodes))
        curvature = motion.curvature(inputs, linearised, of_arrival, ca.vertcat(*of_outputs))
        rest = self.unknowns - motion.size
        hessian = ca.diagcat(curvature + by_energy, ca.MX(rest, rest))
        return LagrangianHessian(of_objective, multipliers, hessian)
