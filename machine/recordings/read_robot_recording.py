"""A recording of a robot from a file: a controller's csv, or JointState messages in YAML.

Columns are found by the joints' names, or by numbers, as `tau_ext[4]`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.recordings.read_recording import Columns, tick_of
from quietarm.machine.recordings.robot_recording import RobotRecording
from quietarm.machine.tables.column_units import split_name
from quietarm.machine.tables.table import Table, read_table, unused_in_words
from quietarm.models.number_checks import listed, quoted
from quietarm.models.robot.text_files import read_text
from quietarm.ocp import FileFormatError

Array = NDArray[np.float64]
_MESSAGES = (".yaml", ".yml")
_CALLED = {
    "torques": ("effort", "torque", "tau", "tau_ext", "tau_J", "tau_ext_hat_filtered"),
    "positions": ("position", "angle", "q"),
}
"""What columns of all joints are called, where no name is given."""
_OPTIONS = {
    "torques": "torque", "positions": "angle", "acceleration": "acceleration", "tip": "tip",
}  # fmt: skip
"""The option that names the columns of each signal."""
_FIELDS = {"torques": "effort", "positions": "position"}
"""Of a JointState."""
_BETWEEN = re.compile(r"^---[ \t]*$", re.MULTILINE)


class ReadRobotRecording(NamedTuple):
    """A recording of a robot, and notes on what of its file is not used."""

    recording: RobotRecording
    notes: list[str]


def read_robot_recording(
    path: Path, columns: Columns, name: str, joints: Sequence[str]
) -> ReadRobotRecording:
    """Read a recording of a robot by the names of its driven joints.

    `columns` names what all columns of torques and of angles begin with, and each of the
    accelerations; those of joints that are not named are found by the joints' names.
    """
    if path.suffix.lower() in _MESSAGES:
        return _of_messages(path, columns, name, joints)
    table = read_table(path)
    headings = dict[str, list[str]]()
    for signal, option in _OPTIONS.items():
        given = [*columns.names.get(option, ())]
        named = signal in ("acceleration", "tip")
        found = given if named else _headings(table, signal, given, joints)
        if found:
            headings[signal] = found
    if not headings.keys() & {"torques", "acceleration", "tip"}:
        if almost := _almost(table, "torques", columns.names.get("torque") or (), joints):
            raise FileFormatError(
                f"{path} has {almost}; rename it, or name what all torques begin with by --torque"
            )
        raise FileFormatError(
            f"{path} has no column of torques by the joints' names, such as "
            f"{joints[0]}_effort; name what they begin with by --torque, as tau_ext of "
            "tau_ext[4], or those of an accelerometer by --acceleration"
        )
    signals = {
        signal: np.column_stack([
            table.find(heading).values * _factor(table, heading, _OPTIONS[signal], columns, joints)
            for heading in found
        ])
        for signal, found in headings.items()
    }  # fmt: skip
    used = [heading for found in headings.values() for heading in found]
    rows = len(next(iter(signals.values())))
    if columns.rate is not None:
        time, tick = np.arange(rows) / columns.rate, 0.0
    else:
        heading, *_ = columns.names.get("time") or [
            table.first("time", "name it by --time, or give the samples per second by --rate")
        ]
        used.append(heading)
        time = table.find(heading).values * _factor(table, heading, "time", columns)
        tick = tick_of(table, {"time": [heading]}, columns)
    recording = _recording(time, signals, name, tick)
    notes = [unused_in_words(table.unused(used))]
    if "positions" not in headings:
        almost = _almost(table, "positions", columns.names.get("angle") or (), joints)
        notes.append(f"no positions are used: it has {almost}" if almost else "")
    return ReadRobotRecording(recording, [note for note in notes if note])


def _recording(
    time: Array, signals: Mapping[str, Array], name: str, tick: float = 0.0
) -> RobotRecording:
    """A recording; what is wrong with it is wrong with its file."""
    arrays: dict[str, Any] = {**signals}
    try:
        return RobotRecording(time, **arrays, name=name, tick=tick)
    except ValueError as error:
        raise FileFormatError(str(error)) from None


def _factor(
    table: Table, heading: str, quantity: str, columns: Columns, joints: Sequence[str] = ()
) -> float:
    """Return the factor of a column to SI units; the name of a joint at its end is no unit."""
    unit = columns.units.get(quantity, "")
    ends_in_joint = heading.strip().endswith(tuple(joints))
    if ends_in_joint and not unit and quantity not in columns.scales:
        return 1.0
    return table.factor(heading, quantity, unit, columns.scales.get(quantity), option=quantity)


def _headings(table: Table, signal: str, given: Sequence[str], joints: Sequence[str]) -> list[str]:
    """The columns of all joints, in the order of the robot; none where there are none.

    FileFormatError where a name was given and does not stand for all of them.
    """
    names = _by_name(table)
    for front in given or _CALLED[signal]:
        for pattern in _patterns(front, joints):
            found = [names[one.lower()] for one in pattern if one.lower() in names]
            if len(found) == len(joints):
                return found
    if given and (almost := _almost(table, signal, given, joints)):
        raise FileFormatError(f"{table.path} has {almost}; rename it")
    if given:
        raise FileFormatError(
            f"{table.path} has no {len(joints)} columns of {quoted(given[0])}, one for each joint; "
            f"they may be called {quoted(f'{joints[0]}_{given[0]}')} or "
            f"{quoted(f'{given[0]}[0]')}; {table.listed()}"
        )
    alone = [names[joint.lower()] for joint in joints if joint.lower() in names]
    return alone if signal == "torques" and len(alone) == len(joints) else []


def _almost(table: Table, signal: str, given: Sequence[str], joints: Sequence[str]) -> str:
    """Say which joints lack a column where others have one, and which columns are left over.

    Nothing where more than half of the joints lack one.
    """
    names = _by_name(table)
    patterns = [
        (front, pattern)
        for front in given or _CALLED[signal]
        for pattern in _patterns(front, joints)
    ]
    if signal == "torques":
        patterns.append(("", [*joints]))
    front, best = max(patterns, key=lambda one: sum(name.lower() in names for name in one[1]))
    missing = [name for name in best if name.lower() not in names]
    count = len(joints) - len(missing)
    if not count or not missing or count < len(missing):
        return ""
    taken = {name.lower() for name in best}
    others = [
        column.name
        for column in table.columns
        if front and front.lower() in _plain(column.name) and _plain(column.name) not in taken
    ]
    left = f"; left over of the file: {listed(others)}" if others else ""
    return (
        f"{signal} of {count} of {len(joints)} joints, and no column "
        f"{listed(map(quoted, missing))}{left}"
    )


def _by_name(table: Table) -> dict[str, str]:
    """The headings by their names in small letters, with and without units."""
    names = {_plain(column.name): column.name for column in table.columns}
    return names | {column.name.strip().lower(): column.name for column in table.columns}


def _patterns(front: str, joints: Sequence[str]) -> Iterator[list[str]]:
    """Yield the names that columns of all joints may have, with what they begin with."""
    for mark in ("_", ".", "/", " "):
        yield [f"{front}{mark}{joint}" for joint in joints]
        yield [f"{joint}{mark}{front}" for joint in joints]
    for first in (0, 1):
        for form in ("{}[{}]", "{}_{}", "{}{}", "{}.{}"):
            yield [form.format(front, first + k) for k in range(len(joints))]


def _plain(name: str) -> str:
    """A heading without its unit, in small letters."""
    return split_name(name)[0].strip().lower()


def _of_messages(
    path: Path, columns: Columns, name: str, joints: Sequence[str]
) -> ReadRobotRecording:
    """The JointState messages of a file, as `ros2 topic echo` writes them."""
    stamps = list[float]()
    rows: dict[str, list[list[float]]] = {signal: [] for signal in _FIELDS}
    passed = 0
    seen = list[str]()
    for message in _messages_in(path):
        names = message.get("name")
        if not isinstance(names, list) or not set(joints) <= set(map(str, names)):
            passed += 1
            if isinstance(names, list) and set(joints) & set(map(str, names)):
                seen = [str(one) for one in names]
            continue
        order = [names.index(joint) for joint in joints]
        for signal, field in _FIELDS.items():
            values = message.get(field)
            if isinstance(values, list) and len(values) == len(names):
                rows[signal].append([_number(path, field, values[k]) for k in order])
        stamps.append(_stamp(path, message))
    if not stamps and seen:
        missing = [quoted(joint) for joint in joints if joint not in seen]
        others = [quoted(one) for one in seen if one not in joints]
        left = f"; left over of the message: {listed(others)}" if others else ""
        raise FileFormatError(
            f"{path} has messages without the joint {listed(missing)}{left}; record those of this "
            "robot, by ros2 topic echo --full-length /joint_states"
        )
    if not stamps:
        raise FileFormatError(
            f"{path} has no JointState message of {', '.join(joints)}; record those of this robot, "
            "by ros2 topic echo --full-length /joint_states"
        )
    without = len(stamps) - len(rows["torques"])
    if without:
        raise FileFormatError(
            f"{path}: {without} of {len(stamps)} messages have no effort "
            "of the joints; record a controller that publishes effort, or an accelerometer"
        )
    whole = {signal: values for signal, values in rows.items() if len(values) == len(stamps)}
    scales = {"torques": "torque", "positions": "angle"}
    signals = {
        signal: np.array(values) * columns.scales.get(scales[signal], 1.0)
        for signal, values in whole.items()
    }
    time = np.array(stamps)
    notes = [f"{passed} messages without these joints are not used"] if passed else []
    return ReadRobotRecording(_recording(time - time[0], signals, name), notes)


def _messages_in(path: Path) -> Iterator[Mapping[str, Any]]:
    """The tables of a file, each by itself."""
    try:
        from quietarm.models.robot.yaml_text import parse_yaml

        text = read_text(path, "recording")
    except (ImportError, ValueError) as error:
        raise FileFormatError(str(error)) from None
    for number, part in enumerate(_BETWEEN.split(text), start=1):
        if not part.strip():
            continue
        try:
            message = parse_yaml(part)
        except ValueError as error:
            raise FileFormatError(f"{path}: message {number} {error}") from None
        if isinstance(message, dict):
            yield message


def _number(path: Path, field: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        said = "is cut off at '...'" if value == "..." else f"has {quoted(str(value))}"
        raise FileFormatError(
            f"{path}: {field} {said}; give numbers, by ros2 topic echo --full-length"
        )
    return float(value)


def _stamp(path: Path, message: Mapping[str, Any]) -> float:
    """The time of a message [s]."""
    header = message.get("header")
    stamp = header.get("stamp") if isinstance(header, dict) else None
    if not isinstance(stamp, dict) or "sec" not in stamp:
        raise FileFormatError(f"{path}: a message has no header.stamp.sec; give those of ROS 2")
    fraction = stamp.get("nanosec", 0)
    return _number(path, "sec", stamp["sec"]) + 1e-9 * _number(path, "nanosec", fraction)
