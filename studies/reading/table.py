"""Columns of numbers by their names, and their units."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp import FileFormatError
from quietarm.ocp.checks import unknown
from quietarm.studies.reading.numbers import read_numbers

Array = NDArray[np.float64]
Units = Mapping[str, float]
"""Units of a quantity a unit of SI; the first is that where none is given."""


def read_table(path: Path) -> dict[str, Array]:
    """Columns by name, of a file as of `read_numbers`; without names they are 0, 1, ..."""
    return read_numbers(path, _by_columns, _vectors, marked=True)


def column_in(path: Path, table: Mapping[str, Array], name: str, unit: str, units: Units) -> Array:
    """A column in SI units, by its unit, that of its name (angle_deg), or SI's."""
    if name not in table:
        raise FileFormatError(f"{path}: {unknown('column', name, table)}")
    ending = name.rpartition("_")[2]
    if unit and ending in units and ending != unit:
        raise FileFormatError(
            f"{path}: column {name} is in {ending} by its name and in {unit} as given; leave the "
            "unit out, or rename the column"
        )
    unit = unit or (ending if ending in units else next(iter(units)))
    return table[name] / units[unit]


def column_of(path: Path, table: Mapping[str, Array], quantity: str, units: Units) -> str:
    """The first column whose name is that of a quantity, or its letter, before _ and the unit."""
    begins = {"time": ("time", "t"), "angle": ("angle", "theta")}[quantity]
    for name in table:
        begin, _, unit = name.partition("_")
        if begin.lower() in begins and (not unit or unit in units):
            return name
    wanted = " or ".join(f"{quantity}_{unit}" for unit in units)
    raise FileFormatError(f"{path} has no column {wanted}; its columns are {', '.join(table)}")


def _by_columns(names: list[str] | None, rows: Array) -> dict[str, Array]:
    if rows.ndim != 2:
        raise FileFormatError(f"the array has {rows.ndim} dimensions; give columns")
    if names is None:
        columns = rows if rows.shape[0] < rows.shape[1] else rows.T
        return {str(k): column for k, column in enumerate(columns)}
    if not len(rows):
        raise FileFormatError("it has no rows below its first line; write some")
    return dict(zip(names, rows.T, strict=True))


def _vectors(values: Mapping[str, Any]) -> dict[str, Array]:
    numbers = {
        name: np.squeeze(value).astype(float)
        for name, value in values.items()
        if np.asarray(value).dtype.kind in "fiu" and np.squeeze(value).ndim == 1
    }
    if not numbers:
        raise FileFormatError("it has no vectors of numbers; save the time and what rings as such")
    return numbers
