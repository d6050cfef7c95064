"""Trajectories of joints as MoveIt's time parametrisation writes them: trapezoids of the speed."""

import numpy as np


def trapezoid(share, time, duration):
    """Place from 0 to 1, speed and acceleration at a time; it speeds up for a share of the way."""
    rise = share * duration
    most = 1 / (rise * (duration - rise))
    if time < rise:
        return most * time**2 / 2, most * time, most
    if time <= duration - rise:
        return most * rise * (time - rise / 2), most * rise, 0.0
    left = duration - time
    return 1 - most * left**2 / 2, most * left, -most


def trajectory_text(names, start, end, duration, law, step=0.02, entries=3):
    """A RobotTrajectory whose points have positions, velocities and accelerations, or fewer."""
    way = np.subtract(end, start)
    kinds = ("positions", "velocities", "accelerations")[:entries]
    lines = ["joint_trajectory:", f"  joint_names: [{', '.join(names)}]", "  points:"]
    for time in np.linspace(0.0, duration, round(duration / step) + 1):
        place, *rates = law(time)
        rows = [start + place * way, *(rate * way for rate in rates)]
        moving = ", ".join(
            f"{kind}: [{', '.join(f'{value:.10f}' for value in row)}]"
            for kind, row in zip(kinds, rows)
        )
        nanoseconds = round(time * 1e9)
        at = f"{{sec: {nanoseconds // 10**9}, nanosec: {nanoseconds % 10**9}}}"
        lines.append(f"  - {{{moving}, time_from_start: {at}}}")
    empty = "{header: {frame_id: ''}, joint_names: [], points: []}"
    return "\n".join([*lines, f"multi_dof_joint_trajectory: {empty}", "---", ""])
