"""A move as a message trajectory_msgs/JointTrajectory of ROS 2 in YAML."""

from __future__ import annotations

from typing import Any

import numpy as np

from quietarm.ocp import Plan
from quietarm.ocp.escapes import yaml_string
from quietarm.views.formats.between_rows import note_of_points
from quietarm.views.formats.export_format import ExportFormat, ExportSetting
from quietarm.views.formats.row_settings import RATE
from quietarm.views.formats.trajectory_points import THIN, left_between, times_of_points
from quietarm.views.report.templates import templates


class RosTrajectory(ExportFormat):
    """Positions, velocities and accelerations of all joints."""

    name = "ros"
    endings = (".yaml", ".yml")
    meaning = "a JointTrajectory of ROS 2"
    settings = (RATE, THIN, ExportSetting("joint", "joint", "The joint's name."))
    to_stdout = True

    def content(
        self, plan: Plan, *args: Any, rate: float, thin: float | None = None, joint: str = "joint"
    ) -> str:
        """A single joint has the name that is given; those of a robot the plant's."""
        if thin is None:
            motion = plan.commanded(rate)
        else:
            motion = plan.sampled(times_of_points(plan, rate, thin))
        orders = [
            np.column_stack([joint[order] for joint in motion.sample.joints]).tolist()
            for order in range(3)
        ]
        points = [
            (divmod(round(time * 1e9), 1_000_000_000), [map(_decimal, row) for row in moving])
            for time, *moving in zip(motion.time, *orders)
        ]
        joint_names = plan.task.plant.joint_names
        names = joint_names if plan.task.plant.has_path else (joint,)
        texts = templates(keep_trailing_newline=True)
        scalars = [yaml_string(name) for name in names]
        return texts.get_template("views/formats/templates/move.yaml").render(
            joints=scalars, points=points
        )

    def note(
        self, plan: Plan, *args: Any, rate: float, thin: float | None = None, **others: Any
    ) -> str:
        """Say what the controller leaves, which takes a quintic between two points."""
        if thin is None:
            return note_of_points(plan, rate)
        return left_between(plan, times_of_points(plan, rate, thin))


def _decimal(value: float) -> str:
    """Twelve digits with a point: ROS takes no whole number for a real one."""
    return repr(float(f"{value:.12g}"))
