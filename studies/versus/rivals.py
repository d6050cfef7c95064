"""What is used today instead of a plan: shaped cycloids, ruckig, shaped ruckig."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import product

import numpy as np
from quietarm.ocp import (
    Candidate,
    JointProfile,
    Motion,
    Plan,
    PointToPoint,
    QuietarmError,
    evaluate_coefficients,
    plan_move,
    shaped_cycloid,
)
from quietarm.ocp.checks import install
from quietarm.ocp.profiles.free_motion import FreeMotion
from quietarm.ocp.profiles.shaped_cycloid import SHAPERS, Impulses, convolved
from quietarm.ocp.simulation.free_vibration import FreeVibration

_ALONG = {1: 41, 2: 9}
"""Errors along each side of their ranges, by how many there are; else their corners."""
_SHORTEST = 1e-9
"""Pieces of a motion that are shorter [s] are none."""
_LEAST_SHARE = 0.02
"""Share of the duration that a shaper has to leave for the motion that it shapes."""


@dataclass(frozen=True)
class Rival:
    """What one way to move makes of a move: its figures by CVODES, or why it cannot be."""

    name: str
    motion: Motion | None = None
    worst: float | None = None
    """The largest residual within the errors [m]; None where there are none."""
    why: str = ""


def rivals(
    task: PointToPoint, profile: JointProfile, residual_limit: float | None = None
) -> Iterator[Rival]:
    """Every way to make a move, one after another; with errors of the plant a robust plan, too.

    The residual limit is of that; those of the task are for the plans and for ruckig.
    """
    for name, candidate_of in _ways(task, profile, residual_limit):
        try:
            rival = _judged(name, task, candidate_of())
        except (QuietarmError, ValueError) as error:
            rival = Rival(name, why=str(error))
        yield rival


def _ways(
    task: PointToPoint, profile: JointProfile, residual_limit: float | None
) -> Iterator[tuple[str, Callable[[], Candidate]]]:
    """What moves the joint, by its name."""
    certain = task.certain

    def along(plan: Plan) -> Candidate:
        return Candidate.of_profile(certain, plan.profile, plan.coefficients)

    def shaped_by(shaper: str) -> Candidate:
        own = shaped_cycloid(certain, shaper)
        return along(evaluate_coefficients(certain, [], profile=own))

    yield "plan", lambda: along(plan_move(certain, profile))
    if task.ranges:
        limit = residual_limit
        yield "robust plan", lambda: along(plan_move(task, profile, residual_limit=limit))
    yield "plain cycloid", lambda: along(evaluate_coefficients(certain, []))
    for name in SHAPERS:
        yield f"{name}, cycloid", partial(shaped_by, name)
    yield "ruckig", partial(_by_ruckig, certain, Impulses((1.0,), (0.0,)))
    for name in SHAPERS:
        yield f"{name}, ruckig", lambda name=name: _by_ruckig(certain, _impulses(task, name))


def _by_ruckig(task: PointToPoint, impulses: Impulses) -> Candidate:
    left = task.duration - impulses.times[-1]
    if left < _LEAST_SHARE * task.duration:
        raise ValueError(f"the shaper alone takes {impulses.times[-1]:.3g} s")
    free = shaped(ruckig_motion(replace(task, duration=left)), impulses)
    return Candidate.of_free_motion(task, free)


def _impulses(task: PointToPoint, shaper: str) -> Impulses:
    modes = FreeVibration(task.plant, task.target).modes
    return convolved([SHAPERS[shaper](*mode) for mode in modes])


def ruckig_motion(task: PointToPoint) -> FreeMotion:
    """The motion of constant jerk that ruckig finds within a task's limits, in its duration.

    ValueError where ruckig is not installed, the task limits no acceleration, or time is too short.
    """
    try:
        from ruckig import InputParameter, Ruckig, Trajectory
    except ImportError:
        raise ValueError(f"ruckig is not installed; {install('ruckig')}") from None
    if task.acceleration_limit is None:
        raise ValueError("ruckig needs an acceleration limit")
    asked, found, free = InputParameter(1), Trajectory(1), (-np.inf, np.inf)
    asked.current_position, asked.target_position = [task.start], [task.target]
    bounds = {limit.name: (limit.lower, limit.upper) for limit in task.limits}
    slowest, fastest = bounds.get("speed", free)
    asked.min_velocity, asked.max_velocity = [slowest], [fastest]
    least, most = bounds["acceleration"]
    asked.min_acceleration, asked.max_acceleration = [least], [most]
    asked.max_jerk = [min(np.abs(bounds.get("jerk", free)))]
    asked.minimum_duration = task.duration
    Ruckig(1).calculate(asked, found)
    if found.duration > task.duration * (1 + 1e-6):
        raise ValueError(
            f"within the limits it takes {found.duration:.4g} s, more than the "
            f"{task.duration:.4g} s that it has"
        )
    one = found.profiles[0][0]
    lengths = np.array(one.t)
    there = lengths > _SHORTEST
    times = np.concatenate([[0.0], np.cumsum(lengths[there])])
    return FreeMotion(times, np.array(one.a)[:-1][there], np.array(one.j)[there])


def shaped(free: FreeMotion, impulses: Impulses) -> FreeMotion:
    """A motion convolved with impulses: one of them again, in pieces."""
    begins = np.add.outer(free.times, impulses.times).ravel()
    times = np.unique(begins)
    times = times[np.append(True, np.diff(times) > _SHORTEST)]
    middle = (times[1:] + times[:-1]) / 2
    acceleration, jerk = np.zeros(len(middle)), np.zeros(len(middle))
    for share, begin in zip(*impulses, strict=True):
        own = np.searchsorted(free.times, middle - begin, side="right") - 1
        moving = (own >= 0) & (own < free.steps)
        k = own[moving]
        since = times[:-1][moving] - begin - free.times[k]
        acceleration[moving] += share * (free.acceleration[k] + free.jerk[k] * since)
        jerk[moving] += share * free.jerk[k]
    return FreeMotion(times, acceleration, jerk)


def _judged(name: str, task: PointToPoint, candidate: Candidate) -> Rival:
    left = [candidate.perturbed(errors).residual for errors in _errors(task.ranges)]
    return Rival(name, candidate.motion, max(left, default=None))


def _errors(ranges: Mapping[str, float]) -> Iterator[dict[str, float]]:
    """Errors within their ranges, evenly along each."""
    if not ranges:
        return
    count = _ALONG.get(len(ranges), 2)
    for errors in product(*(np.linspace(-size, size, count).tolist() for size in ranges.values())):
        yield dict(zip(ranges, errors, strict=True))
