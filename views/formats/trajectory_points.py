"""The points of a trajectory: at a rate, or as few as a controller's quintics need."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from quietarm.models import RobotOnPath, TimedMotion
from quietarm.models.robot.path.joint_table import JointTable
from quietarm.models.robot.path.timed_motion import fewest_points
from quietarm.ocp import Plan, evaluate_as_timed
from quietarm.ocp.planning.move_table import times_of
from quietarm.views.formats.between_rows import residual_at
from quietarm.views.formats.export_format import ExportSetting
from quietarm.views.tips import tip_words

Array = NDArray[np.float64]
THIN = ExportSetting(
    "thin", None, "Of the points at --rate only those that a controller needs, whose quintics keep "
    "joints within this, as 0.001deg or 1e-5.", least=1e-9, most=1.0, unit="rad", kind=float,
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


def left_between(plan: Plan, times: Array) -> str:
    """Words on what a controller leaves that takes quintics between a move's points.

    Of a robot by its whole equations, beside what these say of the plan.
    """
    count = f"{len(times)} points; a controller that joins them by quintics leaves"
    plant = plan.task.plant
    if not isinstance(plant, RobotOnPath):
        left = tip_words(residual_at(plan, times, 3), plant.tip_unit)
        return f"{count} {left}, and the plan {tip_words(plan.residual, plant.tip_unit)}"
    points, speeds, accelerations = moving_joints(plan, times)
    table = JointTable(plant.joint_names, points, times, speeds, accelerations)
    answer = evaluate_as_timed(
        plant.robot,
        TimedMotion.of_table(table),
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
