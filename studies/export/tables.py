"""A move as rows of numbers: chosen columns, units and rate; as CSV, for ROS 2, for MATLAB."""

from __future__ import annotations

import io
from collections.abc import Mapping
from math import degrees
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.models import Plant
from quietarm.models.joint_motion import LINEAR, ROTARY
from quietarm.ocp import Plan
from quietarm.ocp.checks import unknown
from quietarm.ocp.escapes import csv_table, matlab_names, yaml_string
from quietarm.ocp.planning.plan import ticks_of_move
from quietarm.studies.report.templates import templates

Array = NDArray[np.float64]
_WAYS: Mapping[str, Mapping[str, float]] = {
    ROTARY: {"rad": 1.0, "deg": degrees(1.0), "mrad": 1e3, "rev": 0.5 / np.pi},
    LINEAR: {"m": 1.0, "mm": 1e3},
}


def units_of(joint: str, tip_unit: str) -> Mapping[str, Mapping[str, float]]:
    """What a column may hold, and its units; the first is that where none is given."""
    forces = {
        ROTARY: {"Nm": 1.0, "mNm": 1e3},
        LINEAR: {"N": 1.0, "kN": 1e-3},
    }
    # by the plant's `tip_unit`
    tips = {"m": _WAYS[LINEAR], "rad": _WAYS[ROTARY]}
    way = _WAYS[joint]
    speeds = {"rpm": 30 / np.pi} if joint == ROTARY else {}
    return {
        "time": {"s": 1.0, "ms": 1e3, "us": 1e6},
        "angle": way,
        "speed": {f"{unit}/s": factor for unit, factor in way.items()} | speeds,
        "acceleration": {f"{unit}/s^2": factor for unit, factor in way.items()},
        "jerk": {f"{unit}/s^3": factor for unit, factor in way.items()},
        "tip": tips[tip_unit],
        "torque": forces[joint],
        "power": {"W": 1.0, "mW": 1e3},
    }


def columns_of(text: str, plant: Plant) -> dict[str, tuple[str, float]]:
    """Columns as `time:ms,angle:deg,speed`: their units and the factors to these.

    ValueError where one or its unit is unknown, or one comes twice.
    """
    columns = dict[str, tuple[str, float]]()
    known = units_of(plant.joint, plant.tip_unit)
    for heading in text.split(","):
        name, _, unit = (part.strip() for part in heading.partition(":"))
        if name not in known:
            raise ValueError(unknown("column", name, known))
        if name in columns:
            raise ValueError(f"column {name} is given twice; give it once")
        unit = unit or next(iter(known[name]))
        if unit not in known[name]:
            raise ValueError(unknown(f"unit of {name}", unit, known[name]))
        columns[name] = unit, known[name][unit]
    return columns


def table(plan: Plan, columns: str, rate: float) -> dict[str, Array]:
    """Columns, as `columns_of` reads them, by their headings, as `angle_deg`, at a rate [Hz].

    The last row is the first tick at or after arrival. Each of several joints has columns of its
    own, `elbow_angle_deg`, and so has each joint that follows one. Each tip has a column, or of a
    robot each axis of its tip's frame along which that moves, `tip_x_mm`; of a robust plan in each
    scenario, which its heading names.
    """
    linear_names = {"angle": "position", "torque": "force"}
    times = times_of(plan, rate)
    motion = plan.sampled(times)
    tips = _tips(plan, times)
    plant = plan.task.plant
    sample = motion.sample
    values: dict[str, list[Array]] = {
        "time": [motion.time],
        "angle": [joint.angle for joint in sample.joints],
        "speed": [joint.speed for joint in sample.joints],
        "acceleration": [joint.acceleration for joint in sample.joints],
        "jerk": [joint.jerk for joint in sample.joints],
        "torque": list(sample.torques),
        "power": [motion.power],
    }
    names = {} if plant.joint == ROTARY else linear_names
    following = {name: how.motion(sample.joints[at]) for name, (at, how) in plant.followers.items()}
    of_followers: dict[str, dict[str, Array]] = {
        "angle": {name: joint.angle for name, joint in following.items()},
        "speed": {name: joint.speed for name, joint in following.items()},
        "acceleration": {name: joint.acceleration for name, joint in following.items()},
        "jerk": {name: joint.jerk for name, joint in following.items()},
    }

    def by_heading(name: str) -> dict[tuple[str, str], Array]:
        """A column, or one for each joint, by what stands before and after the unit."""
        word = names.get(name, name)
        columns = values[name]
        more = {(f"{joint}_{word}", ""): v for joint, v in of_followers.get(name, {}).items()}
        if len(columns) == 1:
            return {(word, ""): columns[0], **more}
        of_joints = {(f"{joint}_{word}", ""): v for joint, v in zip(plant.joint_names, columns)}
        return of_joints | more

    table: dict[str, Array] = {}
    for name, (unit, factor) in columns_of(columns, plan.task.plant).items():
        ending = unit.replace("/", "_").replace("^", "")
        of_name = tips if name == "tip" else by_heading(name)
        table |= {f"{front}_{ending}{after}": factor * v for (front, after), v in of_name.items()}
    return table


def _tips(plan: Plan, times: Array) -> dict[tuple[str, str], Array]:
    """Displacements of every tip in every scenario, by what stands before and after the unit."""
    by_name: dict[tuple[str, str], Array] = {}
    for candidate, errors in zip(plan.candidate.scenarios, plan.task.scenarios):
        named = zip(plan.task.error_names, errors)
        scenario = "".join(f" {name} {100 * error:+.4g} %" for name, error in named if error)
        tips = candidate.sample(times).tips.T
        names = plan.task.plant.tip_names
        by_name |= {(name, scenario): tip for name, tip in zip(names, tips)}
    return by_name


def times_of(plan: Plan, rate: float) -> Array:
    """Times of the rows [s] at a rate [Hz], up to the first at or after arrival."""
    return np.arange(ticks_of_move(plan.task.duration, rate) + 1) / rate


def csv_text(plan: Plan, columns: str, rate: float) -> str:
    """Comma-separated values under a heading."""
    return csv_table(table(plan, columns, rate), "%.12g")


def mat_bytes(plan: Plan, columns: str, rate: float) -> bytes:
    """A MATLAB v5 file: a column vector for each column, the coefficients and the duration.

    Names of several joints are a cell array as well, as they are.
    """
    from scipy.io import savemat  # slow to load

    file = io.BytesIO()
    rows = table(plan, columns, rate)
    vectors = dict(zip(matlab_names(rows), rows.values()))
    facts: dict[str, Any] = {
        "coefficients": plan.coefficients,
        "duration_s": plan.task.duration,
    }
    joints = plan.task.plant.joint_names
    if len(joints) > 1:
        facts["joint_names"] = np.array(joints, dtype=object)
    savemat(file, {**facts, **vectors}, oned_as="column")
    return file.getvalue()


def ros_text(plan: Plan, rate: float, joint: str) -> str:
    """A message trajectory_msgs/JointTrajectory of ROS 2 in YAML, of all joints.

    A single joint has the name that is given, those of a robot and of several have the plant's.
    """
    motion = plan.sampled(times_of(plan, rate))
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
    return texts.get_template("export/templates/move.yaml").render(joints=scalars, points=points)


def _decimal(value: float) -> str:
    """Twelve digits with a point: ROS takes no whole number for a real one."""
    return repr(float(f"{value:.12g}"))
