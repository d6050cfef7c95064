"""The tables of a document for a paper in LaTeX, with the rules of booktabs."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from quietarm.ocp.files import write_whole
from quietarm.studies.display.saving import File
from quietarm.studies.document.blocks import Block, Document, Section
from quietarm.studies.document.table import Table

_SPECIAL = {
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_",
    "{": r"\{", "}": r"\}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}",
    "<": r"\textless{}", ">": r"\textgreater{}",
}  # fmt: skip


def latex_file(path: Path | None, document: Document) -> File:
    """The file of a document's tables; none where there is no path."""
    return path, lambda place: write_whole(place, latex(document))


def latex(document: Document) -> str:
    """Every table of a document, for a text that loads booktabs."""
    return "\n".join(_table(table, of) for of, table in _tables(document.blocks))


def _tables(blocks: Sequence[Block], of: str = "") -> Iterator[tuple[str, Table]]:
    """The tables, each with the title of its section."""
    for block in blocks:
        if isinstance(block, Table):
            yield of, block
        elif isinstance(block, Section):
            yield from _tables(block.blocks, block.title)


def _table(table: Table, of: str) -> str:
    title = f"{table.title} ({of})" if of else table.title
    label = re.sub(r"\W+", "-", title).strip("-").lower()
    heads, *lines = table.lines
    rows = [" & ".join(map(_escaped, line)) + r" \\" for line in lines]
    columns = "l" + "r" * (len(heads) - 1)
    return "\n".join([
        r"\begin{table}", rf"\caption{{{_escaped(title)}}}", rf"\label{{tab:{label}}}",
        r"\centering",
        rf"\begin{{tabular}}{{{columns}}}", r"\toprule", " & ".join(map(_escaped, heads)) + r" \\",
        r"\midrule", *rows, r"\bottomrule", r"\end{tabular}", r"\end{table}", "",
    ])  # fmt: skip


def _escaped(text: str) -> str:
    return "".join(_SPECIAL.get(one, one) for one in text.strip())
