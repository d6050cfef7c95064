"""`fastest_move`: the shortest duration in which a move within its limits still arrives.

By default on a spline of the joint, which `least_time` fits to the task; along a profile that is
given by bisection, each duration from the coefficients of the last feasible one.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from quietarm.ocp.checks import positive, takes
from quietarm.ocp.errors import InfeasibleTaskError, SolverFailedError
from quietarm.ocp.limits import QUANTITIES
from quietarm.ocp.planning.choose_profile import SIX
from quietarm.ocp.planning.least_time import LeastTime, least_time
from quietarm.ocp.planning.plan import Plan
from quietarm.ocp.planning.plan_along import plan_along
from quietarm.ocp.planning.request import Request
from quietarm.ocp.planning.rigid_motion import (
    assumed_bounds,
    largest_deflection,
    rigid_duration,
    rigid_motion,
)
from quietarm.ocp.planning.too_short import refuse_to_hold
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.profiles.shaped_cycloid import TOLERATED
from quietarm.ocp.simulation.free_vibration import FreeVibration
from quietarm.ocp.solvers.least_excess import least_excess
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.task import LEAST_DURATION, PointToPoint

_GROWTH = 1.5
"""By which a duration along a given profile grows where it fails."""
_RIGID = "within its limits of speed, acceleration and jerk a joint takes longer"


@dataclass(frozen=True)
class Fastest:
    """The shortest duration found for a move.

    Attributes
    ----------
    plan : Plan
        The move of least energy in that duration.
    failed : tuple of (float, str)
        Shorter durations [s] that were tried, the longest first, and why each failed: the first is
        shorter by no more than the duration's tolerance.
    """

    plan: Plan
    failed: tuple[tuple[float, str], ...]

    @property
    def duration(self) -> float:
        """Duration of the plan [s]."""
        return self.plan.task.duration


@takes(task=PointToPoint, profile=JointProfile, solver=Solver)
def fastest_move(
    task: PointToPoint,
    profile: JointProfile | None = None,
    *,
    residual_limit: float | None = None,
    bound: float | None = None,
    seed: int = 0,
    steps: int | None = None,
    solver: Solver = Sqp(),
    duration_tolerance: float = 1e-3,
) -> Fastest:
    """Find the shortest duration in which a move keeps its limits and arrives at rest.

    Parameters
    ----------
    task : PointToPoint
        The move with its limits, of which there is one at least. A plant may be uncertain.
    profile : JointProfile, optional
        How the joint moves; by default a `JointSpline`, whose knots stand where the acceleration
        of the fastest motion changes: it can cruise, and comes within 1 % of the least time. Along
        another profile the task's duration is where the search begins.
    residual_limit : float, optional
        Largest residual [m]; 0, the default, requires rest on arrival. For an uncertain task the
        default is `fastest_residual_limit`, whatever the duration.
    bound, seed, steps, solver
        As for `plan_move`; each duration has one start, the fastest motion on the spline, or the
        last feasible one.
    duration_tolerance : float
        Share of the duration to which it is found.

    Returns
    -------
    Fastest
        The plan, which states the seconds of all the search, and the shorter durations that failed.

    Raises
    ------
    ValueError
        When nothing limits the move, or an argument is out of range.
    InfeasibleTaskError
        When no duration is feasible.
    """
    positive("duration tolerance", duration_tolerance)
    request = Request(task, SIX if profile is None else profile, solver, bound, 1, seed, steps)
    if not task.limits:
        names = ", ".join(QUANTITIES)
        raise ValueError(f"nothing limits how fast the move may be; give a limit of {names}")
    refuse_to_hold(task)
    if task.uncertainty is not None and residual_limit is None and task.band is None:
        residual_limit = fastest_residual_limit(task)
    began = time.perf_counter()
    request = request.stating(residual_limit)
    if profile is None:
        fastest = _fastest_on_spline(request, duration_tolerance)
    else:
        profile.refuse_no_choice()
        fastest = _fastest_along(request, duration_tolerance)
    plan = fastest.plan.restated(seconds=time.perf_counter() - began)
    return Fastest(plan, fastest.failed)


def fastest_residual_limit(task: PointToPoint) -> float:
    """Residual limit [m] of an uncertain task's fastest move where none is given.

    A twentieth of the static deflection at the peak acceleration of a plain cycloid that takes the
    rigid joint's least time within the task's limits: it does not grow as the move gets shorter.
    ValueError where the plant does not bend.
    """
    least = rigid_motion(abs(task.span), assumed_bounds(task)).duration
    peak_acceleration = 2 * math.pi * abs(task.span) / least**2
    limit = TOLERATED * peak_acceleration * largest_deflection(task)
    if limit == 0:
        raise ValueError(
            "no acceleration bends this plant, so that a share of its deflection is no limit; give "
            "a residual limit above 0"
        )
    return limit


def _fastest_on_spline(request: Request, tolerance: float) -> Fastest:
    """The plan of least energy in the least time on a spline, or in hardly more."""
    task = request.task
    try:
        least = least_time(task, request.residual_limit, request.bound, tolerance / 2)
    except ValueError as error:
        raise InfeasibleTaskError(f"no duration was found: {error}") from None
    failed = {least.too_short: _why_too_short(task, least)}
    steps = least.steps if request.steps is None else request.steps
    along = request.along(least.profile, least.coefficients)
    along = replace(along, steps=steps, quick=True)
    for margin in _margins(task):
        duration = (1 + margin) * least.duration
        try:
            plan = plan_along(along.on(replace(least.task, duration=duration)))
        except SolverFailedError as error:
            failed[duration] = str(error)
            continue
        settings = dict(plan.record.settings)
        settings.pop("guess", None)
        settings["steps"] = request.steps
        return Fastest(plan.restated(settings=settings), _longest_first(failed))
    longest, why = max(failed.items())
    raise InfeasibleTaskError(f"no duration up to {longest:.3g} s will do: {why}")


def _margins(task: PointToPoint) -> tuple[float, ...]:
    """Shares by which the least time grows until there is a plan.

    In the least time itself limits could not be narrowed by what passes them between the solver's
    nodes. The worst case of an uncertain plant may lie between the scenarios as well.
    """
    wide = (2e-3, 5e-3, 0.01, 0.02, 0.05, 0.1, 0.2)
    return (5e-4, 1e-3, *wide) if task.uncertainty is None else (1e-3, *wide)


def _why_too_short(task: PointToPoint, least: LeastTime) -> str:
    """Say why the longest duration that failed is too short."""
    if least.too_short <= rigid_duration(task):
        return _RIGID
    return _beyond(least.excess)


def _beyond(excess: float) -> str:
    """Say by how much every motion found exceeds a limit."""
    percent = 100 * max(excess, 1e-6)
    share = f"{percent:.1g}" if percent < 1 else f"{percent:.0f}"
    return f"every motion found exceeds a limit by {share} % or more"


def _longest_first(failed: Mapping[float, str]) -> tuple[tuple[float, str], ...]:
    return tuple(sorted(failed.items(), reverse=True))


def _fastest_along(request: Request, tolerance: float) -> Fastest:
    """The plan in the shortest duration along a profile."""
    tried = _Tried(request)
    _narrow(tried, tolerance)
    assert tried.best is not None  # the bracket found one
    duration = tried.best.task.duration
    shorter = {failed: why for failed, why in tried.failed.items() if failed < duration}
    return Fastest(tried.best, _longest_first(shorter))


def _narrow(tried: _Tried, tolerance: float, shares: tuple[float, ...] = (0.97, 0.9, 0.8)) -> None:
    """Bisect, and again below what failed as long as something there succeeds.

    Shares of the duration that failed are tried, since what is feasible may have gaps.
    """
    least = rigid_duration(tried.request.task)
    low, high = tried.bracket(least)
    while True:
        while high / low > 1 + tolerance:
            middle = math.sqrt(low * high)
            if tried.succeeds(middle):
                high = middle
            else:
                low = middle
        if low > least and tried.succeeds_after_all(low):
            high = low
        else:
            below = (share * low for share in shares if share * low > least)
            shorter = next((duration for duration in below if tried.succeeds(duration)), None)
            if shorter is None:
                return
            high = shorter
        low = least or high / _GROWTH


class _Tried:
    """Durations that were tried for a request.

    Where linear programs about the best motion find no other within the limits, the solver is not
    asked, which takes forty times as long to fail; nor else is what stands in for it, or the search
    for a limit that, if wider, would do. All of these are for the longest duration that failed.
    Where they succeed, less says little, and all that follow are tried so.
    """

    unmet: ClassVar[float] = 1e-4
    """Share of a limit that linear programs are sure of."""

    def __init__(self, request: Request) -> None:
        self.request = request
        self.best: Plan | None = None
        self.failed: dict[float, str] = {}
        self._thorough = False
        self._explained: set[float] = set()

    def succeeds(self, duration: float) -> bool:
        """Return whether there is a plan for a duration."""
        task = replace(self.request.task, duration=duration)
        guess = None if self.best is None else self.best.coefficients
        request = self.request.on(task)
        request = replace(request, thorough=self._thorough)
        along = request.along(self.request.profile, guess)
        if self._thorough:
            self._explained.add(duration)
        elif guess is not None:
            excess = least_excess(along.problem(), np.array(guess))
            if excess.holds and excess.share > self.unmet:
                self.failed[duration] = _beyond(excess.share)
                return False
        try:
            self.best = plan_along(along)
        except SolverFailedError as error:
            self.failed[duration] = str(error)
            return False
        return True

    def succeeds_after_all(self, duration: float) -> bool:
        """Return whether there is a plan for a duration that failed, by the stand-in as well."""
        if duration in self._explained:
            return False
        before = self._thorough
        self._thorough = True
        succeeds = self.succeeds(duration)
        self._thorough = before or succeeds
        return succeeds

    def bracket(self, least: float) -> tuple[float, float]:
        """Return two durations, of which the longer one succeeds and the shorter one does not."""
        if least > 0:
            self.failed[least] = _RIGID
        low = max(least, LEAST_DURATION)
        high = max(self.request.task.duration, 1.01 * least)
        longest = self._longest()
        while not self.succeeds(high):
            if _GROWTH * high > longest:
                if self.succeeds_after_all(high):
                    break
                raise InfeasibleTaskError(
                    f"no duration up to {high:.3g} s will do: {self.failed[high]}"
                )
            low = high
            high = _GROWTH * high
        while low < high / _GROWTH and self.succeeds(high / _GROWTH):
            high /= _GROWTH
        return max(low, high / _GROWTH), high

    def _longest(self, rigid_times: int = 3, swings: int = 20) -> float:
        """The longest duration that is tried [s].

        So many times what a rigid joint takes, and so many swings of the slowest mode.
        """
        task = self.request.task
        modes = FreeVibration(task.plant, task.target).modes
        slowest = 2 * math.pi / modes[0][0] if modes else 1.0
        rigid = rigid_motion(abs(task.span), assumed_bounds(task))
        return max(task.duration, rigid_times * rigid.duration + swings * slowest)
