"""Plans of uncertain tasks, whose residual limit holds between the scenarios as well."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.candidate import Candidate
from quietarm.ocp.errors import InfeasibleTaskError, SolverFailedError
from quietarm.ocp.limits import RESIDUAL
from quietarm.ocp.planning.best_of_starts import (
    best_of_starts,
    plan_from_starts,
    start_coefficients,
)
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.ocp.planning.plan import Plan
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import REST, SolveSettings
from quietarm.ocp.robustness.measures import quiet_residual
from quietarm.ocp.robustness.perturbed import Worst, peaks_between, worst_of
from quietarm.ocp.solvers.choice import solver_of
from quietarm.ocp.solvers.problem import Problem, Scalarization
from quietarm.ocp.solvers.transcription import Transcription
from quietarm.ocp.task import PointToPoint

EXCESS = 0.05
"""Share of the limit by which the residual between scenarios may exceed it before more are added;
and the room above the least worst case, where no lower limit can be reached."""
_ROUNDS, _ADDED, _KEPT = 6, 4, 4
"""Most rounds of added scenarios; most that one adds; most motions to go on from."""
_SAME = 1e-6
"""Errors that differ by less than this share of their range are one scenario."""
_TIGHTENINGS = 4
"""Most times that the limit is tightened by what is left of the excess."""

Array = NDArray[np.float64]
Starts = Sequence[Array]


def limit_of(task: PointToPoint, residual_limit: float | None) -> float:
    """The residual limit that is given, or the largest that is taken by default.

    Of an uncertain task `quiet_residual`; ValueError where that, or what is given, is 0.
    """
    if task.uncertainty is None:
        return 0.0 if residual_limit is None else residual_limit
    if residual_limit is None:
        residual_limit = quiet_residual(task)
        if residual_limit == 0:
            raise ValueError(
                "the plain cycloid does not bend this plant, so that 5 % of that is no limit; give "
                "a residual limit above 0"
            )
    if residual_limit == 0:
        raise ValueError(
            "residual limit is 0, but no motion arrives at rest whatever the errors of its plant; "
            "leave it out (5 % of how far the plain cycloid bends the tip) or give one above 0"
        )
    return residual_limit


def plan_robustly(
    task: PointToPoint,
    profile: JointProfile,
    settings: SolveSettings,
    residual_limit: float | None,
) -> Plan:
    """The plan of an uncertain task.

    Without a residual limit it leaves no more in the worst case than the plan of the nominal plant.
    """
    began, largest = time.perf_counter(), limit_of(task, residual_limit)
    if residual_limit is not None:
        plan = _hold(task, profile, replace(settings, residual_limit=largest))
        if plan.excess is not None and plan.excess > OVERRUN:
            assert plan.worst is not None
            raise SolverFailedError(
                f"the residual is {plan.worst.residual:.4g} m in the worst case, above its limit "
                f"of {residual_limit:g} m: give a larger residual limit, more {profile.term}s or "
                "a smaller uncertainty"
            )
    else:
        plan = _hold_default(task, profile, settings, largest)
    return replace(plan, provenance=replace(plan.provenance, seconds=time.perf_counter() - began))


def _hold_default(
    task: PointToPoint, profile: JointProfile, settings: SolveSettings, largest: float
) -> Plan:
    """The plan within the default limit, at most what the nominal plant's plan leaves."""
    nominal = _nominal_plan(task, profile, settings)
    reached = np.inf if nominal is None or nominal.worst is None else nominal.worst.residual
    starts = [] if nominal is None else [np.array(nominal.coefficients)]
    limit = min(largest, max(reached, REST))
    try:
        plan = _hold(task, profile, replace(settings, residual_limit=limit), starts)
    except InfeasibleTaskError:
        least = _least_worst_case(task, profile, settings, starts)
        limit = min((1 + EXCESS) * least, max(reached, REST))
        plan = _hold(task, profile, replace(settings, residual_limit=limit), starts)
    if plan.excess is None or plan.excess <= OVERRUN or plan.worst is None:
        return plan
    if nominal is not None and plan.worst.residual > reached:
        plan = nominal
    # it is as low as this profile gets: the limit is what it leaves
    assert plan.worst is not None
    settings = replace(settings, residual_limit=plan.worst.residual)
    return replace(plan, provenance=replace(plan.provenance, settings=settings))


def _nominal_plan(
    task: PointToPoint, profile: JointProfile, settings: SolveSettings
) -> Plan | None:
    """The nominal plant's plan with its figures on the uncertain task; None if there is none."""
    try:
        plan, _ = plan_from_starts(task.certain, profile, replace(settings, residual_limit=0.0))
    except SolverFailedError:  # only other motions may keep the limits
        return None
    motion = Candidate.of_profile(task, profile, plan.coefficients).motion
    return replace(plan, task=task, motion=motion, worst=worst_of(task, profile, plan.coefficients))


def _least_worst_case(
    task: PointToPoint, profile: JointProfile, settings: SolveSettings, starts: Starts
) -> float:
    """The least residual over the scenarios [m]; InfeasibleTaskError where limits are not kept."""
    transcription = Transcription.of(task, profile, settings.steps)
    asked = Scalarization(task.limits, settings.bound, {RESIDUAL: 1.0})
    every = [*starts, *start_coefficients(profile, settings)]
    solver = solver_of(settings)
    (found,) = best_of_starts([Problem(transcription, asked)], [every], solver)
    if not found.status.solved:
        raise InfeasibleTaskError(f"no motion keeps the limits: {found.status.text}")
    return found.residual


def _hold(
    task: PointToPoint, profile: JointProfile, settings: SolveSettings, starts: Starts = ()
) -> Plan:
    """The plan whose residual limit holds between the scenarios as well, if that can be had.

    The residual of every scenario is a constraint of one problem. Where that of its solution
    exceeds the limit between them by more than `EXCESS`, those peaks become scenarios, and the
    motions that were found are the next starts. What is left of the excess is then taken off the
    limit.
    """
    limit = settings.residual_limit

    def solve(task: PointToPoint, starts: Starts) -> tuple[Plan, list[Worst], Starts]:
        plan, others = plan_from_starts(task, profile, settings, starts)
        return *_look_between(plan), [np.array(plan.coefficients), *others[:_KEPT]]

    plan, peaks, starts = solve(task, [*starts, *start_coefficients(profile, settings)])
    for _ in range(_ROUNDS):
        more = _new_scenarios(task, [one for one in peaks if one.residual > limit])
        if peaks[0].residual / limit - 1 <= EXCESS or not more:
            break
        task = task.with_samples([*task.scenarios[1:], *more])
        plan, peaks, starts = solve(task, starts)
    plan = _tighten(plan, peaks, settings)
    return replace(plan, provenance=replace(plan.provenance, settings=settings))


def _tighten(plan: Plan, peaks: list[Worst], settings: SolveSettings) -> Plan:
    """Take what is left of the excess off the limit."""
    limit = used = settings.residual_limit
    for _ in range(_TIGHTENINGS):
        excess = peaks[0].residual / limit - 1
        if excess <= 0:
            break
        used /= (1 + excess) * (1 + OVERRUN)
        tighter = replace(settings, residual_limit=used, steps=plan.verification.steps)
        start = [np.array(plan.coefficients)]
        try:
            found, _ = plan_from_starts(plan.task, plan.profile, tighter, start)
        except SolverFailedError:
            break
        plan, peaks = _look_between(found)
    return plan


def _new_scenarios(task: PointToPoint, peaks: list[Worst]) -> list[list[float]]:
    """The errors of those peaks that are no scenario of the task yet."""
    known = np.array(task.scenarios[1:])
    near = _SAME * np.array(list(task.ranges.values()))
    errors = [list(one.errors.values()) for one in peaks]
    return [one for one in errors if (np.abs(known - one) > near).any(axis=1).all()]


def _look_between(plan: Plan) -> tuple[Plan, list[Worst]]:
    """The plan with its worst case, and the peaks of the residual between the scenarios."""
    peaks = peaks_between(plan.task, plan.profile, plan.coefficients, _ADDED)
    return replace(plan, worst=peaks[0]), peaks
