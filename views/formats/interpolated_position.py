"""A move as records of the interpolated position mode of CiA 402, in the drive's increments."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.models import Plant
from quietarm.models.dimensions import WAY
from quietarm.models.joint_motion import ROTARY
from quietarm.ocp import Plan
from quietarm.ocp.escapes import csv_table, one_line
from quietarm.ocp.planning.move_table import times_of
from quietarm.views.formats.between_rows import THROUGH_DRIVE, residual_through
from quietarm.views.formats.deviation import (
    CUBIC,
    LINEAR,
    MOST_POINTS,
    deviation_of,
    deviation_words,
    motion_at,
    pieces_through,
)
from quietarm.views.formats.exact_path import figures_of, title_of
from quietarm.views.formats.export_format import (
    Answers,
    Exported,
    ExportFormat,
    ExportSetting,
    Progress,
    values_of,
)
from quietarm.views.tips import tip_words

Array = NDArray[np.float64]
_BETWEEN = {"linear": LINEAR, "cubic": CUBIC}
"""What the drive does between two records: positions alone, or positions and speeds."""
_SUB_MODES = {LINEAR: 0, CUBIC: -1}
"""Object 60C0h; a cubic is the manufacturer's own."""
_LARGEST = 2**31 - 1
"""Of an INTEGER32."""


class InterpolatedPosition(ExportFormat):
    """A record for every period of object 60C2h: positions, and speeds where the drive takes them.

    The header says which objects the drive has to have, and what its interpolation leaves.
    """

    name = "cia402"
    endings = (".cia402",)
    meaning = "records of CiA 402's interpolated position mode"
    settings = (
        ExportSetting("period", 0.001, "Period of the records, 60C2h [s].", 1e-4, 0.255, unit="s"),
        ExportSetting(
            "increments", 1e6, "Increments of the drive in a rad, or in a m of a joint that "
            "slides.", 1e-3, 1e12,
        ),
        ExportSetting(
            "increments_per_revolution", None, "Increments in a revolution, in place of those in "
            "a rad.", 1e-3, 1e12, kind=float,
        ),
        ExportSetting("polarity", 1, "-1 counts the other way round.", -1, 1),
        ExportSetting("zero", 0, "Increments where the joint is at 0.", -_LARGEST, _LARGEST),
        ExportSetting(
            "between", "linear", "The drive's own interpolation: linear, of positions; or cubic, "
            "of positions and speeds.",
        ),
    )  # fmt: skip
    to_stdout = True

    def export(self, answers: Answers, path: Path, report: Progress, **settings: Any) -> Exported:
        """Write a header in lines of #, a heading, and a row for every record."""
        (plan,) = values_of(answers)
        records = _Records(plan, **settings)
        header = "".join(f"# {one_line(line)}\n" for line in records.header())
        return Exported({path: header + csv_table(records.columns())}, [records.left])


class _Records:
    """The set points of a plan in a drive's increments."""

    def __init__(
        self, plan: Plan, period: float, increments: float,
        increments_per_revolution: float | None, polarity: int, zero: int, between: str,
    ):  # fmt: skip
        if between not in _BETWEEN:
            raise ValueError(f"between is {between!r}; give {' or '.join(_BETWEEN)}")
        if polarity == 0:
            raise ValueError("polarity is 0; give 1 or -1")
        self.plan = plan
        self.tenths = round(period * 1e4)
        if abs(self.tenths - period * 1e4) > 1e-6:
            raise ValueError(
                f"period is {1e3 * period:g} ms, which 60C2h cannot hold; give a multiple of 0.1 ms"
            )
        self.period = self.tenths / 1e4
        self.interpolation = _BETWEEN[between]
        self.zero = zero
        plant = plan.task.plant
        self.scales = polarity * _scales(plant, increments, increments_per_revolution)
        self.times, positions, speeds = _set_points(plan, 1 / self.period)
        self.positions = self._counted(zero + positions * self.scales, "position")
        self.speeds = self._counted(speeds * self.scales, "speed")

    def _counted(self, values: Array, what: str) -> NDArray[np.int64]:
        """Whole increments; ValueError if an INTEGER32 cannot hold them."""
        largest = float(np.abs(values).max())
        if largest > _LARGEST:
            raise ValueError(
                f"the largest {what} is {largest:.4g} increments, and a record holds {_LARGEST}; "
                "give fewer increments, or another zero"
            )
        return np.round(values).astype(np.int64)

    def columns(self) -> dict[str, Any]:
        """The records' columns by their headings; of several joints each with its name."""
        names = self.plan.task.plant.joint_names
        fronts = [f"{name} " for name in names] if len(names) > 1 else [""]
        columns: dict[str, Any] = {"time_ms": self.times * 1e3}
        for front, positions, speeds in zip(fronts, self.positions.T, self.speeds.T):
            columns[f"{front}60C1h:01 position"] = positions
            if self.interpolation == CUBIC:
                columns[f"{front}60C1h:02 speed"] = speeds
        return columns

    def header(self) -> list[str]:
        """The lines above the table."""
        whole = self.tenths % 10 == 0
        units, index = (self.tenths // 10, -3) if whole else (self.tenths, -4)
        if units > 255:
            raise ValueError(
                f"period is {1e3 * self.period:g} ms, which 60C2h cannot hold; give up to 25.5 ms "
                "in tenths, or up to 255 ms in whole ms"
            )
        plant = self.plan.task.plant
        scales = [
            f"{name} {scale:.12g} increments/{WAY.of(kind)}"
            for name, scale, kind in zip(plant.joint_names, self.scales, plant.joint_kinds)
        ]
        mode = _SUB_MODES[self.interpolation]
        return [
            f"CiA 402 interpolated position: {title_of(self.plan)}. "
            f"{figures_of(self.plan, through_drive=True)}.",
            f"6060h = 7, 60C2h:01 = {units}, 60C2h:02 = {index}, 60C0h = {mode}"
            + (" (the manufacturer's own number may be another)" if mode else ""),
            f"{', '.join(scales)}, {self.zero} at 0" + ("; speeds in increments/s" if mode else ""),
            self.left,
        ]

    @cached_property
    def left(self) -> str:
        """Words on what the drive's interpolation leaves."""
        plan = self.plan
        if plan.candidate.inverts_drive:
            return THROUGH_DRIVE
        points = [(self.positions - self.zero) / self.scales, self.speeds / self.scales]
        if len(self.times) > MOST_POINTS:
            return ""
        how = "linearly" if self.interpolation == LINEAR else "by cubics"
        between = f"a drive that interpolates {how}"
        pieces = pieces_through(self.times, points, self.interpolation)
        far = deviation_words(plan, deviation_of(plan, pieces))
        plant = plan.task.plant
        along = [values[:, 0] for values in points]
        of_path = ""
        if plant.has_path:  # the model knows the place on the path alone
            path = plan.sampled(self.times).sample.path
            along = [np.asarray(path.angle), np.asarray(path.speed)]
            of_path = ", interpolated along its path,"
        residual = residual_through(plan, self.times, along, self.interpolation)
        words = tip_words(residual, plant.tip_unit)
        return f"{between} is {far} off the plan; the plan{of_path} then leaves {words}"


def _set_points(plan: Plan, rate: float) -> tuple[Array, Array, Array]:
    """Times, positions and speeds of a plan, through its drive if that is inverted."""
    if plan.candidate.inverts_drive:
        commanded = plan.commanded(rate)
        joints = commanded.sample.joints
        positions, speeds = (
            np.column_stack([joint[order] for joint in joints]) for order in (0, 1)
        )
        return commanded.time, positions, speeds
    times = times_of(plan, rate)
    positions, speeds, _ = motion_at(plan, times)
    return times, positions, speeds


def _scales(plant: Plant, increments: float, per_revolution: float | None) -> Array:
    """Increments in a rad or a m, of every joint."""
    turning = increments if per_revolution is None else per_revolution / (2 * np.pi)
    kinds = plant.joint_kinds
    if per_revolution is not None and ROTARY not in kinds:
        raise ValueError(
            f"increments_per_revolution is {per_revolution:g}, and no joint turns; give "
            "increments, in a m"
        )
    return np.array([turning if kind == ROTARY else increments for kind in kinds])
