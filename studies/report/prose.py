"""Sentences that wait for their figures: a template of jinja2 beside the code that has them."""

from __future__ import annotations

import re

from jinja2 import Environment, PackageLoader, StrictUndefined
from quietarm.studies.display.words import millimetres


def told(template: str, **figures: object) -> list[str]:
    """The paragraphs of a template in this package with its figures, each in a line."""
    texts = Environment(
        loader=PackageLoader("quietarm.studies", ""),
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    texts.filters["mm"] = millimetres
    text = texts.get_template(template).render(figures)
    return [" ".join(part.split()) for part in re.split(r"\n\s*\n", text) if part.strip()]
