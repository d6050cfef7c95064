"""How wide a table of Markdown is on a terminal."""

from __future__ import annotations

from itertools import zip_longest


def width_of_table(text: str) -> int:
    """Return how many columns of a terminal a table of Markdown takes."""
    heading, _, *rows = text.splitlines()
    cells = [[cell.strip() for cell in row.split("|")[1:-1]] for row in (heading, *rows)]
    beside = 2  # of each column: the room between it and the next
    return sum(max(map(len, column)) + beside for column in zip_longest(*cells, fillvalue=""))
