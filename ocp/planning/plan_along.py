"""The plan along one profile: least energy within a residual limit, in every scenario of the task.

A certain task has one scenario. Of an uncertain one the residual of every scenario is a constraint
of one problem, and the peaks between them become scenarios until the limit holds there as well.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.errors import InfeasibleTaskError, SolverFailedError
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.limits import RESIDUAL
from quietarm.ocp.planning.best_of_starts import (
    SAME,
    best_of_starts,
    is_beyond,
    minimum_of,
    shortened,
    solve_from_starts,
)
from quietarm.ocp.planning.certify import OVERRUN, by_cvodes, certify_one
from quietarm.ocp.planning.plan import Plan
from quietarm.ocp.planning.remedies import stated_limit
from quietarm.ocp.planning.request import Request
from quietarm.ocp.planning.residual_limit import band_words
from quietarm.ocp.planning.too_short import arrives_at_rest, refuse_too_short
from quietarm.ocp.planning.worst_scenarios import new_scenarios, with_moved_scenarios
from quietarm.ocp.rest import rest_of
from quietarm.ocp.robustness import peaks_between
from quietarm.ocp.solvers.choice import stand_in_settings
from quietarm.ocp.solvers.least_excess import Excess, least_excess
from quietarm.ocp.solvers.problem import Program, Solution
from quietarm.ocp.solvers.solver import NAME

EXCESS = 0.05
"""Share of the limit by which the residual between scenarios may exceed it before more are added;
and the room above the least worst case, where no lower limit can be reached."""
_ROUNDS = 6
"""Most rounds that add a plan's `peaks` as scenarios."""
_TIGHTENINGS = 4
"""Most times that the limit is tightened by the remaining excess."""
_MOST_MOTIONS = 4
"""Of the nominal plant, from which a robust plan starts."""
_NOMINAL_STARTS = 8
"""Most starts of a robust plan, these motions and given ones, unless more are asked for."""
_BETWEEN = 2e-4
"""Share of the limit that is left to the worst case where it is beside a scenario."""

FAR = 0.03
"""Share by which the limits have to be wider by linear programs, above which no robust plan is
looked for."""

Array = NDArray[np.float64]


def plan_along(request: Request) -> Plan:
    """The plan along the profile of a request, within its residual limit."""
    began = time.perf_counter()
    if request.adapts:
        plan = _adapt_limit(request)
    else:
        plan = _keep_briefly(request) if request.is_held else _keep_limit(request)
    return plan.restated(seconds=time.perf_counter() - began)


def _keep_briefly(request: Request) -> Plan:
    """The plan within a residual limit that is held: what can be had is soon found, or refused.

    No other solver stands in, which takes most of a refusal and finds nothing.
    """
    if not request.quick:
        refuse_far_beyond(request)
    brief = replace(request, solver=shortened(request.solver), has_stand_in=False)
    plan = _keep_limit(brief)
    only_brief = brief.solver.stated
    settings = {
        name: value for name, value in plan.record.settings.items() if name not in only_brief
    }
    return plan.restated(settings=settings | dict(request.solver.stated))


def refuse_far_beyond(request: Request) -> None:
    """Refuse limits that linear programs find far out of reach; InfeasibleTaskError says how far.

    They are asked of an uncertain plant alone, which takes the solver many times as long.
    """
    excess = excess_of(request)
    if excess is None or not excess.is_beyond(FAR):
        return
    limits = request.problem().limits
    stated = ", ".join(stated_limit(request.task, limit) for limit in limits)
    names = " and ".join(limit.label for limit in request.task.limits)
    raise InfeasibleTaskError(
        f"found no motion of {request.profile.amount} with {stated}",
        f"limits of {names} wider by {100 * excess.share:.0f} % or more, a longer duration or a "
        "larger residual may do",
    )


def excess_of(request: Request) -> Excess | None:
    """The least share by which limits have to be wider, by linear programs; None without limits."""
    return least_excess(request.problem(), request.guesses[0]) if request.task.limits else None


def _keep_limit(request: Request) -> Plan:
    """The plan within a residual limit that is stated, between the scenarios as well.

    SolverFailedError where the worst case exceeds it.
    """
    plan = _hold(request, request.guesses)
    if plan.worst is None or (plan.excess or 0.0) <= OVERRUN:
        return plan
    unit = request.task.plant.tip_unit
    band = band_words(request.task, request.residual_limit)
    if band:
        raise SolverFailedError(
            f"the residual is {1e3 * plan.worst.residual:.4g} mm in the worst case, above its "
            f"limit of {1e3 * request.residual_limit:.4g} mm ({band}): give a wider band, more "
            f"{request.profile.term}s or a smaller uncertainty"
        )
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
    nominal, motions = _nominal_plan(request)
    if nominal is not None:
        # of many random starts, as networks take them, those stand for the others that led there
        starts = [*motions, *starts[: max(request.starts, _NOMINAL_STARTS - len(motions))]]

    def within_nominal(limit: float) -> float:
        """Return the limit, or the worst case of the nominal plant's plan where that is less."""
        if nominal is None or not request.task.ranges:
            return limit
        if nominal.residual >= limit:  # in the scenarios alone, which is soon computed
            return limit
        return min(limit, max(worst_residual(nominal), rest_of(request.task)))

    limit = within_nominal(request.residual_limit)
    try:
        plan = _hold(request.within(limit), starts, gives_up=True)
    except InfeasibleTaskError:
        least = _least_residual(request, starts)
        limit = limit if least is None else within_nominal((1 + EXCESS) * least)
        plan = _hold(request.within(limit), starts)
    if plan.excess is None or plan.excess <= OVERRUN:
        return plan
    if nominal is not None and worst_residual(plan) > worst_residual(nominal):
        plan = nominal
    return plan.with_entries(residual_limit=worst_residual(plan))


def worst_residual(plan: Plan) -> float:
    """Return what the plan of an uncertain task leaves in the worst case [m]."""
    return plan.residual if plan.worst is None else plan.worst.residual


def _nominal_plan(request: Request) -> tuple[Plan | None, list[Array]]:
    """The plan at rest of the nominal plant, for the uncertain task; None where there is none.

    And the coefficients of some that were solved, itself first.
    """
    nominal = request.on(request.task.certain).within(0.0)
    try:
        refuse_too_short(nominal.task, arrives_at_rest(nominal.task, nominal.residual_limit))
        plan, motions = plan_from_starts(nominal, request.guesses)
    except SolverFailedError:  # only other motions may keep the limits
        return None, []
    motions = [np.array(plan.coefficients), *motions[1:_MOST_MOTIONS]]
    return plan.on(request.task), motions


def _least_residual(request: Request, starts: list[Array]) -> float | None:
    """The least residual over the scenarios [m]; None where no start was solved."""
    problem = request.within(np.inf).problem(minimise={RESIDUAL: 1.0})
    (stillest,) = best_of_starts([problem], [starts], request.solver)
    return stillest.residual if stillest.status.solved else None


class _Solved(NamedTuple):
    """A problem, its best solution from some starts, the coefficients of all, and how long it took.

    The cheapest come first; of those that cost the same there is one.
    """

    problem: Program
    best: Solution
    motions: list[Array]
    seconds: float

    @property
    def peaks(self) -> list[JudgedMotion]:
        """Peaks of the best motion's residual between the scenarios, before it is certified."""
        return peaks_between(by_cvodes(self.problem, self.best.coefficients), roughly=True)


def _hold(
    request: Request, starts: list[Array], most_starts: int = 4, gives_up: bool = False
) -> Plan:
    """The plan whose residual limit holds between the scenarios as well, if that can be had.

    Where its residual exceeds the limit between them by more than `EXCESS`, those peaks become
    scenarios, and of the motions that were found so many are the next starts. The limit is then
    divided by the remaining excess; where that does not settle it, they become scenarios as well.
    A search that gives up looks for nothing else where no start leads to a limit far out of reach.
    """
    limit = request.residual_limit
    request, solved = _solve_with_the_worst(request, starts, most_starts, gives_up)
    plan = _certified_plan(request, solved)
    between = list(plan.peaks)
    tightened = limit
    rounds = 0
    tightenings = 0
    while between:
        excess = between[0].residual / limit - 1
        above = [peak for peak in between if peak.residual > limit]
        scenarios = new_scenarios(request.task, above)
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
            starts += solved.motions[:most_starts]
        elif can_tighten:
            tightenings += 1
            tightened /= (1 + excess) * (1 + OVERRUN)
            following = replace(request, steps=plan.steps, quick=True).within(tightened)
        else:
            break
        try:
            again = _solve_near(following, starts) if tightenings else _solve(following, starts)
            another = _certified_plan(following, again)
            between = list(another.peaks)
            plan, solved = another, again
        except SolverFailedError:
            if not tightenings:
                raise
            tightenings = _TIGHTENINGS  # a tighter limit leads nowhere: more scenarios may
    return plan.with_entries(residual_limit=limit)


def _solve_with_the_worst(
    request: Request, starts: list[Array], most_starts: int, gives_up: bool
) -> tuple[Request, _Solved]:
    """The request with the worst cases of its solution as scenarios, and that solution.

    They are looked for before anything is certified, which takes several solves. A worst case that
    is near one of those replaces it. A limit that is hardly exceeded is tightened by as much.
    """
    limit = request.residual_limit
    solved = _solve(request, starts, gives_up)
    for _ in range(_ROUNDS if request.task.ranges and limit > 0 else 0):
        peaks = solved.peaks
        excess = peaks[0].residual / limit - 1
        above = [peak for peak in peaks if peak.residual > (1 + OVERRUN) * limit]
        scenarios = new_scenarios(request.task, above)
        if not scenarios:
            if new_scenarios(request.task, peaks[:1]) and excess > -_BETWEEN:
                tightened = limit / (1 + max(excess, 0.0) + _BETWEEN)
                return request, _solve_near(request.within(tightened), solved.motions)
            break
        following = request.on(with_moved_scenarios(request.task, scenarios))
        try:
            if excess > EXCESS:
                near = solved.motions[:most_starts]
                solved = _solve(following, near, gives_up)
            else:
                solved = _solve_near(following, solved.motions)
        except SolverFailedError:
            if excess > EXCESS:
                raise
            break  # so little may be had by a tighter limit
        request = following
    return request, solved


def _solve(request: Request, starts: Sequence[Array], gives_up: bool = False) -> _Solved:
    """Solve from starts, with the errors of `solve_from_starts`."""
    if gives_up and not request.quick:
        try:
            return _solve(replace(request, quick=True), starts)
        except InfeasibleTaskError:
            if is_beyond(request.problem(), starts[0]):
                raise
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
    minima = [minimum_of(solution, problem) for solution in solved]
    cheaper = [-np.inf, *((1 + SAME) * minimum for minimum in minima)]
    distinct = [
        solution.coefficients
        for solution, minimum, most in zip(solved, minima, cheaper)
        if minimum > most
    ]
    return _Solved(problem, best, distinct, time.perf_counter() - began)


def _solve_near(request: Request, starts: Sequence[Array]) -> _Solved:
    """Solve from a start that is nearly a solution, or anew if that leads nowhere."""
    began = time.perf_counter()
    problem = request.problem()
    (best,) = best_of_starts([problem], [starts[:1]], request.solver, warm=True)
    if not best.status.solved:
        return _solve(request, starts)
    return _Solved(problem, best, [best.coefficients], time.perf_counter() - began)


def plan_from_starts(request: Request, starts: Sequence[Array]) -> tuple[Plan, list[Array]]:
    """The plan from starts, whose limit holds in all scenarios.

    And the coefficients of all that were solved, cheapest first. Errors are those of
    `solve_from_starts` and `certify`.
    """
    solved = _solve(request, starts)
    return _certified_plan(request, solved), solved.motions


def _certified_plan(request: Request, solved: _Solved) -> Plan:
    """The plan of a solution, judged by CVODES."""
    began = time.perf_counter() - solved.seconds
    certified = certify_one(solved.problem, solved.best, request.solver)
    candidate = certified.figures.candidate
    assert candidate is not None  # a single motion is judged by CVODES
    solution = certified.solution
    found_by = solution.solved_by
    return Plan.of_candidate(
        candidate,
        status=solution.status,
        record=request.record(
            str(found_by.get(NAME, request.solver.name)),
            solution.iterations,
            time.perf_counter() - began,
            **stand_in_settings(request.solver, [found_by]),
        ),
        steps=certified.steps,
        residual_limit=request.residual_limit,
        shadow_prices=solution.shadow_prices,
    )
