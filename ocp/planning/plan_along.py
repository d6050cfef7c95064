"""The plan along one profile: least energy within a residual limit, in every scenario of the task.

A certain task has one scenario. Of an uncertain one the residual of every scenario is a constraint
of one problem, and the peaks between them become scenarios until the limit holds there as well.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.candidate import Candidate
from quietarm.ocp.errors import InfeasibleTaskError, SolverFailedError
from quietarm.ocp.limits import RESIDUAL
from quietarm.ocp.planning.best_of_starts import best_of_starts, solve_from_starts
from quietarm.ocp.planning.certify import OVERRUN, certify_one
from quietarm.ocp.planning.plan import Plan
from quietarm.ocp.planning.request import Request
from quietarm.ocp.planning.too_short import arrives_at_rest, refuse_too_short
from quietarm.ocp.record import REST
from quietarm.ocp.robustness import Worst
from quietarm.ocp.task import PointToPoint

EXCESS = 0.05
"""Share of the limit by which the residual between scenarios may exceed it before more are added;
and the room above the least worst case, where no lower limit can be reached."""
_ROUNDS = 6
"""Most rounds that add a plan's `peaks` as scenarios."""
_TIGHTENINGS = 4
"""Most times that the limit is tightened by the remaining excess."""

Array = NDArray[np.float64]


def plan_along(request: Request) -> Plan:
    """The plan along the profile of a request, within its residual limit."""
    began = time.perf_counter()
    plan = _adapt_limit(request) if request.adapts else _keep_limit(request)
    return plan.restated(seconds=time.perf_counter() - began)


def _keep_limit(request: Request) -> Plan:
    """The plan within a residual limit that is stated, between the scenarios as well.

    SolverFailedError where the worst case exceeds it.
    """
    plan = _hold(request, request.guesses)
    if plan.worst is None or (plan.excess or 0.0) <= OVERRUN:
        return plan
    unit = request.task.plant.tip_unit
    raise SolverFailedError(
        f"the residual is {plan.worst.residual:.4g} {unit} in the worst case, above its "
        f"limit of {request.residual_limit:g} {unit}: give a larger residual limit, more "
        f"{request.profile.term}s or a smaller uncertainty"
    )


def _adapt_limit(request: Request) -> Plan:
    """The plan within the default limit, at most the worst case of the nominal plant's plan.

    If neither is feasible, the limit is near the least residual over the scenarios; if that does
    not hold between them, it is the worst case of the plan.
    """
    request = replace(request, quick=False)
    starts = request.guesses
    nominal = _nominal_plan(request)
    nominal_worst = np.inf
    if nominal is not None and nominal.worst is not None:
        nominal_worst = nominal.worst.residual
        starts = [np.array(nominal.coefficients), *starts]
    most = max(nominal_worst, REST * request.task.smallness)
    limit = min(request.residual_limit, most)
    try:
        plan = _hold(request.within(limit), starts)
    except InfeasibleTaskError:
        least = _least_residual(request, starts)
        if least is None:
            raise
        limit = min((1 + EXCESS) * least, most)
        plan = _hold(request.within(limit), starts)
    assert plan.worst is not None
    if plan.excess is None or plan.excess <= OVERRUN:
        return plan
    if nominal is not None and plan.worst.residual > nominal_worst:
        plan = nominal
    assert plan.worst is not None
    return plan.with_entries(residual_limit=plan.worst.residual)


def _nominal_plan(request: Request) -> Plan | None:
    """The plan at rest of the nominal plant, for the uncertain task; None where there is none."""
    nominal = request.on(request.task.certain).within(0.0)
    try:
        refuse_too_short(nominal.task, arrives_at_rest(nominal.task, nominal.residual_limit))
        plan = _hold(nominal, request.guesses)
    except SolverFailedError:  # only other motions may keep the limits
        return None
    return plan.on(request.task)


def _least_residual(request: Request, starts: list[Array]) -> float | None:
    """The least residual over the scenarios [m]; None where no start was solved."""
    problem = request.within(np.inf).problem(minimise={RESIDUAL: 1.0})
    (stillest,) = best_of_starts([problem], [starts], request.solver)
    return stillest.residual if stillest.status.solved else None


def _hold(request: Request, starts: list[Array], most_starts: int = 4) -> Plan:
    """The plan whose residual limit holds between the scenarios as well, if that can be had.

    Where its residual exceeds the limit between them by more than `EXCESS`, those peaks become
    scenarios, and of the motions that were found so many are the next starts. The limit is then
    divided by the remaining excess; where that does not settle it, they become scenarios as well.
    """
    limit = request.residual_limit
    plan, solved = plan_from_starts(request, starts)
    between = list(plan.peaks)
    tightened = limit
    rounds = 0
    tightenings = 0
    while between:
        excess = between[0].residual / limit - 1
        above = [peak for peak in between if peak.residual > limit]
        scenarios = _new_scenarios(request.task, above)
        can_add = bool(scenarios) and rounds < _ROUNDS
        can_tighten = excess > 0 and tightenings < _TIGHTENINGS
        starts = [np.array(plan.coefficients)]
        if can_add and (
            (excess > EXCESS and not tightenings) or (excess > OVERRUN and not can_tighten)
        ):
            rounds += 1
            tightenings = 0
            tightened = limit
            known = request.task.scenarios[1:]
            request = request.on(request.task.with_samples([*known, *scenarios]))
            following = request
            starts += solved[:most_starts]
        elif can_tighten:
            tightenings += 1
            tightened /= (1 + excess) * (1 + OVERRUN)
            following = replace(request, steps=plan.steps, quick=True).within(tightened)
        else:
            break
        try:
            another, solved_now = plan_from_starts(following, starts)
            between = list(another.peaks)
            plan, solved = another, solved_now
        except SolverFailedError:
            if not tightenings:
                raise
            tightenings = _TIGHTENINGS  # a tighter limit leads nowhere: more scenarios may
    return plan.with_entries(residual_limit=limit)


def plan_from_starts(request: Request, starts: Sequence[Array]) -> tuple[Plan, list[Array]]:
    """The plan from starts, whose limit holds in all scenarios.

    And the coefficients of all that were solved, cheapest first. Errors are those of
    `solve_from_starts` and `certify`.
    """
    began = time.perf_counter()
    problem = request.problem()
    best, solved = solve_from_starts(
        problem,
        starts,
        request.solver,
        quick=request.quick,
        thorough=request.thorough,
        has_stand_in=request.has_stand_in,
    )
    certified = certify_one(problem, best, request.solver)
    assert isinstance(certified.checked, Candidate)  # a single motion is judged by CVODES
    solution = certified.solution
    plan = Plan.of_candidate(
        certified.checked,
        status=solution.status,
        record=request.record(
            request.solver.name, solution.iterations, time.perf_counter() - began
        ),
        steps=certified.steps,
        residual_limit=request.residual_limit,
        shadow_prices=solution.shadow_prices,
    )
    return plan, [solution.coefficients for solution in solved]


def _new_scenarios(task: PointToPoint, peaks: list[Worst], same: float = 1e-6) -> list[list[float]]:
    """The errors of those peaks that are no scenario of the task yet.

    Errors that differ by less than the share `same` of their range are one scenario.
    """
    known = np.array(task.scenarios[1:])
    near = same * np.array(list(task.ranges.values()))
    errors = [list(peak.errors.values()) for peak in peaks]
    return [error for error in errors if (np.abs(known - error) > near).any(axis=1).all()]
