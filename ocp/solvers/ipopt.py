"""The independent answer: a problem written down in CasADi as it stands, and solved by IPOPT.

All derivatives are CasADi's own. It shares the symbolic simulation with `Sqp`, and nothing else.
Unknowns are the coefficients a, the scaled state z that is missed on arrival in every scenario, and
the scaled peak p that is minimised, where one is:

    minimise    weight * energy(a) + weight * p
    subject to  (arrival(a) - wanted) / scale = z
                z = 0 for the nominal plant        where rest on arrival is asked for
                |tips * scale * z| <= limit, or p  where the residual is bounded
                |quantity(a)| <= limit, or p       at every node of the steps
                lower <= a <= upper
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
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.objective import integrated
from quietarm.ocp.simulation.residual import residual_rows
from quietarm.ocp.simulation.rollout import SymbolicRollout, symbolic_rollout
from quietarm.ocp.solvers.nlp import OPTIONS, compile_nlp, run_ipopt
from quietarm.ocp.solvers.problem import Problem, Scalarization
from quietarm.ocp.solvers.solution import Solution, price_of_rest
from quietarm.ocp.solvers.transcription import ENERGY, RESIDUAL
from quietarm.ocp.task import QUANTITIES, ask_for_jerk
from quietarm.ocp.uncertainty import perturb_plant

Array = NDArray[np.float64]
_WIDTHS = (0.1, 0.02, 0.0)
"""Shares of the plain motion's mean power over which |power| is rounded off, run by run."""


class _Form(NamedTuple):
    """What problems that share a compiled solver have in common; all else are its parameters."""

    plant: Plant
    profile: JointProfile
    energy: Energy
    steps: int
    quantities: tuple[str, ...]
    error_names: tuple[str, ...]
    scenarios: tuple[tuple[float, ...], ...]
    tips: tuple[int, ...]
    peak: str | None
    print_level: int


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
        return [_Numbers(one, self.print_level).solve(start, widths) for one, start in pairs]


class _Nlp:
    """The nonlinear program of a form in symbols, and IPOPT compiled for it."""

    def __init__(self, form: _Form) -> None:
        modes, scenarios = 2 * form.plant.modes, len(form.scenarios)
        a = ca.MX.sym("a", form.profile.size)
        z = ca.MX.sym("z", modes, scenarios)
        p = ca.MX.sym("p", form.peak is not None)
        move, scale = ca.MX.sym("move", 3 + modes), ca.MX.sym("scale", modes)
        wanted = ca.MX.sym("wanted", modes, scenarios)
        tips = [ca.MX.sym("tips", rows, modes) for rows in form.tips]
        scales = ca.MX.sym("scales", len(form.quantities))
        weights, width = ca.MX.sym("weights", 2), ca.MX.sym("width")

        rollouts = [_simulate(form, errors, a, move) for errors in form.scenarios]
        arrival = ca.horzcat(*(rollout.arrival.T for rollout in rollouts))
        limited = {name: _values(form, name, rollouts) for name in form.quantities}
        bounded = {RESIDUAL: ca.vertcat(*(r @ (scale * z[:, i]) for i, r in enumerate(tips)))}
        bounded |= {name: limited[name] / scales[i] for i, name in enumerate(form.quantities)}
        constraints = {"arrival": ca.vec((arrival - wanted) / ca.repmat(scale, 1, scenarios) - z)}
        for name, values in bounded.items():
            if name == form.peak:
                constraints |= {"below peak": values - p, "above peak": values + p}
            else:
                constraints[name] = values
        nominal = rollouts[0]
        energy = ca.if_else(width > 0, _rounded_energy(form.energy, nominal, width), nominal.energy)
        nlp = {
            "x": ca.veccat(a, z, p),
            "p": ca.veccat(move, wanted, scale, *tips, scales, weights, width),
            "f": weights[0] * energy + (weights[1] * p if form.peak else 0.0),
            "g": ca.vertcat(*constraints.values()),
        }
        self.counts = {name: values.numel() for name, values in constraints.items()}
        self.solver = compile_nlp(nlp, {**OPTIONS, "print_level": form.print_level})
        on_the_way = ca.vertcat(*(
            ca.mmax(ca.fabs(ca.horzcat(*(getattr(state, part)[i] for state in nominal.states))))
            for part in ("W", "dW")
            for i in range(form.plant.modes)
        ))  # fmt: skip
        figures = [nominal.energy, arrival.T, on_the_way, *limited.values()]
        self.figures = ca.Function("figures", [a, move], figures)


_compile = lru_cache(maxsize=16)(_Nlp)


def _simulate(form: _Form, errors: Sequence[float], a: ca.MX, move: ca.MX) -> SymbolicRollout:
    """The motion of one scenario."""
    coordinates = ca.vertsplit(move)
    return symbolic_rollout(
        _perturb(form, errors), form.profile, ca.vertsplit(a), coordinates[:3], form.steps,
        jerk=ask_for_jerk(form.quantities), initial=coordinates[3:], energy=form.energy,
    )  # fmt: skip


def _perturb(form: _Form, errors: Sequence[float]) -> Plant:
    return perturb_plant(form.plant, dict(zip(form.error_names, errors, strict=True)))


def _values(form: _Form, name: str, rollouts: Sequence[SymbolicRollout]) -> ca.MX:
    """A limited quantity at all nodes; the deflection of all scenarios."""
    counted = rollouts if name == "deflection" else rollouts[:1]
    return ca.veccat(*(
        ca.MX.zeros(1, form.steps) + value
        for rollout, errors in zip(counted, form.scenarios, strict=False)
        for joint, state, torque in zip(
            rollout.joints, rollout.states, rollout.torque, strict=True)
        for value in QUANTITIES[name].of(
            joint, _perturb(form, errors).tip_displacements(state.W), torque)
    ))  # fmt: skip


def _rounded_energy(energy: Energy, rollout: SymbolicRollout, width: ca.MX) -> Any:
    """The energy with |power| rounded off to the root of power^2 + width^2 [W]."""
    speeds = [joint.speed for joint in rollout.joints]
    smooth = [energy.smooth(*node) for node in zip(rollout.torque, speeds, strict=True)]
    rounded = [ca.sqrt(power**2 + width**2) for power in rollout.power]
    return energy.absolute * integrated(rounded, rollout.h) + integrated(smooth, rollout.h)


class _Numbers:
    """One problem's numbers: the parameters of its program, and what its solution means."""

    def __init__(self, problem: Problem, print_level: int) -> None:
        (transcription, self.asked), task = problem, problem.transcription.task
        self.task, self.profile, modes = task, transcription.profile, 2 * task.plant.modes
        self.tips = [residual_rows(task, plant) for plant in task.perturbed_plants]
        tips = self.tips if self.asked.bounds_residual else [np.zeros((0, modes))] * len(self.tips)
        self.nlp = _compile(
            _Form(
                task.plant, self.profile, task.energy, transcription.steps, tuple(task.limits),
                task.error_names, task.scenarios, tuple(map(len, tips)), self.asked.peak,
                print_level,
            )
        )  # fmt: skip
        energy, _, on_the_way, peaks = self.figures(self.profile.plain)
        self.energy = energy or 1.0
        self.scale = np.where(on_the_way > 0, on_the_way, 1.0)
        tip = max(float(np.abs(rows * self.scale).max()) for rows in self.tips)
        self.scales = {RESIDUAL: tip} | {name: peak or 1.0 for name, peak in peaks.items()}
        self.wanted = np.array([task.final_state] * len(self.tips))
        if self.asked.offset is not None:
            self.wanted = self.wanted - self.asked.offset
        self.weights = self._weights(self.asked)
        self.parameters = [
            task.row, self.wanted, self.scale, *(rows.T / tip for rows in tips),
            [self.scales[name] for name in task.limits], self.weights,
        ]  # fmt: skip

    def figures(self, coefficients: Array) -> tuple[float, Array, Array, dict[str, float]]:
        """Energy, state on arrival by scenario, largest state on the way, and peaks."""
        with keep_interrupts():
            found = [x.full() for x in self.nlp.figures.call([coefficients, self.task.row])]
        peaks = [float(np.abs(values).max()) for values in found[3:]]
        names = zip(self.task.limits, peaks, strict=True)
        return found[0].item(), found[1], found[2].ravel(), dict(names)

    def residual(self, arrival: Array) -> float:
        """The largest of all scenarios [m]."""
        missed = zip(self.tips, arrival - self.wanted, strict=True)
        return max(float(np.abs(rows @ state).max()) for rows, state in missed)

    def _weights(self, asked: Scalarization) -> list[float]:
        """Of the energy and of the scaled peak; the larger of the scaled ones is 1."""
        of_energy = asked.minimise.get(ENERGY, 0.0) * self.energy
        of_peak = asked.minimise[asked.peak] * self.scales[asked.peak] if asked.peak else 0.0
        largest = max(of_energy, of_peak)
        return [of_energy / largest / self.energy, of_peak / largest]

    def solve(self, start: Array, widths: Sequence[float]) -> Solution:
        """Run IPOPT for one width after another."""
        lower, upper = self.profile.box(self.asked.bound)
        a = np.clip(start, lower, upper)
        _, arrival, _, peaks = self.figures(a)
        z = (arrival - self.wanted) / self.scale
        free = np.full(z.shape, np.inf)
        free[0] = 0.0 if self.asked.at_rest else np.inf
        peaks[RESIDUAL] = self.residual(arrival)
        p = [peaks[name] / self.scales[name] for name in [self.asked.peak] if name]
        unbounded = np.full(len(p), np.inf)
        box = (
            np.concatenate([lower, -free.ravel(), -unbounded]),
            np.concatenate([upper, free.ravel(), unbounded]),
        )
        x, iterations, stop = np.concatenate([a, z.ravel(), p]), 0, None
        for width in widths:
            given = [*self.parameters, [width * self.energy / self.task.duration]]
            parameters = np.concatenate([np.ravel(one) for one in given])
            stop = run_ipopt(self.nlp.solver, x, box, self._bounds(), parameters)
            x, iterations = stop.unknowns, iterations + stop.iterations
        assert stop is not None
        return self._in_units(x, stop.multipliers, stop.return_status, iterations)

    def _bounds(self) -> tuple[Array, Array]:
        """Lower and upper bounds of the constraints."""
        lower, upper = list[Array](), list[Array]()
        for name, count in self.nlp.counts.items():
            limit = self.asked.limits.get(name, np.inf) / self.scales.get(name, 1.0)
            least, most = {
                "arrival": (0.0, 0.0), "below peak": (-np.inf, 0.0), "above peak": (0.0, np.inf),
            }.get(name, (-limit, limit))  # fmt: skip
            lower.append(np.full(count, least))
            upper.append(np.full(count, most))
        return np.concatenate(lower), np.concatenate(upper)

    def _in_units(
        self, x: Array, multipliers: Array, return_status: str, iterations: int
    ) -> Solution:
        """What IPOPT found, in SI units."""
        asked, size = self.asked, self.profile.size
        coefficients = np.clip(x[:size], *self.profile.box(asked.bound))
        energy, arrival, _, peaks = self.figures(coefficients)
        status = SolveStatus.from_ipopt(return_status)
        rest = asked.at_rest and status.solved
        stops = np.cumsum(list(self.nlp.counts.values()))[:-1]
        of = dict(zip(self.nlp.counts, np.split(multipliers, stops), strict=True))
        prices = dict[str, float]()
        if self.weights[0]:
            for name in asked.limits.keys() & of.keys():
                prices[name] = float(np.abs(of[name]).sum()) / self.weights[0] / self.scales[name]
            if asked.at_rest:
                of_arrival = of["arrival"][: self.scale.size] / self.scale
                prices[RESIDUAL] = price_of_rest(of_arrival, self.tips[0]) / self.weights[0]
        return Solution(
            coefficients=coefficients,
            energy=energy,
            peaks={RESIDUAL: 0.0 if rest else self.residual(arrival), **peaks},
            status=status,
            iterations=iterations,
            arrival=arrival if asked.offset is None else arrival + asked.offset,
            shadow_prices=prices,
            reason=return_status.replace("_", " ").lower(),
        )
