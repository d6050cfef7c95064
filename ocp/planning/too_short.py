"""Tasks that no solver has to be asked: not even a joint without vibration can do them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.errors import InfeasibleTaskError
from quietarm.ocp.joint_words import above_words, beyond, joint_peaks
from quietarm.ocp.limits import QUANTITIES, TORQUE_SPEED, Limit
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.ocp.planning.rigid_motion import rigid_duration, rigid_durations
from quietarm.ocp.planning.rigid_pass import least_duration, values_at_rest
from quietarm.ocp.task import PointToPoint

Array = NDArray[np.float64]
_OF_A_RIGID_JOINT = ("speed", "acceleration", "jerk", TORQUE_SPEED)
_NO_MOVE = 1e3
"""So many times longer is no other duration of the same move: a unit was mistaken."""
_SURE = 0.95
"""Share of the least duration by torque and deflection that is surely too short: the equations are
not quite linear, and the bound is a sum over places."""
_ROOM = 1.001
"""A limit that holds is quoted with this margin, so that its digits hold as well."""


def arrives_at_rest(task: PointToPoint, residual_limit: float) -> bool:
    """Return whether the tip is at rest before and after the move, in all that a task asks for."""
    return (
        residual_limit == 0
        and task.initial is None
        and task.final is None
        and task.uncertainty is None
    )


def refuse_too_short(task: PointToPoint, at_rest: bool = False) -> None:
    """InfeasibleTaskError where a rigid joint within the task's limits takes longer.

    A duration that is shorter by no more than a plan may exceed its limits is not refused. Limits
    of torque and deflection count in full only where the tip arrives at rest.
    """
    if not task.limits:
        return
    refuse_to_hold(task)
    of_joints = rigid_durations(task)
    by_joints = max(of_joints)
    by_plant = _SURE * least_duration(task, at_rest)
    if (1 + OVERRUN) * task.duration >= by_joints and task.duration >= by_plant:
        return
    of_a_joint = [limit for limit in task.limits if limit.name in _OF_A_RIGID_JOINT]
    slowest = "joint"
    limits = task.limits
    if by_joints >= by_plant:
        limits = of_a_joint
        slowest = _named(task, of_joints.index(by_joints))
    names = ", ".join(limit.label for limit in limits)
    needed = _needed(task, at_rest) if len(task.limits) == 1 else ""
    least = max(by_joints, by_plant)
    unit = "; were other units meant?" if least > _NO_MOVE * task.duration else ""
    raise InfeasibleTaskError(
        f"{task.duration:g} s is too short: within the limits of {names} even a rigid "
        f"{slowest} takes {least:.4g} s{needed}; give a longer duration or wider "
        f"limits{unit}"
    )


def _named(task: PointToPoint, joint: int) -> str:
    """Return the name of one of several joints; of a single one that it is a joint."""
    names = task.plant.joint_names
    return names[joint] if len(names) > 1 else "joint"


def _needed(task: PointToPoint, at_rest: bool, rounds: int = 12) -> str:
    """Say how wide the only limit has to be at least; nothing where no number tells that.

    The least duration falls with a power of the size, which follows from two sizes.
    """
    (limit,) = task.limits
    if not limit.is_peak or limit.name not in QUANTITIES:
        return ""

    def excess(logarithm: float) -> float:
        wider = replace(task, **{limit.quantity.limit: math.exp(logarithm)})
        least = max(rigid_duration(wider), least_duration(wider, at_rest))
        return math.log(least / task.duration) if least > 0 else -math.inf

    sizes = [math.log(limit.size)]
    excesses = [excess(sizes[0])]
    sizes.append(sizes[0] + 2 * excesses[0])
    for _ in range(rounds):
        excesses.append(excess(sizes[-1]))
        if not math.isfinite(excesses[-1]):
            return ""
        if abs(excesses[-1]) < 2e-4:
            size = limit.describe(math.exp(sizes[-1]))
            return f", and in {task.duration:g} s it takes {size} or more"
        slope = (excesses[-1] - excesses[-2]) / (sizes[-1] - sizes[-2])
        sizes.append(sizes[-1] - excesses[-1] / slope)
    return ""


def refuse_to_hold(task: PointToPoint) -> None:
    """InfeasibleTaskError where a limit is passed by the machine that stands still at an end.

    It has the limit that holds the machine at both ends.
    """
    for limit in task.limits:
        if limit.quantity.derivative is not None:
            continue
        values = values_at_rest(task, limit)
        peaks = limit.peak(values.min(axis=0, initial=0.0), values.max(axis=0, initial=0.0))
        for place, peak, rows in zip(("start", "target"), peaks.tolist(), values.T):
            if not limit.keeps(peak, OVERRUN):
                by_joint = joint_peaks(limit, task.plant, np.column_stack([rows, rows]))
                passed = above_words(beyond(by_joint, OVERRUN))
                of_one = f"{limit.describe(peak)}, above its limit of {limit.bounds}"
                raise InfeasibleTaskError(
                    f"to stand still at its {place} the machine takes {limit.label} "
                    f"{passed or of_one}; give a {_that_holds(task, limit, values)}, or another "
                    f"{place}"
                )


def _that_holds(task: PointToPoint, limit: Limit, values: Array) -> str:
    """The limit with which the machine can stand still at both ends, in words: a move takes more.

    `values` are those at rest, shape (rows, 2).
    """
    ranges = np.column_stack([values.min(axis=1), values.max(axis=1)])
    peaks = beyond(joint_peaks(limit, task.plant, ranges), OVERRUN)
    if peaks:
        holding = " and ".join(peak.times(_ROOM) for peak in peaks)
        return f"{limit.label} limit of at least {holding}"
    largest = float(limit.peak(values.min(initial=0.0), values.max(initial=0.0)))
    return f"{limit.label} limit of at least {limit.describe(_ROOM * largest)}"
