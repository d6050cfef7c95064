"""How results are reported: rows and Markdown templates, words, tables, pictures and progress."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from quietarm.studies.report.report import Report
    from quietarm.studies.report.terminal import show, show_facts

__all__ = ["Report", "show", "show_facts"]
_LATER = {"Report": "report", "show": "terminal", "show_facts": "terminal"}


def __getattr__(name: str) -> object:
    """Import what takes long to load when it is first asked for."""
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"quietarm.studies.report.{_LATER[name]}"), name)
