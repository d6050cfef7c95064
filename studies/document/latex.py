"""The tables of a document for a paper in LaTeX, with the rules of booktabs."""

from __future__ import annotations

from pathlib import Path

from quietarm.ocp.files import write_whole
from quietarm.studies.display.saving import File
from quietarm.studies.document.blocks import Document
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
    return "\n".join(map(_table, document.tables))


def _table(table: Table) -> str:
    heads, *lines = table.lines
    rows = [" & ".join(map(_escaped, line)) + r" \\" for line in lines]
    columns = "l" + "r" * (len(heads) - 1)
    return "\n".join([
        r"\begin{table}", rf"\caption{{{_escaped(table.title)}}}", r"\centering",
        rf"\begin{{tabular}}{{{columns}}}", r"\toprule", " & ".join(map(_escaped, heads)) + r" \\",
        r"\midrule", *rows, r"\bottomrule", r"\end{tabular}", r"\end{table}", "",
    ])  # fmt: skip


def _escaped(text: str) -> str:
    return "".join(_SPECIAL.get(one, one) for one in text.strip())
