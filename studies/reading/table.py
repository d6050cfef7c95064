"""Columns of numbers by their names, from text, NumPy's arrays and MATLAB's files."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp import FileFormatError
from quietarm.ocp.checks import unknown
from quietarm.ocp.files import read_bytes

Array = NDArray[np.float64]
Units = Mapping[str, float]
"""Units of a quantity a unit of SI; the first is that where none is given."""

_WRITE = "write columns such as time_s and angle_rad under their names, separated by commas"
_REMEDIES = {".npy": "save it again by numpy.save", ".mat": "save it again by MATLAB's save -v7"}


def read_table(path: Path) -> dict[str, Array]:
    """Columns by name, of a file by its ending: .npy, .mat (version 5), and text for any other.

    The first line of text names its columns, after a # or not; those of an array are 0, 1, ...
    Nothing in a file is run.

    Raises
    ------
    FileFormatError
        When the file is no such table.
    """
    content, kind = read_bytes(path), path.suffix.lower()
    try:
        if kind == ".npy":
            return _of_array(np.load(io.BytesIO(content), allow_pickle=False))
        if kind == ".mat":
            from scipy.io import loadmat  # takes long to load

            return _of_variables(loadmat(io.BytesIO(content), squeeze_me=True))
        return _of_text(content.decode("utf-8-sig"))
    except UnicodeDecodeError:
        reason = "it is no text"
    except Exception as error:  # whatever their parsers make of a damaged file
        reason = str(error)
    raise FileFormatError(
        f"{path} is no table of numbers ({reason}); {_REMEDIES.get(kind, _WRITE)}"
    )


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


def _of_text(text: str) -> dict[str, Array]:
    lines = [line for line in text.splitlines() if line.strip()]
    if not lines:
        raise ValueError("it is empty")
    between = next((mark for mark in (";", "\t", ",") if mark in lines[0]), None)
    heading = [name.strip().strip('"') for name in lines[0].lstrip("#% ").split(between)]
    rows = [line for line in lines[1:] if not line.startswith(("#", "%"))]
    try:
        float(heading[0])
    except ValueError:
        pass
    else:
        raise ValueError("its first line has numbers and names no columns")
    if not rows:
        raise ValueError("it has no rows below its first line")
    if between == ";":
        rows = [row.replace(",", ".") for row in rows]
    cells = [row.split(between) for row in rows]
    for number, row in enumerate(cells, start=2):
        if len(row) != len(heading):
            raise ValueError(f"line {number} has {len(row)} columns, the first {len(heading)}")
    return dict(zip(heading, np.array(cells, float).T, strict=True))


def _of_array(values: Any) -> dict[str, Array]:
    if values.dtype.names:
        return {name: np.asarray(values[name], float) for name in values.dtype.names}
    if values.ndim != 2:
        raise ValueError(f"the array has {values.ndim} dimensions")
    columns = values if values.shape[0] < values.shape[1] else values.T
    return {str(k): np.asarray(column, float) for k, column in enumerate(columns)}


def _of_variables(values: Mapping[str, Array]) -> dict[str, Array]:
    numbers = {
        name: np.asarray(value, float)
        for name, value in values.items()
        if isinstance(value, np.ndarray) and value.dtype.kind in "fiu" and value.ndim == 1
    }
    if not numbers:
        raise ValueError("it has no vectors of numbers")
    return numbers
