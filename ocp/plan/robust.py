"""Hold a residual limit between the samples of an uncertain plant, not only at them."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ocp.answers.provenance import SolveSettings
from ocp.base.errors import InfeasibleTaskError, SolverFailedError
from ocp.base.interrupts import note_interrupts
from ocp.plan.answer import Plan, evaluate_coefficients
from ocp.plan.verification import OVERRUN
from ocp.profiles.joint_profile import JointProfile
from ocp.robustness.measures import tolerated_residual
from ocp.robustness.uncertain import (
    UncertainPlant,
    on_assumed,
    uncertain_plant,
    with_halves,
    with_samples,
)
from ocp.robustness.worst import peaks_between
from ocp.task.point_to_point import PointToPoint

EXCESS = 0.05
"""Share of the limit by which the residual between samples may pass it before more are added."""
_ROUNDS, _ADDED = 6, 4
"""Most rounds of added samples, and most samples that one adds."""
_SAME = 1e-6
"""Errors that differ by less than this share of their range are one sample."""
_TIGHTENINGS = 4
"""Most times that the limit is tightened by what is left of the excess."""

Solve = Callable[[PointToPoint, JointProfile, SolveSettings], Plan]


def limit_of(task: PointToPoint, residual_limit: float | None) -> float:
    """The residual limit of a plan, also where none is given.

    Parameters
    ----------
    task : PointToPoint
        The move.
    residual_limit : float or None
        Largest F1 [m].

    Returns
    -------
    float
        The same; where it is None, 0, or for an uncertain plant its `tolerated_residual`.

    Raises
    ------
    ValueError
        When it is 0 and the plant uncertain, or none is given and the joint moves no mode.
    """
    if not isinstance(task.plant, UncertainPlant):
        return 0.0 if residual_limit is None else residual_limit
    if residual_limit is None:
        residual_limit = tolerated_residual(task)
        if residual_limit == 0:
            raise ValueError(
                "the plain cycloid leaves no residual on this plant, so that 5 % of it is no "
                "limit; give a residual limit above 0"
            )
    if residual_limit == 0:
        raise ValueError(
            "residual limit is 0, but no motion arrives at rest whatever the errors of its plant; "
            "leave it out (5 % of the plain cycloid's residual) or give one above 0"
        )
    return residual_limit


def robust_plan(
    task: PointToPoint, profile: JointProfile, settings: SolveSettings, solve: Solve
) -> Plan:
    """The plan of an uncertain plant, with its residual limit held between the samples.

    The first start is the guess, or else the assumed plant's plan, at rest on arrival. Where the
    solver fails, it starts again with more samples, half way to those that there are.

    Parameters
    ----------
    task : PointToPoint
        A move of an `UncertainPlant`.
    profile : JointProfile
        How the joint moves.
    settings : SolveSettings
        What was asked for.
    solve : callable
        Gives the plan of a task, a profile and settings.

    Returns
    -------
    Plan
        The plan with its `worst`, which is above the limit where no tighter one could be kept.
        After Ctrl-C the last plan until then, not ``complete``; before there is a robust one, that
        of the assumed plant.

    Raises
    ------
    SolverFailedError
        When there is no plan.
    KeyboardInterrupt
        After Ctrl-C before there is any plan.
    """
    began = time.perf_counter()
    assumed = None if settings.guess else _of_assumed(task, profile, settings, solve)
    try:
        if assumed and not assumed.complete:
            raise KeyboardInterrupt
        first = replace(settings, guess=assumed.coefficients) if assumed else settings
        plan = _from_samples(task, profile, first, settings, solve)
    except KeyboardInterrupt:
        if assumed is None:
            raise
        with note_interrupts():
            plan = _unheld(task, assumed, settings)
    seconds = time.perf_counter() - began
    return replace(plan, provenance=replace(plan.provenance, seconds=seconds))


def _of_assumed(
    task: PointToPoint, profile: JointProfile, settings: SolveSettings, solve: Solve
) -> Plan | None:
    """The plan of the plant without errors, at rest on arrival; None where there is none."""
    try:
        return solve(on_assumed(task), profile, replace(settings, residual_limit=0.0))
    except SolverFailedError:
        return None


def _from_samples(
    task: PointToPoint,
    profile: JointProfile,
    first: SolveSettings,
    settings: SolveSettings,
    solve: Solve,
) -> Plan:
    try:
        return _held_between(solve(task, profile, first), settings, solve)
    except InfeasibleTaskError:  # more samples make it no easier
        raise
    except SolverFailedError:
        finer = with_halves(task)
    return _held_between(solve(finer, profile, first), settings, solve)


def _unheld(task: PointToPoint, assumed: Plan, settings: SolveSettings) -> Plan:
    """The assumed plant's plan with its figures on the uncertain one."""
    plan = evaluate_coefficients(task, assumed.coefficients, profile=assumed.profile)
    stopped = "the assumed plant's plan, before there was a robust one"
    provenance = replace(assumed.provenance, settings=settings, stopped=stopped)
    return replace(plan, status=assumed.status, provenance=provenance)


def _held_between(plan: Plan, settings: SolveSettings, solve: Solve) -> Plan:
    """The plan with its `worst`, solved on until the limit holds between the samples as well.

    Where the residual passes the limit by more than `EXCESS`, its peaks become samples. What is
    left of the excess is then taken off the limit; `worst` is above the limit where no tighter one
    could be kept. After Ctrl-C it is the last plan until then, not ``complete``.
    """
    began = time.perf_counter() - plan.provenance.seconds
    stopped = plan.provenance.stopped
    try:
        for better in _held(plan, settings, solve):
            plan, stopped = better, better.provenance.stopped
            if stopped:
                break
    except KeyboardInterrupt:
        stopped = "some rounds, before the residual was held between the samples"
    seconds = time.perf_counter() - began
    provenance = replace(plan.provenance, settings=settings, seconds=seconds, stopped=stopped)
    return replace(plan, provenance=provenance)


def _held(plan: Plan, settings: SolveSettings, solve: Solve) -> Iterator[Plan]:
    """The plan with its worst, then with more samples, then with tighter limits."""
    limit = used = settings.residual_limit
    plan, peaks = _checked(plan)
    yield plan
    for _ in range(_ROUNDS):
        if _excess(plan, limit) <= EXCESS:
            break
        more = _new_samples(plan.task, peaks[peaks[:, 0] > limit, 1:])
        if not more:
            break
        task = with_samples(plan.task, more)
        plan, peaks = _checked(solve(task, plan.profile, _from(plan, settings)))
        yield plan
    for _ in range(_TIGHTENINGS):
        if _excess(plan, limit) <= 0:
            break
        used /= (1 + _excess(plan, limit)) * (1 + OVERRUN)
        tighter = replace(_from(plan, settings), residual_limit=used)
        try:
            plan, _ = _checked(solve(plan.task, plan.profile, tighter))
        except SolverFailedError:
            break
        yield plan


def _new_samples(task: PointToPoint, errors: NDArray[np.float64]) -> list[list[float]]:
    """Those of the errors that no sample of the uncertain plant has."""
    plant = uncertain_plant(task.plant)
    known, near = np.array(plant.samples), _SAME * np.array(list(plant.ranges.values()))
    return [one.tolist() for one in errors if (np.abs(known - one) > near).any(axis=1).all()]


def _checked(plan: Plan) -> tuple[Plan, NDArray[np.float64]]:
    worst, peaks = peaks_between(plan.task, plan.profile, plan.coefficients, _ADDED)
    return replace(plan, worst=worst), peaks


def _excess(plan: Plan, limit: float) -> float:
    return -1.0 if plan.worst is None else plan.worst.residual / limit - 1


def _from(plan: Plan, settings: SolveSettings) -> SolveSettings:
    steps = plan.verification.steps
    return replace(settings, starts=1, guess=plan.coefficients, steps=steps)
