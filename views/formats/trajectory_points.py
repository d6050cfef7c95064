"""The points of a trajectory: at a rate, or as few as a controller's quintics need."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from quietarm.models import RobotOnPath, TimedMotion
from quietarm.models.robot.path.joint_table import JointTable
from quietarm.models.robot.path.timed_motion import fewest_points
from quietarm.ocp import Plan, evaluate_as_timed
from quietarm.ocp.checks import listed, quoted
from quietarm.ocp.planning.move_table import times_of
from quietarm.views.formats.between_rows import residual_at
from quietarm.views.formats.export_format import ExportSetting
from quietarm.views.tips import tip_words

Array = NDArray[np.float64]
PAUSE = ExportSetting(
    "pause", 0.0, "Of several plans, one move after another: time between two, in which the tip "
    "rests, such as 0.5.", least=0.0, most=3600.0, unit="s",
)  # fmt: skip
THIN = ExportSetting(
    "thin", None, "Of the points at --rate only those that a controller needs, whose quintics keep "
    "joints within this, such as 0.001deg or 1e-5.", least=1e-9, most=1.0, unit="rad", kind=float,
)  # fmt: skip


def times_of_points(plan: Plan, rate: float, thin: float | None) -> Array:
    """Times of a move at a rate [Hz], or of as few points as keep joints within a tolerance [s].

    A tolerance is in rad, or in m of joints that slide.
    """
    times = times_of(plan, rate)
    if thin is None:
        return times
    if plan.candidate.inverts_drive:
        raise ValueError(
            f"thin is {thin:g}, and the plan's set points go through its drive, at every tick; "
            "leave it out"
        )
    return times[fewest_points(times, *moving_joints(plan, times), thin)]


class Points(NamedTuple):
    """Points of a trajectory: times [s], and positions, speeds and accelerations of all joints."""

    times: Array
    positions: Array
    speeds: Array
    accelerations: Array

    def table(self, joints: tuple[str, ...]) -> JointTable:
        """Return the points as a table of these joints."""
        return JointTable(joints, self.positions, self.times, self.speeds, self.accelerations)


def ros_time(time: float) -> tuple[int, int]:
    """Return the seconds and nanoseconds of a builtin_interfaces/Duration."""
    return divmod(round(time * 1e9), 1_000_000_000)


def points_of(plan: Plan, rate: float, thin: float | None) -> Points:
    """The points of a move, of its set points where they go through a drive."""
    if thin is None:
        motion = plan.commanded(rate)
        joints = motion.sample.joints
        orders = (np.column_stack([joint[order] for joint in joints]) for order in range(3))
        return Points(np.asarray(motion.time), *orders)
    times = times_of_points(plan, rate, thin)
    return Points(times, *moving_joints(plan, times))


def points_of_several(
    plans: Sequence[Plan], rate: float, thin: float | None, pause: float
) -> tuple[Points, list[float]]:
    """Points of moves one after another, with a pause between two [s], and when each ends.

    Raises
    ------
    ValueError
        When a move begins elsewhere than where the one before it ends, or has other joints.
    """
    if pause and len(plans) == 1:
        raise ValueError("a pause is between several moves, and one plan is given; leave it out")
    _check_joined(plans)
    parts = list[Points]()
    ends = list[float]()
    begin = 0.0
    for number, plan in enumerate(plans):
        part = points_of(plan, rate, thin)
        first = 1 if number and pause == 0 else 0  # which the move before has as its last
        if len(part.times) - first < 1:
            raise ValueError(f"move {number + 1} has a single point; give a higher rate")
        later = part._replace(times=part.times + begin)
        parts.append(Points(*(values[first:] for values in later)))
        ends.append(float(later.times[-1]))
        begin = ends[-1] + pause
    return Points(*map(np.concatenate, zip(*parts))), ends


def _check_joined(plans: Sequence[Plan]) -> None:
    """Refuse moves of which one does not begin where the one before it ends."""
    for number, (before, after) in enumerate(pairwise(plans), start=1):
        names, others = before.task.plant.joint_names, after.task.plant.joint_names
        if names != others:
            raise ValueError(
                f"move {number} is of {listed(names)} and move {number + 1} of {listed(others)}; "
                "give moves of the same joints"
            )
        end, begin = _place(before, before.task.duration), _place(after, 0.0)
        off = np.abs(end - begin)
        if off.max() > _JOINED:
            joint = int(off.argmax())
            raise ValueError(
                f"move {number} ends with {quoted(names[joint])} at {end[joint]:.6g}, and move "
                f"{number + 1} begins with it at {begin[joint]:.6g}; give each move from where the "
                "one before it stops, in their order"
            )


def _place(plan: Plan, time: float) -> Array:
    """Positions of the joints at a time of a move."""
    return moving_joints(plan, np.array([time]))[0][0]


_JOINED = 1e-6
"""How far apart the ends of two moves may be [rad or m]."""


def left_after_each(
    plans: Sequence[Plan], points: Points, ends: Sequence[float], pause: float
) -> str:
    """Words on several moves: what is left in the pauses and after the last, where it is known.

    Of a robot with one load by the whole equations, all moves in their order.
    """
    times = points.times
    words = f"{len(plans)} moves, {len(times)} points in {times[-1]:.5g} s"
    plants = [plan.task.plant for plan in plans]
    first = plants[0]
    alike = isinstance(first, RobotOnPath) and all(
        isinstance(plant, RobotOnPath)
        and (plant.robot, plant.payload, plant.stiffness)
        == (first.robot, first.payload, first.stiffness)
        for plant in plants
    )
    if not alike or not isinstance(first, RobotOnPath):
        left = max(plan.residual for plan in plans)
        return f"{words}; each from rest, the plans leave {tip_words(left, first.tip_unit)} at most"
    most = list[float]()
    for plan, end in zip(plans, ends):
        until = times <= end + _AT_ONCE
        part = Points(*(values[until] for values in points))
        last = plan is plans[-1]
        window = float(plan.task.residual_window) if last or pause == 0 else pause
        answer = evaluate_as_timed(
            first.robot, TimedMotion.of_table(part.table(first.joint_names)),
            residual_window=window, stiffness=first.stiffness, payload=first.payload,
        )  # fmt: skip
        most.append(answer.residual)
    shown = ", ".join(tip_words(size, first.tip_unit) for size in most)
    return (
        f"{words}; a controller that joins them by quintics leaves {shown} after each, by the "
        "whole equations"
    )


_AT_ONCE = 1e-9
"""Rounding of times [s]."""


def left_between(plan: Plan, times: Array) -> str:
    """Words on what a controller leaves that takes quintics between a move's points.

    Of a robot by its whole equations, beside what these say of the plan.
    """
    count = f"{len(times)} points; a controller that joins them by quintics leaves"
    plant = plan.task.plant
    if not isinstance(plant, RobotOnPath):
        left = tip_words(residual_at(plan, times, 3), plant.tip_unit)
        return f"{count} {left}, and the plan {tip_words(plan.residual, plant.tip_unit)}"
    points = Points(times, *moving_joints(plan, times))
    answer = evaluate_as_timed(
        plant.robot,
        TimedMotion.of_table(points.table(plant.joint_names)),
        residual_window=float(plan.task.residual_window),
        stiffness=plant.stiffness,
        payload=plant.payload,
    )
    figures = plan.candidate.in_full
    exact = plan.residual if figures is None else figures.residual
    left, of_plan = (tip_words(size, plant.tip_unit) for size in (answer.residual, exact))
    return f"{count} {left} by the whole equations, and the plan {of_plan}"


def moving_joints(plan: Plan, times: Array) -> tuple[Array, Array, Array]:
    """Positions, speeds and accelerations of all joints, shape (times, joints)."""
    joints = plan.sampled(times).sample.joints
    points, speeds, accelerations = (
        np.column_stack([joint[order] for joint in joints]) for order in range(3)
    )
    return points, speeds, accelerations
