"""Columns of numbers in texts of other programs, whatever separates and heads them."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence
from contextlib import suppress
from functools import partial
from itertools import groupby
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.tables.cells import is_clock, is_number, numbers_of, seconds_of
from quietarm.machine.tables.column_units import is_unit
from quietarm.ocp import FileFormatError
from quietarm.ocp.checks import quoted

Array = NDArray[np.float64]
_SEPARATORS = (";", "\t", ",", "|", None)
"""None is white space."""
_LIKE = 4
"""Rows that look alike are where the numbers begin."""
_MARKS = "#%!/ \t"
"""What a comment begins with, also where it names the columns."""
_HEAD = 2000
"""Lines in which the numbers have to begin."""


class TextColumns(NamedTuple):
    """Names, units and numbers of a text's columns, and names of those that hold words."""

    numbers: list[tuple[str, str, Array]]
    words: list[str]


def read_columns(content: bytes, strict: bool) -> TextColumns:
    """The columns of a text; separator, decimal mark and heading are found.

    A column of clock times is in seconds since its first row. A `strict` table has nothing but its
    heading above the numbers.
    """
    lines = [line.strip(" ") for line in _decode(content).splitlines()]
    filled = [k for k, line in enumerate(lines) if line.strip() and not _is_rule(line)]
    if not filled:
        raise FileFormatError("it is empty; give rows of numbers")
    data = [k for k in filled if lines[k].lstrip()[0] not in "#%"]
    head = [lines[k] for k in data[:_HEAD]]
    marks = [mark for mark in _SEPARATORS if mark is None or any(mark in line for line in head)]
    begins = dict[str | None, tuple[int, int, int]]()
    for least in (1,) if strict else (2, 1):  # one column where there is nothing wider
        if not begins:
            by_mark = {mark: _begin(head, mark, least) for mark in marks}
            begins = {mark: begin for mark, begin in by_mark.items() if begin}
    if not begins:
        raise FileFormatError(
            f"no rows of numbers in it (its first line: {quoted(lines[filled[0]][:60])}); give "
            "columns of numbers, with semicolons between numbers with decimal commas"
        )
    separator = min(begins, key=lambda mark: begins[mark][:2])
    above = data[: begins[separator][2]]
    data = data[begins[separator][2] :]
    first_row = _cells(lines[data[0]], separator)
    width = len(first_row)
    before = [lines[k].lstrip(_MARKS) for k in filled if k < data[0]]
    heading = _heading(before, separator, first_row, strict)
    if strict and above and not heading:
        raise FileFormatError(
            f"line {data[0] + 1} has {width} columns, the first "
            f"{len(_cells(lines[above[0]], separator))}; give as many in every line"
        )
    names, units = heading or ([str(k) for k in range(width)], [""] * width)
    columns = _numbers([(k, lines[k]) for k in data], separator, len(names))
    numbers = [
        (names[k].strip(), unit or units[k], column)
        for k, (unit, column) in columns.items()
        if names[k].strip() or np.isfinite(column).any()
    ]
    words = [names[k].strip() for k in range(len(names)) if k not in columns]
    return TextColumns(numbers, [name for name in words if name])


def _is_rule(line: str) -> bool:
    """Return whether a line only separates a heading from its rows, as |---|:--:| does."""
    return "--" in line and not line.strip("-|+:= \t")


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
    plain = _without_frame(line, separator)
    return [cell.strip() for cell in next(csv.reader([plain], delimiter=separator), [])]


def _without_frame(line: str, separator: str | None) -> str:
    """A line of a table that has bars at both ends, without these."""
    framed = separator == "|" and len(line) > 1 and line[0] == line[-1] == "|"
    return line[1:-1] if framed else line


def _begin(lines: list[str], separator: str | None, least: int) -> tuple[int, int, int] | None:
    """Words and numbers, negative, in the first row of numbers, and which row that is.

    It is the first of several that have their words in the same places.
    """
    rows = [_cells(line, separator) for line in lines]
    words = [[bool(cell) and not _is_value(cell) for cell in row] for row in rows]
    begin = 0
    for where, alike in groupby(words):
        count = len(list(alike))
        numbers = sum(map(bool, rows[begin + min(count, _LIKE) - 1])) - sum(where)
        if numbers >= least and (count >= _LIKE or begin + count == len(rows)):
            return sum(where), -numbers, begin
        begin += count
    return None


def _is_value(cell: str) -> bool:
    return is_number(cell) or is_clock(cell)


def _heading(
    before: list[str], separator: str | None, first_row: list[str], strict: bool
) -> tuple[list[str], list[str]] | None:
    """Names and units of the columns, of the last rows above them that have as many cells.

    The row just above the numbers may name one more, whose cells are empty: a comment. Not so in a
    `strict` table.
    """
    rows = [row for line in before if (row := _named(line, separator, first_row))]
    if before and separator is not None and not strict:
        nearest_row = _cells(before[-1], separator)
        if len(nearest_row) == len(first_row) + 1 and all(nearest_row) and _has_words(nearest_row):
            return nearest_row, [""] * len(nearest_row)
    if len(rows) > 1 and all(is_unit(cell) for cell in rows[-1] if cell):
        return rows[-2], [cell.strip("()[]{} ") for cell in rows[-1]]
    return (rows[-1], [""] * len(first_row)) if rows else None


def _named(line: str, separator: str | None, first_row: list[str]) -> list[str] | None:
    """The cells of a line that may name the columns: as many, and not all of them numbers.

    One may be missing: that of rows with a mark at their end, or of rows that are numbered.
    """
    width = len(first_row)
    splits = _splits(line, separator)
    for cells in splits:
        if len(cells) == width and _has_words(cells):
            return cells
    for cells in splits[:2]:
        if len(cells) + 1 == width and _has_words(cells):
            return ["", *cells] if first_row[-1] else [*cells, ""]
    return None


def _splits(line: str, separator: str | None) -> list[list[str]]:
    """The ways in which a line may be cells: as the rows are, or as people write headings.

    Above columns of white space names may have spaces of their own, a unit in brackets, or another
    separator.
    """
    splits = [_cells(line, separator)]
    if separator is None:
        plain = line.strip()
        splits.append(re.split(r"\s{2,}|\t", plain))
        splits += [_cells(plain, mark) for mark in _SEPARATORS if mark and mark in plain]
        splits.append(re.split(r"\s+(?![(\[{])(?![^(\[{]*[)\]}])", plain))
        splits.append(re.findall(r"[^\s(\[{][^(\[{]*[(\[{][^)\]}]*[)\]}]", plain))
    return splits


def _has_words(cells: list[str]) -> bool:
    return not all(_is_value(cell) for cell in cells if cell)


def _numbers(
    rows: Sequence[tuple[int, str]], separator: str | None, width: int
) -> dict[int, tuple[str, Array]]:
    """The columns' units and numbers, not a number where a cell is blank; without those of words.

    A unit is known of clock times alone: seconds.
    """
    import pandas as pd  # not at the top: it takes half a second to load

    for k, line in rows:
        count = _without_frame(line, separator).count(separator) if separator else 0
        if count >= width and '"' not in line:
            raise FileFormatError(
                f"line {k + 1} has {count + 1} columns, the first {width}; give as many in every "
                "line"
            )
    text = "\n".join(_without_frame(line, separator) for _, line in rows)
    read: Any = partial(
        pd.read_csv, sep=separator or r"\s+", header=None, names=range(width), index_col=False,
        skipinitialspace=True,
    )  # fmt: skip
    with suppress(ValueError):  # plain numbers: that is fast
        plain = read(io.StringIO(text), dtype=float)
        return {k: ("", plain[k].to_numpy(float)) for k in plain}
    cells: Any = read(io.StringIO(text), dtype=str)
    filled = cells.notna()
    clocks = [k for k in cells if filled[k].any() and is_clock(cells[k][filled[k].idxmax()])]
    numbers: Any = numbers_of(cells.drop(columns=clocks))
    numbers = numbers.join(cells[clocks].apply(seconds_of))[list(cells)]
    wrong = filled & numbers.isna()
    wrong = wrong.loc[:, wrong.sum() <= 0.5 * filled.sum()]
    if wrong.any(axis=None):
        row, column = np.argwhere(wrong.to_numpy())[0]
        raise FileFormatError(
            f"line {rows[row][0] + 1}: {quoted(cells[wrong.columns[column]].iloc[row])} is no "
            "number; mend it, or leave the cell empty"
        )
    return {k: ("s" if k in clocks else "", numbers[k].to_numpy(float)) for k in wrong.columns}
