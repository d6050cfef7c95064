"""`fastest_move`: the shortest duration in which a move within its limits still arrives.

By default on a spline of the joint, which `least_time` fits to the task; along a profile that is
given by bisection, each duration from the coefficients of the last feasible one.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace

from quietarm.ocp.checks import positive, takes
from quietarm.ocp.errors import InfeasibleTaskError, SolverFailedError
from quietarm.ocp.limits import QUANTITIES
from quietarm.ocp.planning.least_time import LeastTime, least_time
from quietarm.ocp.planning.plan import Plan
from quietarm.ocp.planning.plan_along import plan_along
from quietarm.ocp.planning.residual_limit import ResidualLimit
from quietarm.ocp.planning.rigid_motion import (
    assumed_bounds,
    largest_deflection,
    rigid_duration,
    rigid_motion,
)
from quietarm.ocp.planning.setup import Setup
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.profiles.shaped_cycloid import TOLERATED
from quietarm.ocp.simulation.free_vibration import FreeVibration
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.task import LEAST_DURATION, PointToPoint

_SHORTER = (0.97, 0.9, 0.8)
"""Shares of the duration that failed which are tried as well: what is feasible may have gaps."""
_GROWTH = 1.5
"""By which a duration along a given profile grows where it fails."""
_LONGEST, _SWINGS = 3, 20
"""So many times what a rigid joint takes, and so many swings of the slowest mode, are tried."""
_RIGID = "within its limits of speed, acceleration and jerk a joint takes longer"
_LONGER = (5e-4, 1e-3, 2e-3, 5e-3, 0.01, 0.02, 0.05, 0.1, 0.2)
"""Shares by which the least time grows until there is a plan: in the least time itself limits could
not be narrowed by what passes them between the solver's nodes."""
_LONGER_IF_UNCERTAIN = 2e-3
"""The least of them for an uncertain plant, whose worst case may lie between the scenarios."""


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
        """Of the plan [s]."""
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
        Largest F1 [m]; 0, the default, requires rest on arrival. For an uncertain task the default
        is `fastest_residual_limit`, whatever the duration.
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
    setup = Setup(solver, bound, 1, seed, steps)
    if not task.limits:
        names = ", ".join(QUANTITIES)
        raise ValueError(f"nothing limits how fast the move may be; give a limit of {names}")
    if task.uncertainty is not None and residual_limit is None:
        residual_limit = fastest_residual_limit(task)
    begin = time.perf_counter()
    limit = ResidualLimit.of(task, residual_limit)
    if profile is None:
        fastest = _fastest_on_spline(task, setup, limit, duration_tolerance)
    else:
        profile.refuse_no_choice()
        search = _Search(task, profile, setup, limit)
        fastest = _fastest_along(search, duration_tolerance)
    plan = fastest.plan.restated(seconds=time.perf_counter() - begin)
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


def _fastest_on_spline(
    task: PointToPoint, setup: Setup, residual_limit: ResidualLimit, tolerance: float
) -> Fastest:
    """The plan of least energy in the least time on a spline, or in hardly more."""
    try:
        least = least_time(task, residual_limit.size, setup.bound, tolerance / 2)
    except ValueError as error:
        raise InfeasibleTaskError(f"no duration was found: {error}") from None
    failed = {least.too_short: _why_too_short(task, least)}
    from_least = replace(setup, guess=tuple(least.coefficients.tolist()))
    shortest = _LONGER[0] if task.uncertainty is None else _LONGER_IF_UNCERTAIN
    for longer in (share for share in _LONGER if share >= shortest):
        duration = (1 + longer) * least.duration
        try:
            plan = plan_along(
                replace(task, duration=duration),
                least.profile,
                from_least,
                residual_limit,
                quick=True,
            )
        except SolverFailedError as error:
            failed[duration] = str(error)
            continue
        stated = {name: value for name, value in plan.record.settings.items() if name != "guess"}
        shorter = tuple(sorted(failed.items(), reverse=True))
        return Fastest(plan.restated(settings=stated), shorter)
    longest, why = max(failed.items())
    raise InfeasibleTaskError(f"no duration up to {longest:.3g} s will do: {why}")


def _why_too_short(task: PointToPoint, least: LeastTime) -> str:
    """What is said of the longest duration that failed."""
    if least.too_short <= rigid_duration(task):
        return _RIGID
    return f"every motion found exceeds a limit by {max(least.excess, 1e-6):.1g} of it or more"


def _fastest_along(search: _Search, tolerance: float) -> Fastest:
    """The plan in the shortest duration along a profile."""
    _narrow(search, tolerance)
    assert search.best is not None  # the bracket found one
    shorter = [
        failure for failure in search.failed.items() if failure[0] < search.best.task.duration
    ]
    return Fastest(search.best, tuple(sorted(shorter, reverse=True)))


def _narrow(search: _Search, tolerance: float) -> None:
    """Bisect, and again below what failed as long as something there succeeds."""
    least = rigid_duration(search.task)
    low, high = search.bracket(least)
    while True:
        while high / low > 1 + tolerance:
            middle = math.sqrt(low * high)
            if search.succeeds(middle):
                high = middle
            else:
                low = middle
        below = (share * low for share in _SHORTER if share * low > least)
        shorter = next((one for one in below if search.succeeds(one, thorough=False)), None)
        if shorter is None:
            return
        low, high = least or shorter / _GROWTH, shorter


class _Search:
    """Durations that were tried along a profile."""

    def __init__(
        self,
        task: PointToPoint,
        profile: JointProfile,
        setup: Setup,
        residual_limit: ResidualLimit,
    ) -> None:
        self.task = task
        self.profile = profile
        self.setup = setup
        self.residual_limit = residual_limit
        self.best: Plan | None = None
        self.failed: dict[float, str] = {}

    def succeeds(self, duration: float, thorough: bool = True) -> bool:
        """Whether there is a plan for a duration, by the setup's solver alone if not thorough."""
        task = replace(self.task, duration=duration)
        guess = None if self.best is None else self.best.coefficients
        try:
            from_best = replace(self.setup, guess=guess, thorough=thorough)
            plan = plan_along(task, self.profile, from_best, self.residual_limit)
        except SolverFailedError as error:
            self.failed[duration] = str(error)
            return False
        self.best = plan
        return True

    def bracket(self, least: float) -> tuple[float, float]:
        """Two durations, of which the longer one succeeds and the shorter one does not."""
        if least > 0:
            self.failed[least] = _RIGID
        low, high = max(least, LEAST_DURATION), max(self.task.duration, 1.01 * least)
        modes = FreeVibration(self.task.plant, self.task.target).modes
        slowest = 2 * math.pi / modes[0][0] if modes else 1.0
        rigid = rigid_motion(abs(self.task.span), assumed_bounds(self.task))
        longest = max(self.task.duration, _LONGEST * rigid.duration + _SWINGS * slowest)
        while not self.succeeds(high):
            low, high = high, _GROWTH * high
            if high > longest:
                raise InfeasibleTaskError(
                    f"no duration up to {low:.3g} s will do: {self.failed[low]}"
                )
        while low < high / _GROWTH and self.succeeds(high / _GROWTH):
            high /= _GROWTH
        return max(low, high / _GROWTH), high
