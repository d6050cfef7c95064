"""Names of pictures, checked before the work and without the drawing library."""

from __future__ import annotations

from pathlib import Path

from ocp.base.files import check_writable

SUFFIXES = (".png", ".pdf", ".svg")


def check_figure(path: str | Path) -> Path:
    """Make sure that a picture can be written under this name; ValueError otherwise."""
    target = check_writable(path)
    if target.suffix.lower() not in SUFFIXES:
        raise ValueError(f"{target} is no picture; end its name in {', '.join(SUFFIXES)}")
    return target
