"""What is used today in place of a plan: the cycloid, input shapers, ruckig, toppra."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from quietarm.models import JointMotion
from quietarm.ocp import JudgedMotion, Plan, PointToPoint, evaluate_coefficients, shaped_cycloid
from quietarm.ocp.checks import install, several, takes, unknown
from quietarm.ocp.limits import Limit, Shares
from quietarm.ocp.profiles.free_motion import FreeMotion
from quietarm.ocp.profiles.shaped_cycloid import SHAPERS, Impulses, convolved
from quietarm.ocp.simulation.free_vibration import FreeVibration
from quietarm.studies.compare.toppra_motion import toppra_motion

CYCLOID = "cycloid"
RUCKIG = "ruckig"
TOPPRA = "toppra"
BASELINES = (CYCLOID, *SHAPERS, RUCKIG, *(f"{name}-{RUCKIG}" for name in SHAPERS), TOPPRA)
"""Their names; a shaper alone shapes the cycloid."""
ALL = "all"
_SHORTEST = 1e-9
"""Pieces of a motion that are shorter [s] are none."""
_PLACES = 21
"""Of a path, at which it is seen whether it is straight."""
_STRAIGHT = 1e-9
"""Curvature of a straight path, as a share of its slope."""


def choose_baselines(names: Iterable[str]) -> tuple[str, ...]:
    """Baselines of these names, of "all" every one, each once; ValueError where one is unknown."""
    names = several("baselines", names, "names")
    chosen = dict[str, None]()
    for name in names:
        chosen |= dict.fromkeys(BASELINES if name == ALL else [name])
    for name in chosen:
        if name not in BASELINES:
            raise ValueError(unknown("baseline", name, (ALL, *BASELINES)))
    return tuple(chosen)


@takes(task=PointToPoint)
def baseline(name: str, task: PointToPoint) -> Plan | JudgedMotion:
    """A baseline's motion of a task; ValueError where there is none."""
    # share of the duration that a shaper has to leave for the motion that it shapes
    least_share = 0.02
    task = task.certain
    if name == CYCLOID:
        return evaluate_coefficients(task, [])
    if name in SHAPERS:
        return evaluate_coefficients(task, [], profile=shaped_cycloid(task, name))
    if name == TOPPRA:
        return JudgedMotion.of_free_motion(task, toppra_motion(task))
    shaper = name.removesuffix(RUCKIG).removesuffix("-")
    impulses = _impulses(task, shaper) if shaper else Impulses((1.0,), (0.0,))
    remaining = task.duration - impulses.times[-1]
    if remaining < least_share * task.duration:
        raise ValueError(
            f"the shaper alone takes {impulses.times[-1]:.3g} s, of a move of {task.duration:.4g} "
            "s; give a longer duration"
        )
    free = shaped(ruckig_motion(replace(task, duration=remaining)), impulses)
    return JudgedMotion.of_free_motion(task, free)


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
    slowest, fastest = bounds.get("speed", free)
    request.min_velocity = [slowest]
    request.max_velocity = [fastest]
    least, most = bounds["acceleration"]
    request.min_acceleration = [least]
    request.max_acceleration = [most]
    request.max_jerk = [min(np.abs(bounds.get("jerk", free)))]
    request.minimum_duration = task.duration
    result = Ruckig(1).calculate(request, trajectory)
    if int(result) < 0:
        raise ValueError(f"ruckig finds no motion ({result}); give wider limits")
    if trajectory.duration > task.duration * (1 + 1e-6):
        raise ValueError(
            f"within the limits it takes {trajectory.duration:.4g} s, more than the "
            f"{task.duration:.4g} s that it has; give a longer duration or wider limits"
        )
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
