"""`fastest_move`: the shortest duration in which a move within its limits still arrives."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from quietarm.ocp.checks import positive, takes
from quietarm.ocp.errors import InfeasibleTaskError, SolverFailedError
from quietarm.ocp.interrupts import one_at_a_time
from quietarm.ocp.limits import QUANTITIES, TorqueSpeedLine
from quietarm.ocp.planning.best_of_starts import best_of_starts, explain, least_peaks_of
from quietarm.ocp.planning.plan import Plan
from quietarm.ocp.planning.plan_move import plan_move
from quietarm.ocp.planning.profiles import CHOSEN, SIX
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.free_vibration import FreeVibration
from quietarm.ocp.solvers.problem import Problem, Transcription
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.task import LEAST_DURATION, PointToPoint

TOLERANCE = 1e-3
DURATION_OF_SIX = "duration_of_six_terms"
_TERMS = 12
"""With which the shortest duration is looked for: 18 shorten it by another 1 %, and take minutes
where nothing is found."""
_SHORTER = (0.97, 0.9, 0.8)
"""Shares of the duration that failed which are tried as well: what is feasible may have gaps."""
_GROWTH, _LONGEST = 1.5, 20
"""By which a duration that fails grows; so many swings of the slowest mode are tried at most."""


@dataclass(frozen=True)
class Fastest:
    """The shortest duration found for a move.

    Attributes
    ----------
    plan : Plan
        The move of least energy in that duration.
    failed : tuple of (float, str)
        Shorter durations [s] that were tried, the longest first, and why each failed: the first is
        shorter by no more than the tolerance.
    """

    plan: Plan
    failed: tuple[tuple[float, str], ...]

    @property
    def duration(self) -> float:
        """Of the plan [s]."""
        return self.plan.task.duration


@one_at_a_time
@takes(task=PointToPoint, profile=JointProfile)
def fastest_move(
    task: PointToPoint,
    profile: JointProfile | None = None,
    *,
    residual_limit: float | None = None,
    bound: float | None = None,
    tolerance: float = TOLERANCE,
    **settings: Any,
) -> Fastest:
    """Find the shortest duration in which a move keeps its limits and arrives at rest.

    Durations are found by bisection, each from the coefficients of the last feasible one.

    Parameters
    ----------
    task : PointToPoint
        The move with its limits, of which there is one at least; its duration is where the search
        begins. A plant may be uncertain.
    profile, residual_limit, bound, **settings
        As for `plan_move`. Without a profile the duration is that of 12 terms, and the plan has its
        default number of terms; its record has the duration of six.
    tolerance : float
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
    asked, profile = profile, SIX if profile is None else profile
    positive("tolerance", tolerance)
    profile.refuse_no_choice()
    if not task.limits:
        names = ", ".join(QUANTITIES)
        raise ValueError(f"nothing limits how fast the move may be; give a limit of {names}")
    begin = time.perf_counter()
    search = _Search(task, profile, {
        "residual_limit": residual_limit, "bound": bound, **{"starts": 1, **settings},
    })  # fmt: skip
    _narrow(search, tolerance)
    best, chosen = search.best, {}
    assert best is not None  # the bracket found one
    if asked is None:
        chosen = {DURATION_OF_SIX: best.task.duration}
        search, best = _with_more_terms(search, tolerance)
        chosen |= {CHOSEN: best.profile.size}
    settings, seconds = {**best.record.settings, **chosen}, time.perf_counter() - begin
    plan = best.restated(settings=settings, seconds=seconds)
    failed = sorted(search.failed.items(), reverse=True)
    shorter = tuple(one for one in failed if one[0] < plan.task.duration)
    return Fastest(plan, shorter)


def _with_more_terms(six: _Search, tolerance: float) -> tuple[_Search, Plan]:
    """The search that goes on from that of six terms, and the plan of the shortest duration."""
    assert six.best is not None
    search = _Search(six.best.task, CycloidPolynomial(_TERMS), six.settings, quick=True)
    search.best = six.best
    _narrow(search, tolerance)
    try:
        settings: dict[str, Any] = {**search.settings, "guess": None}
        return search, plan_move(search.best.task, **settings)
    except SolverFailedError:
        return search, search.best


def _narrow(search: _Search, tolerance: float) -> None:
    """Bisect, and again below what failed as long as something there succeeds."""
    least = _least_duration(search.task)
    low, high = search.bracket(least)
    while True:
        while high / low > 1 + tolerance:
            middle = math.sqrt(low * high)
            if search.succeeds(middle):
                high = middle
            else:
                low = middle
        below = (share * low for share in _SHORTER if share * low > least)
        shorter = next((one for one in below if search.succeeds(one)), None)
        if shorter is None:
            return
        low, high = least or shorter / _GROWTH, shorter


class _Search:
    """Durations that were tried; a quick search gives one up where the solver's starts do."""

    def __init__(
        self,
        task: PointToPoint,
        profile: JointProfile,
        settings: dict[str, Any],
        quick: bool = False,
    ) -> None:
        self.task, self.profile, self.settings, self.quick = task, profile, settings, quick
        self.best: Plan | None = None
        self.failed: dict[float, str] = {}

    def succeeds(self, duration: float) -> bool:
        """Whether there is a plan for a duration."""
        task, guess = replace(self.task, duration=duration), None
        if self.best is not None:
            more = self.profile.size - len(self.best.coefficients)
            guess = (*self.best.coefficients, *[0.0] * more)
        if self.quick and (why := self._refusal(task, guess)):
            self.failed[duration] = why
            return False
        try:
            plan = plan_move(task, self.profile, guess=guess, **self.settings)
        except SolverFailedError as error:
            self.failed[duration] = str(error)
            return False
        self.best = plan
        return True

    def _refusal(self, task: PointToPoint, guess: tuple[float, ...] | None) -> str:
        """Why the solver finds no motion of the nominal plant from the last one and the cycloid.

        The default residual limit of an uncertain task is not known yet; other limits count.
        """
        residual = 1.0 if task.uncertainty else self.settings["residual_limit"] or 0.0
        steps = Transcription.of(task.certain, self.profile)
        problem = Problem.of(steps, residual, self.settings["bound"])
        starts = [self.profile.plain, *([] if guess is None else [np.array(guess)])]
        (found,) = best_of_starts([problem], [starts], Sqp())
        if found.status.solved:
            return ""
        return str(explain(problem, [found], least_peaks_of(problem, starts)))

    def bracket(self, least: float) -> tuple[float, float]:
        """Two durations, of which the longer one succeeds and the shorter one does not."""
        if least > 0:
            self.failed[least] = "within its limits of speed and acceleration a joint takes longer"
        low, high = max(least, LEAST_DURATION), max(self.task.duration, 1.01 * least)
        modes = FreeVibration(self.task.plant, self.task.target).modes
        slowest = 2 * math.pi / modes[0][0] if modes else 1.0
        longest = max(self.task.duration, _LONGEST * slowest)
        while not self.succeeds(high):
            low, high = high, _GROWTH * high
            if high > longest:
                raise InfeasibleTaskError(
                    f"no duration up to {low:.3g} s will do: {self.failed[low]}"
                )
        while low < high / _GROWTH and self.succeeds(high / _GROWTH):
            high /= _GROWTH
        return max(low, high / _GROWTH), high


def _least_duration(task: PointToPoint) -> float:
    """What the limits of speed and acceleration allow a rigid joint [s]."""
    span, speeds, least = abs(task.span), list[float](), 0.0
    forward = task.span > 0
    for limit in task.limits:
        if limit.name == "speed":
            speeds.append(limit.upper if forward else -limit.lower)
        if limit.name == "acceleration":  # the one, then the other
            least = math.sqrt(2 * span * (1 / limit.upper - 1 / limit.lower))
        if isinstance(limit.quantity.of, TorqueSpeedLine):
            speeds.append(limit.quantity.of.largest_speed)
    return max([least, *(span / speed for speed in speeds)])
