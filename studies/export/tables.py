"""A move as rows of numbers: chosen columns, units and rate; as CSV, for ROS 2, for MATLAB."""

from __future__ import annotations

import io
import re
from collections.abc import Mapping
from math import degrees
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.models import Plant
from quietarm.models.joint_motion import LINEAR, ROTARY
from quietarm.ocp import Plan
from quietarm.ocp.checks import unknown
from quietarm.ocp.planning.plan import ticks_of_move
from quietarm.ocp.simulation.trajectory import Trajectory
from quietarm.studies.report.templates import templates

Array = NDArray[np.float64]
_WAYS: Mapping[str, Mapping[str, float]] = {
    ROTARY: {"rad": 1.0, "deg": degrees(1.0), "mrad": 1e3, "rev": 0.5 / np.pi},
    LINEAR: {"m": 1.0, "mm": 1e3},
}
_FORCES: Mapping[str, Mapping[str, float]] = {
    ROTARY: {"Nm": 1.0, "mNm": 1e3},
    LINEAR: {"N": 1.0, "kN": 1e-3},
}
_TIPS = {"m": _WAYS[LINEAR], "rad": _WAYS[ROTARY]}
"""By the plant's `tip_unit`."""
_LINEAR_NAMES = {"angle": "position", "torque": "force"}


def units_of(joint: str, tip_unit: str) -> Mapping[str, Mapping[str, float]]:
    """What a column may hold, and its units; the first is that where none is given."""
    way, speeds = _WAYS[joint], {"rpm": 30 / np.pi} if joint == ROTARY else {}
    return {
        "time": {"s": 1.0, "ms": 1e3, "us": 1e6},
        "angle": way,
        "speed": {f"{unit}/s": factor for unit, factor in way.items()} | speeds,
        "acceleration": {f"{unit}/s^2": factor for unit, factor in way.items()},
        "jerk": {f"{unit}/s^3": factor for unit, factor in way.items()},
        "tip": _TIPS[tip_unit],
        "torque": _FORCES[joint],
        "power": {"W": 1.0, "mW": 1e3},
    }


def columns_of(text: str, plant: Plant) -> dict[str, tuple[str, float]]:
    """Columns as `time:ms,angle:deg,speed`: their units and the factors to these.

    ValueError where one or its unit is unknown, or one comes twice.
    """
    columns, known = dict[str, tuple[str, float]](), units_of(plant.joint, plant.tip_unit)
    for one in text.split(","):
        name, _, unit = (part.strip() for part in one.partition(":"))
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

    The last row is the first tick at or after arrival. Each tip has a column of its own, and of a
    robust plan in each scenario, which its heading names.
    """
    times = times_of(plan, rate)
    motion, tips = plan.sampled(times), _tips(plan, times)
    names = {} if plan.task.plant.joint == ROTARY else _LINEAR_NAMES
    found: dict[str, Array] = {}
    for name, (unit, factor) in columns_of(columns, plan.task.plant).items():
        ending = unit.replace("/", "_").replace("^", "")
        of_name = tips if name == "tip" else _columns(names.get(name, name), name, motion, plan)
        found |= {f"{one}_{ending}{after}": factor * v for (one, after), v in of_name.items()}
    return found


def _columns(
    heading: str, name: str, motion: Trajectory, plan: Plan
) -> dict[tuple[str, str], Array]:
    """A column by what stands before and after its unit; of several joints one for each."""
    if name in ("time", "power"):
        return {(heading, ""): getattr(motion, name)}
    of_joints = motion.sample.torques
    if name != "torque":
        of_joints = [getattr(joint, name) for joint in motion.sample.joints]
    joints = plan.task.plant.joint_names
    if len(joints) == 1:
        return {(heading, ""): of_joints[0]}
    return {(f"{joint} {heading}", ""): column for joint, column in zip(joints, of_joints)}


def _tips(plan: Plan, times: Array) -> dict[tuple[str, str], Array]:
    """Displacements of every tip in every scenario, by what stands before and after the unit."""
    found: dict[tuple[str, str], Array] = {}
    for candidate, errors in zip(plan.candidate.scenarios, plan.task.scenarios):
        named = zip(plan.task.error_names, errors)
        scenario = "".join(f" {name} {100 * error:+.4g} %" for name, error in named if error)
        tips = candidate.sample(times).tips.T
        names = ["tip"] if len(tips) == 1 else [f"tip_{i}" for i in range(1, len(tips) + 1)]
        found |= {(name, scenario): tip for name, tip in zip(names, tips)}
    return found


def times_of(plan: Plan, rate: float) -> Array:
    """Times of the rows [s] at a rate [Hz], up to the first at or after arrival."""
    return np.arange(ticks_of_move(plan.task.duration, rate) + 1) / rate


def csv_text(plan: Plan, columns: str, rate: float) -> str:
    """Comma-separated values under a heading."""
    import pandas  # not at the top: it takes half a second to load

    rows = pandas.DataFrame(table(plan, columns, rate))
    return rows.to_csv(index=False, float_format="%.12g", lineterminator="\n")


def mat_bytes(plan: Plan, columns: str, rate: float) -> bytes:
    """A MATLAB v5 file: a column vector for each column, the coefficients and the duration."""
    from scipy.io import savemat  # slow to load

    file, vectors = io.BytesIO(), dict[str, Any]()
    for name, column in table(plan, columns, rate).items():
        words = name.replace("-", "minus ").replace("+", "plus ").replace(" %", "")
        vectors[re.sub(r"\W+", "_", words)] = column
    facts = {"coefficients": plan.coefficients, "duration_s": plan.task.duration}
    savemat(file, {**facts, **vectors}, oned_as="column")
    return file.getvalue()


def ros_text(plan: Plan, rate: float, joint: str) -> str:
    """A message trajectory_msgs/JointTrajectory of ROS 2 in YAML.

    A plant of one joint is called by this name; several have names of their own.
    """
    names = plan.task.plant.joint_names
    motion = plan.sampled(times_of(plan, rate))
    moving = np.array([joint[:3] for joint in motion.sample.joints])
    points = [
        (divmod(round(time * 1e9), 1_000_000_000), [map(_decimal, row) for row in rows])
        for time, rows in zip(motion.time, np.moveaxis(moving, (2, 1), (0, 1)))
    ]
    named = (name.replace("'", "''") for name in (names if len(names) > 1 else [joint]))
    joints = [f"'{name}'" for name in named]  # as YAML reads them back
    texts = templates(keep_trailing_newline=True)
    return texts.get_template("export/templates/move.yaml").render(joints=joints, points=points)


def _decimal(value: float) -> str:
    """Twelve digits with a point: ROS takes no whole number for a real one."""
    return repr(float(f"{value:.12g}"))
