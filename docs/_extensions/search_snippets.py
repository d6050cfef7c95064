"""Search with snippets on a site that is opened as files, where no page can fetch another.

The text of every page, section by section, is written as a script, which the page of results loads;
`search_snippets.js` puts into each result the words around what was found.
"""

from __future__ import annotations

import json
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

TEXTS = "page_texts.js"
_FRAME = "const PAGE_TEXTS = {};\n"
"""Around the texts in their file."""
_BLOCKS = ("p", "h1", "h2", "h3", "h4", "li", "dt", "dd", "td", "th", "pre", "div")
"""After these the next word begins."""


class _Sections(HTMLParser):
    """Text of a page by the anchors of its sections; the anchor before the first one is empty."""

    def __init__(self) -> None:
        super().__init__()
        self.texts: dict[str, list[str]] = {"": []}
        self._anchors = [""]
        self._hidden = 0

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        attributes = dict(attrs)
        if tag == "section":
            anchor = attributes.get("id") or ""
            self._anchors.append(anchor)
            self.texts.setdefault(anchor, [])
        elif tag in ("script", "style") or (
            tag == "a" and "headerlink" in (attributes.get("class") or "")
        ):
            self._hidden += 1

    def handle_endtag(self, tag: str) -> None:
        if tag in _BLOCKS:
            self.texts[self._anchors[-1]].append(" ")
        if tag == "section":
            self._anchors.pop()
        elif self._hidden and tag in ("script", "style", "a"):
            self._hidden -= 1

    def handle_data(self, data: str) -> None:
        if not self._hidden:
            self.texts[self._anchors[-1]].append(data)


def sections_of(body: str) -> dict[str, str]:
    """Text of a page's sections, by their anchors, with single spaces."""
    parser = _Sections()
    parser.feed(body)
    texts = {anchor: " ".join("".join(pieces).split()) for anchor, pieces in parser.texts.items()}
    return {anchor: text for anchor, text in texts.items() if text}


def collect(app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: Any) -> None:
    """Keep the text of a page; load all texts on the page of results alone."""
    if page == "search":
        app.add_js_file(TEXTS)
        app.add_js_file("search_snippets.js")
    elif body := context.get("body"):
        app.env.page_texts[page] = sections_of(body)  # type: ignore[attr-defined]


def begin(app: Sphinx) -> None:
    """Begin with the texts of the last build: pages that have not changed are not written again."""
    before = _place(app)
    texts = before.read_text("utf-8") if before.exists() else _FRAME.format("{}")
    app.env.page_texts = json.loads(texts[_FRAME.index("{}") : -2])  # type: ignore[attr-defined]


def write(app: Sphinx, exception: Exception | None) -> None:
    """Write the texts as a script."""
    if exception is None and app.builder.format == "html":
        texts = json.dumps(app.env.page_texts, ensure_ascii=False)  # type: ignore[attr-defined]
        _place(app).write_text(_FRAME.format(texts), encoding="utf-8")


def _place(app: Sphinx) -> Path:
    return Path(app.outdir) / "_static" / TEXTS


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect with Sphinx."""
    app.connect("builder-inited", begin)
    app.connect("html-page-context", collect)
    app.connect("build-finished", write)
    return {"parallel_read_safe": True, "parallel_write_safe": False}
