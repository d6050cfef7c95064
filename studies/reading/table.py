"""Tables of numbers from files of other programs: text, NumPy's arrays and MATLAB's files."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp import FileFormatError
from quietarm.ocp.checks import nearest
from quietarm.ocp.files import read_bytes
from quietarm.studies.reading.units import UNITS, is_unit, normal, split_name

Array = NDArray[np.float64]
_SEPARATORS = (";", "\t", ",", None)
"""None is white space."""
_LIKE = 4
"""Rows that look alike are where the numbers begin."""
_MARKS = "#%!/ \t"
"""What a comment begins with, also where it names the columns."""
_SHOWN = 12
_TIMES = ("time", "t", "x_value", "x value", "timestamp", "zeit", "seconds")
_ANGLES = ("angle", "theta", "position", "q")


@dataclass(frozen=True)
class Column:
    """A column of a file: its heading, its unit where it stands elsewhere, its numbers."""

    name: str
    unit: str
    values: Array


@dataclass(frozen=True)
class Table:
    """The columns of a file, in its order."""

    path: Path
    columns: tuple[Column, ...]

    def find(self, name: str) -> Column:
        """A column by its heading, or by its number from 0; FileFormatError where there is none."""
        for same in (str, lambda text: text.strip().lower(), lambda text: split_name(text)[0]):
            found = [k for k, one in enumerate(self.columns) if same(one.name) == same(name)]
            if len(found) > 1:
                raise FileFormatError(
                    f"{self.path}: {len(found)} columns are called {name!r}; give one's number, "
                    f"{' or '.join(map(str, found))}"
                )
            if found:
                return self.columns[found[0]]
        if name.isdecimal() and int(name) < len(self.columns):
            return self.columns[int(name)]
        names = [one.name for one in self.columns]
        listed = ", ".join(names[:_SHOWN]) + ", ..." * (len(names) > _SHOWN)
        near = nearest(name, names) if names else ""
        raise FileFormatError(
            f"{self.path} has no column {name!r}{near}; its columns, from 0, are {listed}"
        )

    def first(self, quantity: str) -> str:
        """The first column that is called as a time or an angle is."""
        begins = {"time": _TIMES, "angle": _ANGLES}[quantity]
        for one in self.columns:
            if {one.name.strip().lower(), split_name(one.name)[0].strip().lower()} & set(begins):
                return one.name
        names = ", ".join(one.name for one in self.columns[:_SHOWN])
        raise FileFormatError(
            f"{self.path} has no column called {quantity}; name it by --{quantity} (its columns, "
            f"from 0: {names})"
        )

    def in_si(self, name: str, quantity: str, unit: str = "", scale: float | None = None) -> Array:
        """A column in SI units: by a scale, a unit, that of its name, or as it is."""
        column = self.find(name)
        if scale is not None:
            return column.values * scale
        written = column.unit or split_name(column.name)[1]
        known = UNITS[quantity]
        if (
            unit
            and written
            and normal(written) in known
            and known[normal(unit)] != known[normal(written)]
        ):
            raise FileFormatError(
                f"{self.path}: column {column.name} is in {written} by its name and in {unit} as "
                "given; leave the unit out, or rename the column"
            )
        if not unit and written and normal(written) not in known:
            raise FileFormatError(
                f"{self.path}: is {written!r} of column {column.name} a unit? give the "
                f"{quantity}'s by --units {quantity}:{next(iter(known))}, or by --scale"
            )
        unit = normal(unit or written)
        return column.values * known[unit] if unit else column.values


def read_table(path: Path) -> Table:
    """Read a file by its ending: .npy, .npz, .mat (up to version 7), and text for any other.

    In text the last row with as many cells before the first row of numbers names the columns; a row
    of units may stand between. Nothing in a file is run.
    """
    content, kind = read_bytes(path), path.suffix.lower()
    try:
        if kind == ".npy":
            columns = _of_array("", np.load(io.BytesIO(content), allow_pickle=False))
        elif kind == ".npz":
            with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
                columns = _of_variables(dict(arrays))
        elif kind == ".mat":
            columns = _of_variables(_matlab(content))
        else:
            columns = _of_text(_decoded(content))
    except FileFormatError as error:
        raise FileFormatError(f"{path}: {error}") from None
    except Exception as error:  # whatever their parsers make of a damaged file
        raise FileFormatError(
            f"{path}: it is no whole {kind} file of numbers ({error}); save it again"
        ) from None
    if not columns:
        raise FileFormatError(f"{path}: it has no vectors of numbers; save the time and what rings")
    return Table(path, tuple(columns))


def _matlab(content: bytes) -> dict[str, Any]:
    from scipy.io import loadmat  # not at the top: it takes long to load

    try:
        values = loadmat(io.BytesIO(content), simplify_cells=True)
    except NotImplementedError:
        raise FileFormatError(
            "it is of MATLAB's version 7.3; save it by save(..., '-v7')"
        ) from None
    return {name: value for name, value in values.items() if not name.startswith("__")}


def _of_variables(values: Mapping[str, Any], front: str = "") -> list[Column]:
    """Vectors by name, a matrix by name and column (``X:2``), a structure by field (``a.b``)."""
    found: list[Column] = []
    for name, value in values.items():
        if isinstance(value, Mapping):
            found += _of_variables(value, f"{front}{name}.")
        else:
            found += _of_array(front + name, np.asarray(value))
    return found


def _of_array(name: str, values: NDArray[Any]) -> list[Column]:
    if values.dtype.names:
        return [Column(one, "", np.ravel(values[one]).astype(float)) for one in values.dtype.names]
    values = np.squeeze(values)
    if values.dtype.kind not in "fiu" or values.size < 2:
        return []
    if values.ndim == 1:
        return [Column(name or "0", "", values.astype(float))]
    if values.ndim > 2:
        return []
    rows = values.T if values.shape[0] < values.shape[1] else values
    first = 0 if not name else 1  # MATLAB counts from 1
    return [
        Column(f"{name}:{k}" if name else str(k), "", column.astype(float))
        for k, column in enumerate(rows.T, first)
    ]


def _decoded(content: bytes) -> str:
    encodings = (
        ("utf-16",) if content[:2] in (b"\xff\xfe", b"\xfe\xff") else ("utf-8-sig", "cp1252")
    )
    for encoding in encodings:
        try:
            text = content.decode(encoding)
        except UnicodeDecodeError:
            continue
        if "\0" not in text:
            return text
    raise FileFormatError("it is no text; give .npy, .npz and .mat files their ending")


def _of_text(text: str) -> list[Column]:
    """Columns of a text: separator, decimal mark, heading and units are found."""
    lines = text.splitlines()
    filled = [k for k, line in enumerate(lines) if line.strip()]
    if not filled:
        raise FileFormatError("it is empty; give rows of numbers")
    data = [k for k in filled if lines[k].lstrip()[0] not in "#%"]
    begins = {one: begin for one in _SEPARATORS if (begin := _begin(lines, data, one))}
    if not begins:
        raise FileFormatError(
            f"no rows of numbers in it (its first line: {lines[filled[0]][:60]!r}); give columns "
            "of numbers, with semicolons between numbers with decimal commas"
        )
    separator = min(begins, key=lambda one: begins[one][1])
    data = data[begins[separator][0] :]
    width = len(_cells(lines[data[0]], separator))
    before = [lines[k].lstrip(_MARKS) for k in filled if k < data[0]]
    names, units = _heading(before, separator, width)
    values = _numbers([(k, lines[k]) for k in data], separator, width)
    return [
        Column(name.strip(), unit, column)
        for name, unit, column in zip(names, units, values, strict=True)
        if column is not None and (name.strip() or np.isfinite(column).any())
    ]


def _cells(line: str, separator: str | None) -> list[str]:
    if separator is None:
        return line.split()
    return [cell.strip() for cell in next(csv.reader([line], delimiter=separator), [])]


def _is_number(cell: str, separator: str | None) -> bool:
    try:
        float(cell if separator == "," else cell.replace(",", "."))
    except ValueError:
        return False
    return True


def _begin(lines: list[str], data: list[int], separator: str | None) -> tuple[int, int] | None:
    """Where rows begin with numbers in the same places, and how many cells there are words."""
    kinds: list[tuple[bool, ...]] = []
    run = 0
    for k, row in enumerate(data):
        cells = _cells(lines[row], separator)
        kinds.append(tuple(bool(cell) and not _is_number(cell, separator) for cell in cells))
        run = run + 1 if k and kinds[-1] == kinds[-2] else 1
        if run == _LIKE or k + 1 == len(data):
            texts = sum(kinds[-1])
            if sum(map(bool, cells)) - texts >= 2:
                return k + 1 - run, texts
    return None


def _heading(
    before: list[str], separator: str | None, width: int
) -> tuple[Sequence[str], Sequence[str]]:
    """Names and units of the columns, of the last rows above them that have as many cells."""
    rows = [_named(line, separator, width) for line in before]
    filled = [row for row in rows if row]
    none = [""] * width
    if not filled:
        return [str(k) for k in range(width)], none
    if len(filled) > 1 and all(is_unit(cell) for cell in filled[-1] if cell):
        return filled[-2], [cell.strip("()[]{} ") for cell in filled[-1]]
    return filled[-1], none


def _named(line: str, separator: str | None, width: int) -> list[str] | None:
    """The cells of a line that may name the columns: as many, and not all of them numbers."""
    splits = [_cells(line, separator)]
    if separator is None:
        splits.append(re.split(r"\s{2,}|\t", line.strip()))
    for cells in splits:
        named = [*cells, ""] if len(cells) + 1 == width else cells  # rows with a mark at their end
        if len(named) == width and not all(_is_number(cell, separator) for cell in named if cell):
            return named
    return None


def _numbers(
    rows: Sequence[tuple[int, str]], separator: str | None, width: int
) -> list[Array | None]:
    """The columns' numbers, not a number where a cell is blank; None for columns of words."""
    import pandas as pd  # not at the top: it takes half a second to load

    for k, line in rows:
        if separator and line.count(separator) >= width and '"' not in line:
            count = line.count(separator) + 1
            raise FileFormatError(
                f"line {k + 1} has {count} columns, the first {width}; give as many in every line"
            )
    table = pd.read_csv(
        io.StringIO("\n".join(line.strip(" ") for _, line in rows)), sep=separator or r"\s+",
        header=None, names=range(width), index_col=False, dtype=str, skipinitialspace=True,
    )  # fmt: skip
    found: list[Array | None] = []
    for k in range(width):
        text = table[k] if separator == "," else table[k].str.replace(",", ".", regex=False)
        numbers: Any = pd.to_numeric(text, errors="coerce")
        wrong = np.flatnonzero((text.notna() & numbers.isna()).to_numpy())
        if len(wrong) > len(rows) / 2:
            found.append(None)
            continue
        if len(wrong):
            row = int(wrong[0])
            raise FileFormatError(
                f"line {rows[row][0] + 1}: {table[k].iloc[row]!r} is no number; mend it, or leave "
                "the cell empty"
            )
        found.append(numbers.to_numpy(float))
    return found
