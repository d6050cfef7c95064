"""Tables of positions that joints go through, as files have them: csv, and messages of ROS."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.models.joint_motion import Array
from quietarm.models.number_checks import joined, listed, quoted
from quietarm.models.robot.path.table_headings import Headings, cell_value, read_headings
from quietarm.models.robot.text_files import read_text, read_yaml

_MESSAGES = (".yaml", ".yml", ".json", ".moveit")
"""Endings of files in YAML, of which JSON is a part."""


@dataclass(frozen=True, eq=False)
class JointTable:
    """Positions of joints, a row a point, and what a file has beside them.

    Attributes
    ----------
    joints : tuple of str
        Their names; none of a csv without.
    positions : ndarray, shape (points, joints)
        [rad or m].
    times : ndarray, shape (points,), optional
        When each is passed [s].
    velocities, accelerations : ndarray, shape (points, joints), optional
        At each point [rad/s, rad/s^2, or of m].
    remarks : tuple of str
        What of the file a path does not use, and what nothing does, in one line each.
    frame : str
        In which a message says that its joints' base stands; empty where it does not.
    """

    joints: tuple[str, ...]
    positions: Array
    times: Array | None = None
    velocities: Array | None = None
    accelerations: Array | None = None
    remarks: tuple[str, ...] = ()
    frame: str = ""

    def between(self, points: tuple[int, int] | None) -> JointTable:
        """The table from one point to another, counted from 1; all of it without these.

        Raises
        ------
        ValueError
            When they are no points of it, or not two.
        """
        if points is None:
            return self
        first, last = points
        if not 1 <= first < last <= len(self.positions):
            raise ValueError(
                f"waypoints {first}:{last} are none of {len(self.positions)}; give the numbers of "
                "the first and the last, such as 2:4"
            )
        return self._of_rows(np.arange(first - 1, last))

    def _of_rows(self, rows: NDArray[np.int64], *remarks: str) -> JointTable:
        """Return the table of some of its points, with further remarks."""
        times, velocities, accelerations = (
            None if values is None else values[rows]
            for values in (self.times, self.velocities, self.accelerations)
        )
        return replace(
            self,
            positions=self.positions[rows],
            times=times,
            velocities=velocities,
            accelerations=accelerations,
            remarks=(*self.remarks, *remarks),
        )

    @property
    def without_repeated(self) -> JointTable:
        """The table without rows that repeat the time and the positions of the row before them.

        MoveIt gives such rows at the start where a planner repeats its first state.
        """
        times = self.times
        if times is None:
            return self
        nearest = np.abs(np.diff(self.positions, axis=0)).max(axis=1, initial=0.0)
        repeated = np.append(False, (np.diff(times) == 0) & (nearest <= _AS_FAR))
        if not repeated.any():
            return self
        rows = np.flatnonzero(repeated) + 1
        words = " and ".join(
            f"points {row - 1} and {row} are at one time and place and taken as one"
            for row in rows[:_NAMED].tolist()
        )
        more = f", and {len(rows) - _NAMED} more" if len(rows) > _NAMED else ""
        return self._of_rows(np.flatnonzero(~repeated), f"{words}{more}")


_AS_FAR = 1e-9
"""By which positions of one place may differ: a file's rounding [rad or m]."""
_NAMED = 3
"""Rows that repeat others, of which each is named."""


def read_joint_table(path: str | Path) -> JointTable:
    """The points of a file: csv, or a JointTrajectory in YAML or a message that has one within.

    Raises
    ------
    ValueError
        When it has none, several, or a point without positions of all joints.
    """
    if Path(path).suffix.lower() in _MESSAGES:
        return table_of_message(read_yaml(path, "path"), f"path {path}")
    return _table_of(path)


def table_of_message(
    message: object, what: str, used: Collection[str] = ("positions",)
) -> JointTable:
    """The points of the JointTrajectory in a message, however deep; its name is for errors.

    Remarks name what its points have beside the entries that are used.

    Raises
    ------
    ValueError
        As of `read_joint_table`.
    """
    messages = list(_trajectories_in(message))
    filled = [message for message in messages if message["joint_names"] or message["points"]]
    positioned = [message for message in filled if not _is_in_space(message)]
    if not positioned:
        raise ValueError(
            f"{what} is no JointTrajectory; give one with joint_names and points, or a csv"
        )
    if len(positioned) > 1:
        raise ValueError(
            f"{what} has {len(positioned)} trajectories: {_several_words(positioned)}; give a file "
            "of one of them"
        )
    (trajectory,) = positioned
    points = trajectory["points"]
    names = tuple(map(str, trajectory["joint_names"] or ()))
    if _CUT_OFF in (*(points or ()), *names):
        raise ValueError(
            f"{what} is cut off at '...'; write it whole, by ros2 topic echo --full-length"
        )
    if not points:
        raise ValueError(f"{what} has no points; give two or more")
    positions = _entries(points, "positions")
    if positions is None or positions.ndim != 2 or positions.shape[1] != len(names or positions[0]):
        raise ValueError(f"{what} {_short_point(points, names)}; write it again")
    others = {entry for point in points for entry, value in point.items() if value}
    unused = [
        words for entry, words in _BESIDE_POSITIONS.items() if entry in others and entry not in used
    ]
    remarks = [f"not used of the trajectory: {', '.join(unused)}"] if unused else []
    if len(filled) > 1:
        remarks.append("not used of the file: a trajectory of joints with several degrees")
    times = [_seconds(point.get("time_from_start")) for point in points]
    return JointTable(
        names,
        positions,
        times=None if None in times else np.array(times, float),
        velocities=_of_shape(_entries(points, "velocities"), positions),
        accelerations=_of_shape(_entries(points, "accelerations"), positions),
        remarks=tuple(remarks),
        frame=_frame_of(trajectory.get("header")),
    )


def _several_words(trajectories: Sequence[Mapping[str, Any]]) -> str:
    """Say of each trajectory how many points it has, and of which joints."""
    return joined(
        f"number {number} with {len(one['points'] or ())} points of "
        f"{listed(map(str, one['joint_names'] or ()))}"
        for number, one in enumerate(trajectories[:_NAMED], start=1)
    ) + (f", and {len(trajectories) - _NAMED} more" if len(trajectories) > _NAMED else "")


def _short_point(points: Any, names: Sequence[str]) -> str:
    """Say which point has not a position of every joint."""
    if isinstance(points, list):
        for number, point in enumerate(points, start=1):
            values = point.get("positions") if isinstance(point, Mapping) else None
            if isinstance(values, str) or not isinstance(values, Sequence) or not values:
                return f"has no positions at point {number} of {len(points)}"
            if len(values) != len(names or points[0]["positions"]):
                wanted = len(names or points[0]["positions"])
                return f"has {len(values)} of {wanted} positions at point {number} of {len(points)}"
            for value in values:
                if isinstance(value, bool) or not isinstance(value, int | float):
                    return f"has position {quoted(value)} at point {number} of {len(points)}"
    return "has points that are no list of positions by joint"


def _frame_of(header: object) -> str:
    return str(header.get("frame_id", "")) if isinstance(header, Mapping) else ""


_CUT_OFF = "..."
"""What `ros2 topic echo` writes in place of the rest of a long list."""


def _entries(points: Any, name: str) -> Array | None:
    """An entry of every point, a row each; None where one has none."""
    try:
        return np.array([point[name] for point in points], dtype=float)
    except (TypeError, KeyError, ValueError):
        return None


def _of_shape(entries: Array | None, positions: Array) -> Array | None:
    """Entries that every joint has at every point; None of others."""
    return entries if entries is not None and entries.shape == positions.shape else None


def _seconds(time: Any) -> float | None:
    """A duration of ROS 2 or ROS 1, or a number [s]; None of what is none."""
    if isinstance(time, Mapping):
        whole = time.get("sec", time.get("secs", 0))
        parts = time.get("nanosec", time.get("nsecs", 0))
        if isinstance(whole, int | float) and isinstance(parts, int | float):
            return float(whole) + 1e-9 * float(parts)
        return None
    return float(time) if isinstance(time, int | float) and not isinstance(time, bool) else None


_BESIDE_POSITIONS = {
    "velocities": "velocities", "accelerations": "accelerations", "effort": "efforts",
    "time_from_start": "times",
}  # fmt: skip
"""Entries of a trajectory's point that a path has no use for."""


def _trajectories_in(document: object) -> Iterator[Mapping[str, Any]]:
    """Find the parts of a message that have joint_names and points, however deep."""
    if isinstance(document, Mapping):
        if "points" in document and "joint_names" in document:
            yield document
            return
        document = list(document.values())
    if isinstance(document, list):
        for entry in document:
            yield from _trajectories_in(entry)


def _is_in_space(trajectory: Mapping[str, Any]) -> bool:
    """Return whether a trajectory is a MultiDOFJointTrajectory, which holds whole poses."""
    points = trajectory["points"]
    first = points[0] if isinstance(points, list) and points else None
    return isinstance(first, Mapping) and "transforms" in first


_DECIMAL_COMMA = re.compile(r"\s*[+-]?\d*,\d+(?:[eE][+-]?\d+)?\s*")
_DECIMAL_POINT = re.compile(r"\s*[+-]?\d*\.\d+(?:[eE][+-]?\d+)?\s*")


def _separator(lines: list[str]) -> str | None:
    """Return the mark between the cells of a table; None for white space."""
    mark = next((mark for mark in ";\t," if mark in lines[0]), None)
    cells = lines[-1].split()
    spaced = len(cells) > 1 and all(_DECIMAL_COMMA.fullmatch(cell) for cell in cells)
    return None if mark == "," and spaced else mark


def _with_points(rows: list[list[str]], path: str) -> list[list[str]]:
    """Rows whose numbers have decimal points, of cells that commas do not separate.

    Such cells may have decimal commas, but then all of a table do: 1,250 beside 0.5 may be a
    thousand and more.
    """
    cells = [cell for row in rows for cell in row]
    by_comma = next((cell for cell in cells if _DECIMAL_COMMA.fullmatch(cell)), None)
    if by_comma is None:
        return rows
    by_point = next((cell for cell in cells if _DECIMAL_POINT.fullmatch(cell)), None)
    if by_point is not None:
        raise ValueError(
            f"path {path} has numbers with decimal commas and with decimal points, such as "
            f"{quoted(by_comma)} and {quoted(by_point)}; give all of them with points"
        )
    return [
        [cell.replace(",", ".") if _DECIMAL_COMMA.fullmatch(cell) else cell for cell in row]
        for row in rows
    ]


def _table_of(path: str | Path) -> JointTable:
    """Names, where they are above the columns, and positions of a csv; its times."""
    text = read_text(path, "path")
    lines = [
        line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")
    ]
    if not lines:
        raise ValueError(f"path {path} is empty; give a row for each waypoint")
    mark = _separator(lines)
    rows = (
        [line.split() for line in lines]
        if mark is None
        else list(csv.reader(io.StringIO("\n".join(lines)), delimiter=mark))
    )
    if mark != ",":
        rows = _with_points(rows, str(path))
    headings = None
    try:
        [cell_value(cell) for cell in rows[0]]
    except ValueError:
        headings = read_headings(rows[0])
        names = rows[0]
        rows = rows[1:]
    else:
        names = []
    if len({len(row) for row in rows}) != 1:
        raise ValueError(
            f"path {path} has rows of different lengths, or none; give a number for each joint in "
            "each, and semicolons between numbers with decimal commas"
        )
    if headings is not None and len(names) != len(rows[0]):
        raise ValueError(
            f"path {path} names {len(names)} columns and has {len(rows[0])} numbers in a row; "
            "give a number for each name, and semicolons between numbers with decimal commas"
        )
    headings = headings or Headings(dict.fromkeys(range(len(rows[0])), ""), {}, [], [])
    columns = [*headings.times, *headings.joints]
    try:
        table = {
            column: _in_si([row[column] for row in rows], headings, column) for column in columns
        }
    except ValueError as error:
        raise ValueError(
            f"path {path} has a row that is no row of numbers ({error}); give a number for each "
            "joint"
        ) from None
    unused = ["times"] if headings.times else []
    if headings.others:
        first, *others = headings.others
        more = f" and {len(others)} more" if others else ""
        unused.append(f"columns that are no positions, {first}{more}")
    return JointTable(
        headings.names,
        np.column_stack([table[column] for column in headings.joints]),
        times=table[headings.times[0]] if len(headings.times) == 1 else None,
        remarks=(
            *headings.unit_words,
            *([f"not used of the table: {' and '.join(unused)}"] if unused else []),
        ),
    )


def _in_si(cells: list[str], headings: Headings, column: int) -> Array:
    """A column's numbers in SI units, by the unit of the cell or of the heading."""
    read = [cell_value(cell) for cell in cells]
    per_unit = headings.per_unit(column)
    return np.array([value if own else value / per_unit for value, own in read])
