"""Read coefficients that another program found: CSV and other text, .npy, .npz and .mat files."""

from __future__ import annotations

import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp import FileFormatError
from quietarm.ocp.files import read_bytes

Array = NDArray[np.float64]

MOST_MOTIONS = 1_000_000
_COEFFICIENT = re.compile(r"(?:a|x|coefficient)?[ _]?\(?\[?(\d+)\]?\)?", re.IGNORECASE)
_CLAIMS: Mapping[str, tuple[int, float]] = {
    "residual": (0, 1.0), "residual_m": (0, 1.0), "residual_mm": (0, 1e-3), "f1": (0, 1.0),
    "energy": (1, 1.0), "energy_j": (1, 1.0), "energy_mj": (1, 1e-3), "f2": (1, 1.0),
}  # fmt: skip
"""Columns that state a figure: which of residual [m] and energy [J], and its unit in these."""
_MATRICES = ("coefficients", "x", "a", "pareto_set")
_FIGURES = ("f", "objectives", "pareto_front")


@dataclass(frozen=True)
class Found:
    """What a file holds: coefficients, what it claims of each motion, columns of no use."""

    coefficients: Array
    claims: Array
    ignored: tuple[str, ...] = ()


def read_found(path: Path) -> Found:
    """Read a file by its ending: .npy, .npz, .mat, and text for any other.

    Text has a row for each motion, with commas, semicolons, tabs or spaces between. Its first line
    may name the columns: ``a_1``, ``a_2``, ... are coefficients, ``residual_m`` and ``energy_J``
    what is claimed; without names all columns are coefficients. Arrays are a matrix of
    coefficients, or several named ones. Nothing in a file is run.
    """
    content, kind = read_bytes(path), path.suffix.lower()
    try:
        if kind == ".npy":
            found = _of_array(np.load(io.BytesIO(content), allow_pickle=False))
        elif kind == ".npz":
            with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
                found = _by_variables({name: arrays[name] for name in arrays.files})
        elif kind == ".mat":
            from scipy.io import loadmat  # comes with pymoo; takes long to load

            values = loadmat(io.BytesIO(content))
            found = _by_variables({k: v for k, v in values.items() if not k.startswith("__")})
        else:
            found = _of_text(content.decode("utf-8-sig"))
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
    if not found.coefficients.size:
        raise FileFormatError(f"{path} holds no coefficients; give a row for each motion")
    return found


def _of_text(text: str) -> Found:
    lines = [(i, line.strip()) for i, line in enumerate(text.splitlines(), start=1)]
    lines = [(i, line) for i, line in lines if line and not line.startswith(("#", "%"))]
    if not lines:
        raise FileFormatError("it is empty; give a row for each motion")
    if len(lines) > 1 + MOST_MOTIONS:  # told before a minute is spent on their numbers
        raise FileFormatError(f"it has {len(lines)} lines; give at most {MOST_MOTIONS} motions")
    between = next((mark for mark in (";", "\t", ",") if mark in lines[0][1]), None)
    rows = [(i, [cell.strip().strip('"') for cell in line.split(between)]) for i, line in lines]
    names = None
    counted = [str(i) for i in range(len(rows[0][1]))]  # how pandas names columns without names
    try:
        if len(counted) > 1 and rows[0][1] == counted:
            raise ValueError
        _numbers(rows[0][1], between)
    except ValueError:
        names = rows.pop(0)[1]
    table, width = list[list[float]](), len(names or rows[0][1])
    for i, cells in rows:
        try:
            table.append(_numbers(cells, between))
        except ValueError as error:
            raise FileFormatError(
                f"line {i}: {error}; give numbers, and put semicolons between numbers with decimal "
                "commas"
            ) from None
        if len(cells) != width:
            raise FileFormatError(
                f"line {i} has {len(cells)} columns, the first {width}; give as many in every line"
            )
    return _by_columns(names, np.array(table).reshape(-1, width))


def _numbers(cells: Sequence[str], between: str | None) -> list[float]:
    return [float(cell if between == "," else cell.replace(",", ".")) for cell in cells]


def _by_columns(names: Sequence[str] | None, table: Array) -> Found:
    """What the columns of a table are."""
    claims = np.full((len(table), 2), np.nan)
    if names is None:
        if min(table.shape) > 1 and np.array_equal(table[:, 0], np.arange(len(table))):
            raise FileFormatError(
                "its first column counts the rows; leave it out, in pandas by index=False"
            )
        return Found(table, claims)
    numbered, ignored = dict[int, int](), list[str]()
    for column, name in enumerate(names):
        match, claim = _COEFFICIENT.fullmatch(name), _CLAIMS.get(name.lower().replace(" ", "_"))
        if match:
            if int(match[1]) in numbered:
                raise FileFormatError(f"coefficient {match[1]} has two columns; leave one")
            numbered[int(match[1])] = column
        elif claim:
            claims[:, claim[0]] = table[:, column] * claim[1]
        else:
            ignored.append(name[:30] or "a column without a name")
    order = sorted(numbered)
    if not order:
        raise FileFormatError(
            "no column is a coefficient; name them a_1, a_2, ..., or leave the names out"
        )
    missing = set(range(min(1, order[0]), order[-1] + 1)) - numbered.keys()
    if missing:
        raise FileFormatError(f"there is no column for coefficient {min(missing)}; give all")
    return Found(table[:, [numbered[i] for i in order]], claims, tuple(ignored))


def _of_array(values: Any) -> Found:
    names = values.dtype.names
    if names:
        return _by_columns(names, np.column_stack([_real(values[n], n) for n in names]))
    return _by_columns(None, _matrix(values, "the array"))


def _by_variables(values: Mapping[str, Any]) -> Found:
    """What named arrays are."""
    small = {name.lower(): name for name in values}
    matrix = next((small[name] for name in _MATRICES if name in small), None)
    if matrix is None:
        tables = [n for n, v in values.items() if np.ndim(v) == 2 and min(np.shape(v)) > 1]
        if len(tables) != 1:
            listed = ", ".join(values)[:200] or "none"
            raise FileFormatError(f"name the matrix of coefficients X (its variables: {listed})")
        (matrix,) = tables
    coefficients, ignored = _matrix(values[matrix], matrix), list[str]()
    claims = np.full((len(coefficients), 2), np.nan)
    for name, value in values.items():
        claim = _CLAIMS.get(name.lower())
        if name.lower() in _FIGURES and np.shape(value) == claims.shape:
            claims[:] = _real(value, name)
        elif claim and np.size(value) == len(coefficients):
            claims[:, claim[0]] = _real(value, name).ravel() * claim[1]
        elif name != matrix:
            ignored.append(name[:30])
    return Found(coefficients, claims, tuple(ignored))


def _matrix(values: Any, name: str) -> Array:
    table = _real(values, name)
    if table.ndim != 2:
        raise FileFormatError(f"{name[:30]} has shape {table.shape}; give (motions, coefficients)")
    return table


def _real(values: Any, name: str) -> Array:
    array = np.asarray(values)
    if array.dtype.kind not in "fiu":
        raise FileFormatError(f"{name[:30]} is no array of real numbers; save it as numbers")
    return array.astype(float)
