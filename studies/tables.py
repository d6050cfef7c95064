"""Tables that read the same on screen, in Markdown and in CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from rich import box
from rich.table import Table as ScreenTable
from rich.text import Text

Cell = str | int | float | None


@dataclass(frozen=True)
class Column:
    """A column: its heading (with the unit), how its numbers are written, its name in CSV."""

    heading: str
    show: Callable[[float], str] = "{:.4g}".format
    key: str = ""

    def text(self, cell: Cell) -> str:
        """A cell for people; a dash where there is nothing."""
        if cell is None:
            return "-"
        return self.show(cell) if isinstance(cell, float) else str(cell)


@dataclass(frozen=True)
class Table:
    """Rows of cells under columns; CSV keeps every digit, the other forms are for people.

    For people a row stands upright, beside the others: a table has few rows and many quantities,
    and so fits a narrow terminal. The first column names the rows; empty ones are left out.
    """

    title: str
    columns: Sequence[Column]
    rows: Sequence[Sequence[Cell]]

    def for_screen(self) -> ScreenTable:
        """The table for rich's console."""
        table = ScreenTable(title=self.title, title_justify="left", box=box.SIMPLE_HEAD)
        heading, *lines = self.upright()
        table.add_column(Text(heading[0]), no_wrap=True)
        for name in heading[1:]:
            table.add_column(Text(name), justify="right")
        for line in lines:
            table.add_row(*(Text(cell) for cell in line))  # Text: a unit in brackets is no markup
        return table

    def markdown(self) -> str:
        """The table in Markdown, with its title above it."""
        heading, *lines = self.upright()
        rule = ["---", *["---:"] * (len(heading) - 1)]
        rows = [_line(line) for line in (heading, rule, *lines)]
        return "\n".join([f"**{self.title}**", "", *rows]) + "\n"

    def csv(self) -> str:
        """The table as comma-separated values, a row a line, numbers in full."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow([column.key or column.heading for column in self.columns])
        writer.writerows([["" if cell is None else cell for cell in row] for row in self.rows])
        return text.getvalue()

    def upright(self) -> list[list[str]]:
        """The table as people read it: a line a quantity, its heading first; the names on top."""
        return [
            [column.heading, *(column.text(row[i]) for row in self.rows)]
            for i, column in enumerate(self.columns)
            if any(row[i] is not None for row in self.rows)
        ]


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cell.replace('|', '/') for cell in cells)} |"
