"""Tables: rows of cells under columns, with every digit in CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from quietarm.ocp.files import write_whole

Cell = str | int | float | None
_PLAIN = "{:.4g}"


@dataclass(frozen=True)
class Column:
    """A column: its heading (with the unit), how its numbers are written, its name in CSV."""

    heading: str
    form: Callable[[float], str] = _PLAIN.format
    key: str = ""

    def text(self, cell: Cell) -> str:
        """A cell as it is shown; a dash where it is empty."""
        if cell is None:
            return "-"
        return self.form(cell) if isinstance(cell, float) else str(cell)


@dataclass(frozen=True)
class Table:
    """Rows of cells under columns; CSV keeps every digit, for people they are rounded.

    There are few rows and many quantities, so for people the table is turned to fit a narrow
    terminal: each column becomes a line. The first column names the rows; columns that are empty
    are left out.
    """

    title: str
    columns: Sequence[Column]
    rows: Sequence[Sequence[Cell]]

    @property
    def lines(self) -> list[list[str]]:
        """The table turned, as text: one line for each quantity, the names of the rows on top."""
        return [
            [column.heading, *(column.text(row[i]) for row in self.rows)]
            for i, column in enumerate(self.columns)
            if i == 0 or any(row[i] is not None for row in self.rows)
        ]

    def turned(self) -> Table:
        """The table with rows and columns exchanged, as it is shown."""
        first, *others = self.columns
        heads = [Column(first.heading), *(Column(str(row[0])) for row in self.rows)]
        rows = [
            [c.heading.strip(), *(row[i] for row in self.rows)] for i, c in enumerate(others, 1)
        ]
        return Table(self.title, heads, rows)

    def csv(self) -> str:
        """The table as comma-separated values, one line for each row, with every digit."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow([column.key or column.heading for column in self.columns])
        writer.writerows([["" if cell is None else cell for cell in row] for row in self.rows])
        return text.getvalue()

    def save_csv(self, path: Path) -> None:
        """Write the table as CSV, whole or not at all."""
        write_whole(path, self.csv())


Line = tuple[str, str, Sequence[Cell]]
"""A heading, how numbers are written under it (empty: as by `Column`), and the cells."""


def table_of(title: str, columns: Sequence[Line]) -> Table:
    """A table given column by column; numbers that are not finite stay empty."""
    cells = [[_if_finite(cell) for cell in cells] for *_, cells in columns]
    headings = [Column(heading, (form or _PLAIN).format) for heading, form, _ in columns]
    return Table(title, headings, list(zip(*cells, strict=True)))


def _if_finite(cell: Cell) -> Cell:
    return None if isinstance(cell, float) and not isfinite(cell) else cell
