"""Lines, facts and reports on a terminal, however narrow."""

from __future__ import annotations

import os
import re
import textwrap
from collections.abc import Sequence
from contextlib import suppress
from itertools import groupby
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table
from rich.text import Text

from quietarm.ocp.escapes import one_line, printable
from quietarm.views.report.table_width import narrow_tables

if TYPE_CHECKING:
    from quietarm.views.report.report import Report

LEAST_WIDTH = 100
"""Columns that a sentence may take, however narrow the console."""


class ErrorConsole(Console):
    """Standard error, for progress and warnings: the work goes on when its reader has gone."""

    def __init__(self, *, quiet: bool = False) -> None:
        super().__init__(stderr=True, quiet=quiet)

    def on_broken_pipe(self) -> None:
        """Say nothing more, here or elsewhere; rich's own ends the process."""
        self.quiet = True
        with suppress(OSError, ValueError):  # a stream of Python's alone has no number
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, self.file.fileno())
            os.close(nowhere)


def show_all(console: Console, *parts: Report | Sequence[tuple[str, str]] | str) -> None:
    """Print reports, facts and lines, one below the other; empty ones are left out.

    Nothing is wider than the console, or than a hundred columns where that is narrower, so that
    the first line is whole: a line that would be goes on in the next one, indented.
    """
    for part in filter(None, parts):
        if isinstance(part, str):
            print_lines(console, *wrapped(part, max(console.width, LEAST_WIDTH)))
        elif isinstance(part, Sequence):
            show_facts(console, part)
        else:
            show(console, part)


def print_lines(console: Console, *lines: str) -> None:
    """Print lines as they are, however narrow the console; a line stays one, whatever is in it."""
    text = "\n".join(one_line(line) if line.strip() else "" for line in lines)
    console.print(text, markup=False, highlight=False, soft_wrap=True)


def wrapped(line: str, width: int) -> list[str]:
    """Return a line in pieces that fit into a width, broken between words alone."""
    text = one_line(line) if line.strip() else ""
    if len(text) <= width:
        return [text]
    indent = " " * (len(text) - len(text.lstrip(" ")))
    return textwrap.wrap(
        text,
        width,
        subsequent_indent=f"{indent}  ",
        break_long_words=False,
        break_on_hyphens=False,
    )


def in_clauses(answer: str, width: int) -> list[str]:
    """Return an answer in lines that fit into a width, broken behind its clauses if it can be.

    So the first line is whole by itself.
    """
    lines = [""]
    for clause in re.split(r"(?<=;) ", one_line(answer)):
        longer = f"{lines[-1]} {clause}".strip()
        if lines[-1] and len(longer) > width:
            lines.append(clause)
        else:
            lines[-1] = longer
    return [piece for line in lines for piece in wrapped(line, width)]


def show_facts(console: Console, rows: Sequence[tuple[str, str]]) -> None:
    """Print names and values in two columns, or one below the other on a narrow console."""
    # least width of the column of values; below it they would be broken up
    least_value = 30
    rows = [(one_line(name), one_line(value)) for name, value in rows]
    if console.width < max(len(name) for name, _ in rows) + least_value:
        for name, value in rows:
            print_lines(console, name, *wrapped(f"  {value}", max(console.width, LEAST_WIDTH)))
        return
    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_column(style="bold", no_wrap=True)
    table.add_column(overflow="fold")
    for name, value in rows:
        table.add_row(Text(name), Text(value))
    console.print(table)


EXPLANATION = "## How to read it\n"
"""The heading of what a report explains, which is in its files alone."""
EXPLAINED = (
    "Less is better in hypervolume gap, IGD+ and additive epsilon; --output FOLDER explains them.\n"
)


def show(console: Console, report: Report) -> None:
    """Print a report without its pictures: the answer, then the page without how to read it.

    A table that is wider than the console becomes several, one below the other.
    """
    from rich.markdown import Markdown  # not at the top: it takes long to load

    if report.answer:
        print_lines(console, *in_clauses(report.answer, max(console.width, LEAST_WIDTH)))
    text, explained, _ = printable(report.markdown(with_answer=False)).partition(EXPLANATION)
    text += EXPLAINED if explained else ""
    lines = [line for line in text.splitlines() if not line.startswith("![")]
    console.print(Markdown("\n".join(_narrowed(lines, console.width))))


def _narrowed(lines: Sequence[str], width: int) -> list[str]:
    """Return lines of Markdown whose tables fit into a width, as far as two columns do."""
    narrow = list[str]()
    for is_table, rows in groupby(lines, key=lambda line: line.startswith("|")):
        block = list(rows)
        narrow += narrow_tables(block, width) if is_table else block
    return narrow
