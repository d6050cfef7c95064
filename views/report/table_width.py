"""The width of Markdown tables on a terminal; a table that is too wide is cut into several."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import zip_longest


def width_of_table(text: str) -> int:
    """Return how many columns of a terminal a table of Markdown takes."""
    heading, _, *rows = text.splitlines()
    cells = [[cell.strip() for cell in _cells(row)] for row in (heading, *rows)]
    beside = 2  # of each column: the room between it and the next
    return sum(max(map(len, column)) + beside for column in zip_longest(*cells, fillvalue=""))


def narrow_tables(lines: Sequence[str], width: int) -> list[str]:
    """Return a table's lines as tables that fit into a width, each with the first column.

    One of two columns may still be wider.
    """
    if width_of_table("\n".join(lines)) <= width:
        return [*lines]
    first, *columns = zip(*map(_cells, lines))
    parts = list[list[tuple[str, ...]]]()
    for column in columns:
        wider = [*(parts[-1] if parts else []), column]
        if parts and width_of_table("\n".join(_rows([first, *wider]))) <= width:
            parts[-1] = wider
        else:
            parts.append([column])
    return [line for part in parts for line in (*_rows([first, *part]), "")]


def _cells(row: str) -> list[str]:
    """Return the cells of a row; a bar behind a backslash is a letter."""
    return re.split(r"(?<!\\)\|", row)[1:-1]


def _rows(columns: Sequence[Sequence[str]]) -> list[str]:
    return [f"|{'|'.join(cells)}|" for cells in zip(*columns)]
