"""Tables for the screen, Markdown and CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from quietarm.ocp.base.files import write_whole
from quietarm.studies.display.words import print_lines
from rich import box
from rich.console import Console
from rich.table import Table as ScreenTable
from rich.text import Text

Cell = str | int | float | None
_WIDEST = 10_000
_LEAST_VALUE = 30
"""Least width of the column of values; below it they would be broken up."""


@dataclass(frozen=True)
class Column:
    """A column: its heading (with the unit), how its numbers are written, its name in CSV."""

    heading: str
    form: Callable[[float], str] = "{:.4g}".format
    key: str = ""

    def text(self, cell: Cell) -> str:
        """A cell as it is shown; a dash where it is empty."""
        if cell is None:
            return "-"
        return self.form(cell) if isinstance(cell, float) else str(cell)


@dataclass(frozen=True)
class Table:
    """Rows of cells under columns; CSV keeps every digit, the other forms are rounded.

    On screen and in Markdown the table is turned: each column becomes a line. There are few rows
    and many quantities, so it fits a narrow terminal. The first column names the rows; columns
    that are empty are left out.
    """

    title: str
    columns: Sequence[Column]
    rows: Sequence[Sequence[Cell]]

    def for_screen(self, *, narrow: bool = False) -> ScreenTable:
        """The table for rich's console; a narrow one breaks headings between all words."""
        table = ScreenTable(title=self.title, title_justify="left", box=box.SIMPLE_HEAD)
        heading, *lines = self.upright()
        table.add_column(Text(heading[0]), no_wrap=True)
        for i, name in enumerate(heading[1:], start=1):
            parts = [*name.split(), *(line[i] for line in lines)]
            width = max(map(len, parts), default=1) if narrow else None
            table.add_column(Text(name), justify="right", width=width)
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
        """The table as comma-separated values, one line for each row, with every digit."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow([column.key or column.heading for column in self.columns])
        writer.writerows([["" if cell is None else cell for cell in row] for row in self.rows])
        return text.getvalue()

    def save_csv(self, path: Path) -> None:
        """Write the table as CSV, whole or not at all."""
        write_whole(path, self.csv())

    def turned(self) -> Table:
        """The table with rows and columns exchanged, as it is shown."""
        first, *others = self.columns
        heads = [Column(first.heading), *(Column(str(row[0])) for row in self.rows)]
        rows = [
            [c.heading.strip(), *(row[i] for row in self.rows)] for i, c in enumerate(others, 1)
        ]
        return Table(self.title, heads, rows)

    def upright(self) -> list[list[str]]:
        """The table turned: one line for each quantity, its heading first; the names on top."""
        return [
            [column.heading, *(column.text(row[i]) for row in self.rows)]
            for i, column in enumerate(self.columns)
            if any(row[i] is not None for row in self.rows)
        ]


def print_rows(console: Console, rows: Sequence[tuple[str, str]]) -> None:
    """Print names and their values in two columns, or one below the other on a narrow console."""
    if console.width < max(len(name) for name, _ in rows) + _LEAST_VALUE:
        for name, value in rows:
            print_lines(console, name, f"  {value}")
        return
    table = ScreenTable(box=None, show_header=False, pad_edge=False)
    table.add_column(style="bold", no_wrap=True)
    table.add_column(overflow="fold")
    for name, value in rows:
        table.add_row(Text(name), Text(value))
    console.print(table)


def print_table(console: Console, table: Table) -> None:
    """Print a table, in pieces below each other where the console is too narrow for it."""
    wide = console.options.update(max_width=_WIDEST)
    if console.measure(table.for_screen(), options=wide).maximum <= console.width:
        console.print(table.for_screen())
        return
    rows = list(table.rows)
    while rows:
        count = len(rows)
        piece = replace(table, rows=rows).for_screen(narrow=True)
        while console.measure(piece, options=wide).maximum > console.width and count > 1:
            count -= 1
            piece = replace(table, rows=rows[:count]).for_screen(narrow=True)
        if console.measure(piece, options=wide).maximum > console.width:
            lines = replace(table, rows=rows[:count]).upright()
            print_lines(console, table.title, *(f"  {name}: {text}" for name, text in lines))
        else:
            console.print(piece)
        rows = rows[count:]


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cell.replace('|', '/') for cell in cells)} |"
