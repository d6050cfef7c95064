"""A report: a Markdown template with its values, tables and pictures, and the files it becomes."""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from quietarm.ocp.checks import joined
from quietarm.ocp.escapes import (
    Markdown,
    code,
    csv_table,
    markdown,
    one_line,
    words_of_markdown,
)
from quietarm.ocp.files import write_whole
from quietarm.views.report.saving import File, drawing, inside
from quietarm.views.report.table_width import narrow_tables
from quietarm.views.report.templates import templates
from quietarm.views.report.words import counted, millimetres

if TYPE_CHECKING:
    from jinja2 import Environment
    from matplotlib.figure import Figure
    from pandas import DataFrame


@dataclass(frozen=True)
class Report:
    """Results that are printed, and written as Markdown, a page of HTML, CSV and LaTeX.

    Parameters
    ----------
    template : str or Path
        A jinja2 template that gives Markdown: its path below `studies`, or a file of one's own as
        a Path. The first line is the title, as ``# Title``.
    values : mapping
        What the template names, besides ``tables``.
    tables : mapping of str to DataFrame
        Each a CSV file beside the report; in the template ``{{ tables.energies | table }}``.
    figures : mapping of str to callable
        Functions that draw a picture, by the name of its file; in the template
        ``![what it shows](front.png)``.
    answer : str
        The answer in a sentence or two: the first line on a terminal, below the title of a page.
    """

    template: str | Path
    values: Mapping[str, Any] = field(default_factory=dict)
    tables: Mapping[str, DataFrame] = field(default_factory=dict)
    figures: Mapping[str, Callable[[], Figure]] = field(default_factory=dict)
    answer: str = ""

    def markdown(self, *, with_answer: bool = True) -> str:
        """Return the text, whose pictures lie beside it; the answer stands below the title."""
        if isinstance(self.template, Path):
            template = _environment().from_string(self.template.read_text(encoding="utf-8"))
        else:
            template = _environment().get_template(self.template)
        rendered = template.render(**self.values, tables=self.tables)
        text = re.sub(r"\n{3,}", "\n\n", rendered).strip() + "\n"
        if not (with_answer and self.answer):
            return text
        title, _, rest = text.partition("\n")
        return f"{title}\n\n{markdown(self.answer)}\n{rest}"

    def html(self) -> str:
        """The text as a page that stands alone, with its pictures inside."""
        from markdown_it import MarkdownIt

        text = self.markdown()
        body = MarkdownIt("commonmark", {"html": False, "xhtmlOut": True}).enable("table")
        html = body.render(text).replace("<table>", '<div class="scroll"><table>')
        html = html.replace("</table>", "</table></div>")
        for name, draw in self.figures.items():
            html = html.replace(f'src="{name}"', f'src="{_svg(draw())}"')
        title = words_of_markdown(text.partition("\n")[0].lstrip("# "))
        page = templates(autoescape=True).get_template("views/report/page.html")
        return page.render(title=title, body=html)

    def latex(self) -> str:
        """Every table for a text that loads booktabs; names of tables are captions and labels."""
        return "\n".join(
            _in_lines(table).to_latex(
                index=False, float_format="%.4g", na_rep="-", escape=True,
                caption=name.replace("_", " "), label=f"tab:{name}",
            )
            for name, table in self.tables.items()
        )  # fmt: skip

    def files(self, *paths: Path) -> list[File]:
        """A page (.html) or tables (.tex) by the endings of paths; any other path is a folder."""
        return [file for path in paths for file in self._files(path)]

    def _files(self, path: Path) -> list[File]:
        """The file, or in a folder the text, a CSV file for each table, and the pictures."""
        forms = {".html": self.html, ".htm": self.html, ".tex": self.latex}
        if form := forms.get(path.suffix.lower()):
            return [(path, lambda place: write_whole(place, form()))]
        writes: dict[str, Callable[[Path], object]] = {
            "report.md": lambda path: write_whole(path, self.markdown())
        }
        for key, table in self.tables.items():
            writes[f"{key}.csv"] = lambda path, table=table: write_whole(path, csv_table(table))
        writes |= {picture: drawing(draw) for picture, draw in self.figures.items()}
        return inside(path, writes)


def _in_lines(table: DataFrame) -> DataFrame:
    """A table whose texts are of one line each."""
    cells = table.map(lambda cell: one_line(cell) if isinstance(cell, str) else cell)
    return cells.rename(columns=lambda name: one_line(str(name)))


def table_in_markdown(table: DataFrame) -> str:
    """A table in Markdown: four digits, a dash where there is no value."""
    cells = table.map(lambda cell: markdown(cell) if isinstance(cell, str) else cell)
    cells = cells.astype(object).where(table.notna(), None).rename(columns=markdown)
    for place in range(len(cells.columns)):
        cells.isetitem(place, _whole_numbers(cells.iloc[:, place]))
    return Markdown(cells.to_markdown(index=False, floatfmt=".4g", missingval="-"))


def _whole_numbers(column: Any) -> Any:
    """Return a column of numbers as whole ones if all are: 40000, not 4e+04."""
    import pandas as pd  # not at the top: it takes long to load

    known = column[column.notna()]
    if not all(isinstance(cell, float) and cell.is_integer() for cell in known):
        return column
    values = [None if cell is None else int(cell) for cell in column]
    return pd.Series(values, index=column.index, dtype=object)


def tables_in_markdown(table: DataFrame, width: int = 100) -> str:
    """A table as several below each other that fit into a width, each with the first column."""
    if len(table.columns) < 2:
        return ""
    return Markdown("\n".join(narrow_tables(table_in_markdown(table).splitlines(), width)))


def turned(table: DataFrame, names: str) -> str:
    """A table in Markdown whose columns are lines: few rows of many figures, named by a column."""
    cells = table.map(lambda cell: f"{cell:.4g}" if isinstance(cell, float) else cell)
    cells = cells.astype(object).where(table.notna(), "-").astype(str).set_index(names)
    return table_in_markdown(cells.T.rename_axis(names).reset_index())


def percents(shares: Sequence[float]) -> str:
    """A share, or the range of several, in per cent."""
    words = [
        "less than 0.01" if abs(share) < 1e-4 else f"{float(f'{100 * share:.2g}'):g}"
        for share in (min(shares), max(shares))  # 120 %, not 1.2e+02 %
    ]
    return f"{' to '.join(dict.fromkeys(words))} %"


def in_a_sentence(words: Sequence[str]) -> str:
    """Words with commas, and an "and" before the last."""
    return joined(words)


def _environment() -> Environment:
    environment = templates(finalize=_words)
    filters: dict[str, Any] = {
        "table": table_in_markdown, "tables": tables_in_markdown, "turned": turned,
        "mm": millimetres, "percents": percents, "listed": in_a_sentence, "counted": counted,
        "code": code,
    }  # fmt: skip
    environment.filters.update(filters)
    return environment


def _words(value: Any) -> Any:
    """Return a value as it stands in a template's Markdown."""
    if isinstance(value, int | float):
        return value
    return markdown(value if isinstance(value, str) else str(value))


def _svg(figure: Figure) -> str:
    """A picture as an address that holds it."""
    from quietarm.views.report.saving import as_written

    content = io.BytesIO()
    with as_written(figure):
        figure.savefig(content, format="svg", metadata={"Date": None})
    return f"data:image/svg+xml;base64,{base64.b64encode(content.getvalue()).decode()}"
