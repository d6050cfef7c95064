"""Read coefficients that another program found: CSV and other text, .npy, .npz and .mat files."""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp import FileFormatError
from quietarm.ocp.answers.documents import read_bytes
from quietarm.ocp.base.files import MOST_BYTES
from quietarm.studies.display.words import counted

Array = NDArray[np.float64]

MOST_MOTIONS = 1_000_000
_COEFFICIENT = re.compile(r"(?:a|x|coefficient)[ _]?\(?\[?(\d+)\]?\)?", re.IGNORECASE)
_CLAIMS: Mapping[str, tuple[int, float]] = {
    "residual": (0, 1.0), "residual_m": (0, 1.0), "residual_mm": (0, 1e-3), "f1": (0, 1.0),
    "energy": (1, 1.0), "energy_j": (1, 1.0), "energy_mj": (1, 1e-3), "f2": (1, 1.0),
}  # fmt: skip
"""Columns that state a figure: which of residual [m] and energy [J], and its unit in these."""
_MATRICES = ("coefficients", "x", "a", "pareto_set")
_FIGURES = ("f", "objectives", "pareto_front")


@dataclass(frozen=True)
class Found:
    """What a file holds."""

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
    content = read_bytes(path)
    readers = {".npy": _of_npy, ".npz": _of_npz, ".mat": _of_mat}
    reader = readers.get(path.suffix.lower(), _of_text)
    try:
        found = reader(content)
    except FileFormatError as error:
        raise FileFormatError(f"{path}: {error}") from None
    if not found.coefficients.size:
        raise FileFormatError(f"{path} holds no coefficients; give a row for each motion")
    return found


def _of_text(content: bytes) -> Found:
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise FileFormatError(
            "it is no text; give .npy, .npz and .mat files their ending, and save text as UTF-8"
        ) from None
    if text.lstrip().startswith(("{", "[")):
        raise FileFormatError(
            "it is JSON, no table; give a row for each motion; a front that quietarm wrote needs "
            "no import"
        )
    lines = [(i, line.strip()) for i, line in enumerate(text.splitlines(), start=1)]
    lines = [(i, line) for i, line in lines if line and not line.startswith(("#", "%"))]
    if not lines:
        raise FileFormatError("it is empty; give a row for each motion")
    if len(lines) > 1 + MOST_MOTIONS:  # told before a minute is spent on their numbers
        raise FileFormatError(f"it has {len(lines)} lines; give at most {MOST_MOTIONS} motions")
    between = next((mark for mark in (";", "\t", ",") if mark in lines[0][1]), None)
    rows = [(i, [cell.strip().strip('"') for cell in line.split(between)]) for i, line in lines]
    names: list[str] | None = None
    if not any(_is_number(cell, between) for cell in rows[0][1]):
        names = rows.pop(0)[1]
    width = len(names) if names else len(rows[0][1])
    table = np.empty((len(rows), width))
    for row, (i, cells) in zip(table, rows, strict=True):
        if len(cells) != width:
            raise FileFormatError(
                f"line {i} has {counted(len(cells), 'column')}, the first {width}; give as many "
                "in every line"
            )
        for k, cell in enumerate(cells):
            try:
                row[k] = _number(cell, between)
            except ValueError:
                shown = repr(cell[:30])
                raise FileFormatError(
                    f"line {i} has {shown} where a number should be; give a number there, and put "
                    "semicolons between numbers with decimal commas"
                ) from None
    return _by_columns(names, table)


def _number(cell: str, between: str | None) -> float:
    return float(cell.replace(",", ".") if between != "," else cell)


def _is_number(cell: str, between: str | None) -> bool:
    try:
        _number(cell, between)
    except ValueError:
        return False
    return True


def _by_columns(names: Sequence[str] | None, table: Array) -> Found:
    """What the columns of a table are."""
    if names is None:
        return _without_claims(table)
    claims, numbered, ignored = np.full((len(table), 2), np.nan), dict[int, int](), list[str]()
    for column, name in enumerate(names):
        match, claim = _COEFFICIENT.fullmatch(name), _CLAIMS.get(name.lower().replace(" ", "_"))
        if match:
            number = int(match[1])
            if number in numbered:
                raise FileFormatError(f"coefficient {number} has two columns; leave one")
            numbered[number] = column
        elif claim:
            which, unit = claim
            claims[:, which] = table[:, column] * unit
        else:
            ignored.append(name[:30] or "a column without a name")
    order = sorted(numbered)
    if not order:
        raise FileFormatError(
            "no column is a coefficient; name them a_1, a_2, ..., or leave the names out"
        )
    least = 0 if order[0] == 0 else 1
    if order != list(range(least, least + len(order))):
        missing = next(i for i in range(least, order[-1]) if i not in numbered)
        raise FileFormatError(f"there is no column for coefficient {missing}; give all of them")
    return Found(table[:, [numbered[i] for i in order]], claims, tuple(ignored))


def _without_claims(table: Array) -> Found:
    return Found(table, np.full((len(table), 2), np.nan))


def _of_npy(content: bytes) -> Found:
    try:
        values = np.load(io.BytesIO(content), allow_pickle=False)
    except Exception:  # whatever numpy's parsers make of a damaged file
        raise FileFormatError(
            "it is no whole .npy file of numbers; save the array by numpy.save"
        ) from None
    if values.dtype.names:
        table = np.column_stack([_numbers(values[name], name) for name in values.dtype.names])
        return _by_columns(values.dtype.names, table)
    return _without_claims(_matrix(values, "the array"))


def _of_npz(content: bytes) -> Found:
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            if sum(entry.file_size for entry in archive.infolist()) > MOST_BYTES:
                raise ValueError
        with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
            values = {name: arrays[name] for name in arrays.files}
    except Exception:
        raise FileFormatError(
            "it is no whole .npz file of numbers, or a huge one; save the arrays by numpy.savez"
        ) from None
    return _by_variables(values)


def _of_mat(content: bytes) -> Found:
    # comes with pymoo; takes long to load
    from scipy.io import loadmat

    try:
        values = loadmat(io.BytesIO(content))
    except NotImplementedError:
        raise FileFormatError("it is a .mat file of version 7.3; save it with -v7") from None
    except Exception:
        raise FileFormatError("it is no whole .mat file; save it again, with -v7") from None
    return _by_variables({k: v for k, v in values.items() if not k.startswith("__")})


def _by_variables(values: Mapping[str, Any]) -> Found:
    """What named arrays are."""
    small = {name.lower(): name for name in values}
    matrices = [small[name] for name in _MATRICES if name in small]
    if not matrices:
        tables = [name for name, value in values.items() if np.ndim(value) == 2]
        tables = [name for name in tables if min(np.shape(values[name])) > 1]
        if len(tables) != 1:
            listed = ", ".join(values)[:200] or "none"
            raise FileFormatError(f"name the matrix of coefficients X (its variables: {listed})")
        matrices = tables
    coefficients = _matrix(values[matrices[0]], matrices[0])
    claims = np.full((len(coefficients), 2), np.nan)
    used = {matrices[0]}
    for name, value in values.items():
        claim = _CLAIMS.get(name.lower())
        if name in used:
            continue
        if name.lower() in _FIGURES and np.shape(value) == (len(coefficients), 2):
            claims[:] = _numbers(value, name)
        elif claim and np.size(value) == len(coefficients):
            claims[:, claim[0]] = _numbers(value, name).ravel() * claim[1]
        else:
            continue
        used.add(name)
    ignored = tuple(name[:30] for name in values if name not in used)
    return Found(coefficients, claims, ignored)


def _matrix(values: Any, name: str) -> Array:
    table = _numbers(values, name)
    if table.ndim != 2:
        raise FileFormatError(f"{name[:30]} has shape {table.shape}; give (motions, coefficients)")
    return table


def _numbers(values: Any, name: str) -> Array:
    array = np.asarray(values)
    if array.dtype.kind not in "fiu":
        raise FileFormatError(f"{name[:30]} is no array of real numbers; save it as numbers")
    return array.astype(float)
