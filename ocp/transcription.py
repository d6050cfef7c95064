"""From a task to a nonlinear program.

Multiple shooting: the modes before every step are unknowns, and each step of the one simulation is
a constraint. |power| is exact through slacks at the Gauss nodes (s >= p, s >= -p). Every quantity
that may be limited has a variable for its peak, so that one program serves a limit (a bound on the
variable), the least peak that is possible (a weight on it) and a weighted sum.

All steps are alike, so the derivatives of one step are formed once, as small dense blocks, and
mapped over the steps: building takes hundredths of a second whatever the number of steps, where
casadi's own derivative of the whole graph takes half a second for a hundred.
"""

from __future__ import annotations

import io
from collections.abc import Iterable, Mapping, Sequence
from contextlib import redirect_stderr
from dataclasses import dataclass, field
from types import MappingProxyType

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from models import Plant
from ocp.collocation import GAUSS_WEIGHTS, NODES, mesh
from ocp.interrupts import keep_interrupts
from ocp.profile import JointProfile
from ocp.step_model import StepModel

RESIDUAL = "residual"


@dataclass(frozen=True)
class Layout:
    """Where things stand in the vectors of the program.

    Attributes
    ----------
    coefficients, state, steps : int
        Number of coefficients, of entries of the state, and of steps.
    peaks : tuple of str
        Names of the peak variables, the residual first where it has one.
    slacks : int
        Number of slacks of |power|.
    residual_rows : int
        Rows of the residual matrix, 0 where the program has no residual variable.
    """

    coefficients: int
    state: int
    steps: int
    peaks: tuple[str, ...]
    slacks: int
    residual_rows: int

    @property
    def first_state(self) -> int:
        """Index of the first state among the unknowns."""
        return self.coefficients + len(self.peaks)

    @property
    def first_slack(self) -> int:
        """Index of the first slack among the unknowns."""
        return self.first_state + self.state * (self.steps + 1)

    @property
    def unknowns(self) -> int:
        """Number of unknowns."""
        return self.first_slack + self.slacks


@dataclass(frozen=True)
class Point:
    """Where the solver starts or stops: the unknowns, and the multipliers where they are known.

    Attributes
    ----------
    unknowns : ndarray
        Coefficients, peaks, states, slacks, scaled.
    bound_multipliers, multipliers : ndarray, empty where unknown
        Of the bounds on the unknowns (positive at an upper one), and of the constraints.
    """

    unknowns: NDArray[np.float64]
    bound_multipliers: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))
    multipliers: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))


class NonlinearProgram:
    """A compiled program for a plant, a profile, a number of steps and the limited quantities.

    Start, target, duration, scales, residual matrix and the weights of the objective are its
    parameters; limits are bounds. It holds live casadi objects: keep it out of answers.
    """

    def __init__(
        self,
        plant: Plant,
        profile: JointProfile,
        steps: int,
        quantities: tuple[str, ...],
        residual_rows: int,
        options: Mapping[str, str | int | float],
        warm_options: Mapping[str, str | int | float] = MappingProxyType({}),
    ) -> None:
        self.model = model = StepModel(plant, profile, steps, quantities)
        peaks = ((RESIDUAL,) if residual_rows else ()) + quantities
        self.layout = layout = Layout(
            profile.size, model.size, steps, peaks, NODES * steps, residual_rows
        )
        parameters = {
            "move": 3,
            "scale": model.scales,
            "weights": 1 + len(peaks),
            "residual": residual_rows * model.size,
        }
        x, p = ca.MX.sym("x", layout.unknowns), ca.MX.sym("p", sum(parameters.values()))
        move, scale, weights, residual = ca.vertsplit(p, offsets(parameters.values()))
        residual = ca.reshape(residual, residual_rows, model.size)
        a, peak, flat_states, slack = ca.vertsplit(
            x, offsets([layout.coefficients, len(peaks), model.size * (steps + 1), layout.slacks])
        )
        states = ca.reshape(flat_states, model.size, steps + 1)
        arguments = (states[:, :-1], ca.MX(ca.DM(np.arange(steps)).T), a, move, scale)

        outputs = _mapped(model.value, steps)(*arguments)
        lengths = mesh(ca.DM(np.arange(steps)), steps)[1].full()
        self.node_weights = np.outer(lengths, GAUSS_WEIGHTS).ravel()
        energy = ca.dot(self.node_weights, slack)
        objective = weights[0] * energy + (ca.dot(weights[1:], peak) if peaks else 0)
        constraints = self._constraints(outputs, states, slack, peak, residual)
        self.lower, self.upper = self._constraint_bounds(constraints.numel())
        problem = {"x": x, "p": p, "f": objective, "g": constraints}
        jacobian = self._jacobian(arguments, residual)
        derivatives = {
            "jac_g": ca.Function(
                "nlp_jac_g", [x, p], [constraints, jacobian], ["x", "p"], ["g", "jac_g_x"]
            ),
            "hess_lag": self._hessian(x, p, arguments, constraints.numel()),
        }
        self._cold, self._warm = (
            ca.nlpsol(name, "ipopt", problem, {**derivatives, "print_time": False, "ipopt": chosen})
            for name, chosen in (("cold", dict(options)), ("warm", {**options, **warm_options}))
        )
        self._simulate = self._simulation()

    def simulate(
        self, coefficients: np.ndarray, move: Sequence[float], scale: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Scaled states (size, steps + 1) and step outputs (rows, steps) along a profile."""
        states, outputs = self._simulate(ca.DM(coefficients), ca.DM(move), ca.DM(scale))
        return states.full(), outputs.full()

    def solve(
        self, start: Point, lower: np.ndarray, upper: np.ndarray, parameters: np.ndarray
    ) -> tuple[Point, str, int]:
        """Run IPOPT: where it stopped, its own status (all casadi warns of) and its iterations."""
        solver, known = self._cold, {}
        if start.multipliers.size:
            solver, known = (
                self._warm,
                {"lam_x0": start.bound_multipliers, "lam_g0": start.multipliers},
            )
        with keep_interrupts(), redirect_stderr(io.StringIO()):
            result = solver(
                x0=start.unknowns, lbx=lower, ubx=upper, lbg=self.lower, ubg=self.upper,
                p=parameters, **known,
            )  # fmt: skip
        stopped = Point(*(result[name].full().ravel() for name in ("x", "lam_x", "lam_g")))
        stats = solver.stats()
        return stopped, str(stats["return_status"]), int(stats["iter_count"])

    def _simulation(self) -> ca.Function:
        steps, coefficients = self.layout.steps, self.layout.coefficients
        sizes = [self.layout.state, 1, coefficients, 3, self.model.scales]
        z, k, *shared = [ca.SX.sym(f"i{i}", size) for i, size in enumerate(sizes)]
        outputs = self.model.value(z, k, *shared)
        chain = ca.Function("chain", [z, k, *shared], [outputs[: sizes[0]], outputs])
        inputs = [ca.MX.sym(f"i{i}", size) for i, size in enumerate(sizes[2:])]
        after, all_outputs = chain.mapaccum(steps)(
            ca.DM.zeros(sizes[0]),
            ca.DM(np.arange(steps)).T,
            *(ca.repmat(value, 1, steps) for value in inputs),
        )
        states = ca.horzcat(ca.DM.zeros(sizes[0]), after)
        return ca.Function("simulate", inputs, [states, all_outputs])

    # -- the program, in the order of its constraints: steps, power, limited peaks, residual --

    def _constraints(
        self, outputs: ca.MX, states: ca.MX, slack: ca.MX, peak: ca.MX, residual: ca.MX
    ) -> ca.MX:
        state, *bounded = self.model.groups
        rows = [ca.vec(outputs[state.where, :] - states[:, 1:])]
        for group in bounded:
            value = ca.vec(outputs[group.where, :])
            ceiling = slack if group.name == "power" else peak[self.layout.peaks.index(group.name)]
            rows += [ceiling - value, ceiling + value]
        if self.layout.residual_rows:
            tip = residual @ states[:, -1]
            rows += [peak[0] - tip, peak[0] + tip]
        return ca.vertcat(*rows)

    def _constraint_bounds(self, count: int) -> tuple[np.ndarray, np.ndarray]:
        equalities = self.layout.state * self.layout.steps
        lower, upper = np.zeros(count), np.full(count, np.inf)
        upper[:equalities] = 0.0
        return lower, upper

    def _jacobian(self, arguments: tuple[ca.MX, ...], residual: ca.MX) -> ca.MX:
        layout, steps = self.layout, self.layout.steps
        by_coefficients, by_state = _mapped(self.model.first, steps)(*arguments)
        size, n_peaks = layout.state, len(layout.peaks)
        rows: list[ca.MX] = []
        for group in self.model.groups:
            count = group.rows * steps
            of_a = ca.vertcat(*ca.horzsplit(by_coefficients[group.where, :], layout.coefficients))
            of_z = ca.horzcat(
                block_diagonal(by_state[group.where, :], group.rows, size, steps),
                ca.MX(count, size),
            )
            of_peak, of_slack = ca.MX(count, n_peaks), ca.MX(count, layout.slacks)
            if group.name == "state":
                of_next = ca.horzcat(ca.DM(count, size), ca.DM.eye(count))
                rows.append(ca.horzcat(of_a, of_peak, of_z - of_next, of_slack))
                continue
            if group.name == "power":
                of_slack = ca.MX(ca.DM.eye(count))
            else:
                of_peak = ca.MX(unit_column(count, n_peaks, layout.peaks.index(group.name)))
            rows += [
                ca.horzcat(-of_a, of_peak, -of_z, of_slack),
                ca.horzcat(of_a, of_peak, of_z, of_slack),
            ]
        if layout.residual_rows:
            count = layout.residual_rows
            before = ca.MX(count, layout.coefficients)
            of_peak = ca.MX(unit_column(count, n_peaks, 0))
            middle, after = ca.MX(count, size * steps), ca.MX(count, layout.slacks)
            rows += [
                ca.horzcat(before, of_peak, middle, sign * residual, after) for sign in (-1, 1)
            ]
        return ca.vertcat(*rows)

    def _hessian(
        self, x: ca.MX, p: ca.MX, arguments: tuple[ca.MX, ...], constraints: int
    ) -> ca.Function:
        layout, steps, n = self.layout, self.layout.steps, self.layout.coefficients
        of_objective, multipliers = ca.MX.sym("lam_f"), ca.MX.sym("lam_g", constraints)
        sizes: list[int] = []
        for group in self.model.groups:
            sizes += [group.rows * steps] * (1 if group.name == "state" else 2)
        parts = ca.vertsplit(multipliers, offsets([*sizes, 2 * layout.residual_rows]))
        rows = [ca.reshape(parts[0], layout.state, steps)]
        for i, group in enumerate(self.model.groups[1:]):
            below, above = parts[1 + 2 * i], parts[2 + 2 * i]
            rows.append(ca.reshape(above - below, group.rows, steps))
        a_a, a_z, z_z = _mapped(self.model.second, steps)(*arguments, ca.vertcat(*rows))
        a_a = ca.reshape(ca.sum2(ca.reshape(a_a, n * n, steps)), n, n)
        z_z = block_diagonal(z_z, layout.state, layout.state, steps)
        n_peaks, rest = len(layout.peaks), layout.state + layout.slacks
        inner = layout.state * steps
        hessian = ca.vertcat(
            ca.horzcat(a_a, ca.MX(n, n_peaks), a_z, ca.MX(n, rest)),
            ca.MX(n_peaks, layout.unknowns),
            ca.horzcat(ca.MX(inner, n + n_peaks), z_z, ca.MX(inner, rest)),
            ca.MX(rest, layout.unknowns),
        )
        return ca.Function(
            "nlp_hess_l",
            [x, p, of_objective, multipliers],
            [ca.triu(hessian)],
            ["x", "p", "lam_f", "lam_g"],
            ["triu_hess_gamma_x_x"],
        )


def _mapped(function: ca.Function, steps: int) -> ca.Function:
    """The function over all steps; coefficients, move and scales are shared."""
    return function.map(f"{function.name()}_all", "serial", steps, [2, 3, 4], [])


def block_diagonal(dense: ca.MX, rows: int, columns: int, blocks: int) -> ca.MX:
    """Lay blocks that stand side by side along the diagonal; the entries stay where they are."""
    pattern = ca.diagcat(*[ca.Sparsity.dense(rows, columns)] * blocks)
    return ca.sparsity_cast(dense, pattern)


def unit_column(rows: int, columns: int, column: int) -> ca.DM:
    """Zeros but for ones in one column."""
    return ca.horzcat(ca.DM(rows, column), ca.DM.ones(rows, 1), ca.DM(rows, columns - column - 1))


def offsets(sizes: Iterable[int]) -> list[int]:
    """Where parts of these sizes begin, and where the last ends, for `vertsplit`."""
    return [0, *np.cumsum(list(sizes)).tolist()]
