"""Links that name a page by its title where the repository's texts name its file.

README.md says docs/moves.md, since that is what a reader of the repository opens; on the site the
same link says Plan a move. The last page names the first one as its next.
"""

from __future__ import annotations

import posixpath
import re
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx

_FILE = re.compile(r"(?:[\w.-]+/)*[\w.-]+\.md(?:#[\w-]+)?")


def name_pages(app: Sphinx, doctree: nodes.document, page: str) -> None:
    """Replace the words of links that are the path of a page's file by its title."""
    for link in doctree.findall(nodes.reference):
        words = link.astext()
        if not _FILE.fullmatch(words):
            continue
        path = words.partition("#")[0]
        anchor = link.get("refuri", "").partition("#")[2]
        target = posixpath.normpath(path).removesuffix(".md")
        if target not in app.env.titles:  # beside this page
            target = posixpath.normpath(posixpath.join(posixpath.dirname(page), target))
        if title := _title_of(app, target, anchor):
            link.children = []
            link += nodes.Text(title)


def _title_of(app: Sphinx, page: str, anchor: str) -> str:
    """Of a page, or of the section with an anchor."""
    if page not in app.env.titles:
        return ""
    for entry in app.env.tocs[page].findall(nodes.reference):
        if anchor and entry["anchorname"] == f"#{anchor}":
            return entry.astext()
    return app.env.titles[page].astext()


def end_where_it_begins(
    app: Sphinx, page: str, template: str, context: dict[str, Any], tree: Any
) -> None:
    """The page that follows the last one is the first."""
    root = app.config.root_doc
    if context.get("prev") and not context.get("next") and page != root:
        address = app.builder.get_relative_uri(page, root)
        context["next"] = {"link": address, "title": app.env.titles[root].astext()}


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect with Sphinx."""
    app.connect("doctree-resolved", name_pages)
    app.connect("html-page-context", end_where_it_begins)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
