"""Tables of numbers from files of other programs: text, NumPy's arrays and MATLAB's files."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import groupby
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
_HEAD = 2000
"""Lines in which the numbers have to begin."""
_CALLED = {
    "time": {"time", "t", "x_value", "x value", "timestamp", "zeit", "seconds"},
    "angle": {"angle", "theta", "position", "q"},
    "position": {"position", "x", "s", "q"},
}


@dataclass(frozen=True)
class Column:
    """A column of a file: its heading, its unit where it stands elsewhere, its numbers."""

    name: str
    unit: str
    values: Array

    @property
    def written(self) -> str:
        """Its unit, wherever it is written; empty where it is nowhere."""
        return self.unit or split_name(self.name)[1]


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
        """The first column that is called as a time, an angle or a position is."""
        for one in self.columns:
            names = (one.name, split_name(one.name)[0])
            if {name.strip().lower() for name in names} & _CALLED[quantity]:
                return one.name
        names = ", ".join(one.name for one in self.columns[:_SHOWN])
        raise FileFormatError(
            f"{self.path} has no column called {quantity}; name it by --{quantity} (its columns, "
            f"from 0: {names})"
        )

    def in_si(self, name: str, quantity: str, unit: str = "", scale: float | None = None) -> Array:
        """A column in SI units: by a scale, a unit, that of its name, or as it is."""
        column, known = self.find(name), UNITS[quantity]
        if scale is not None:
            return column.values * scale
        written = normal(column.written)
        if unit and written in known and known[normal(unit)] != known[written]:
            raise FileFormatError(
                f"{self.path}: column {column.name} is in {column.written} by its name and in "
                f"{unit} as given; leave the unit out, or rename the column"
            )
        if written and not unit and written not in known:
            raise FileFormatError(
                f"{self.path}: is {column.written!r} of column {column.name} a unit? give the "
                f"{quantity}'s by --units {quantity}:{next(iter(known))}, or by --scale"
            )
        return column.values * known.get(normal(unit) or written, 1.0)


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """Say of which file an error is, whatever a parser makes of a damaged one."""
    try:
        yield
    except FileFormatError as error:
        raise FileFormatError(f"{path}: {error}") from None
    except Exception as error:
        raise FileFormatError(
            f"{path}: it is no whole {path.suffix} file of numbers ({error}); save it again"
        ) from None


def read_table(path: Path, *, strict: bool = False) -> Table:
    """Read a file by its ending: .npy, .npz, .mat (up to version 7), and text for any other.

    In text the last row with as many cells before the first row of numbers names the columns; a row
    of units may stand between. A `strict` table has its rows as they are, be it one row or column,
    and in a text nothing but a heading above them. Nothing in a file is run.
    """
    content = read_bytes(path)
    with reading(path):
        arrays = _arrays(path.suffix.lower(), content, strict)
        columns = _of_text(content, strict) if arrays is None else _of_variables(arrays, strict)
    if not columns:
        raise FileFormatError(f"{path}: it has no vectors of numbers; save the time and what rings")
    return Table(path, tuple(columns))


def _arrays(kind: str, content: bytes, strict: bool) -> dict[str, Any] | None:
    """Named arrays of a file of this ending, "" of one alone; None where it is a text."""
    file = io.BytesIO(content)
    if kind == ".npy":
        return {"": np.load(file, allow_pickle=False)}
    if kind == ".npz":
        with np.load(file, allow_pickle=False) as arrays:
            return dict(arrays)
    if kind != ".mat":
        return None
    from scipy.io import loadmat  # not at the top: it takes long to load

    try:
        values = loadmat(file, simplify_cells=not strict)
    except NotImplementedError:
        raise FileFormatError(
            "it is of MATLAB's version 7.3; save it by save(..., '-v7')"
        ) from None
    return {name: value for name, value in values.items() if not name.startswith("__")}


def _of_variables(values: Mapping[str, Any], strict: bool, front: str = "") -> list[Column]:
    """Vectors by name, a matrix by name and column (``X:2``), a structure by field (``a.b``)."""
    found: list[Column] = []
    for name, value in values.items():
        array = np.asarray(value)
        if isinstance(value, Mapping):
            found += _of_variables(value, strict, f"{front}{name}.")
        elif array.dtype.names:
            fields = {field: np.ravel(array[field]) for field in array.dtype.names}
            found += _of_variables(fields, strict, front)
        else:
            found += _of_array(front + name, array if strict else np.squeeze(array), strict)
    return found


def _of_array(name: str, values: NDArray[Any], strict: bool) -> list[Column]:
    if values.dtype.kind not in "fiu" or values.ndim not in (1, 2):
        return []
    if values.size < 2 and not strict:
        return []
    if values.ndim == 1:
        return [Column(name or "0", "", values.astype(float))]
    rows = values.T if values.shape[0] < values.shape[1] and not strict else values
    first = 0 if not name else 1  # MATLAB counts from 1
    return [
        Column(f"{name}:{k}" if name else str(k), "", column.astype(float))
        for k, column in enumerate(rows.T, first)
    ]


def _decode(content: bytes) -> str:
    utf16 = content[:2] in (b"\xff\xfe", b"\xfe\xff")
    for encoding in ("utf-16",) if utf16 else ("utf-8-sig", "cp1252"):
        with suppress(UnicodeDecodeError):
            text = content.decode(encoding)
            if "\0" not in text:
                return text
    raise FileFormatError("it is no text; give .npy, .npz and .mat files their ending")


def _of_text(content: bytes, strict: bool) -> list[Column]:
    """Columns of a text: separator, decimal mark, heading and units are found."""
    lines = [line.strip(" ") for line in _decode(content).splitlines()]
    filled = [k for k, line in enumerate(lines) if line.strip()]
    if not filled:
        raise FileFormatError("it is empty; give rows of numbers")
    data = [k for k in filled if lines[k].lstrip()[0] not in "#%"]
    head = [lines[k] for k in data[:_HEAD]]
    marks = [one for one in _SEPARATORS if one is None or any(one in line for line in head)]
    begins = {one: found for one in marks if (found := _begin(head, one, 1 if strict else 2))}
    if not begins:
        raise FileFormatError(
            f"no rows of numbers in it (its first line: {lines[filled[0]][:60]!r}); give columns "
            "of numbers, with semicolons between numbers with decimal commas"
        )
    separator = min(begins, key=lambda one: begins[one][:2])
    above, data = data[: begins[separator][2]], data[begins[separator][2] :]
    width = len(_cells(lines[data[0]], separator))
    before = [lines[k].lstrip(_MARKS) for k in filled if k < data[0]]
    heading = _heading(before, separator, width)
    if strict and above and not heading:
        raise FileFormatError(
            f"line {data[0] + 1} has {width} columns, the first "
            f"{len(_cells(lines[above[0]], separator))}; give as many in every line"
        )
    names, units = heading or ([str(k) for k in range(width)], [""] * width)
    return [
        Column(names[k].strip(), units[k], column)
        for k, column in _numbers([(k, lines[k]) for k in data], separator, width).items()
        if names[k].strip() or np.isfinite(column).any()
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


def _begin(lines: list[str], separator: str | None, least: int) -> tuple[int, int, int] | None:
    """Words and numbers, negative, in the first row of numbers, and which row that is.

    It is the first of several that have their words in the same places.
    """
    rows = [_cells(line, separator) for line in lines]
    words = [[bool(cell) and not _is_number(cell, separator) for cell in row] for row in rows]
    begin = 0
    for where, alike in groupby(words):
        count = len(list(alike))
        numbers = sum(map(bool, rows[begin + min(count, _LIKE) - 1])) - sum(where)
        if numbers >= least and (count >= _LIKE or begin + count == len(rows)):
            return sum(where), -numbers, begin
        begin += count
    return None


def _heading(
    before: list[str], separator: str | None, width: int
) -> tuple[list[str], list[str]] | None:
    """Names and units of the columns, of the last rows above them that have as many cells."""
    rows = [row for line in before if (row := _named(line, separator, width))]
    if len(rows) > 1 and all(is_unit(cell) for cell in rows[-1] if cell):
        return rows[-2], [cell.strip("()[]{} ") for cell in rows[-1]]
    return (rows[-1], [""] * width) if rows else None


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
) -> dict[int, Array]:
    """The columns' numbers, not a number where a cell is blank; without columns of words."""
    import pandas as pd  # not at the top: it takes half a second to load

    for k, line in rows:
        if separator and (count := line.count(separator)) >= width and '"' not in line:
            raise FileFormatError(
                f"line {k + 1} has {count + 1} columns, the first {width}; give as many in every "
                "line"
            )
    cells = pd.read_csv(
        io.StringIO("\n".join(line for _, line in rows)), sep=separator or r"\s+", header=None,
        names=range(width), index_col=False, dtype=str, skipinitialspace=True,
    )  # fmt: skip
    plain = cells if separator == "," else cells.apply(lambda text: text.str.replace(",", "."))
    numbers: Any = plain.apply(pd.to_numeric, errors="coerce")
    wrong = cells.notna() & numbers.isna()
    wrong = wrong.loc[:, wrong.mean() <= 0.5]
    if wrong.any(axis=None):
        row, column = np.argwhere(wrong.to_numpy())[0]
        raise FileFormatError(
            f"line {rows[row][0] + 1}: {cells[wrong.columns[column]].iloc[row]!r} is no number; "
            "mend it, or leave the cell empty"
        )
    return {k: numbers[k].to_numpy(float) for k in wrong.columns}
