"""Words of commands that no line breaks: a browser would break an option after its hyphens.

On a wide screen a long command goes on in the next line, between two words; on a narrow one it
scrolls (`site.css`).
"""

from __future__ import annotations

import re
from typing import Any

from sphinx.application import Sphinx

_BLOCK = re.compile(r'<div class="highlight-(?:console|sh)\b.*?</pre>', re.DOTALL)
_HYPHENATED = re.compile(r"(?<![^\s>])[^\s<>]*-[^\s<>]*(?![^<]*>)")


def keep_whole(body: str) -> str:
    """A page with every word of a command that has a hyphen in an element of its own."""
    return _BLOCK.sub(
        lambda block: _HYPHENATED.sub(r'<span class="word">\g<0></span>', block[0]), body
    )


def _on_page(app: Sphinx, page: str, template: str, context: dict[str, Any], tree: Any) -> None:
    if body := context.get("body"):
        context["body"] = keep_whole(body)


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect with Sphinx."""
    app.connect("html-page-context", _on_page)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
