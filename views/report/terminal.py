"""Lines, facts and reports on a terminal, however narrow."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table
from rich.text import Text

from quietarm.ocp.escapes import one_line, printable
from quietarm.views.report.table_width import width_of_table

if TYPE_CHECKING:
    from quietarm.views.report.report import Report


def show_all(console: Console, *parts: Report | Sequence[tuple[str, str]] | str) -> None:
    """Print reports, facts and lines, one below the other; empty ones are left out."""
    for part in filter(None, parts):
        if isinstance(part, str):
            print_lines(console, part)
        elif isinstance(part, Sequence):
            show_facts(console, part)
        else:
            show(console, part)


def print_lines(console: Console, *lines: str) -> None:
    """Print lines as they are, however narrow the console; a line stays one, whatever is in it."""
    text = "\n".join(one_line(line) if line.strip() else "" for line in lines)
    console.print(text, markup=False, highlight=False, soft_wrap=True)


def show_facts(console: Console, rows: Sequence[tuple[str, str]]) -> None:
    """Print names and values in two columns, or one below the other on a narrow console."""
    # least width of the column of values; below it they would be broken up
    least_value = 30
    rows = [(one_line(name), one_line(value)) for name, value in rows]
    if console.width < max(len(name) for name, _ in rows) + least_value:
        for name, value in rows:
            print_lines(console, name, f"  {value}")
        return
    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_column(style="bold", no_wrap=True)
    table.add_column(overflow="fold")
    for name, value in rows:
        table.add_row(Text(name), Text(value))
    console.print(table)


def show(console: Console, report: Report) -> None:
    """Print a report without its pictures; in a pipe its tables are as wide as they need."""
    from rich.markdown import Markdown  # not at the top: it takes long to load

    text = printable(report.markdown())
    lines = [line for line in text.splitlines() if not line.startswith("![")]
    if not console.is_terminal:
        console = Console(file=console.file, width=max(console.width, _widest_table(lines)))
    console.print(Markdown("\n".join(lines)))


def _widest_table(lines: Sequence[str]) -> int:
    """The width of the widest table of Markdown in lines, 0 if there is none."""
    widest = 0
    for is_table, rows in groupby(lines, key=lambda line: line.startswith("|")):
        if is_table:
            widest = max(widest, width_of_table("\n".join(rows)))
    return widest
