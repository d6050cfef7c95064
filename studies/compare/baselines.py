"""Baselines, used today in place of a plan: cycloid, S-curves, input shapers, ruckig, toppra.

A baseline is made for the duration of a task, or takes the shortest one within the task's limits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial

import numpy as np

from quietarm.models import JointMotion
from quietarm.ocp import JudgedMotion, Plan, PointToPoint, evaluate_coefficients, shaped_cycloid
from quietarm.ocp.checks import install, several, takes, unknown
from quietarm.ocp.joint_words import broken_limits
from quietarm.ocp.limits import Limit, Shares
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.ocp.planning.rigid_motion import RigidBounds
from quietarm.ocp.profiles.free_motion import FreeMotion
from quietarm.ocp.profiles.shaped_cycloid import (
    LEAST_SHARE,
    SHAPERS,
    Impulses,
    convolved,
    extra_insensitive,
)
from quietarm.ocp.simulation.free_vibration import FreeVibration
from quietarm.studies.compare.s_curves import (
    bounds_of,
    cycloid_duration,
    gentler,
    s_curve,
    slower,
    tuned_s_curve,
)
from quietarm.studies.compare.toppra_motion import toppra_motion

CYCLOID = "cycloid"
S_CURVE = "s-curve"
TUNED = f"tuned-{S_CURVE}"
EI_OF_BAND = f"ei-band-{S_CURVE}"
RUCKIG = "ruckig"
TOPPRA = "toppra"
OVER_RUCKIG = tuple(f"{name}-{RUCKIG}" for name in SHAPERS)
"""Shapers over ruckig, which finds the same motion as the S-curve at its shortest duration."""
EVERY = (
    CYCLOID, *SHAPERS, S_CURVE, TUNED, *(f"{name}-{S_CURVE}" for name in SHAPERS), EI_OF_BAND,
    RUCKIG, TOPPRA,
)  # fmt: skip
"""What "all" stands for; a shaper alone shapes the cycloid."""
BASELINES = (*EVERY, *OVER_RUCKIG)
"""Their names."""
ALL = "all"
_SHORTEST = 1e-9
"""Pieces of a motion that are shorter [s] are none."""
_PLACES = 21
"""Of a path, at which it is seen whether it is straight."""
_STRAIGHT = 1e-9
"""Curvature of a straight path, as a share of its slope."""
_LEAST_UNSHAPED = 0.02
"""Share of the duration that a shaper has to leave for the motion that it shapes."""


def meaning_of_baseline(name: str) -> str:
    """Return which of the pictures' `MEANINGS` a baseline is, by its shaper; or another word."""
    shaper = _shaper_in(name)
    return "EI" if name == EI_OF_BAND else shaper.upper()


def _shaper_in(name: str) -> str:
    """The shaper in a baseline's name; empty of one without."""
    return name.removesuffix(RUCKIG).removesuffix(S_CURVE).removesuffix("-")


def choose_baselines(names: Iterable[str]) -> tuple[str, ...]:
    """Baselines of these names, of "all" every one, each once; ValueError where one is unknown."""
    names = several("baselines", names, "names")
    chosen = dict[str, None]()
    for name in names:
        chosen |= dict.fromkeys(EVERY if name == ALL else [name])
    for name in chosen:
        if name not in BASELINES:
            raise ValueError(unknown("baseline", name, (ALL, *BASELINES)))
    return tuple(chosen)


@takes(task=PointToPoint)
def baseline(name: str, task: PointToPoint, tolerated: float | None = None) -> Plan | JudgedMotion:
    """Return a baseline's motion of a task in the task's duration; ValueError if there is none.

    `tolerated` is the share of the vibration that ``ei-band-s-curve`` lets pass.
    """
    task = task.certain
    if name == CYCLOID:
        return evaluate_coefficients(task, [])
    if name in SHAPERS:
        return evaluate_coefficients(task, [], profile=shaped_cycloid(task, name))
    if name == TOPPRA:
        return JudgedMotion.of_free_motion(task, toppra_motion(task))
    if name == TUNED:
        free = tuned_s_curve(task, bounds_of(task), task.duration)
        return JudgedMotion.of_free_motion(task, free)
    impulses = _impulses_of(name, task, tolerated)
    remaining = task.duration - impulses.times[-1]
    if remaining < _LEAST_UNSHAPED * task.duration:
        raise ValueError(
            f"the shaper alone takes {impulses.times[-1]:.3g} s, of a move of {task.duration:.4g} "
            "s; give a longer duration"
        )
    shorter = replace(task, duration=remaining)
    unshaped = ruckig_motion(shorter) if name.endswith(RUCKIG) else _stretched_s_curve(shorter)
    return JudgedMotion.of_free_motion(task, shaped(unshaped, impulses))


@takes(task=PointToPoint)
def fastest_baseline(
    name: str, task: PointToPoint, tolerated: float | None = None
) -> Plan | JudgedMotion:
    """Return a baseline's fastest motion that keeps a task's limits on its model.

    The task's duration does not matter. Where the fastest rigid motion passes a limit, such as the
    torque of what bends, accelerations are reduced until it holds. toppra's motion, which jumps,
    may pass a limit of the jerk. ValueError if there is none.
    """
    task = task.certain
    if name == TOPPRA:
        task = replace(task, jerk_limit=None)
    family = _family(name, task, tolerated)
    most = 32.0
    fast = family(1.0)
    if _keeps_limits(fast):
        return fast
    fitting = None
    too_fast = 1.0
    slow = 1.1
    while fitting is None:
        moved = family(slow)
        if _keeps_limits(moved):
            fitting = moved
        elif slow > most:
            names = ", ".join(_exceeded(moved))
            raise ValueError(
                f"it passes the limit of {names} even with a thousandth of the acceleration; give "
                "a wider limit"
            )
        else:
            too_fast = slow
            slow *= 1.5
    accuracy = 2e-3
    while slow / too_fast > 1 + accuracy:
        between = (slow * too_fast) ** 0.5
        moved = family(between)
        if _keeps_limits(moved):
            fitting = moved
            slow = between
        else:
            too_fast = between
    return fitting


def _keeps_limits(moved: Plan | JudgedMotion) -> bool:
    return not _exceeded(moved)


def _exceeded(moved: Plan | JudgedMotion) -> list[str]:
    """Labels of the limits that a motion passes."""
    motion = moved if isinstance(moved, JudgedMotion) else moved.candidate
    return broken_limits(motion, motion.task.limits, OVERRUN)


def _family(
    name: str, task: PointToPoint, tolerated: float | None
) -> Callable[[float], Plan | JudgedMotion]:
    """A baseline's motions by how slow they are: accelerations are divided by the square of it."""
    if name == TOPPRA:
        return partial(_toppra_family, task)
    if name in (CYCLOID, *SHAPERS):
        return partial(_cycloid_family, name, task, bounds_of(task))
    if name == TUNED:
        return partial(_tuned_family, task, bounds_of(task))
    impulses = _impulses_of(name, task, tolerated)
    if name.endswith(RUCKIG):
        return partial(_ruckig_family, task, impulses)
    return partial(_s_curve_family, task, bounds_of(task), impulses)


def _cycloid_family(
    name: str, task: PointToPoint, bounds: RigidBounds, slowness: float
) -> Plan | JudgedMotion:
    duration = cycloid_duration(task, gentler(bounds, slowness))
    if name != CYCLOID:
        length = _impulses_of(name, task, None).times[-1]
        duration = max(duration + length, length / (1 - LEAST_SHARE) * (1 + 1e-9))
    return baseline(name, replace(task, duration=duration))


def _tuned_family(task: PointToPoint, bounds: RigidBounds, slowness: float) -> JudgedMotion:
    return _timed(task, tuned_s_curve(task, gentler(bounds, slowness)))


def _s_curve_family(
    task: PointToPoint, bounds: RigidBounds, impulses: Impulses, slowness: float
) -> JudgedMotion:
    return _timed(task, shaped(s_curve(task, gentler(bounds, slowness)), impulses))


def _ruckig_family(task: PointToPoint, impulses: Impulses, slowness: float) -> JudgedMotion:
    return _timed(task, shaped(ruckig_motion(task, fastest=True, slowness=slowness), impulses))


def _toppra_family(task: PointToPoint, slowness: float) -> JudgedMotion:
    return _timed(task, toppra_motion(task, fastest=True, slowness=slowness))


def _timed(task: PointToPoint, free: FreeMotion) -> JudgedMotion:
    return JudgedMotion.of_free_motion(replace(task, duration=float(free.times[-1])), free)


def _stretched_s_curve(task: PointToPoint) -> FreeMotion:
    """The fastest S-curve, stretched in time to the task's duration; ValueError if it is longer."""
    bounds = bounds_of(task)
    least = float(s_curve(task, bounds).times[-1])
    _refuse_shorter(least, task.duration)
    free = s_curve(task, slower(bounds, task.duration / least))
    return replace(free, times=free.times * (task.duration / free.times[-1]))


def _refuse_shorter(least: float, duration: float) -> None:
    if least > duration * (1 + 1e-6):
        raise ValueError(
            f"within the limits it takes {least:.4g} s, more than the {duration:.4g} s that it "
            "has; give a longer duration or wider limits"
        )


def _impulses_of(name: str, task: PointToPoint, tolerated: float | None) -> Impulses:
    """The shaper in a baseline's name, for every mode; one impulse of a motion without a shaper."""
    shaper = _shaper_in(name)
    if not shaper:
        return Impulses((1.0,), (0.0,))
    modes = FreeVibration(task.plant, task.target).modes
    if not modes:
        raise ValueError(
            f"plant {task.plant.name!r} does not vibrate, so that there is nothing to shape; take "
            f"{S_CURVE}"
        )
    if name != EI_OF_BAND:
        return convolved([SHAPERS[shaper](*mode) for mode in modes])
    if tolerated is None:
        raise ValueError(
            f"{EI_OF_BAND} lets as much of the vibration pass as fits into a band; give one, such "
            "as --band 0.1mm"
        )
    return convolved([extra_insensitive(*mode, tolerated) for mode in modes])


def ruckig_motion(
    task: PointToPoint, *, fastest: bool = False, slowness: float = 1.0
) -> FreeMotion:
    """The motion of constant jerk that ruckig finds within a task's limits, in its duration.

    Or the fastest one, with accelerations that are divided by the square of its slowness.

    ValueError where ruckig is not installed, the task limits no acceleration, or time is too short.
    """
    try:
        from ruckig import InputParameter, Ruckig, Trajectory
    except ImportError:
        raise ValueError(f"ruckig is not installed; {install('ruckig')}") from None
    if task.acceleration_limit is None:
        raise ValueError(
            "ruckig moves within an acceleration limit, and the move has none; plan it with one, "
            "as --acceleration-limit 40"
        )
    request = InputParameter(1)
    trajectory = Trajectory(1)
    free = (-np.inf, np.inf)
    request.current_position = [task.start]
    request.target_position = [task.target]
    bounds = _bounds_along(task)
    backward, forward = bounds.get("speed", free)
    request.min_velocity = [backward]
    request.max_velocity = [forward]
    least, most = bounds["acceleration"]
    request.min_acceleration = [least / slowness**2]
    request.max_acceleration = [most / slowness**2]
    request.max_jerk = [min(np.abs(bounds.get("jerk", free)))]
    if not fastest:
        request.minimum_duration = task.duration
    result = Ruckig(1).calculate(request, trajectory)
    if int(result) < 0:
        raise ValueError(f"ruckig finds no motion ({result}); give wider limits")
    if not fastest:
        _refuse_shorter(trajectory.duration, task.duration)
    profile = trajectory.profiles[0][0]
    lengths = np.array(profile.t)
    there = lengths > _SHORTEST
    times = np.concatenate([[0.0], np.cumsum(lengths[there])])
    return FreeMotion(times, np.array(profile.a)[:-1][there], np.array(profile.j)[there])


def _bounds_along(task: PointToPoint) -> dict[str, tuple[float, float]]:
    """Least and largest speed, acceleration and jerk of the motion along the path.

    Several joints move in phase: the joint that is nearest to its limit counts. ValueError where
    their path is curved, so that these would not follow.
    """
    joints = task.plant.joints(JointMotion(np.linspace(task.start, task.target, _PLACES), 1.0, 0.0))
    slopes = [np.broadcast_to(joint.speed, _PLACES) for joint in joints]
    bends = [np.broadcast_to(joint.acceleration, _PLACES) for joint in joints]
    if np.abs(bends).max() > _STRAIGHT * np.abs(slopes).max():
        raise ValueError(
            "ruckig goes straight in joint space, and the path of the plan is curved; compare it "
            "with cycloid, shapers and toppra"
        )
    along = dict[str, tuple[float, float]]()
    for limit in task.limits:
        least = -np.inf
        most = np.inf
        for joint, lower, upper in _joint_bounds(limit, len(joints)):
            slope = float(slopes[joint][0])
            if slope:
                ends = sorted((lower / slope, upper / slope))
                least = max(least, ends[0])
                most = min(most, ends[1])
        along[limit.name] = (least, most)
    return along


def _joint_bounds(limit: Limit, joints: int) -> list[tuple[int, float, float]]:
    """Number of the joint, least and largest value, of each joint that is limited."""
    values = limit.quantity.values
    if isinstance(values, Shares):
        return [(bound.place, bound.lower, bound.upper) for bound in values.bounds]
    return [(joint, limit.lower, limit.upper) for joint in range(joints)]


def shaped(free: FreeMotion, impulses: Impulses) -> FreeMotion:
    """A motion convolved with impulses: one of them again, in pieces."""
    begins = np.add.outer(free.times, impulses.times).ravel()
    times = np.unique(begins)
    times = times[np.append(True, np.diff(times) > _SHORTEST)]
    middle = (times[1:] + times[:-1]) / 2
    acceleration = np.zeros(len(middle))
    jerk = np.zeros(len(middle))
    for share, begin in zip(*impulses):
        piece = np.searchsorted(free.times, middle - begin, side="right") - 1
        moving = (piece >= 0) & (piece < free.steps)
        k = piece[moving]
        since = times[:-1][moving] - begin - free.times[k]
        acceleration[moving] += share * (free.acceleration[k] + free.jerk[k] * since)
        jerk[moving] += share * free.jerk[k]
    return FreeMotion(times, acceleration, jerk)
