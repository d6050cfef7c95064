"""Documents as files: Markdown with its pictures beside it, or a page of HTML that stands alone."""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from quietarm.ocp.files import write_whole
from quietarm.studies.display.saving import File, drawing, inside
from quietarm.studies.document.blocks import (
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
from quietarm.studies.document.table import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def document_files(folder: Path | None, document: Document) -> list[File]:
    """The report, a CSV file for each table of its data, and its pictures; what writes each."""
    writes: dict[str, Callable[[Path], object]] = {
        "report.md": lambda path: write_whole(path, markdown(document))
    }
    writes |= {f"{name}.csv": table.save_csv for name, table in document.data.items()}
    writes |= {picture.name: drawing(picture.draw) for picture in document.pictures}
    return inside(folder, writes)


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
        case Verdict(claim, _, evidence):
            return [f"{'#' * level} {claim} **{block.word.capitalize()}.**", _bullets(evidence)]
        case Section(title, inner):
            return [f"{'#' * level} {title}", *_blocks(inner, level + 1)]
        case Table():
            return [table_in_markdown(block)]
        case _:
            return []  # contents: readers of Markdown make their own


def _bullets(lines: Sequence[str]) -> str:
    return "\n".join(f"- {line}" for line in lines)


def page(document: Document) -> str:
    """The document as a page, which is well-formed XML as well."""
    from quietarm.studies.display.templates import templates

    pages = templates(autoescape=True)
    pages.filters.update(kind=lambda block: type(block).__name__, svg=_svg, anchor=_anchor)
    return pages.get_template("document/page.html").render(document=document) + "\n"


def _anchor(title: str) -> str:
    """A title as the name that links go to."""
    return re.sub(r"\W+", "-", title)


def _svg(figure: Figure) -> str:
    """A picture as an address that holds it."""
    from quietarm.studies.display.pictures import as_written

    content = io.BytesIO()
    with as_written(figure):
        figure.savefig(content, format="svg", metadata={"Date": None})
    return f"data:image/svg+xml;base64,{base64.b64encode(content.getvalue()).decode()}"
