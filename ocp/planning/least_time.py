"""The least time of a task on a spline of the joint, whose knots go where its acceleration turns.

The search begins from the time-optimal motion of the rigid joint with a ZV shaper behind it, which
leaves a linear plant at rest: its switches are the first knots, its duration the first to be tried.
The knots then follow the acceleration of the fastest motion that was found.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.planning.rigid_motion import (
    RigidMotion,
    assumed_bounds,
    rigid_duration,
    rigid_motion,
)
from quietarm.ocp.planning.worst_scenarios import new_scenarios, with_moved_scenarios
from quietarm.ocp.profiles.joint_spline import JointSpline
from quietarm.ocp.robustness import peaks_between
from quietarm.ocp.simulation.free_vibration import FreeVibration
from quietarm.ocp.solvers.least_excess import Excess, least_excess
from quietarm.ocp.solvers.problem import (
    MOST_SOLVER_STEPS,
    Program,
    first_steps,
)
from quietarm.ocp.task import LEAST_DURATION, PointToPoint

Array = NDArray[np.float64]
_SAMPLES = 4001
"""Of the acceleration, for the knots."""
_ROUNDS = 3
"""Of knots."""
_WORST_ROUNDS = 4
"""Of worst cases that become scenarios."""
_FINER = 2
"""Times the steps of the first rounds: on these limits are passed between the nodes by 1e-3."""
_GAIN = 5e-3
"""A round that shortens the move by a smaller share is the last."""
_HOPELESS = 0.8
"""Share of an excess that is left by other knots: where it is more, none will do."""
_GROWTH = 1.3
"""By which a duration that is too short grows."""


class LeastTime(NamedTuple):
    """The shortest duration [s] that was found, the motion of it, and the longest one that failed.

    The latter comes with the least share by which its limits are exceeded; the task has the
    motion's worst cases as scenarios. The motion has so many steps.
    """

    duration: float
    coefficients: Array
    profile: JointSpline
    too_short: float
    excess: float
    task: PointToPoint
    steps: int


def least_time(
    task: PointToPoint,
    residual_limit: float,
    bound: float | None,
    tolerance: float,
    rounds: int = _ROUNDS,
    most_steps: int = MOST_SOLVER_STEPS,
    roughly: bool = False,
) -> LeastTime:
    """The least time of a task within its limits, to a share of it, after so many rounds of knots.

    Roughly it is by the solver's nodes and the task's scenarios alone. ValueError where a move as
    long as its limits ask for takes more steps than the solver has, or than is wanted.
    """
    shaped = _shaped_rigid_motion(task)
    low = rigid_duration(task) or shaped.duration / _GROWTH
    first = JointSpline(_knots_at(shaped))
    durations = _Durations(task, first, residual_limit, bound, most_steps)
    best = durations.least(low, shaped.duration, tolerance)
    for _ in range(rounds):
        profile = JointSpline(_knots_along(best.profile, best.coefficients))
        following = _Durations(task, profile, residual_limit, bound)
        shorter = following.least(max(low, best.duration / _GROWTH), best.duration, tolerance)
        gain = best.duration / shorter.duration - 1
        if gain > 0:
            best = shorter
            durations = following
        if gain < _GAIN:
            break
    if roughly:
        return best
    finer = _FINER * best.steps
    for _ in range(_WORST_ROUNDS):
        uncertain = durations.with_worst_cases(best)
        if uncertain is None:
            break
        # on as many steps as the plan takes, which then need not be compiled again
        durations = _Durations(uncertain, best.profile, residual_limit, bound, fewest_steps=finer)
        best = durations.least(best.duration, (1 + _GAIN) * best.duration, tolerance)
    if durations.widen_margins(best):
        best = durations.least(best.duration, (1 + _GAIN) * best.duration, tolerance)
    return best


class SplineFit(NamedTuple):
    """The spline on which a motion comes nearest to a task's limits in its duration."""

    profile: JointSpline
    excess: Excess

    @property
    def keeps(self) -> bool:
        """Return whether the motion keeps every limit."""
        return self.excess.holds and self.excess.share <= 0


def fit_spline(task: PointToPoint, residual_limit: float, bound: float | None) -> SplineFit:
    """The spline whose motion keeps a task's limits in its duration, or comes nearest.

    ValueError where nothing limits the joint, or no motion is so slow that it keeps the limits.
    """
    knots = _knots_at(_shaped_rigid_motion(task))
    fits: list[SplineFit] = []
    for _ in range(1 + _ROUNDS):
        profile = JointSpline(knots)
        excess = _Durations(task, profile, residual_limit, bound).excess(task.duration)
        least = min((fit.excess.share for fit in fits if fit.excess.holds), default=math.inf)
        fits.append(SplineFit(profile, excess))
        if fits[-1].keeps or (excess.holds and excess.share > _HOPELESS * least):
            break
        knots = _knots_along(profile, excess.coefficients)
    return min(fits, key=lambda fit: (not fit.excess.holds, fit.excess.share))


def shaped_duration(task: PointToPoint) -> float:
    """Return the time of the rigid joint's fastest motion behind a ZV shaper for every mode [s].

    ValueError where nothing limits the joint.
    """
    return _shaped_rigid_motion(task).duration


def _shaped_rigid_motion(task: PointToPoint) -> RigidMotion:
    """The rigid joint's time-optimal motion with a ZV shaper for every mode behind it."""
    rigid = rigid_motion(abs(task.span), assumed_bounds(task))
    modes = FreeVibration(task.plant, task.target).modes
    half_periods = [
        math.pi / (frequency * math.sqrt(1 - damping**2)) for frequency, damping in modes
    ]
    impulses = product(*((0.0, half_period) for half_period in half_periods))
    delays = [sum(impulse) for impulse in impulses]
    switches = {switch + delay for switch in rigid.switches for delay in delays}
    duration = rigid.duration + sum(half_periods)
    return RigidMotion(duration, tuple(sorted(switches)))


def _knots_at(motion: RigidMotion, ramp: float = 4e-3) -> tuple[float, ...]:
    """Knots about the switches of a motion.

    The acceleration may change within the share `ramp` of the move on either side of a switch.
    """
    fractions = np.linspace(0.0, 1.0, _SAMPLES)
    switches = np.array(motion.switches) / motion.duration
    ramps = (fractions[:, None] - switches + ramp) / (2 * ramp)
    changed = np.clip(ramps, 0.0, 1.0).sum(axis=1)
    return _knots_by(fractions, changed)


def _knots_along(profile: JointSpline, coefficients: Array) -> tuple[float, ...]:
    """Knots where the acceleration of a motion changes."""
    fractions = np.linspace(0.0, 1.0, _SAMPLES)
    *_, acceleration = profile.derivatives(coefficients.tolist(), fractions)
    changes = np.abs(np.diff(acceleration, prepend=acceleration[0]))
    return _knots_by(fractions, np.cumsum(changes))


def _knots_by(
    fractions: Array,
    changed: Array,
    *,
    count: int = 32,
    even_share: float = 0.35,
    gap: float = 1e-3,
) -> tuple[float, ...]:
    """Knots between which a rising quantity changes alike, blended with even ones.

    With 24 of them the least time is up to 1 % longer, with 40 a plan takes twice as long. A share
    of them is spread evenly; all are a `gap` apart at least, a share of the move.
    """
    risen = (changed - changed[0]) / (changed[-1] - changed[0])
    blend = even_share * fractions + (1 - even_share) * risen
    levels = np.linspace(0.0, 1.0, count + 2)[1:-1]
    places = np.interp(levels, blend, fractions)
    knots: list[float] = []
    for place in places.tolist():
        last = knots[-1] if knots else 0.0
        if place - last >= gap and place <= 1 - gap:
            knots.append(place)
    return tuple(knots)


class _Durations:
    """Durations of one task and profile, with the least excess of each."""

    margin: ClassVar[float] = 2e-3
    """Share by which limits are narrowed, for what passes them between the solver's nodes."""
    margin_of_speed: ClassVar[float] = 2e-4
    """The speed, smoother than all else, by less, since it settles how long a cruise takes."""
    room: ClassVar[float] = 1.2
    """Where CVODES finds more above a limit, this multiple of it is the margin."""
    far: ClassVar[float] = 1.0
    """An excess of more counts as this one: how far it is says nothing."""

    def __init__(
        self,
        task: PointToPoint,
        profile: JointSpline,
        residual_limit: float,
        bound: float | None,
        most_steps: int = MOST_SOLVER_STEPS,
        fewest_steps: int = 0,
    ) -> None:
        self._most_steps = most_steps
        self._task = task
        self._profile = profile
        self._residual_limit = residual_limit
        self._bound = bound
        self._steps = fewest_steps
        self._margins = {limit.name: self.margin for limit in task.limits}
        if "speed" in self._margins:
            self._margins["speed"] = self.margin_of_speed
        self._start = profile.plain
        self._shortest: tuple[float, Array] | None = None
        self._too_short = _Probe(0.0, math.inf)

    def excess(self, duration: float) -> Excess:
        """The least excess of a duration, from the motion of the last one."""
        task = replace(self._task, duration=duration)
        # as many as the longest move takes: others have to be compiled
        self._steps = max(self._steps, first_steps(task, self._profile))
        if self._steps > self._most_steps:
            raise ValueError(f"a move of {duration:g} s takes {self._steps} steps")
        problem = self._problem(Program.of(task, self._profile, self._steps))
        excess = least_excess(problem, self._start)
        if not excess.holds:
            excess = least_excess(problem, self._profile.plain)
        if excess.holds:
            self._start = excess.coefficients
        return excess

    def _problem(self, program: Program) -> Program:
        """Return the problem within narrower limits of what is limited on the way."""
        problem = program.within(self._residual_limit, self._bound)
        limits = [
            limit.tightened(1 + self._margins.get(limit.name, 0.0)) for limit in problem.limits
        ]
        return problem.asking(limits=tuple(limits))

    def with_worst_cases(self, least: LeastTime) -> PointToPoint | None:
        """The task with what passes the residual's limit between its scenarios; None if nothing."""
        if self._task.uncertainty is None:
            return None
        peaks = peaks_between(self._motion(least), roughly=True)
        above = [peak for peak in peaks if peak.residual > (1 + self.margin) * self._residual_limit]
        scenarios = new_scenarios(self._task, above)
        return with_moved_scenarios(self._task, scenarios) if scenarios else None

    def _motion(self, least: LeastTime) -> JudgedMotion:
        task = replace(self._task, duration=least.duration)
        return JudgedMotion.of_profile(task, self._profile, least.coefficients)

    def widen_margins(self, least: LeastTime) -> bool:
        """Widen the margins that a motion passes limits by; return whether there are any."""
        exceeded = self._motion(least).figures.exceeded(self._task.limits)
        for name, ratio in exceeded.items():
            self._margins[name] += self.room * (ratio - 1)
        self._shortest = None
        return bool(exceeded)

    def least(self, low: float, high: float, tolerance: float) -> LeastTime:
        """The least duration, to a share; the ends are where it is expected."""
        above = self._probe(max(high, LEAST_DURATION))
        below = self._probe(max(low, LEAST_DURATION))
        while above.share > 0:
            below = above
            above = self._probe(_GROWTH * above.duration)
        while below.share <= 0:
            above = below
            below = self._probe(below.duration / _GROWTH)
        weights = _Weights()
        while above.duration / below.duration > 1 + tolerance:
            between = self._probe(weights.between(below, above, tolerance))
            if between.share > 0:
                below = between
            else:
                above = between
            weights.moved(up=between.share > 0)
        assert self._shortest is not None  # the upper end
        duration, coefficients = self._shortest
        return LeastTime(
            duration,
            coefficients,
            self._profile,
            too_short=self._too_short.duration,
            excess=self._too_short.share,
            task=self._task,
            steps=self._steps,
        )

    def _probe(self, duration: float) -> _Probe:
        """The excess of a duration as far as it matters; the shortest that does is noted.

        And the longest that does not.
        """
        excess = self.excess(duration)
        share = min(excess.share, self.far) if excess.holds else self.far
        probe = _Probe(duration, share)
        if share <= 0:
            self._shortest = (duration, excess.coefficients)
        elif duration > self._too_short.duration:
            self._too_short = probe
        return probe


class _Probe(NamedTuple):
    """A duration [s], and by what share its limits are exceeded."""

    duration: float
    share: float


class _Weights:
    """Regula falsi (Illinois): an end that stays counts for half as much each time."""

    def __init__(self) -> None:
        self._of_below = 1.0
        self._of_above = 1.0
        self._went_up: bool | None = None

    def between(self, below: _Probe, above: _Probe, tolerance: float) -> float:
        """Return where the line through both ends is zero, not too near to either of them."""
        excess = self._of_below * below.share
        room = -self._of_above * above.share
        middle = below.duration + (above.duration - below.duration) * excess / (excess + room)
        step = min(tolerance * below.duration, above.duration - below.duration) / 2
        return min(max(middle, below.duration + step), above.duration - step)

    def moved(self, up: bool) -> None:
        """Note which end was replaced."""
        self._of_below = 1.0 if up else self._of_below
        self._of_above = self._of_above if up else 1.0
        if up == self._went_up:
            if up:
                self._of_above /= 2
            else:
                self._of_below /= 2
        self._went_up = up
