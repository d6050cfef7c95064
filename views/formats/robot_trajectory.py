"""A move as a message moveit_msgs/RobotTrajectory in YAML, as MoveIt takes and gives it."""

from __future__ import annotations

from textwrap import indent
from typing import Any

from quietarm.models import Plant
from quietarm.models.joint_motion import LINEAR
from quietarm.ocp.escapes import yaml_string
from quietarm.views.formats.export_format import ExportSetting
from quietarm.views.formats.ros_trajectory import RosTrajectory
from quietarm.views.formats.row_settings import RATE
from quietarm.views.formats.trajectory_points import PAUSE, THIN, Points


class RobotTrajectory(RosTrajectory):
    """A JointTrajectory within a RobotTrajectory, without joints of several degrees."""

    name = "robot-trajectory"
    endings = (".moveit",)
    meaning = "a RobotTrajectory of MoveIt in YAML"
    settings = (
        RATE,
        THIN,
        PAUSE,
        ExportSetting("joint", "joint", "The joint's name."),
        ExportSetting("frame", "", "The frame in the message's header."),
    )
    to_stdout = True

    def message(
        self, plant: Plant, points: Points, *, joint: str = "joint", frame: str = "", **others: Any
    ) -> str:
        """The points as of a JointTrajectory; a comment says in which unit each joint is."""
        within = super().message(plant, points, joint=joint)
        units = ["m" if kind == LINEAR else "rad" for kind in plant.joint_kinds]
        names = plant.joint_names if plant.has_path else (joint,)
        listed = ", ".join(f"{yaml_string(name)} in {unit}" for name, unit in zip(names, units))
        header = f"header:\n  stamp: {{sec: 0, nanosec: 0}}\n  frame_id: {yaml_string(frame)}\n"
        return (
            f"# joints: {listed}\n"
            f"joint_trajectory:\n{indent(header + within, '  ')}"
            "multi_dof_joint_trajectory:\n"
            f"{indent(header, '  ')}  joint_names: []\n  points: []\n"
        )
