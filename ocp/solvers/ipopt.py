"""The independent answer: a problem written down in CasADi as it stands, and solved by IPOPT.

All derivatives are CasADi's own. It shares with `Sqp` the symbolic simulation and what a task says:
weights, limits, the rows of the residual, how multipliers become shadow prices.
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

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from quietarm.models import Plant
from quietarm.ocp.energy import Energy
from quietarm.ocp.errors import SolveStatus
from quietarm.ocp.interrupts import keep_interrupts
from quietarm.ocp.limits import RESIDUAL, Quantity, ask_for_jerk
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.free_vibration import after_arrival
from quietarm.ocp.simulation.objective import integrated
from quietarm.ocp.simulation.rollout import SymbolicRollout, symbolic_rollout
from quietarm.ocp.solvers.nlp import OPTIONS, compile_nlp, run_ipopt
from quietarm.ocp.solvers.problem import Problem, Solution, shadow_prices
from quietarm.ocp.uncertainty import perturb_plant

Array = NDArray[np.float64]
_WIDTHS = (0.5, 0.05, 0.0)
"""Shares of the plain motion's mean power over which |power| is rounded off, run by run."""
_OPTIONS = {
    **OPTIONS,
    # Where zeros of the power meet, exact second derivatives are without bound.
    "hessian_approximation": "limited-memory", "limited_memory_max_history": 50,
    # There a second-order correction leads to and fro across the kink, for hundreds of iterations.
    "max_soc": 0,
    # And there it ends within the constraints when the objective has hardly changed three times.
    "acceptable_tol": 1e3, "acceptable_dual_inf_tol": 1e10, "acceptable_constr_viol_tol": 1e-9,
    "acceptable_compl_inf_tol": 1e-5, "acceptable_obj_change_tol": 1e-10, "acceptable_iter": 3,
}  # fmt: skip
_WARM = {
    **_OPTIONS, "mu_strategy": "monotone", "mu_init": 1e-8, "bound_push": 1e-9,
    "bound_frac": 1e-9, "slack_bound_push": 1e-9, "slack_bound_frac": 1e-9,
}  # fmt: skip
"""A thin barrier, which does not drive a start beside a minimum away from it."""


@dataclass(frozen=True)
class Ipopt:
    """IPOPT (Waechter and Biegler, 2006), one problem after another.

    Parameters
    ----------
    print_level : int
        How much of its log IPOPT prints, 0 to 12; 5 shows every iteration.
    """

    name: ClassVar[str] = "ipopt"

    print_level: int = 0

    def solve(
        self,
        problems: Sequence[Problem],
        starts: Sequence[Array],
        *,
        warm: bool = False,
        groups: Sequence[int] | None = None,
    ) -> list[Solution]:
        """Solve each problem from its start, as `Sqp.solve` does; groups are not used."""
        del groups
        widths = _WIDTHS[-1:] if warm else _WIDTHS
        pairs = zip(problems, starts, strict=True)
        return [_Numbers(one, self.print_level, warm).solve(start, widths) for one, start in pairs]


class _Form(NamedTuple):
    """What problems that share a compiled program have in common; all else are its parameters."""

    plant: Plant
    profile: JointProfile
    energy: Energy
    steps: int
    quantities: tuple[Quantity, ...]
    error_names: tuple[str, ...]
    scenarios: tuple[tuple[float, ...], ...]
    tips: tuple[int, ...]
    at_rest: bool
    peak: str | None
    sides: tuple[float, float]
    print_level: int
    warm: bool


class _Program:
    """The nonlinear program of a form in symbols, and IPOPT compiled for it.

    Attributes
    ----------
    solver : Function
        IPOPT.
    counts : dict of str to int
        How many values each constraint has, in their order.
    figures : Function
        (coefficients, row of a task) -> energy, state on arrival of every scenario, values of each
        limited quantity.
    """

    def __init__(self, form: _Form) -> None:
        modes, scenarios = 2 * form.plant.modes, len(form.scenarios)
        a, p = ca.MX.sym("a", form.profile.size), ca.MX.sym("p", form.peak is not None)
        row, wanted = ca.MX.sym("row", 3 + modes), ca.MX.sym("wanted", modes, scenarios)
        scale, scales = ca.MX.sym("scale", modes), ca.MX.sym("scales", len(form.quantities))
        tips = [ca.MX.sym("tips", rows, modes) for rows in form.tips]
        weights, width = ca.MX.sym("weights", 2), ca.MX.sym("width")

        start, target, duration, *initial = ca.vertsplit(row)
        plants = [
            perturb_plant(form.plant, dict(zip(form.error_names, errors, strict=True)))
            for errors in form.scenarios
        ]
        rollouts = [
            symbolic_rollout(
                plant, form.profile, a, (start, target, duration), form.steps,
                jerk=ask_for_jerk(form.quantities), initial=initial, energy=form.energy,
            )
            for plant in plants
        ]  # fmt: skip
        nominal, arrival = rollouts[0], ca.horzcat(*(one.arrival.T for one in rollouts))
        missed = arrival - wanted
        limited = {one.name: _values(one, plants, rollouts) for one in form.quantities}
        least, most = form.sides
        energy = ca.if_else(width > 0, _round_off(form.energy, nominal, width), nominal.energy)

        bounded = {RESIDUAL: ca.vertcat(*(rows @ missed[:, i] for i, rows in enumerate(tips)))}
        bounded |= {name: values / scales[i] for i, (name, values) in enumerate(limited.items())}
        constraints = {"arrival": missed[:, 0] / scale if form.at_rest else ca.MX(0, 1)}
        for name, values in bounded.items():
            if name == form.peak:
                constraints |= {"below peak": values - most * p, "above peak": values - least * p}
            else:
                constraints[name] = values
        nlp = {
            "x": ca.veccat(a, p),
            "p": ca.veccat(row, wanted, scale, *tips, scales, weights, width),
            "f": weights[0] * energy + (weights[1] * p if form.peak else 0.0),
            "g": ca.vertcat(*constraints.values()),
        }
        self.counts = {name: values.numel() for name, values in constraints.items()}
        options = {**(_WARM if form.warm else _OPTIONS), "print_level": form.print_level}
        self.solver = compile_nlp(nlp, options)
        figures = [nominal.energy, arrival.T, *limited.values()]
        self.figures = ca.Function("figures", [a, row], figures)


compile_program = lru_cache(maxsize=16)(_Program)


def _values(
    quantity: Quantity, plants: Sequence[Plant], rollouts: Sequence[SymbolicRollout]
) -> ca.MX:
    """A limited quantity at all nodes, where it asks for that in all scenarios."""
    values, scenarios = list[Any](), len(plants) if quantity.in_scenarios else 1
    for plant, rollout in zip(plants[:scenarios], rollouts[:scenarios], strict=True):
        for joint, state, torque in zip(
            rollout.joints, rollout.states, rollout.torque, strict=True
        ):
            values += quantity.of(joint, plant.tip_displacements(state.W), torque)
    return ca.veccat(*(ca.MX.zeros(*rollouts[0].h.shape) + value for value in values))


def _round_off(energy: Energy, rollout: SymbolicRollout, width: ca.MX) -> Any:
    """The energy with the root of power^2 + width^2 [W] in place of |power|."""
    speeds = [joint.speed for joint in rollout.joints]
    smooth = [energy.smooth(*node) for node in zip(rollout.torque, speeds, strict=True)]
    rounded = [ca.sqrt(power**2 + width**2) for power in rollout.power]
    return energy.absolute * integrated(rounded, rollout.h) + integrated(smooth, rollout.h)


class _Numbers:
    """One problem's numbers: the parameters of its program, and what its solution means."""

    def __init__(self, problem: Problem, print_level: int, warm: bool) -> None:
        (transcription, self.asked), task = problem, problem.transcription.task
        self.task, self.profile, modes = task, transcription.profile, 2 * task.plant.modes
        self.tips = [vibration.rows for vibration in after_arrival(task)]
        tips = self.tips if self.asked.bounds_residual else [np.zeros((0, modes))] * len(self.tips)
        form = _Form(
            task.plant, self.profile, task.energy, transcription.steps,
            tuple(one.quantity for one in task.limits), task.error_names, task.scenarios,
            tuple(map(len, tips)), self.asked.at_rest, self.asked.peak,
            transcription.limits[self.asked.peak or RESIDUAL].sides, print_level, warm,
        )  # fmt: skip
        with keep_interrupts():  # casadi loses a Ctrl-C
            self.program = compile_program(form)
        self.wanted = np.array([task.final_state] * len(self.tips))
        if self.asked.offset is not None:
            self.wanted = self.wanted - self.asked.offset
        self._measure()
        self.parameters = [
            task.row, self.wanted, self.scale, *(r.T / self.scales[RESIDUAL] for r in tips),
            [self.scales[limit.name] for limit in task.limits], self.weights,
        ]  # fmt: skip

    def _measure(self) -> None:
        """Scales, by the plain motion; and weights of energy and scaled peak."""
        asked, (energy, arrival, peaks) = self.asked, self.figures(self.profile.plain)
        self.energy = energy or 1.0
        swing = np.abs(arrival - self.wanted).max(axis=0)
        self.scale = np.where(swing > 0, swing, 1.0)
        self.scales = {name: peak or 1.0 for name, peak in peaks.items()}
        self.scales[RESIDUAL] = self.residual(arrival) or 1.0
        peak_scale = self.scales[asked.peak] if asked.peak else 0.0
        of_energy, of_peak = asked.weights(self.energy, peak_scale)
        self.weights = [of_energy / self.energy, of_peak]

    def figures(self, coefficients: Array) -> tuple[float, Array, dict[str, float]]:
        """Energy, state on arrival by scenario, and peaks of the limited quantities."""
        with keep_interrupts():
            found = [x.full() for x in self.program.figures.call([coefficients, self.task.row])]
        limited = zip(self.task.limits, found[2:], strict=True)
        peaks = {one.name: float(one.peak(x.min(), x.max())) for one, x in limited}
        return found[0].item(), found[1], peaks

    def residual(self, arrival: Array) -> float:
        """The largest of all scenarios [m]."""
        missed = zip(self.tips, arrival - self.wanted, strict=True)
        return max(float(np.abs(rows @ state).max()) for rows, state in missed)

    def solve(self, start: Array, widths: Sequence[float]) -> Solution:
        """Run IPOPT for one width after another."""
        lower, upper = self.profile.box(self.asked.bound)
        x, total, stop = np.clip(start, lower, upper), 0, None
        if self.asked.peak is not None:
            _, arrival, peaks = self.figures(x)
            peaks[RESIDUAL] = self.residual(arrival)
            x = np.append(x, peaks[self.asked.peak] / self.scales[self.asked.peak])
            lower, upper = np.append(lower, -np.inf), np.append(upper, np.inf)
        for width in widths:
            given = [*self.parameters, [width * self.energy / self.task.duration]]
            parameters = np.concatenate([np.ravel(one) for one in given])
            bounds = (lower, upper), self._bounds()
            stop = run_ipopt(self.program.solver, x, *bounds, parameters)
            x, total = stop.unknowns, total + stop.iterations
        assert stop is not None
        return self._in_units(x, stop.multipliers, stop.return_status, total)

    def _bounds(self) -> tuple[Array, Array]:
        """Lower and upper bounds of the constraints."""
        bounds = {
            "arrival": (0.0, 0.0), "below peak": (-np.inf, 0.0), "above peak": (0.0, np.inf),
            **{one.name: (one.lower / self.scales[one.name], one.upper / self.scales[one.name])
               for one in self.asked.limits},
        }  # fmt: skip
        counts, free = self.program.counts, (-np.inf, np.inf)
        lower, upper = zip(*(bounds.get(name, free) for name in counts), strict=True)
        sizes = list(counts.values())
        return np.repeat(lower, sizes), np.repeat(upper, sizes)

    def _in_units(
        self, x: Array, multipliers: Array, return_status: str, iterations: int
    ) -> Solution:
        """What IPOPT found, in SI units."""
        asked, size = self.asked, self.profile.size
        coefficients = np.clip(x[:size], *self.profile.box(asked.bound))
        energy, arrival, peaks = self.figures(coefficients)
        status = SolveStatus.from_ipopt(return_status)
        rest = asked.at_rest and status.solved
        return Solution(
            coefficients=coefficients,
            energy=energy,
            peaks={RESIDUAL: 0.0 if rest else self.residual(arrival), **peaks},
            status=status,
            iterations=iterations,
            arrival=arrival if asked.offset is None else arrival + asked.offset,
            shadow_prices=self._shadow_prices(multipliers),
            reason=return_status.replace("_", " ").lower(),
        )

    def _shadow_prices(self, multipliers: Array) -> dict[str, float]:
        """What the least energy falls by if a limit is widened [J by its unit]."""
        counts = self.program.counts
        parts = np.split(multipliers, np.cumsum(list(counts.values()))[:-1])
        own = dict(zip(counts, parts, strict=True))
        bounded = {name: own[name] / self.scales[name] for name in own.keys() & self.scales.keys()}
        of_arrival = own["arrival"] / self.scale if self.asked.at_rest else own["arrival"]
        return shadow_prices(self.asked, self.weights[0], bounded, of_arrival, self.tips[0])
