"""Answers as tables in a notebook."""

from collections.abc import Iterable
from html import escape


def to_html(rows: Iterable[Iterable[str]], head: Iterable[str] = ()) -> str:
    """A table in HTML, of rows of text."""
    cells = ["".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rows]
    first = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    lines = [first, *cells] if first else cells
    return f"<table>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>"
