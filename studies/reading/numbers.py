"""Numbers from files of other programs: text, NumPy's arrays and MATLAB's files."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp import FileFormatError
from quietarm.ocp.files import read_bytes

T = TypeVar("T")
Array = NDArray[np.float64]
MOST_ROWS = 1_000_000


def read_numbers(
    path: Path,
    of_columns: Callable[[list[str] | None, Array], T],
    of_variables: Callable[[Mapping[str, Any]], T],
) -> T:
    """What is made of a file's columns, with their names or None, or of its named arrays.

    By its ending: .npy, .npz, .mat (version 5), and text for any other, with commas, semicolons,
    tabs or spaces between, whose first line may name the columns. Nothing in a file is run.
    """
    content, kind = read_bytes(path), path.suffix.lower()
    try:
        if kind == ".npy":
            return of_columns(*_columns_of(np.load(io.BytesIO(content), allow_pickle=False)))
        if kind == ".npz":
            with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
                return of_variables(dict(arrays))
        if kind == ".mat":
            from scipy.io import loadmat  # comes with pymoo; takes long to load

            values = loadmat(io.BytesIO(content))
            return of_variables({k: v for k, v in values.items() if not k.startswith("__")})
        text = content.decode("utf-8-sig")
        return of_columns(*_columns_in(text))
    except FileFormatError as error:
        raise FileFormatError(f"{path}: {error}") from None
    except UnicodeDecodeError:
        raise FileFormatError(
            f"{path}: it is no text; give .npy, .npz and .mat files their ending, and save text as "
            "UTF-8"
        ) from None
    except Exception as error:  # whatever their parsers make of a damaged file
        raise FileFormatError(
            f"{path}: it is no whole {kind} file of numbers ({error}); save it again"
        ) from None


def real(values: Any, name: str) -> Array:
    """An array of real numbers."""
    array = np.asarray(values)
    if array.dtype.kind not in "fiu":
        raise FileFormatError(f"{name[:30]} is no array of real numbers; save it as numbers")
    return array.astype(float)


def _columns_of(values: Any) -> tuple[list[str] | None, Array]:
    names = values.dtype.names
    if names:
        return list(names), np.column_stack([real(values[name], name) for name in names])
    return None, real(values, "the array")


def _columns_in(text: str) -> tuple[list[str] | None, Array]:
    lines = [(i, line.strip()) for i, line in enumerate(text.splitlines(), start=1)]
    lines = [(i, line) for i, line in lines if line and not line.startswith(("#", "%"))]
    if not lines:
        raise FileFormatError("it is empty; give rows of numbers")
    if len(lines) > 1 + MOST_ROWS:  # told before a minute is spent on their numbers
        raise FileFormatError(f"it has {len(lines)} lines; give at most {MOST_ROWS} motions")
    between = next((mark for mark in (";", "\t", ",") if mark in lines[0][1]), None)
    rows = [(i, [cell.strip().strip('"') for cell in line.split(between)]) for i, line in lines]
    names, width = None, len(rows[0][1])
    try:
        # pandas counts columns without names
        if width > 1 and rows[0][1] == [str(i) for i in range(width)]:
            raise ValueError
        _floats(rows[0][1], between)
    except ValueError:
        names = rows.pop(0)[1]
    table = list[list[float]]()
    for i, cells in rows:
        try:
            table.append(_floats(cells, between))
        except ValueError as error:
            raise FileFormatError(
                f"line {i}: {error}; give numbers, and put semicolons between numbers with decimal "
                "commas"
            ) from None
        if len(cells) != width:
            raise FileFormatError(
                f"line {i} has {len(cells)} columns, the first {width}; give as many in every line"
            )
    return names, np.array(table).reshape(-1, width)


def _floats(cells: Sequence[str], between: str | None) -> list[float]:
    return [float(cell if between == "," else cell.replace(",", ".")) for cell in cells]
