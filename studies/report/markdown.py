"""Documents as Markdown."""

from __future__ import annotations

from collections.abc import Sequence

from quietarm.studies.report.document import (
    Block,
    Bullets,
    Document,
    Facts,
    Grid,
    Lines,
    Picture,
    Section,
    Text,
    Verdict,
)
from quietarm.studies.report.table import Table


def markdown(document: Document) -> str:
    """The document as Markdown, whose pictures lie beside it."""
    return "\n\n".join([f"# {document.title}", *_blocks(document.blocks, level=2)]) + "\n"


def table_in_markdown(table: Table) -> str:
    """A table with its title above it."""
    heading, *lines = table.lines
    rule = ["---", *["---:"] * (len(heading) - 1)]
    rows = [
        f"| {' | '.join(cell.replace('|', '/') for cell in line)} |"
        for line in (heading, rule, *lines)
    ]
    return "\n".join([*([f"**{table.title}**", ""] if table.title else []), *rows])


def _blocks(blocks: Sequence[Block], level: int) -> list[str]:
    return [part for block in blocks for part in _block(block, level)]


def _block(block: Block, level: int) -> list[str]:
    match block:
        case Text(words):
            return [words]
        case Bullets(lines):
            return [_bullets(lines)] if lines else []
        case Facts(rows):
            return [_bullets([f"{name}: {value}" for name, value in rows])]
        case Lines(lines):
            return ["\n".join(["```", *lines, "```"])]
        case Picture(name, _, caption, alternative):
            return [f"![{alternative or caption}]({name})"]
        case Grid(pictures):
            return _blocks(pictures, level)
        case Verdict(claim, word, _, evidence):
            return [f"{'#' * level} {claim} **{word.capitalize()}.**", _bullets(evidence)]
        case Section(title, inner):
            return [f"{'#' * level} {title}", *_blocks(inner, level + 1)]
        case Table():
            return [table_in_markdown(block)]
        case _:
            return []  # contents: readers of Markdown make their own


def _bullets(lines: Sequence[str]) -> str:
    return "\n".join(f"- {line}" for line in lines)
