"""Documents as a page of HTML that stands alone: style and pictures are inside, nothing runs."""

from __future__ import annotations

import base64
import io
import re

from jinja2 import Environment, PackageLoader
from markupsafe import Markup
from matplotlib.figure import Figure
from quietarm.studies.display.pictures import as_written
from quietarm.studies.report.document import Block, Document


def page(document: Document) -> str:
    """The document as a page, which is well-formed XML as well."""
    templates = Environment(
        loader=PackageLoader("quietarm.studies", "report"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    templates.filters.update(kind=_kind, svg=_svg, anchor=_anchor)
    return templates.get_template("page.html").render(document=document) + "\n"


def _kind(block: Block) -> str:
    return type(block).__name__


def _anchor(title: str) -> str:
    """A title as the name that links go to."""
    return re.sub(r"\W+", "-", title)


def _svg(figure: Figure) -> Markup:
    """A picture as an address that holds it."""
    content = io.BytesIO()
    with as_written(figure):
        figure.savefig(content, format="svg", metadata={"Date": None})
    return Markup(f"data:image/svg+xml;base64,{base64.b64encode(content.getvalue()).decode()}")
