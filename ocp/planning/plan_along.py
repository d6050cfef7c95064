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
from quietarm.ocp.planning.residual_limit import ResidualLimit
from quietarm.ocp.planning.setup import Setup
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import REST, Verification
from quietarm.ocp.robustness import Worst, peaks_between
from quietarm.ocp.solvers.problem import Problem, Transcription
from quietarm.ocp.task import PointToPoint

EXCESS = 0.05
"""Share of the limit by which the residual between scenarios may exceed it before more are added;
and the room above the least worst case, where no lower limit can be reached."""
_ROUNDS, _ADDED, _KEPT = 6, 4, 4
"""Most rounds of added scenarios; most that one adds; most motions to go on from."""
_SAME = 1e-6
"""Errors that differ by less than this share of their range are one scenario."""
_TIGHTENINGS = 4
"""Most times that the limit is tightened by the remaining excess."""

Array = NDArray[np.float64]


def plan_along(
    task: PointToPoint,
    profile: JointProfile,
    setup: Setup,
    residual_limit: ResidualLimit,
    *,
    quick: bool = False,
) -> Plan:
    """The plan along a profile within a residual limit.

    A quick one fails without saying what would be feasible.
    """
    began = time.perf_counter()
    starts = setup.start_coefficients(profile)
    if residual_limit.adapts:
        plan = _adapt_limit(task, profile, setup, residual_limit.size, starts)
    else:
        plan = _hold(task, profile, setup, residual_limit.size, starts, quick=quick)
        if plan.worst is not None and (plan.excess or 0.0) > OVERRUN:
            unit = task.plant.tip_unit
            raise SolverFailedError(
                f"the residual is {plan.worst.residual:.4g} {unit} in the worst case, above its "
                f"limit of {residual_limit.size:g} {unit}: give a larger residual limit, more "
                f"{profile.term}s or a smaller uncertainty"
            )
    return plan.restated(seconds=time.perf_counter() - began)


def _adapt_limit(
    task: PointToPoint, profile: JointProfile, setup: Setup, limit: float, starts: list[Array]
) -> Plan:
    """The plan within the default limit, at most the worst case of the nominal plant's plan.

    If neither is feasible, the limit is near the least residual over the scenarios; if that does
    not hold between them, it is the worst case of the plan.
    """
    try:
        nominal = _hold(task.certain, profile, setup, 0.0, starts).on(task)
    except SolverFailedError:  # only other motions may keep the limits
        nominal = None
    reached = np.inf
    if nominal is not None and nominal.worst is not None:
        reached = nominal.worst.residual
        starts = [np.array(nominal.coefficients), *starts]
    most = max(reached, REST)
    try:
        plan = _hold(task, profile, setup, min(limit, most), starts)
    except InfeasibleTaskError:
        least = _least_residual(task, profile, setup, starts)
        if least is None:
            raise
        plan = _hold(task, profile, setup, min((1 + EXCESS) * least, most), starts)
    assert plan.worst is not None
    if plan.excess is None or plan.excess <= OVERRUN:
        return plan
    if nominal is not None and plan.worst.residual > reached:
        plan = nominal
    assert plan.worst is not None
    return replace(plan, residual_limit=plan.worst.residual)


def _least_residual(
    task: PointToPoint, profile: JointProfile, setup: Setup, starts: list[Array]
) -> float | None:
    """The least residual over the scenarios [m]; None where no start was solved."""
    transcription = Transcription.of(task, profile, setup.steps)
    problem = Problem.of(transcription, bound=setup.bound, minimise={RESIDUAL: 1.0})
    (stillest,) = best_of_starts([problem], [starts], setup.solver)
    return stillest.residual if stillest.status.solved else None


def _hold(
    task: PointToPoint,
    profile: JointProfile,
    setup: Setup,
    limit: float,
    starts: list[Array],
    *,
    quick: bool = False,
) -> Plan:
    """The plan whose residual limit holds between the scenarios as well, if that can be had.

    Where its residual exceeds the limit between them by more than `EXCESS`, those peaks become
    scenarios, and the motions that were found are the next starts. The remaining excess is
    then subtracted from the limit; where that does not settle it, they become scenarios as well.
    """
    plan, others, peaks = _solve_and_look_between(task, profile, setup, limit, starts, quick=quick)
    tightened = limit
    rounds = tightenings = 0
    while peaks:
        plan = replace(plan, worst=peaks[0])
        excess = peaks[0].residual / limit - 1
        more = _new_scenarios(task, [peak for peak in peaks if peak.residual > limit])
        can_add = bool(more) and rounds < _ROUNDS
        can_tighten = excess > 0 and tightenings < _TIGHTENINGS
        next_setup = setup
        next_limit = limit
        starts = [np.array(plan.coefficients)]
        if can_add and (
            (excess > EXCESS and not tightenings) or (excess > OVERRUN and not can_tighten)
        ):
            rounds += 1
            tightenings = 0
            tightened = limit
            task = task.with_samples([*task.scenarios[1:], *more])
            starts += others[:_KEPT]
        elif can_tighten:
            tightenings += 1
            tightened /= (1 + excess) * (1 + OVERRUN)
            next_limit = tightened
            next_setup = replace(setup, steps=plan.verification.steps)
        else:
            break
        try:
            plan, others, peaks = _solve_and_look_between(
                task, profile, next_setup, next_limit, starts, quick=quick or tightenings > 0
            )
        except SolverFailedError:
            if not tightenings:
                raise
            tightenings = _TIGHTENINGS  # a tighter limit leads nowhere: more scenarios may
    return replace(plan, residual_limit=limit)


def _solve_and_look_between(
    task: PointToPoint,
    profile: JointProfile,
    setup: Setup,
    limit: float,
    starts: list[Array],
    *,
    quick: bool,
) -> tuple[Plan, list[Array], list[Worst]]:
    """As `plan_from_starts`, and the peaks of the residual between the scenarios, if it has any."""
    plan, others = plan_from_starts(task, profile, setup, limit, starts, quick=quick)
    if task.uncertainty is None:
        return plan, others, []
    return plan, others, peaks_between(plan.candidate, _ADDED)


def plan_from_starts(
    task: PointToPoint,
    profile: JointProfile,
    setup: Setup,
    residual_limit: float,
    starts: Sequence[Array],
    *,
    quick: bool = False,
) -> tuple[Plan, list[Array]]:
    """The plan from starts, whose limit holds in all scenarios.

    And the coefficients of all that were solved, cheapest first. Errors are those of
    `solve_from_starts` and `certify`.
    """
    began = time.perf_counter()
    transcription = Transcription.of(task, profile, setup.steps)
    problem = Problem.of(transcription, residual_limit, setup.bound)
    best, solved = solve_from_starts(
        problem,
        starts,
        setup.solver,
        quick=quick,
        thorough=setup.thorough,
    )
    certified = certify_one(problem, best, setup.solver)
    assert isinstance(certified.checked, Candidate)  # one alone is judged by CVODES
    solution = certified.solution
    motion = certified.checked.motion
    plan = Plan(
        task=task,
        profile=profile,
        coefficients=profile.checked(solution.coefficients),
        motion=motion,
        status=solution.status,
        verification=Verification.between(
            certified.steps, solution.energy, solution.residual, motion
        ),
        record=setup.record(setup.solver.name, solution.iterations, time.perf_counter() - began),
        residual_limit=residual_limit,
        shadow_prices=solution.shadow_prices,
    )
    return plan, [solution.coefficients for solution in solved]


def _new_scenarios(task: PointToPoint, peaks: list[Worst]) -> list[list[float]]:
    """The errors of those peaks that are no scenario of the task yet."""
    known = np.array(task.scenarios[1:])
    near = _SAME * np.array(list(task.ranges.values()))
    errors = [list(one.errors.values()) for one in peaks]
    return [one for one in errors if (np.abs(known - one) > near).any(axis=1).all()]
