"""Tables of words that a phone shows as rows below each other.

Beside each other two columns of words do not fit on a phone, and who scrolls to the last one no
longer sees the first. There every cell of such a table stands on a line of its own, behind the
heading of its column. Tables of numbers stay as they are, since their columns are compared.
"""

from __future__ import annotations

import re
from html import escape, unescape
from typing import Any

from sphinx.application import Sphinx

_TABLE = re.compile(r'<table class="docutils\b[^"]*">.*?</table>', re.DOTALL)
_ROW = re.compile(r"<tr\b.*?</tr>", re.DOTALL)
_CELL = re.compile(r"<(?P<tag>t[dh])\b(?P<attributes>[^>]*)>(?P<content>.*?)</(?P=tag)>", re.DOTALL)
_NUMBER = re.compile(r"[-+]?[\d.]")
_RIGHT = "text-right"
"""Of a column of numbers, as its page says."""
SIDE_BY_SIDE = 36
"""Letters of a row that fit beside each other on a phone."""


def stack_tables(body: str) -> str:
    """A page whose tables of words have the class and the labels that the style sheet stacks."""
    return _TABLE.sub(lambda table: _stacked(table[0]) if has_words(table[0]) else table[0], body)


def has_words(table: str) -> bool:
    """Whether a table has words, and more of them in a row than fit on a phone."""
    _, *rows = [
        [_text(cell["content"]) for cell in _CELL.finditer(row)] for row in _ROW.findall(table)
    ]
    beside = [text for row in rows for text in row[1:] if text]
    numbers = sum(bool(_NUMBER.match(text)) for text in beside)
    sentence = 6  # words
    of_words = 2 * numbers < len(beside) or any(len(text.split()) >= sentence for text in beside)
    longest = max((sum(map(len, row)) for row in rows), default=0)
    return longest > SIDE_BY_SIDE and _RIGHT not in table and of_words


def _stacked(table: str) -> str:
    head, *rows = _ROW.findall(table)
    labels = [_text(cell["content"]) for cell in _CELL.finditer(head)]
    for row in rows:
        table = table.replace(row, _with_labels(row, labels), 1)
    return table.replace('class="docutils', 'class="stacked docutils', 1)


def _with_labels(row: str, labels: list[str]) -> str:
    waiting = iter(labels)
    return _CELL.sub(lambda cell: _labelled(cell, next(waiting)), row)


def _labelled(cell: re.Match[str], label: str) -> str:
    said = f' data-label="{escape(label)}"' if label and _text(cell["content"]) else ""
    return f"<{cell['tag']}{cell['attributes']}{said}>{cell['content']}</{cell['tag']}>"


def _text(content: str) -> str:
    return unescape(" ".join(re.sub(r"<[^>]*>", "", content).split()))


def _on_page(app: Sphinx, page: str, template: str, context: dict[str, Any], tree: Any) -> None:
    if body := context.get("body"):
        context["body"] = stack_tables(body)


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect with Sphinx."""
    app.connect("html-page-context", _on_page)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
