"""Write what was identified of a robot as entries of its file."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from math import tau
from pathlib import Path
from typing import Any

from quietarm.machine.held_robots.identify_robot import IdentifiedRobot
from quietarm.models.robot import Measured
from quietarm.models.robot.robot_file import OF_URDF
from quietarm.models.robot.text_files import read_yaml
from quietarm.ocp.escapes import yaml_string
from quietarm.ocp.files import write_whole


def measured_lines(measured: Sequence[Measured]) -> list[str]:
    """Return the entry `measured` of a robot's file, a line each."""
    return ["measured:", *(f"  - {_flow(_entry(one))}" for one in measured)]


def write_robot(found: IdentifiedRobot, original: Path, path: Path) -> None:
    """Write a robot's file anew, with what was identified; its comments are not kept.

    Parameters
    ----------
    found : IdentifiedRobot
        What was identified.
    original : Path
        The file that it was identified from.
    path : Path
        The file to write; files that it names are looked for beside it.
    """
    document: Any = read_yaml(original, "robot file")
    entries = {name: value for name, value in document.items() if name != "measured"}
    for name in ("urdf", "limits"):
        if name in entries and (name, entries[name]) != ("limits", OF_URDF):
            entries[name] = _beside(original.parent / entries[name], path.parent)
    if found.payload is not None:
        mass = float(f"{found.payload.value:.5g}")
        entries["beam"] = {**entries["beam"], "tip_mass": mass}
    lines = [f"{_scalar(name)}: {_flow(value)}" for name, value in entries.items()]
    lines += measured_lines(found.robot.measurements)
    head = ["# identified by quietarm from ring-downs"]
    if found.unfit:
        head.append("# the torques at rest do not fit the posture: springs and at are in doubt")
    write_whole(path, "\n".join([*head, *lines, ""]))


def _beside(file: Path, folder: Path) -> str:
    """A file's name as it is found from a folder."""
    try:
        return Path(os.path.relpath(file, folder)).as_posix()
    except ValueError:  # on another drive of Windows
        return str(file.resolve())


def _entry(measured: Measured) -> Mapping[str, Any]:
    """An entry of the list, rounded to what was told."""
    entry: dict[str, Any] = {
        "frequency": f"{measured.frequency / tau:.6g}Hz",
        "at": [round(place, 5) + 0.0 for place in measured.at],
    }
    if measured.mode != 1:
        entry["mode"] = measured.mode
    if measured.damping is not None:
        entry["damping"] = f"{100 * measured.damping:.3g}%"
    return entry | {"within": f"{100 * measured.within:.2g}%"}


def _flow(value: Any) -> str:
    """A value of YAML in one line."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_scalar(k)}: {_flow(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_flow, value)) + "]"
    return _scalar(value)


def _scalar(value: Any) -> str:
    """A number, a word, or a text in quotation marks."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float):
        return repr(value)
    is_plain = str(value).isidentifier() or _is_quantity(str(value))
    return str(value) if is_plain and str(value).lower() not in _WORDS else yaml_string(str(value))


_WORDS = {"null", "true", "false", "yes", "no", "on", "off", "y", "n"}
"""That would be read as something else than a text."""


def _is_quantity(text: str) -> bool:
    """Return whether a text is a number with a unit of letters, such as 3.05Hz or 0.5%."""
    number = text.rstrip("%abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ")
    return text.isascii() and bool(number) and number != text and number.replace(".", "").isdigit()
