"""A move as a cam: master position, or time, to slave position, in layouts that tools read."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from quietarm.models import Plant
from quietarm.models.dimensions import ANGLE, WAY
from quietarm.ocp import Plan
from quietarm.ocp.checks import joined, unknown
from quietarm.ocp.escapes import csv_table
from quietarm.ocp.joint_words import heading_unit
from quietarm.ocp.planning.move_table import units_of
from quietarm.views.formats.deviation import (
    CUBIC,
    QUINTIC,
    SPLINE,
    Deviation,
    deviation_of,
    deviation_words,
    motion_at,
    pieces_through,
)
from quietarm.views.formats.export_format import ExportFormat, ExportSetting

Array = NDArray[np.float64]
_BETWEEN = {
    SPLINE: "by a cubic spline",
    CUBIC: "by cubics of position and speed",
    QUINTIC: "by quintics of position, speed and acceleration",
}


class Cam(NamedTuple):
    """A cam's points; slaves have a column for each joint.

    Speeds and accelerations are derivatives by the master's position.
    """

    master: Array
    position: Array
    speed: Array
    acceleration: Array
    by_time: bool
    slaves: Sequence[tuple[str, str, str]]
    """What stands before the quantity, what the position is called, and its unit."""


class Layout(NamedTuple):
    """Layout of a cam for a tool, which also says how the tool interpolates between the points."""

    write: Callable[[Cam], str]
    interpolation: int
    several: bool = False


def _table(cam: Cam) -> str:
    """A heading, and all columns; of several joints those of each joint together."""
    by = "s" if cam.by_time else "by_master"
    columns = {"time_s" if cam.by_time else "master": cam.master}
    for at, (front, position, unit) in enumerate(cam.slaves):
        columns[f"{front}{position}_{unit}"] = cam.position[:, at]
        columns[f"{front}speed_{unit}_{by}"] = cam.speed[:, at]
        columns[f"{front}acceleration_{unit}_{by}2"] = cam.acceleration[:, at]
    return csv_table(columns, "%.12g")


def _rows(cam: Cam, between: str, *more: str) -> list[str]:
    """A line for each point of a cam of one slave: master, slave, and what follows."""
    pairs = zip(cam.master.tolist(), cam.position[:, 0].tolist())
    return [between.join([f"{x:.12g}", f"{y:.12g}", *more]) for x, y in pairs]


def _kollmorgen(cam: Cam) -> list[str]:
    return ["CYCLIC;NO;", "TABLE_BEGIN;;", *_rows(cam, ";", "SPLINE"), "TABLE_END;;"]


def _lines(rows: Sequence[str]) -> str:
    return "\n".join([*rows, ""])


_LAYOUTS: Mapping[str, Layout] = {
    "table": Layout(_table, QUINTIC, several=True),
    "codesys": Layout(lambda cam: _lines(_rows(cam, "\t")), SPLINE),
    "lenze": Layout(lambda cam: _lines(_rows(cam, " ")), SPLINE),
    "sew": Layout(lambda cam: _lines([str(len(cam.master)), *_rows(cam, ";")]), SPLINE),
    "kollmorgen": Layout(lambda cam: _lines(_kollmorgen(cam)), SPLINE),
    "rockwell": Layout(lambda cam: _lines(["Master,Slave,Type", *_rows(cam, ",", "1")]), SPLINE),
}
"""Layouts by their names; docs/cams.md says where each is described. None was tried."""


class CamTable(ExportFormat):
    """Points of a cam, from the start to the target, at equal distances of the master."""

    name = "cam"
    endings = (".cam",)
    meaning = "a cam table"
    of_the_load = True
    settings = (
        ExportSetting("layout", "table", f"The layout: {joined(_LAYOUTS, 'or')}."),
        ExportSetting("points", 201, "Points of the cam, both ends included.", 5, 10_000),
        ExportSetting(
            "master", None, "How far the master moves; by default the duration in s.", 1e-6, 1e9,
            kind=float,
        ),
        ExportSetting("unit", "", "Unit of the slave, such as deg or mm; by default rad or m."),
        ExportSetting("span", None, "How far the slave moves in the table, such as 1: from 0 to "
                      "it; by default from start to target.", 1e-9, 1e9, kind=float),
        ExportSetting("slave", "", "Which joint of several is the slave; table has all."),
    )  # fmt: skip
    to_stdout = True

    def content(self, plan: Plan, *args: Any, **settings: Any) -> str:
        """The cam in its layout."""
        layout, cam, _ = _cam_of(plan, **settings)
        return layout.write(cam)

    def note(self, plan: Plan, *args: Any, **settings: Any) -> str:
        """Say how far the tool's interpolation is from the plan."""
        layout, _, joints = _cam_of(plan, **settings)
        times = _times(plan, settings["points"])
        given = motion_at(plan, times)[: layout.interpolation]
        deviation = deviation_of(plan, pieces_through(times, given, layout.interpolation))
        own = Deviation(*(np.where(joints, values, 0.0) for values in deviation))
        return f"{_BETWEEN[layout.interpolation]} {deviation_words(plan, own)} off the plan"


def _times(plan: Plan, points: int) -> Array:
    """Times of the points; the last is the arrival."""
    return np.linspace(0.0, plan.task.duration, points)


def _cam_of(
    plan: Plan, layout: str, points: int, master: float | None, unit: str, span: float | None,
    slave: str,
) -> tuple[Layout, Cam, Array]:  # fmt: skip
    """The layout, the cam, and which joints are in it."""
    if layout not in _LAYOUTS:
        raise ValueError(unknown("layout", layout, _LAYOUTS))
    chosen = _LAYOUTS[layout]
    plant = plan.task.plant
    joints = _slaves(plant, layout, slave)
    times = _times(plan, points)
    duration = plan.task.duration
    # seconds in a unit of the master
    pace = 1.0 if master is None else duration / master
    motion = [values[:, joints] for values in motion_at(plan, times)]
    factors, units = _scaling(plant, joints, unit)
    offset = 0.0
    if span is not None:
        ways = motion[0][-1] - motion[0][0]
        if not ways.all():
            raise ValueError("a joint ends where it begins and has no span; leave --span out")
        factors, offset = span / ways, motion[0][0]
        units = ["span"] * len(units)
    names = [plant.joint_names[at] for at in joints]
    fronts = [f"{name}_" for name in names] if len(plant.joint_names) > 1 else [""]
    kinds = [plant.joint_kinds[at] for at in joints]
    slaves = [
        (front, ANGLE.of(kind), heading_unit(unit))
        for front, kind, unit in zip(fronts, kinds, units)
    ]
    cam = Cam(
        times / pace,
        (motion[0] - offset) * factors,
        motion[1] * factors * pace,
        motion[2] * factors * pace**2,
        master is None,
        slaves,
    )
    held = np.zeros(len(plant.joint_names))
    held[joints] = 1.0
    return chosen, cam, held


def _slaves(plant: Plant, layout: str, slave: str) -> list[int]:
    """Return which joints a table has; ValueError for one that is none, or that is not named."""
    names = list(plant.joint_names)
    if slave:
        if slave not in names:
            raise ValueError(unknown("joint", slave, names))
        return [names.index(slave)]
    if len(names) > 1 and not _LAYOUTS[layout].several:
        raise ValueError(
            f"a cam of the layout {layout} has one slave, and {len(names)} joints move; give "
            f"--slave, such as {names[0]}, or --layout table"
        )
    return list(range(len(names)))


def _scaling(plant: Plant, joints: Sequence[int], unit: str) -> tuple[Array, list[str]]:
    """The factor from SI units, and the unit, of every slave."""
    kinds = [plant.joint_kinds[at] for at in joints]
    known = {kind: units_of(kind, plant.tip_unit)["angle"] for kind in kinds}
    if unit and all(unit not in units for units in known.values()):
        every = dict.fromkeys(name for units in known.values() for name in units)
        raise ValueError(unknown("unit of the slave", unit, every))
    chosen = [unit if unit in known[kind] else str(WAY.of(kind)) for kind in kinds]
    return np.array([known[kind][name] for kind, name in zip(kinds, chosen)]), chosen
