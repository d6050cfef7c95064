"""What no solver has to be asked: a duration in which not even a rigid joint gets there."""

from __future__ import annotations

from quietarm.ocp.errors import InfeasibleTaskError
from quietarm.ocp.limits import TORQUE_SPEED
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.ocp.planning.rigid_motion import rigid_duration
from quietarm.ocp.task import PointToPoint

_OF_A_RIGID_JOINT = ("speed", "acceleration", "jerk", TORQUE_SPEED)


def refuse_too_short(task: PointToPoint) -> None:
    """InfeasibleTaskError where a rigid joint within the task's limits takes longer.

    A duration that is shorter by no more than a plan may exceed its limits is not refused.
    """
    least = rigid_duration(task)
    if (1 + OVERRUN) * task.duration >= least:
        return
    names = [limit.label for limit in task.limits if limit.name in _OF_A_RIGID_JOINT]
    raise InfeasibleTaskError(
        f"{task.duration:g} s is too short: within the limits of {', '.join(names)} even a rigid "
        f"joint takes {least:.4g} s; give a longer duration or wider limits"
    )
