"""`plan_move`: least energy within a residual limit, certified, in every scenario of the task.

A certain task has one scenario. Of an uncertain one the residual of every scenario is a constraint
of one problem, and the peaks between them become scenarios until the limit holds there as well.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.ocp.candidate import Candidate
from quietarm.ocp.checks import takes
from quietarm.ocp.errors import InfeasibleTaskError, SolverFailedError
from quietarm.ocp.limits import RESIDUAL
from quietarm.ocp.planning.best_of_starts import (
    SolverName,
    best_of_starts,
    solve_from_starts,
    solver_of,
    start_coefficients,
)
from quietarm.ocp.planning.certify import OVERRUN, certify_one
from quietarm.ocp.planning.choose_profile import plan_on_chosen_profile
from quietarm.ocp.planning.plan import Plan, only_motion
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import REST, SolveSettings, Verification
from quietarm.ocp.robustness import Worst, peaks_between, quiet_residual
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
            "residual limit is 0, but no motion arrives at rest in all scenarios; omit it "
            "(default: 5 % of the plain cycloid's largest deflection) or give one above 0"
        )
    return residual_limit


@takes(task=PointToPoint, profile=JointProfile)
def plan_move(
    task: PointToPoint,
    profile: JointProfile | None = None,
    *,
    residual_limit: float | None = None,
    bound: float | None = None,
    starts: int = 4,
    seed: int = 0,
    steps: int | None = None,
    guess: ArrayLike | None = None,
    solver: SolverName = "sqp",
    log: bool = False,
) -> Plan:
    """Find the motion of least energy whose residual vibration is within a limit.

    Without a profile that is named a task is refused only if, within its limits, a `JointSpline`
    finds no motion either, or without limits 18 or 24 terms.

    Parameters
    ----------
    task : PointToPoint
        The move and its limits.
    profile : JointProfile, optional
        How the joint moves; by default the cycloid of a polynomial, of six terms without limits,
        and of 18 or 24 with limits (`choose_profile`); the plan's record then has the energy of
        six. The only motion of a profile without coefficients, such as `shaped_cycloid`, is
        evaluated, not optimised.
    residual_limit : float, optional
        Largest F1 [m]; 0, the default, requires rest on arrival, or the task's `final` state. For
        an uncertain task, where rest in all scenarios is infeasible, the default is 5 % of the
        largest deflection during the plain cycloid of the same duration on the nominal plant, or
        the worst case of the nominal plant's plan if that is smaller. If neither is feasible, it is
        the least worst case. `Plan.residual_limit` is the limit that was used.
    bound : float, optional
        Largest absolute coefficient; none by default.
    starts : int
        How many starts: the guess or the plain cycloid first, then random ones; all at once. Once
        half of them, and more than one, have ended at the lowest energy, the others are stopped.
        Gaussians and networks take four random starts for each: they have many local minima.
    seed : int
        Seed of the random starts.
    steps : int, optional
        Steps of the solver's discretisation, chosen from the task by default; they are doubled
        while the verification disagrees.
    guess : array_like, shape (profile.size,), optional
        Coefficients of the first start, such as a metaheuristic's; without a profile the polynomial
        has as many terms.
    solver : {"sqp", "ipopt"}
        Sequential quadratic programming, all starts at once, or IPOPT, one after another. If the
        first solves no start, IPOPT is tried.
    log : bool
        Whether the solver prints a line for each iteration; with `"sqp"` it is about the start with
        the least objective.

    Returns
    -------
    Plan
        The coefficients, with values by CVODES. For an uncertain task the residual limit holds
        between the scenarios as well, see ``worst``; its task has the scenarios that were used.

    Raises
    ------
    ValueError
        When an argument is out of range.
    InfeasibleTaskError, SolverFailedError
        When no motion of this profile is feasible, with what would be; when no start ended at an
        optimum for another reason.
    """
    least = 0.0 if residual_limit is None else residual_limit
    settings = SolveSettings(least, bound, starts, seed, steps, None, solver, log)

    if profile is None:
        if guess is None:
            plan = partial(plan_within, residual_limit=residual_limit)
            return plan_on_chosen_profile(task, settings, limit_of(task, residual_limit), plan)
        profile = CycloidPolynomial.of_size(np.size(guess))
    if profile.size == 0:
        return only_motion(task, profile, residual_limit)
    if guess is not None:
        settings = replace(settings, guess=profile.checked(guess))
    return plan_within(task, profile, settings, residual_limit)


def plan_within(
    task: PointToPoint,
    profile: JointProfile,
    settings: SolveSettings,
    residual_limit: float | None,
    *,
    quick: bool = False,
) -> Plan:
    """The plan within a residual limit, or within the default one of a task.

    A quick one fails without saying what would be feasible.
    """
    began, largest = time.perf_counter(), limit_of(task, residual_limit)
    if task.uncertainty is not None and residual_limit is None:
        plan = _hold_default(task, profile, settings, largest)
    else:
        plan = _hold(task, profile, replace(settings, residual_limit=largest), quick=quick)
        if plan.worst is not None and (plan.excess or 0.0) > OVERRUN:
            unit = task.plant.tip_unit
            raise SolverFailedError(
                f"the residual is {plan.worst.residual:.4g} {unit} in the worst case, above its "
                f"limit of {largest:g} {unit}: give a larger residual limit, more {profile.term}s "
                "or a smaller uncertainty"
            )
    return plan.restated(seconds=time.perf_counter() - began)


def _hold_default(
    task: PointToPoint, profile: JointProfile, settings: SolveSettings, largest: float
) -> Plan:
    """The plan within the default limit, at most the worst case of the nominal plant's plan.

    If neither is feasible, the limit is near the least residual over the scenarios; if that does
    not hold between them, it is the worst case of the plan.
    """
    starts = start_coefficients(profile, settings)
    try:
        nominal = _hold(task.certain, profile, replace(settings, residual_limit=0.0))
        nominal = nominal.on(task)
    except SolverFailedError:  # only other motions may keep the limits
        nominal = None
    reached = np.inf
    if nominal is not None and nominal.worst is not None:
        reached = nominal.worst.residual
        starts = [np.array(nominal.coefficients), *starts]
    most = max(reached, REST)
    try:
        plan = _hold(task, profile, replace(settings, residual_limit=min(largest, most)), starts)
    except InfeasibleTaskError:
        transcription = Transcription.of(task, profile, settings.steps)
        problem = Problem.of(transcription, bound=settings.bound, minimise={RESIDUAL: 1.0})
        (found,) = best_of_starts([problem], [starts], solver_of(settings))
        if not found.status.solved:
            raise
        limit = min((1 + EXCESS) * found.residual, most)
        plan = _hold(task, profile, replace(settings, residual_limit=limit), starts)
    assert plan.worst is not None
    if plan.excess is None or plan.excess <= OVERRUN:
        return plan
    if nominal is not None and plan.worst.residual > reached:
        plan = nominal
    assert plan.worst is not None
    return replace(plan, residual_limit=plan.worst.residual)


def _hold(
    task: PointToPoint,
    profile: JointProfile,
    settings: SolveSettings,
    starts: Sequence[Array] | None = None,
    *,
    quick: bool = False,
) -> Plan:
    """The plan whose residual limit holds between the scenarios as well, if that can be had.

    Where its residual exceeds the limit between them by more than `EXCESS`, those peaks become
    scenarios, and the motions that were found are the next starts. The remaining excess is
    then subtracted from the limit; where that does not settle it, they become scenarios as well.
    """
    plan, others = plan_from_starts(task, profile, settings, starts, quick=quick)
    if task.uncertainty is None:
        return plan
    limit = settings.residual_limit
    tightened = limit
    rounds = tightenings = 0
    peaks = peaks_between(plan.candidate, _ADDED)
    while True:
        plan = replace(plan, worst=peaks[0])
        excess = peaks[0].residual / limit - 1
        more = _new_scenarios(task, [peak for peak in peaks if peak.residual > limit])
        can_add = bool(more) and rounds < _ROUNDS
        can_tighten = excess > 0 and tightenings < _TIGHTENINGS
        next_settings, starts = settings, [np.array(plan.coefficients)]
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
            steps = plan.verification.steps
            next_settings = replace(settings, residual_limit=tightened, steps=steps)
        else:
            break
        try:
            plan, others = plan_from_starts(
                task, profile, next_settings, starts, quick=quick or tightenings > 0
            )
        except SolverFailedError:
            if not tightenings:
                raise
            tightenings = _TIGHTENINGS  # a tighter limit leads nowhere: more scenarios may
        else:
            peaks = peaks_between(plan.candidate, _ADDED)
    return replace(plan, residual_limit=settings.residual_limit)


def plan_from_starts(
    task: PointToPoint,
    profile: JointProfile,
    settings: SolveSettings,
    starts: Sequence[NDArray[np.float64]] | None = None,
    *,
    quick: bool = False,
) -> tuple[Plan, list[NDArray[np.float64]]]:
    """The plan from starts, by default those of the settings, whose limit holds in all scenarios.

    And the coefficients of all that were solved, cheapest first. Errors are those of
    `solve_from_starts` and `certify`.
    """
    began, solver = time.perf_counter(), solver_of(settings)
    starts = start_coefficients(profile, settings) if starts is None else starts
    transcription = Transcription.of(task, profile, settings.steps)
    problem = Problem.of(transcription, settings.residual_limit, settings.bound)
    best, solved = solve_from_starts(problem, starts, solver, quick=quick)
    certified = certify_one(problem, best, solver)
    assert isinstance(certified.checked, Candidate)  # one alone is judged by CVODES
    solution, motion = certified.solution, certified.checked.motion
    plan = Plan(
        task=task,
        profile=profile,
        coefficients=profile.checked(solution.coefficients),
        motion=motion,
        status=solution.status,
        verification=Verification.between(
            certified.steps, solution.energy, solution.residual, motion
        ),
        record=settings.record(settings.solver, solution.iterations, time.perf_counter() - began),
        residual_limit=settings.residual_limit,
        shadow_prices=solution.shadow_prices,
    )
    return plan, [one.coefficients for one in solved]


def _new_scenarios(task: PointToPoint, peaks: list[Worst]) -> list[list[float]]:
    """The errors of those peaks that are no scenario of the task yet."""
    known = np.array(task.scenarios[1:])
    near = _SAME * np.array(list(task.ranges.values()))
    errors = [list(one.errors.values()) for one in peaks]
    return [one for one in errors if (np.abs(known - one) > near).any(axis=1).all()]
