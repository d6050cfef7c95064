"""The independent answer: a problem written down in CasADi as it stands, and solved by IPOPT.

All derivatives are CasADi's own, and so are scales, residual and peaks, read off the constraints.
It shares with `Sqp` the symbolic simulation and what a task says: weights, limits, the rows of tip
displacements after arrival, how multipliers become shadow prices.
Unknowns are the coefficients a and, where a peak is minimised, that peak p:

    minimise    weight * energy(a) + weight * p
    subject to  missed(a) = 0                where rest on arrival is asked for
                |tips * missed(a)| <= limit  where the residual is bounded, in every scenario
                below <= quantity(a) <= above  at every node of the steps
                lower <= a <= upper

with missed(a) the state on arrival less the wanted one, and what is minimised within p times the
sides of its limit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, ClassVar, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.models.compiled import Compiled
from quietarm.models.one_thread import on_one_thread
from quietarm.ocp.energy import Energy
from quietarm.ocp.errors import SolveStatus
from quietarm.ocp.limits import RESIDUAL
from quietarm.ocp.sample import total
from quietarm.ocp.simulation.objective import integrated, smooth_power
from quietarm.ocp.simulation.rollout import Simulation, SymbolicRollout
from quietarm.ocp.solvers.nlp import OPTIONS, compile_nlp, run_ipopt
from quietarm.ocp.solvers.problem import Program, Solution, shadow_prices
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.uncertainty import Scenario

Array = NDArray[np.float64]
_OPTIONS = {
    **OPTIONS,
    # Where zeros of the power meet, exact second derivatives are without bound.
    "hessian_approximation": "limited-memory",
    "limited_memory_max_history": 50,
    # There a second-order correction leads to and fro across the kink, for hundreds of iterations.
    "max_soc": 0,
    # And there it ends within the constraints when the objective has hardly changed three times:
    # by less than a tenth of the tolerance.
    "acceptable_tol": 1e3,
    "acceptable_dual_inf_tol": 1e10,
    "acceptable_constr_viol_tol": 1e-9,
    "acceptable_compl_inf_tol": 1e-5,
    "acceptable_iter": 3,
}
_WARM = {
    **_OPTIONS,
    "mu_strategy": "monotone",
    "mu_init": 1e-8,
    "bound_push": 1e-9,
    "bound_frac": 1e-9,
    "slack_bound_push": 1e-9,
    "slack_bound_frac": 1e-9,
}
"""A thin barrier, which does not drive a start beside a minimum away from it."""


@dataclass(frozen=True)
class Ipopt(Solver):
    """IPOPT (Waechter and Biegler, 2006), one problem after another.

    Its tolerance is `tol` of IPOPT, of the scaled optimality conditions. Options are those of
    `Solver`.
    """

    name: ClassVar[str] = "ipopt"

    @property
    def own_options(self) -> dict[str, str | int | float]:
        """Options by IPOPT's own names."""
        return {
            "tol": self.tolerance,
            "max_iter": self.iterations,
            "print_level": 5 if self.log else 0,  # 5 has a line for each iteration
        }

    @on_one_thread
    def solve(
        self,
        problems: Sequence[Program],
        starts: Sequence[Array],
        *,
        warm: bool = False,
        groups: Sequence[int] | None = None,
    ) -> list[Solution]:
        """Solve each problem from its start; see `Solver.solve`. Groups are not used."""
        del groups
        pairs = zip(problems, starts)
        solutions = [_Numbers(problem, warm, self).solve(start) for problem, start in pairs]
        return [replace(solution, solved_by=self.stated) for solution in solutions]


class _Program(NamedTuple):
    """A nonlinear program: IPOPT for it; how many values each constraint has, in their order.

    The figures are a function of coefficients, the row of a task, the wanted states and the tip
    rows: energy, what is missed on arrival, tip displacements and limited quantities in SI units.
    """

    solver: Compiled
    counts: dict[str, int]
    figures: Compiled


class _Form(NamedTuple):
    """The properties of a task along a profile by which one program serves several problems.

    Rows of tip displacements are those of each scenario.
    """

    scenarios: tuple[Scenario, ...]
    tip_rows: tuple[int, ...]
    at_rest: bool
    bounds_residual: bool
    peak: str | None

    @classmethod
    def of(cls, problem: Program) -> _Form:
        """The form of a problem."""
        return cls(
            scenarios=problem.task.scenarios,
            tip_rows=tuple(map(len, problem.tip_rows)),
            at_rest=problem.at_rest,
            bounds_residual=problem.bounds_residual,
            peak=problem.peak,
        )


@lru_cache(maxsize=16)
def compile_program(simulation: Simulation, form: _Form, solver: Ipopt, warm: bool) -> _Program:
    """Compile the program of a form by `_build_program`."""
    return Compiled.guard(lambda: _build_program(simulation, form, solver, warm))


def _build_program(simulation: Simulation, form: _Form, solver: Ipopt, warm: bool) -> _Program:
    """The program in symbols; whatever else differs between problems is a parameter of it."""
    modes = 2 * simulation.plant.modes
    quantities = simulation.quantities
    a = ca.MX.sym("a", simulation.profile.size)
    p = ca.MX.sym("p", form.peak is not None)
    row = ca.MX.sym("row", 3 + modes)
    wanted = ca.MX.sym("wanted", modes, len(form.scenarios))
    tips = [ca.MX.sym("tips", rows, modes) for rows in form.tip_rows]
    scale = ca.MX.sym("scale", modes)
    scales = ca.MX.sym("scales", 1 + len(quantities))
    sides = ca.MX.sym("sides", 2)
    weights = ca.MX.sym("weights", 2)
    width = ca.MX.sym("width")

    rollouts = [simulation.rollout(a, ca.vertsplit(row), errors) for errors in form.scenarios]
    nominal = rollouts[0]
    missed = ca.horzcat(*(rollout.arrival.T for rollout in rollouts)) - wanted
    energy = ca.if_else(
        width > 0,
        _round_off(simulation.energy, nominal, width),
        nominal.energy,
    )
    values = {RESIDUAL: ca.vertcat(*(rows @ missed[:, i] for i, rows in enumerate(tips)))}
    for quantity in quantities:
        counted = rollouts if quantity.in_scenarios else rollouts[:1]
        by_scenario = (ca.horzcat(*rollout.values(quantity)) for rollout in counted)
        values[quantity.name] = ca.veccat(*by_scenario)

    scaled = {name: value / scales[k] for k, (name, value) in enumerate(values.items())}
    arrival = missed[:, 0] / scale if form.at_rest else ca.MX(0, 1)
    constraints = {"arrival": arrival, **_bounded(form, scaled, p, sides)}
    nlp = {
        "x": ca.veccat(a, p),
        "p": ca.veccat(row, wanted, *tips, scale, scales, sides, weights, width),
        "f": weights[0] * energy + (weights[1] * p if form.peak else 0.0),
        "g": ca.vertcat(*constraints.values()),
    }
    options = {
        **(_WARM if warm else _OPTIONS),
        **solver.own_options,
        "acceptable_obj_change_tol": solver.tolerance / 10,
    }
    compiled_solver = compile_nlp(nlp, options)
    outputs = [nominal.energy, missed.T, *values.values()]
    figures = ca.Function(
        "figures",
        [a, row, wanted, *tips],
        list(map(ca.densify, outputs)),
    )
    return _Program(
        Compiled(lambda: compiled_solver, silent=True),  # casadi warns of every failure
        {name: value.numel() for name, value in constraints.items()},
        Compiled(lambda: figures),
    )


def _bounded(form: _Form, scaled: Mapping[str, ca.MX], p: ca.MX, sides: ca.MX) -> dict[str, ca.MX]:
    """The inequalities, of scaled values by name: of the peak p that is minimised two."""
    constraints = dict[str, ca.MX]()
    for name, value in scaled.items():
        if name == form.peak:
            constraints["below peak"] = value - sides[1] * p
            constraints["above peak"] = value - sides[0] * p
        elif name != RESIDUAL or form.bounds_residual:
            constraints[name] = value
    return constraints


def _round_off(energy: Energy, rollout: SymbolicRollout, width: ca.MX) -> Any:
    """The energy with the root of power^2 + width^2 [W] in place of |power|."""
    smooth = [smooth_power(energy, sample) for sample in rollout.samples]
    rounded = [
        total([ca.sqrt(power**2 + width**2) for power in sample.powers])
        for sample in rollout.samples
    ]
    return energy.absolute * integrated(rounded, rollout.h) + integrated(smooth, rollout.h)


class _Numbers:
    """A problem's numbers: parameters and bounds of its program, and what its solution means."""

    def __init__(self, problem: Program, warm: bool, solver: Ipopt) -> None:
        self.problem = problem
        # Shares of the plain motion's mean power over which |power| is rounded off, run by run.
        widths = (0.5, 0.05, 0.0)
        self.widths = widths[-1:] if warm else widths
        task = problem.task
        simulation = problem.batch.simulation
        self.program = compile_program(simulation, _Form.of(problem), solver, warm)
        shape = len(task.scenarios), problem.wanted.size
        wanted = np.broadcast_to(problem.wanted - problem.offset, shape)
        self.of_motion = [task.row, wanted.T, *problem.tip_rows]
        energy, missed, peaks = self.figures(problem.profile.plain)
        swing = np.abs(missed).max(axis=0)
        self.scale = np.where(swing > 0, swing, 1.0)
        self.energy = energy or 1.0
        self.scales = {name: peak or 1.0 for name, peak in peaks.items()}
        peak_scale = self.scales.get(problem.peak or "", 0.0)
        of_energy, of_peak = problem.weights(self.energy, peak_scale)
        self.of_energy = of_energy / self.energy
        sides = problem.limits_of_task[problem.peak or RESIDUAL].sides
        scales = list(self.scales.values())
        weights = [self.of_energy, of_peak]
        self.parameters = [*self.of_motion, self.scale, scales, sides, weights]

    def figures(self, coefficients: Array) -> tuple[float, Array, dict[str, float]]:
        """Energy [J], what is missed on arrival in every scenario, residual and peaks by name."""
        energy, missed, *values = self.program.figures(coefficients, *self.of_motion)
        problem = self.problem
        names = RESIDUAL, *(limit.name for limit in problem.task.limits)
        peaks = {
            name: float(problem.limits_of_task[name].peak(value.min(), value.max()))
            for name, value in zip(names, values)
        }
        return energy.item(), missed, peaks

    def solve(self, start: Array) -> Solution:
        """Run IPOPT for one width after another."""
        problem = self.problem
        box = problem.profile.box(problem.bound)
        x = np.clip(start, *box)
        lower, upper = box
        iterations = 0
        stop = None
        if problem.peak is not None:
            peak = self.figures(x)[-1][problem.peak]
            x = np.append(x, peak / self.scales[problem.peak])
            lower = np.append(lower, -np.inf)
            upper = np.append(upper, np.inf)
        for width in self.widths:
            mean_power = self.energy / problem.task.duration
            parameters = [*self.parameters, [width * mean_power]]
            stop = run_ipopt(
                self.program.solver,
                x,
                (lower, upper),
                self.bounds(),
                np.concatenate([np.ravel(numbers, order="F") for numbers in parameters]),
            )
            x = stop.unknowns
            iterations += stop.iterations
            if SolveStatus.from_ipopt(stop.return_status) is SolveStatus.INFEASIBLE:
                break  # the width is of the objective alone
        assert stop is not None
        coefficients = np.clip(x[: problem.profile.size], *box)
        energy, missed, peaks = self.figures(coefficients)
        status = SolveStatus.from_ipopt(stop.return_status)
        if problem.at_rest and status.solved:
            peaks[RESIDUAL] = 0.0
        return Solution(
            coefficients,
            energy,
            peaks,
            status,
            iterations,
            arrival=missed + problem.wanted,
            shadow_prices=self.prices(stop.multipliers),
            reason=stop.return_status.replace("_", " ").lower(),
        )

    def bounds(self) -> tuple[Array, Array]:
        """Lower and upper bounds of the constraints."""
        bounds = {
            "arrival": (0.0, 0.0),
            "below peak": (-np.inf, 0.0),
            "above peak": (0.0, np.inf),
        }
        for limit in self.problem.limits:
            scale = self.scales[limit.name]
            bounds[limit.name] = (limit.lower / scale, limit.upper / scale)
        counts = self.program.counts
        free = (-np.inf, np.inf)
        by_constraint = np.array([bounds.get(name, free) for name in counts])
        lower, upper = np.repeat(by_constraint, list(counts.values()), axis=0).T
        return lower, upper

    def prices(self, multipliers: Array) -> dict[str, float]:
        """Return the fall of the least energy per unit of each widened limit [J by its unit]."""
        counts = self.program.counts
        problem = self.problem
        parts = np.split(multipliers, np.cumsum(list(counts.values()))[:-1])
        by_name = dict(zip(counts, parts))
        bounded = {
            name: by_name[name] / self.scales[name] for name in by_name.keys() & self.scales.keys()
        }
        of_arrival = by_name["arrival"]
        if problem.at_rest:
            of_arrival = of_arrival / self.scale
        tips = problem.tip_rows[0]
        return shadow_prices(
            problem,
            self.of_energy,
            bounded,
            of_arrival,
            tips,
        )
