"""A move as a message trajectory_msgs/JointTrajectory of ROS 2 in YAML."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from quietarm.models import Plant
from quietarm.ocp import Plan
from quietarm.ocp.escapes import yaml_string
from quietarm.views.formats.between_rows import note_of_points
from quietarm.views.formats.export_format import (
    PLAN,
    SEVERAL,
    Answers,
    Exported,
    ExportFormat,
    ExportSetting,
    Progress,
    values_of,
)
from quietarm.views.formats.row_settings import RATE
from quietarm.views.formats.trajectory_points import (
    PAUSE,
    THIN,
    Points,
    left_after_each,
    left_between,
    points_of,
    points_of_several,
    ros_time,
    times_of_points,
)
from quietarm.views.report.templates import templates


class RosTrajectory(ExportFormat):
    """Positions, velocities and accelerations of all joints, of one move or several in a row."""

    name = "ros"
    endings = (".yaml", ".yml")
    meaning = "a JointTrajectory of ROS 2"
    takes = (PLAN, SEVERAL)
    settings = (RATE, THIN, PAUSE, ExportSetting("joint", "joint", "The joint's name."))
    to_stdout = True

    def export(self, answers: Answers, path: Path, report: Progress, **settings: Any) -> Exported:
        """One message, and what its points leave."""
        plans = values_of(answers)
        if len(plans) == 1:
            return super().export(answers, path, report, **settings)
        several, ends = points_of_several(
            plans, settings["rate"], settings["thin"], settings["pause"]
        )
        note = left_after_each(plans, several, ends, settings["pause"])
        return Exported({path: self.message(plans[0].task.plant, several, **settings)}, [note])

    def content(self, plan: Plan, *args: Any, **settings: Any) -> str:
        """A single joint has the name that is given; those of a robot the plant's."""
        points = points_of(plan, settings["rate"], settings.get("thin"))
        return self.message(plan.task.plant, points, **settings)

    def message(self, plant: Plant, points: Points, *, joint: str = "joint", **others: Any) -> str:
        """The message with the points."""
        rows = [
            (ros_time(time), [map(_decimal, row) for row in moving])
            for time, *moving in zip(points.times, *(order.tolist() for order in points[1:]))
        ]
        names = plant.joint_names if plant.has_path else (joint,)
        texts = templates(keep_trailing_newline=True)
        return texts.get_template("views/formats/templates/move.yaml").render(
            joints=[yaml_string(name) for name in names], points=rows
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
