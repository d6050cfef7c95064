"""The jerk limit of a fastest move where none is given: what a drive's position loop follows."""

from __future__ import annotations

import math
from dataclasses import replace

from quietarm.ocp.checks import takes
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.limits import QUANTITIES, ByJoint
from quietarm.ocp.planning.rigid_motion import assumed_bounds, rigid_motion
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.task import PointToPoint

DRIVE_RISES = 0.005
"""Rise time [s] of a position loop of 70 Hz, 0.35 over the bandwidth, and five set points at 1 kHz.

What changes by its peak in less is no longer followed.
"""
OF_CYCLOID = 0.1
"""Share of the time over 2 pi of a plain cycloid in which its acceleration may change by its peak,
where that is shorter: of a move of some hundredths of a second."""


def rise_time(duration: float) -> float:
    """Return the shortest time in which a drive follows a change of the peak acceleration [s]."""
    return min(DRIVE_RISES, OF_CYCLOID * duration / (2 * math.pi))


@takes(task=PointToPoint)
def with_default_jerk(task: PointToPoint) -> PointToPoint:
    """Return a task with a jerk limit: its own, or the default of a fastest move.

    The default is the peak acceleration of a plain cycloid in the rigid joint's least time within
    the task's limits, over the `rise_time`; each joint of several has its own. A task that nothing
    limits stays as it is.
    """
    if task.limit_of("jerk") is not None or not task.limits:
        return task
    try:
        least = rigid_motion(abs(task.span), assumed_bounds(task)).duration
    except ValueError:  # nothing limits the rigid joint
        return task
    quick = replace(task.certain, duration=least)
    cycloid = JudgedMotion.of_profile(quick, CycloidPolynomial(0), [])
    rise = rise_time(least)
    peaks = cycloid.peaks_of_joints(QUANTITIES["acceleration"]).tolist()
    if len(peaks) == 1:
        return replace(task, jerk_limit=peaks[0] / rise)
    moving = {name: peak / rise for name, peak in zip(task.plant.joint_names, peaks) if peak > 0}
    return replace(task, jerk_limit=ByJoint(moving))
