"""A joint's path from a file of times and angles, as another tool or a recorder wrote it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.recordings.clocks import holes, running
from quietarm.machine.recordings.recording import MOST_ANGLE
from quietarm.machine.tables.table import Table, read_table, unused_in_words
from quietarm.models.dimensions import ANGLE, WAY
from quietarm.models.joint_motion import ROTARY
from quietarm.ocp import FileFormatError
from quietarm.ocp.profiles.free_motion import FreeMotion

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RecordedPath:
    """A joint's path: the cubic spline through its points, at rest at both ends.

    With notes on what was mended of its file, and what of it is not used.
    """

    start: float
    target: float
    motion: FreeMotion
    notes: tuple[str, ...] = ()

    @property
    def duration(self) -> float:
        """Duration of the path [s]."""
        return float(self.motion.times[-1])


def read_path(path: Path, joint: str = ROTARY) -> RecordedPath:
    """Read a CSV file with columns such as time_s and angle_deg, position_mm of a linear joint."""
    from scipy.interpolate import CubicSpline  # not at the top: it takes long to load

    table = read_table(path)
    label = ANGLE.of(joint)
    name, begin = (
        table.first(quantity, "name it so in its heading") for quantity in (label, "time")
    )
    time = table.in_si(begin, "time")
    angle = table.in_si(name, label)
    time, angle, notes = _on_a_clock(table, begin, time, angle)
    _check(path, time, angle, joint)
    largest = np.abs(angle).max()
    if joint == ROTARY and largest > 2 * np.pi and not table.find(name).written:
        raise FileFormatError(
            f"{path}: column {name} reaches {largest:g} and names no unit; were degrees meant? "
            "name it angle_deg, or angle_rad"
        )
    spline = CubicSpline(time - time[0], angle, bc_type="clamped")
    jerk, acceleration, *_ = spline.c
    motion = FreeMotion(time - time[0], 2 * acceleration, 6 * jerk)
    notes += [unused_in_words(table.unused([begin, name]))]
    return RecordedPath(float(angle[0]), float(angle[-1]), motion, tuple(filter(None, notes)))


def _on_a_clock(
    table: Table, begin: str, time: Array, angle: Array
) -> tuple[Array, Array, list[str]]:
    """Times that increase and the angles there, and what was mended of the clock in words."""
    path = table.path
    if len(time) != len(angle):
        raise FileFormatError(f"{path}: its columns have {len(time)} and {len(angle)} rows")
    if not (np.isfinite(time).all() and np.isfinite(angle).all()):
        raise FileFormatError(f"{path} has a number that is not finite; mend it")
    counts = table.find(begin).values
    whole = bool((counts == np.round(counts)).all())
    try:
        clock = running(time, table.factor(begin, "time") if whole else 0.0)
    except ValueError as error:
        raise FileFormatError(f"{path}: {error}") from None
    time = clock.time
    still = np.flatnonzero(np.diff(time) == 0)
    if still.size:
        raise FileFormatError(
            f"{path}: row {clock.rows[still[0] + 1] + 1} has the time of the row before; leave one "
            "of them out"
        )
    after = holes(time)
    if after.size:
        row = after[0]
        raise FileFormatError(
            f"{path}: a hole of {time[row + 1] - time[row]:.4g} s after row {clock.rows[row] + 1}, "
            f"among steps of {np.median(np.diff(time)):.3g} s; give a path without holes"
        )
    return (
        time,
        angle[clock.rows],
        [f"warning: {path}: {change}" for change in clock.changes.values()],
    )


def _check(path: Path, time: Array, angle: Array, joint: str) -> None:
    least_rows = 5
    most_rows = 5000
    # a speed so many times that of three to six points before and after it is a jump
    jump = 20.0
    label = ANGLE.of(joint)
    unit = WAY.of(joint)
    if not least_rows <= len(time) <= most_rows:
        raise FileFormatError(
            f"{path} has {len(time)} rows; give {least_rows} to {most_rows}, for a move of a "
            "second a hundred are plenty"
        )
    if np.abs(angle).max() > MOST_ANGLE:
        rotary = ("an angle", "degrees", "deg")
        which, likely, short = rotary if joint == ROTARY else ("a position", "millimetres", "mm")
        raise FileFormatError(
            f"{path}: {which} of {np.abs(angle).max():g} {unit}; is it in {likely}? name the "
            f"column {label}_{short}"
        )
    if angle[0] == angle[-1]:
        raise FileFormatError(f"{path}: the path ends where it begins; give one that moves")
    speed = np.abs(np.diff(angle) / np.diff(time))
    k = int(speed.argmax())
    beside = [*speed[max(k - 6, 0) : max(k - 2, 0)], *speed[k + 3 : k + 7]]
    if speed[k] > jump * max(beside, default=np.inf):
        raise FileFormatError(
            f"{path}: the {label} jumps by {abs(angle[k + 1] - angle[k]):.3g} {unit} after "
            f"{time[k]:.4g} s; give a path without jumps"
        )
