"""A recording of a machine from a file, by the names of its columns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from quietarm.ocp import FileFormatError
from quietarm.studies.export.tables import UNITS as OF_MOVES
from quietarm.studies.export.tables import columns_of
from quietarm.studies.identify import Recording
from quietarm.studies.reading.table import Units, column_in, column_of, read_table

UNITS: Mapping[str, Units] = {
    **{name: OF_MOVES[name] for name in ("time", "angle", "torque")},
    "tip": {**OF_MOVES["tip"], "cm": 100.0, "um": 1e6},
    "acceleration": {"m/s^2": 1.0, "mm/s^2": 1e3, "g": 1 / 9.80665},
}


def units_of(text: str) -> dict[str, str]:
    """Read units of quantities, `time:ms,angle:deg`; ValueError when one is unknown."""
    return {name: unit for name, (unit, _) in columns_of(text, UNITS, "quantity").items()}


def read_recording(
    path: Path, columns: Mapping[str, Sequence[str]], units: Mapping[str, str], name: str
) -> Recording:
    """Read a recording from the columns of a file, named by quantity of `UNITS`.

    The time's column is found where it is not named. Units are those where the columns' names do
    not end in one.
    """
    table = read_table(path)
    times = columns.get("time") or [column_of(path, table, "time", UNITS["time"])]
    signals = {
        quantity: np.column_stack([
            column_in(path, table, name, units.get(quantity, ""), UNITS[quantity])
            for name in names
        ])
        for quantity, names in {**columns, "time": times}.items()
        if names
    }  # fmt: skip
    flat = {one: signals[one][:, 0] for one in ("time", "angle", "torque") if one in signals}
    try:
        return Recording(**{**signals, **flat}, name=name)
    except ValueError as error:
        raise FileFormatError(str(error)) from None
