"""Terms of the glossary as links where they first stand on a page.

The glossary is docs/glossary.md: the first column of its tables, a row for each meaning. Its rows
get anchors, and on every other page of prose the first words of a row become a link to it.
Headings, code, formulas and what is a link already are left alone.
"""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx

GLOSSARY = "docs/glossary"
NO_PROSE = ("docs/glossary", "docs/reference", "docs/commands", "CHANGELOG")
"""Pages without links: the glossary, lists that are generated, and the history."""
LEFT_ALONE = (
    nodes.literal,
    nodes.literal_block,
    nodes.title,
    nodes.rubric,
    nodes.reference,
    nodes.raw,
    nodes.math,
    nodes.math_block,
    nodes.image,
    addnodes.desc_signature,
    addnodes.toctree,
)


@cache
def rows_of_terms(glossary: Path) -> tuple[tuple[str, ...], ...]:
    """Terms of every row of the glossary's tables, as they stand in its first column."""
    rows = re.findall(
        r"^\| (?!term \|)([^|]*[^-|\s][^|]*) \|", glossary.read_text("utf-8"), re.MULTILINE
    )
    return tuple(tuple(row.replace("**", "").split(", ")) for row in rows)


def anchor_of(terms: tuple[str, ...]) -> str:
    """Anchor of a row of the glossary."""
    return "term-" + re.sub(r"[^a-z0-9]+", "-", terms[0].lower()).strip("-")


def pattern_of(terms: tuple[str, ...]) -> re.Pattern[str]:
    """Where one of a row's terms stands in a text, in the singular or the plural."""
    longest_first = sorted(terms, key=len, reverse=True)
    alternatives = "|".join(re.escape(term).replace(r"\ ", r"\s+") for term in longest_first)
    return re.compile(rf"(?<![\w-])(?:{alternatives})s?(?![\w-])", re.IGNORECASE)


def link_terms(app: Sphinx, doctree: nodes.document, page: str) -> None:
    """Put links into a page, or anchors into the glossary."""
    rows = rows_of_terms(Path(app.srcdir) / f"{GLOSSARY}.md")
    if page == GLOSSARY:
        _put_anchors(doctree, rows)
    elif not page.startswith(NO_PROSE):
        address = app.builder.get_relative_uri(page, GLOSSARY)
        waiting = {f"{address}#{anchor_of(terms)}": pattern_of(terms) for terms in rows}
        for text in list(doctree.findall(nodes.Text)):
            if not _is_left_alone(text):
                _link_first(text, waiting)


def _put_anchors(doctree: nodes.document, rows: tuple[tuple[str, ...], ...]) -> None:
    anchors = {", ".join(terms): anchor_of(terms) for terms in rows}
    for row in doctree.findall(nodes.row):
        cell = row[0]
        assert isinstance(cell, nodes.entry)
        if anchor := anchors.get(cell.astext()):
            cell["ids"].append(anchor)


def _is_left_alone(text: nodes.Text) -> bool:
    node = text.parent
    while node is not None:
        if isinstance(node, LEFT_ALONE):
            return True
        node = node.parent
    return False


def _link_first(text: nodes.Text, waiting: dict[str, re.Pattern[str]]) -> None:
    """Make links of terms in a text that no text before it has; they wait no longer."""
    words = text.astext()
    links = list[tuple[int, int, str]]()
    for address, pattern in list(waiting.items()):
        match = pattern.search(words)
        if match and not any(
            match.start() < end and start < match.end() for start, end, _ in links
        ):
            links.append((*match.span(), address))
            del waiting[address]
    if not links:
        return
    pieces = list[nodes.Node]()
    end = 0
    for start, next_end, address in sorted(links):
        pieces.append(nodes.Text(words[end:start]))
        term = words[start:next_end]
        pieces.append(nodes.reference("", term, refuri=address, internal=True, classes=["term"]))
        end = next_end
    pieces.append(nodes.Text(words[end:]))
    text.parent.replace(text, [piece for piece in pieces if piece.astext()])


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect with Sphinx."""
    app.connect("doctree-resolved", link_terms)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
