"""The options by which commands read recordings of a machine, and the recordings of files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import chain
from pathlib import Path

import click

from quietarm.machine.recordings.read_recording import Columns, ReadRecording, read_recording
from quietarm.machine.recordings.read_robot_recording import (
    ReadRobotRecording,
    read_robot_recording,
)
from quietarm.machine.tables.table import read_table
from quietarm.models import Plant
from quietarm.models.dimensions import words_of
from quietarm.studies.cli.given import Given
from quietarm.studies.cli.options import option
from quietarm.studies.cli.quantities import once, parse_rate, parse_scales, parse_units
from quietarm.studies.cli.types import Parsed

_UNITS = ("As time:ms,angle:deg,tip:mm,acceleration:g, of a linear axis angle:mm,torque:N. "
          "[default: those of the columns' names, or SI]")  # fmt: skip


RECORDED = (
    option("--time", help="Column of the time.  [default: the one that is called so, or the first "
           "if it rises evenly]"),
    option("--rate", type=Parsed("rate", parse_rate), help="Samples per second, such as 1kHz, of "
           "files without a column of the time."),
    option("--angle", help="Column of the joint's angle, of a linear axis its position; without "
           "it the joint was held."),
    option("--tip", multiple=True, help="Column of a tip's displacement."),
    option("--acceleration", multiple=True, help="Column of an accelerometer at a tip."),
    option("--torque", help="Column of the joint's torque, of a linear axis its force; of a robot "
           "what those of all joints begin with, as tau_ext of tau_ext[4].  [default: columns by "
           "the joints' names]"),
    option("--units", type=Parsed("units", parse_units), help=_UNITS),
    option("--scale", "scales", type=Parsed("scale", parse_scales), multiple=True,
           help="What a count is in SI units, such as angle=2pi/4096,tip=1e-5."),
)  # fmt: skip
"""What describes the columns of recordings: a command with these has `read_recordings`."""


def read_recordings(given: Given, paths: Sequence[Path], plant: Plant) -> list[ReadRecording]:
    """The recordings of files, by the columns that were named."""
    # columns of which at least one shows how the machine rings
    rings = ("tip", "acceleration", "torque")
    names = {
        quantity: [column] if isinstance(column, str) else list(column or ())
        for quantity, column in given.pick("time", "angle", *rings).items()
    }
    if not any(names[quantity] for quantity in rings):
        raise click.UsageError(
            "give the column of what rings: --tip, --acceleration or --torque"
            f"; {paths[0]}: {read_table(paths[0]).listed()}"
        )
    if given.rate and given.time:
        raise click.UsageError("--rate is for files without a column of the time; leave --time out")
    units = given.units or {}
    scales = scales_typed(given)
    _refuse_idle(names, {"--units": units, "--scale": scales}, plant.joint, given.rate is not None)
    columns = Columns(names, units, scales, given.rate, plant.joint)
    return [read_recording(path, columns, name) for path, name in _named(paths)]


def read_robot_moves(given: Given, paths: Sequence[Path], plant: Plant) -> list[ReadRobotRecording]:
    """The recordings of a robot's moves along a path."""
    if given.tip:
        raise click.UsageError(
            "--tip is for plants of one joint; of a robot give the torques of its joints, by "
            "--torque, or an accelerometer at the tip, by --acceleration"
        )
    return read_robot_recordings(given, paths, plant.joint_names, plant.joint)


def read_robot_recordings(
    given: Given, paths: Sequence[Path], joints: Sequence[str], kind: str
) -> list[ReadRobotRecording]:
    """The recordings of a robot, by its joints' names or what columns begin with.

    `kind` is that of the joints, rotary, linear or mixed.
    """
    if given.rate and given.time:
        raise click.UsageError("--rate is for files without a column of the time; leave --time out")
    names = {
        quantity: [column] if isinstance(column, str) else list(column or ())
        for quantity, column in given.pick("time", "angle", "tip", "acceleration", "torque").items()
    }
    scales = scales_typed(given)
    columns = Columns(names, given.units or {}, scales, given.rate, kind)
    return [read_robot_recording(path, columns, name, joints) for path, name in _named(paths)]


def scales_typed(given: Given) -> dict[str, float]:
    """Return what a count of each quantity is in SI units, as it was typed."""
    return once(chain.from_iterable(given.scales), "--scale ")


def _named(paths: Sequence[Path]) -> list[tuple[Path, str]]:
    """Files with what they are called: without folders, where they are then told apart."""
    short = len({path.name for path in paths}) == len(paths)
    return [(path, path.name if short else str(path)) for path in paths]


def _refuse_idle(
    names: Mapping[str, Sequence[str]],
    options: Mapping[str, Mapping[str, object]],
    joint: str,
    has_rate: bool,
) -> None:
    """Refuse units and scales of quantities of which no column is read."""
    read = {quantity for quantity, columns in names.items() if columns}
    read |= set() if has_rate else {"time"}
    read |= {words_of(quantity).of(joint) for quantity in read}
    for option_name, entries in options.items():
        for quantity in entries:
            if quantity not in read:
                raise click.UsageError(
                    f"{option_name} has {quantity}, and no column of it is read; leave it out"
                )
