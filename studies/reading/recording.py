"""A recording of a machine from a file, by the names of its columns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from quietarm.ocp import FileFormatError, Recording
from quietarm.ocp.checks import unknown
from quietarm.studies.export.tables import UNITS as OF_MOVES
from quietarm.studies.reading.table import Units, column_in, column_of, read_table

UNITS: Mapping[str, Units] = {
    **{name: OF_MOVES[name] for name in ("time", "angle", "torque")},
    "tip": {**OF_MOVES["tip"], "cm": 100.0, "um": 1e6},
    "acceleration": {"m/s^2": 1.0, "mm/s^2": 1e3, "g": 1 / 9.80665},
}


def units_of(text: str) -> dict[str, str]:
    """Read units of quantities, `time:ms,angle:deg`; ValueError when one is unknown."""
    found: dict[str, str] = {}
    for one in text.split(","):
        quantity, _, unit = (part.strip() for part in one.partition(":"))
        if quantity not in UNITS:
            raise ValueError(unknown("quantity", quantity, UNITS))
        if unit not in UNITS[quantity]:
            raise ValueError(unknown(f"unit of {quantity}", unit, UNITS[quantity]))
        found[quantity] = unit
    return found


def read_recording(
    path: Path, columns: Mapping[str, Sequence[str]], units: Mapping[str, str], name: str
) -> Recording:
    """Read a recording.

    Parameters
    ----------
    path : Path
        The file, as of `read_table`.
    columns : mapping of str to sequence of str
        Names of its columns by quantity, of `UNITS`; the time's is found where it is not named.
    units : mapping of str to str
        Units by quantity where the columns' names do not end in them.
    name : str
        What the recording is called.

    Raises
    ------
    FileFormatError
        When a column is missing, or they are no recording.
    """
    table = read_table(path)
    times = columns.get("time") or [column_of(path, table, "time", UNITS["time"])]
    signals = {
        quantity: np.stack(
            [
                column_in(path, table, name, units.get(quantity, ""), UNITS[quantity])
                for name in names
            ],
            axis=1,
        )
        for quantity, names in {**columns, "time": times}.items()
        if names
    }
    for quantity in ("time", "angle", "torque"):
        if quantity in signals:
            signals[quantity] = signals[quantity][:, 0]
    try:
        return Recording(**signals, name=name)
    except ValueError as error:
        raise FileFormatError(str(error)) from None
