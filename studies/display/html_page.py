"""Pages of HTML that stand alone: text is escaped, style and pictures are inside."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterable
from html import escape

from matplotlib.figure import Figure
from quietarm.studies.display.pictures import as_written
from quietarm.studies.display.tables import Table

_STYLE = """
:root { color-scheme: light dark; --ink: #1b1f24; --paper: #ffffff; --soft: #57606a;
  --line: #d5dae0; --card: #f5f7f9; --accent: #0072b2; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e9ec; --paper: #14181d; --soft: #a4adb7;
  --line: #39414a; --card: #1d232a; --accent: #56b4e9; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 76rem; padding: 1rem 1.25rem 4rem; background: var(--paper);
  color: var(--ink); font: 1rem/1.5 system-ui, "Segoe UI", "Helvetica Neue", Arial, sans-serif;
  overflow-wrap: break-word; }
h1 { font-size: 1.7rem; line-height: 1.2; margin: 1rem 0 .5rem; }
h2 { font-size: 1.3rem; line-height: 1.25; margin: 2.5rem 0 .5rem; padding-top: 1rem;
  border-top: 1px solid var(--line); }
h3 { font-size: 1rem; margin: 1.5rem 0 .25rem; }
p, li { max-width: 46rem; }
a { color: var(--accent); }
pre { overflow-x: auto; background: var(--card); padding: .75rem 1rem; }
.soft { color: var(--soft); font-size: .875rem; }
.findings { background: var(--card); border-left: 4px solid var(--accent); padding: .75rem 1rem;
  margin: 1rem 0; max-width: 50rem; }
.findings ul { margin: 0; padding-left: 1.1rem; }
.findings li { margin: .35rem 0; }
.pictures { display: grid; gap: .75rem; grid-template-columns: repeat(auto-fit, minmax(min(100%,
  21rem), 1fr)); margin: 1rem 0; }
figure { margin: 0; min-width: 0; }
figure img { display: block; width: 100%; height: auto; background: #ffffff;
  border: 1px solid var(--line); border-radius: 4px; }
figcaption { color: var(--soft); font-size: .875rem; padding: .25rem 0; }
.scroll { overflow-x: auto; max-width: 100%; margin: .5rem 0 1rem; }
table { border-collapse: collapse; font-size: .875rem; font-variant-numeric: tabular-nums; }
th, td { padding: .3rem .7rem; border-bottom: 1px solid var(--line); text-align: right;
  white-space: nowrap; }
thead th { border-bottom: 2px solid var(--line); vertical-align: bottom; white-space: normal;
  min-width: 6rem; }
.overview { max-width: 40rem; margin: 1rem 0; }
th:first-child { text-align: left; position: sticky; left: 0; background: var(--paper);
  font-weight: 600; }
tbody th.part { font-weight: 400; color: var(--soft); padding-left: 1.5rem; }
@media (max-width: 40rem) { th:first-child { white-space: normal; min-width: 9rem; }
  body { padding: .5rem .9rem 3rem; } }
"""


class Markup(str):
    """Text that is HTML already."""

    __slots__ = ()


def element(name: str, *children: str, **attributes: str) -> Markup:
    """An element of HTML that is well-formed XML as well."""
    marks = "".join(f' {k.rstrip("_")}="{escape(v)}"' for k, v in attributes.items())
    if not children:
        return Markup(f"<{name}{marks}/>")
    return Markup(f"<{name}{marks}>{joined(children)}</{name}>")


def joined(parts: Iterable[str]) -> Markup:
    """Parts one after the other; escaped where they are not `Markup`."""
    return Markup("".join(p if isinstance(p, Markup) else escape(p, quote=False) for p in parts))


def page(title: str, *body: str) -> str:
    """A whole page that loads nothing and runs nothing."""
    head = element(
        "head",
        element("meta", charset="utf-8"),
        element("meta", name_="viewport", content="width=device-width, initial-scale=1"),
        element("title", title),
        element("style", Markup(_STYLE)),
    )
    return f"<!DOCTYPE html>\n{element('html', head, element('body', *body), lang='en')}\n"


def bullets(lines: Iterable[str]) -> Markup:
    """A list of sentences."""
    return element("ul", *(element("li", line) for line in lines))


def table_element(table: Table) -> Markup:
    """A table with its title above it, with a scroll bar of its own where it is too wide."""
    heading, *lines = table.upright()
    head = element("tr", *(element("th", cell, scope="col") for cell in heading))
    rows = [
        element("tr", _row_heading(line[0]), *(element("td", cell) for cell in line[1:]))
        for line in lines
    ]
    whole = element("table", element("thead", head), element("tbody", *rows))
    scroll = element("div", whole, class_="scroll", tabindex="0", role="region",
                     **{"aria-label": table.title})  # fmt: skip
    return joined([element("h3", table.title), scroll])


def _row_heading(text: str) -> Markup:
    part = {"class_": "part"} if text.startswith(" ") else {}
    return element("th", text.strip(), scope="row", **part)


def picture(figure: Figure, alternative: str, caption: str) -> Markup:
    """A picture within the page, with what it shows in words."""
    content = io.BytesIO()
    with as_written(figure):
        figure.savefig(content, format="svg", metadata={"Date": None})
    data = base64.b64encode(content.getvalue()).decode()
    image = element("img", src=f"data:image/svg+xml;base64,{data}", alt=alternative)
    return element("figure", image, element("figcaption", caption))
