"""The two ends of a front: at rest on arrival, or of least residual, and the cheapest."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.figures import ENERGY
from quietarm.ocp.front.points import point_of
from quietarm.ocp.front.tradeoff import BETWEEN_ENDS, RESIDUAL_LIMIT, Certificate, Tradeoff
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.limits import RESIDUAL, Limit
from quietarm.ocp.planning.best_of_starts import (
    SAME,
    best_of_starts,
    solve_from_starts,
)
from quietarm.ocp.planning.certify import Certified, certify_one
from quietarm.ocp.planning.plan_along import plan_along
from quietarm.ocp.planning.remedies import least_peaks_of
from quietarm.ocp.rest import still_of
from quietarm.ocp.solvers.problem import (
    LEAST_ENERGY,
    Program,
    Solution,
)


@dataclass(frozen=True)
class Ends:
    """The ends of a front, on a trade-off of the steps that the end of least residual needs."""

    tradeoff: Tradeoff
    still: Solution
    cheapest: Solution
    certificates: tuple[Certificate, Certificate]

    @property
    def width(self) -> float:
        """Distance between the ends in the residual [m]."""
        return self.cheapest.residual - self.still.residual

    @property
    def height(self) -> float:
        """Distance between the ends in the energy [J]."""
        return self.still.energy - self.cheapest.energy

    @property
    def are_one(self) -> bool:
        """Return whether the two ends are the same motion, and there is no front between."""
        return self.width <= still_of(self.tradeoff.task) or self.height <= SAME * self.still.energy


def find_ends(tradeoff: Tradeoff) -> Ends:
    """Find the motion of least energy that arrives at rest, and that whose residual is free.

    The number of steps is raised until CVODES agrees at the end of least residual. If no motion
    arrives at rest, this end is the motion of least residual; for an uncertain task it is where a
    smaller residual would cost too much energy. Errors are those of `solve_from_starts`.
    """
    if tradeoff.task.uncertainty is not None:
        return _within_ranges(tradeoff)
    end_at_rest = _at_rest(tradeoff)  # first: it settles the number of steps
    if end_at_rest is not None:
        tradeoff = end_at_rest.tradeoff
    cheapest, _ = solve_from_starts(tradeoff.problem(), tradeoff.starts, tradeoff.solver)
    still = end_at_rest or _least_residual(tradeoff, cheapest)
    certificates = still.certificate, _certify_cheapest(tradeoff, cheapest)
    return Ends(tradeoff, still.solution, cheapest, certificates)


class _Still(NamedTuple):
    """The end at rest, or of least residual, on a trade-off of the steps that it takes."""

    tradeoff: Tradeoff
    solution: Solution
    certificate: Certificate


def _certify_cheapest(tradeoff: Tradeoff, cheapest: Solution) -> Certificate:
    (end,) = tradeoff.certify([(cheapest, {RESIDUAL_LIMIT: cheapest.residual})], free=True)
    return end


def _at_rest(tradeoff: Tradeoff) -> _Still | None:
    """The motion at rest; None where there is none."""
    solver = tradeoff.solver
    try:
        problem = tradeoff.problem(0.0)
        first, _ = solve_from_starts(problem, tradeoff.starts, solver)
        rough = certify_one(problem, first, solver, agreement=BETWEEN_ENDS)
        tradeoff = replace(tradeoff, program=rough.problem)
        end = certify_one(tradeoff.problem(0.0), rough.solution, solver)
    except SolverFailedError:
        return None
    return _Still(tradeoff, rough.solution, tradeoff.certificate_of(end))


def _least_residual(tradeoff: Tradeoff, cheapest: Solution) -> _Still:
    """The motion of least residual, and of motions of that residual the cheapest.

    Limits are tightened while the residual is minimised: at the least residual there is no room to
    tighten them in.
    """
    solver = tradeoff.solver
    least = least_peaks_of(tradeoff.problem(), tradeoff.starts, solver).get(RESIDUAL)
    if least is None:
        return _Still(tradeoff, cheapest, _certify_cheapest(tradeoff, cheapest))
    limits = tradeoff.problem().limits
    try:
        reached = certify_one(tradeoff.problem(minimise={RESIDUAL: 1.0}), least, solver, limits)
        problem = _cheapest_of_residual(reached)
        (solution,) = solver.solve([problem], [reached.solution.coefficients], warm=True)
        still = solution if solution.status.solved else reached.solution
        end = certify_one(problem, still, solver, limits)
    except SolverFailedError:
        (failed,) = tradeoff.certify([(least, {RESIDUAL_LIMIT: least.residual})])
        return _Still(tradeoff, least, failed)
    certificate = tradeoff.certificate_of(end)
    iterations = least.iterations + certificate.iterations
    return _Still(tradeoff, still, certificate._replace(iterations=iterations))


def _cheapest_of_residual(reached: Certified, between_samples: float = 1e-4) -> Program:
    """The problem of least energy within the residual that was reached.

    By the share `between_samples` the residual may exceed there what it is at its samples.
    """
    residual = Limit.of_residual(reached.solution.residual * (1 + between_samples))
    limits = [limit for limit in reached.problem.limits if limit.name != RESIDUAL]
    return reached.problem.asking(
        limits=(*limits, residual),
        minimise=LEAST_ENERGY,
        offset=0.0,
    )


def _within_ranges(tradeoff: Tradeoff) -> Ends:
    """The ends of an uncertain task; with a band the end of least residual is the plan for it.

    The plan keeps the band in all of the ranges, with its worst cases as scenarios. The points
    between the ends have these scenarios as well. Without a band, or a plan that keeps it, the
    scenarios are those of the task.
    """
    task = tradeoff.task
    nominal = find_ends(Tradeoff.begin(tradeoff.request.on(task.certain)))
    if task.band_limit is None:
        return _of_scenarios(tradeoff, nominal)
    request = replace(tradeoff.request.within(task.band_limit), quick=True)
    try:
        plan = plan_along(request)
    except SolverFailedError:
        return _of_scenarios(tradeoff, nominal)
    steps = max(nominal.tradeoff.program.steps, plan.steps)
    profile = tradeoff.program.profile
    kept = replace(
        tradeoff,
        request=tradeoff.request.on(plan.task),
        program=Program(plan.task, profile, steps),
    )
    found = np.array(plan.coefficients)
    starts = [nominal.cheapest.coefficients, found]
    (cheapest,) = best_of_starts([kept.problem()], [starts], kept.solver)
    within = kept.problem(task.band_limit)
    (still,) = best_of_starts([within], [[found]], kept.solver, warm=True)
    motion = JudgedMotion.of_profile(plan.task, profile, found)
    point = replace(point_of(motion, kept.objectives), shadow_prices=plan.shadow_prices)
    certificate = Certificate(point, plan.record.iterations or 0)
    return Ends(kept, still, cheapest, (certificate, _certify_cheapest(kept, cheapest)))


def _of_scenarios(
    tradeoff: Tradeoff,
    nominal: Ends,
    energy_weights: tuple[float, ...] = (1.0, 0.1, 0.02, 2e-3),
) -> Ends:
    """The ends of an uncertain task, from those of the nominal one.

    Its energy is that of the nominal plant, so the cheapest motion is the same. Neither rest in all
    scenarios nor the least residual is asked for: both would cost any energy. On the way to the end
    of least residual the energy is weighted beside the residual, one solve after the other. At the
    last weight, reducing the residual by a further hundredth of the cheapest end's would cost five
    times the energy of the nominal plant's motion at rest.
    """
    profile = tradeoff.program.profile
    steps = nominal.tradeoff.program.steps
    tradeoff = replace(tradeoff, program=Program(tradeoff.task, profile, steps))
    starts = [nominal.cheapest.coefficients, nominal.still.coefficients]
    (cheapest,) = best_of_starts([tradeoff.problem()], [starts], tradeoff.solver)
    still = cheapest
    for weight in energy_weights if cheapest.residual > still_of(tradeoff.task) else ():
        weights = {RESIDUAL: 1 / cheapest.residual, ENERGY: weight / nominal.still.energy}
        problem = tradeoff.problem(minimise=weights)
        (solution,) = tradeoff.solver.solve([problem], [still.coefficients])
        if solution.status.solved:
            still = solution
    (certificate,) = tradeoff.certify([(still, {RESIDUAL_LIMIT: still.residual})])
    return Ends(tradeoff, still, cheapest, (certificate, _certify_cheapest(tradeoff, cheapest)))
