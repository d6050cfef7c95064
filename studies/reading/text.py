"""Columns of numbers in texts of other programs, whatever separates and heads them."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence
from contextlib import suppress
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp import FileFormatError
from quietarm.studies.reading.units import is_unit

Array = NDArray[np.float64]
_SEPARATORS = (";", "\t", ",", None)
"""None is white space."""
_LIKE = 4
"""Rows that look alike are where the numbers begin."""
_MARKS = "#%!/ \t"
"""What a comment begins with, also where it names the columns."""
_HEAD = 2000
"""Lines in which the numbers have to begin."""


def read_text(content: bytes, strict: bool) -> list[tuple[str, str, Array]]:
    """Names, units and numbers of a text's columns; separator, decimal mark and heading are found.

    A `strict` table has nothing but its heading above the numbers, and may be one column.
    """
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
        (names[k].strip(), units[k], column)
        for k, column in _numbers([(k, lines[k]) for k in data], separator, width).items()
        if names[k].strip() or np.isfinite(column).any()
    ]


def _decode(content: bytes) -> str:
    utf16 = content[:2] in (b"\xff\xfe", b"\xfe\xff")
    for encoding in ("utf-16",) if utf16 else ("utf-8-sig", "cp1252"):
        with suppress(UnicodeDecodeError):
            text = content.decode(encoding)
            if "\0" not in text:
                return text
    raise FileFormatError("it is no text; give .npy, .npz and .mat files their ending")


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
