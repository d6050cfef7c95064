"""The templates of jinja2 that stand beside the code that fills them."""

from __future__ import annotations

from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

import quietarm


def templates(**options: Any) -> Environment:
    """The templates of quietarm, by their paths in it."""
    return Environment(
        loader=FileSystemLoader(quietarm.__path__), trim_blocks=True, lstrip_blocks=True,
        undefined=StrictUndefined, **options,
    )  # fmt: skip
