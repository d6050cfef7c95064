"""Texts of the reference: what autodoc and napoleon take from docstrings, as a reader wants it.

- A plant's parameters are the fields that `parameter` declares, with unit, meaning and source.
- A docstring of an attribute may have a colon: napoleon would take what is before it for a type.
- A shape as ``(samples, 2)`` is no link, though something is called samples.
- ``docs/physics.md`` in a docstring is a link, and a dash between words a dash.
"""

from __future__ import annotations

import dataclasses
import re
from typing import Any

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx

_COLON = "\ue000"
"""In place of a colon while napoleon reads; of the private use area."""
_ATTRIBUTES = ("attribute", "data", "property")
_BEFORE_NAPOLEON, _AFTER_NAPOLEON = 400, 600
LONGEST = 40
"""Letters of a constant that a signature shows in place of its name."""
_DUST = re.compile(r"\d+\.\d{14,}")
_CONSTANT = re.compile(r"=([A-Z][A-Z_]+)\b")
_PAGE = re.compile(r"(?<![\w/`])(?:docs/)?(\w+)\.md(?![\w/])")


def parameters_of(plant: type) -> list[str]:
    """The section of a plant's parameters, in NumPy's style; empty without declared ones."""
    fields = dataclasses.fields(plant) if dataclasses.is_dataclass(plant) else ()
    declared = [field for field in fields if "unit" in field.metadata]
    lines = ["", "Parameters", "----------"]
    for field in declared:
        unit, source = field.metadata["unit"], field.metadata["source"]
        meaning = field.metadata["meaning"] or field.name
        sentence = meaning[:1].upper() + meaning[1:]
        if unit not in ("-", "count"):
            sentence += f" [{unit}]"
        if source:
            sentence += f"; {source}"
        lines += [f"{field.name} : {'int' if unit == 'count' else 'float'}", f"    {sentence}."]
    return lines if declared else []


def before_napoleon(
    app: Sphinx, kind: str, name: str, value: Any, options: Any, lines: list[str]
) -> None:
    """Add parameters of plants, and hide colons of attributes."""
    if kind == "class" and "Parameters" not in lines:
        lines += parameters_of(value)
    has_sections = any(re.fullmatch("-{3,}", line) for line in lines)
    if kind in _ATTRIBUTES and not has_sections:
        lines[:] = [line.replace(":", _COLON) for line in lines]


def after_napoleon(
    app: Sphinx, kind: str, name: str, value: Any, options: Any, lines: list[str]
) -> None:
    """Show the colons, and link pages."""
    pages = app.env.found_docs
    lines[:] = [_linked(line.replace(_COLON, ":"), pages) for line in lines]


def _linked(line: str, pages: set[str]) -> str:
    """A line with a link for each page of docs that it names."""

    def link(match: re.Match[str]) -> str:
        return f":doc:`/docs/{match[1]}`" if f"docs/{match[1]}" in pages else match[0]

    return _PAGE.sub(link, line)


def shorten_signature(
    app: Sphinx, kind: str, name: str, value: Any, options: Any, arguments: Any, returned: Any
) -> tuple[str | None, str | None]:
    """Show the value of a constant that is a default, and dots where a factory makes it."""
    constants = getattr(value, "__globals__", {})

    def shown(match: re.Match[str]) -> str:
        constant = repr(constants.get(match[1], match[1]))
        return f"={constant}" if match[1] in constants and len(constant) <= LONGEST else match[0]

    if arguments:
        arguments = _CONSTANT.sub(shown, arguments.replace("<factory>", "..."))
    return arguments, returned


def mend_words(app: Sphinx, doctree: nodes.document) -> None:
    """Keep links of types to names of types, set dashes, and leave out dust of rounding."""
    for link in list(doctree.findall(addnodes.pending_xref)):
        of_type = (link.get("refdomain"), link.get("reftype")) == ("py", "class")
        if of_type and re.fullmatch("[a-z_]+", link["reftarget"]):
            link.parent.replace(link, link.children)
    for signature in doctree.findall(addnodes.desc_signature):
        for text in list(signature.findall(nodes.Text)):
            if _DUST.search(text):
                without = _DUST.sub(lambda number: f"{float(number[0]):.10g}", text)
                text.parent.replace(text, nodes.Text(without))
    for text in list(doctree.findall(nodes.Text)):
        if text.startswith(" -- "):  # between a parameter and its meaning
            text.parent.replace(text, nodes.Text(f" \u2013 {text[4:]}"))


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect with Sphinx."""
    app.connect("autodoc-process-docstring", before_napoleon, priority=_BEFORE_NAPOLEON)
    app.connect("autodoc-process-docstring", after_napoleon, priority=_AFTER_NAPOLEON)
    app.connect("autodoc-process-signature", shorten_signature)
    app.connect("doctree-read", mend_words)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
