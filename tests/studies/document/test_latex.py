"""Tables as LaTeX."""

from quietarm.studies.document.blocks import Document, Section
from quietarm.studies.document.latex import latex
from quietarm.studies.document.table import Column, Table

TABLE = Table(
    "What was found", [Column("method"), Column("left [%]")], [["a_1", 0.5], ["b & c", 2.0]]
)


def test_tables_are_turned_escaped_and_ruled():
    written = latex(Document("", [Section("one", [TABLE])]))
    assert r"method & a\_1 & b \& c \\" in written
    assert r"left [\%] & 0.5 & 2 \\" in written
    for name in ("table", "tabular"):
        assert written.count(rf"\begin{{{name}}}") == written.count(rf"\end{{{name}}}") == 1
    order = [written.index(rule) for rule in (r"\toprule", r"\midrule", r"\bottomrule")]
    assert order == sorted(order)
