"""Sentences that wait for their figures: a template of jinja2 beside the code that has them."""

from __future__ import annotations

import re
from collections.abc import Sequence

from numpy import median
from quietarm.studies.display.templates import templates
from quietarm.studies.display.words import millimetres


def told(template: str, **figures: object) -> list[str]:
    """The paragraphs of a template in this package with its figures, each in a line."""
    texts = templates()
    texts.filters.update(mm=millimetres, percents=percents, listed=listed, median=median)
    text = texts.get_template(template).render(figures)
    return [" ".join(part.split()) for part in re.split(r"\n\s*\n", text) if part.strip()]


def percents(shares: Sequence[float]) -> str:
    """A share, or the range of several, in words."""
    words = [
        "less than 0.01" if abs(share) < 1e-4 else f"{float(f'{100 * share:.2g}'):g}"
        for share in (min(shares), max(shares))  # 120 %, not 1.2e+02 %
    ]
    return f"{' to '.join(dict.fromkeys(words))} %"


def listed(words: Sequence[str]) -> str:
    """Words with commas, and an "and" before the last."""
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)
