"""Hold a residual limit between the samples of an uncertain plant, not only at them."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.planning.best_of_starts import start_coefficients
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.ocp.planning.plan import Plan
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import SolveSettings
from quietarm.ocp.robustness.measures import quiet_residual
from quietarm.ocp.robustness.worst import peaks_between
from quietarm.ocp.task import PointToPoint

EXCESS = 0.05
"""Share of the limit by which the residual between samples may pass it before more are added."""
_ROUNDS, _ADDED, _KEPT = 6, 4, 4
"""Most rounds of added samples; most samples that one adds; most motions to go on from."""
_SAME = 1e-6
"""Errors that differ by less than this share of their range are one sample."""
_TIGHTENINGS = 4
"""Most times that the limit is tightened by what is left of the excess."""

Starts = Sequence[NDArray[np.float64]]
Peaks = NDArray[np.float64]
"""Residuals [m] and errors of peaks between the samples, the largest first."""
PlanFrom = Callable[
    [PointToPoint, JointProfile, SolveSettings, Starts], tuple[Plan, list[NDArray[np.float64]]]
]
"""(task, profile, settings, starts) -> plan, and coefficients of all starts that were solved."""


def limit_of(task: PointToPoint, residual_limit: float | None) -> float:
    """The residual limit of a plan, also where none is given."""
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


def robust_plan(
    task: PointToPoint, profile: JointProfile, settings: SolveSettings, plan_from: PlanFrom
) -> Plan:
    """The plan of an uncertain plant, with its residual limit held between the samples.

    Every sample's residual is a constraint of one program. Where the residual of its solution
    passes the limit between them by more than `EXCESS`, those peaks become samples, and the motions
    that were found are the next starts. What is left of the excess is then taken off the limit.
    """
    began, limit = time.perf_counter(), settings.residual_limit

    def solve(task: PointToPoint, starts: Starts) -> tuple[Plan, Peaks, Starts]:
        plan, others = plan_from(task, profile, settings, starts)
        return *_look_between(plan), [np.array(plan.coefficients), *others[:_KEPT]]

    plan, peaks, starts = solve(task, start_coefficients(profile, settings))
    for _ in range(_ROUNDS):
        more = _new_samples(task, peaks[peaks[:, 0] > limit, 1:])
        if peaks[0, 0] / limit - 1 <= EXCESS or not more:
            break
        task = task.with_samples([*task.scenarios[1:], *more])
        plan, peaks, starts = solve(task, starts)
    plan = _tighten(plan, peaks, settings, plan_from)
    provenance = replace(plan.provenance, settings=settings, seconds=time.perf_counter() - began)
    return replace(plan, provenance=provenance)


def _tighten(plan: Plan, peaks: Peaks, settings: SolveSettings, plan_from: PlanFrom) -> Plan:
    """Take what is left of the excess off the limit."""
    limit = used = settings.residual_limit
    for _ in range(_TIGHTENINGS):
        excess = peaks[0, 0] / limit - 1
        if excess <= 0:
            break
        used /= (1 + excess) * (1 + OVERRUN)
        tighter = replace(settings, residual_limit=used, steps=plan.verification.steps)
        start = [np.array(plan.coefficients)]
        try:
            found, _ = plan_from(plan.task, plan.profile, tighter, start)
        except SolverFailedError:
            break
        plan, peaks = _look_between(found)
    return plan


def _new_samples(task: PointToPoint, errors: NDArray[np.float64]) -> list[list[float]]:
    """Those of the errors that no sample of the uncertain plant has."""
    known = np.array(task.scenarios[1:])
    near = _SAME * np.array(list(task.ranges.values()))
    return [one.tolist() for one in errors if (np.abs(known - one) > near).any(axis=1).all()]


def _look_between(plan: Plan) -> tuple[Plan, Peaks]:
    """The plan with its worst case, and the largest peaks between the samples."""
    worst, peaks = peaks_between(plan.task, plan.profile, plan.coefficients, _ADDED)
    return replace(plan, worst=worst), peaks
