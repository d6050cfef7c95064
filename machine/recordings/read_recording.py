"""A recording of a machine from a file, by the names of its columns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from quietarm.machine import Recording
from quietarm.machine.recordings.recording import MOST_ANGLE
from quietarm.machine.tables.column_units import UNITS, unknown_ending
from quietarm.machine.tables.table import Table, read_table, unused_in_words
from quietarm.models.dimensions import words_of
from quietarm.models.joint_motion import ROTARY
from quietarm.models.number_checks import quoted
from quietarm.ocp import FileFormatError

Array = NDArray[np.float64]
_NEED_A_SCALE = ("time", "angle", "torque")
"""Quantities whose unit matters whatever is sought."""


class Columns(NamedTuple):
    """The columns of a recording: names, units and scales by quantity of `OF_OPTIONS`.

    A joint's position is its angle, and a force its torque; which is meant the kind of joint tells.
    With a rate [Hz] no time is read.
    """

    names: Mapping[str, Sequence[str]]
    units: Mapping[str, str] = {}
    scales: Mapping[str, float] = {}
    rate: float | None = None
    joint: str = ROTARY


class ReadRecording(NamedTuple):
    """A recording, and notes on what of its file is not used or taken as it is."""

    recording: Recording
    notes: list[str]


def notes_in_words(read: Sequence[Any]) -> list[str]:
    """The notes on files, each once, with the files that it is of."""
    files = dict[str, list[str]]()
    for one in read:
        for note in one.notes:
            files.setdefault(note, []).append(one.recording.name)
    return [f"{', '.join(names)}: {note}" for note, names in files.items()]


def read_recording(path: Path, columns: Columns, name: str) -> ReadRecording:
    """Read a recording from the columns of a file.

    The time's column is found where it is not named. Units take the place of those in the columns'
    names; a scale is what one count is in SI units.
    """
    table = read_table(path)
    named = _with_time(table, columns)
    headings = [heading for names in named.values() for heading in names]
    used = [table.find(heading) for heading in headings]
    for k, column in enumerate(used):
        if any(column is earlier for earlier in used[:k]):
            raise FileFormatError(
                f"{path}: column {column.name} is given for two signals; give each a column of its "
                "own"
            )
    signals = {
        quantity: np.column_stack([
            table.find(heading).values * _factor(table, heading, quantity, columns)
            for heading in names
        ])
        for quantity, names in named.items()
    }  # fmt: skip
    if columns.rate is not None:
        longest = max(len(values) for values in signals.values())
        signals["time"] = np.arange(longest)[:, None] / columns.rate
    rows = {len(values) for values in signals.values()}
    if len(rows) > 1:
        raise FileFormatError(
            f"{path}: its columns have {' and '.join(map(str, sorted(rows)))} rows"
        )
    _refuse_far(path, signals, columns.joint)
    flat = {
        quantity: signals[quantity][:, 0]
        for quantity in ("time", "angle", "torque")
        if quantity in signals
    }
    arrays: dict[str, Any] = {**signals, **flat}
    try:
        recording = Recording(**arrays, name=name, tick=tick_of(table, named, columns))
    except ValueError as error:
        raise FileFormatError(str(error)) from None
    notes = [unused_in_words(table.unused(headings)), *_without_unit(table, named, columns)]
    return ReadRecording(recording, [note for note in notes if note])


def _with_time(table: Table, columns: Columns) -> dict[str, Sequence[str]]:
    """The names of columns by quantity, with the time's where it is read."""
    named = {quantity: names for quantity, names in columns.names.items() if names}
    if columns.rate is None and "time" not in named:
        remedy = "name it by --time, or give the samples per second by --rate"
        named["time"] = [table.first("time", remedy)]
    return named


def _factor(table: Table, heading: str, quantity: str, columns: Columns) -> float:
    """Return the factor of a column to SI units, for a kind of joint."""
    label = words_of(quantity).of(columns.joint)
    unit = columns.units.get(quantity) or columns.units.get(label, "")
    scale = columns.scales.get(quantity, columns.scales.get(label))
    return table.factor(heading, label, unit, scale, option=quantity)


def tick_of(table: Table, named: Mapping[str, Sequence[str]], columns: Columns) -> float:
    """Return the tick of the time's column [s]; 0 if it has no whole numbers, or there is none."""
    if "time" not in named:
        return 0.0
    (heading,) = named["time"]
    counts = table.find(heading).values
    counts = counts[np.isfinite(counts)]
    whole = bool(len(counts)) and bool((counts == np.round(counts)).all())
    return abs(_factor(table, heading, "time", columns)) if whole else 0.0


def _refuse_far(path: Path, signals: Mapping[str, Array], joint: str) -> None:
    """Refuse a position that no linear joint has; an angle is the recording's to refuse."""
    largest = np.nanmax(np.abs(signals["angle"]), initial=0.0) if "angle" in signals else 0.0
    if joint != ROTARY and largest > MOST_ANGLE:
        raise FileFormatError(
            f"{path}: a position of {largest:g} m; is it in millimetres? say so by --units angle:mm"
        )


def _without_unit(table: Table, named: Mapping[str, Sequence[str]], columns: Columns) -> list[str]:
    """Say how columns are read whose names end in what may be a unit and is no known one."""
    notes = list[str]()
    for quantity in _NEED_A_SCALE:
        label = words_of(quantity).of(columns.joint)
        given = {**columns.units, **columns.scales}
        for heading in named.get(quantity, ()):
            column = table.find(heading)
            ending = "" if column.written else unknown_ending(column.name)
            if ending and quantity not in given and label not in given:
                notes.append(
                    f"{quoted(ending)} in column {column.name} is not a known unit, so its values "
                    f"are read in {next(iter(UNITS[label]))}; set another by --units {quantity}:..."
                )
    return notes
