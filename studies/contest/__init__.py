"""Methods with the same number of evaluations against the exact front of each problem.

Runs are files in a folder; whatever is measured, tested and drawn is worked out from these files
alone. May import every room but `cli`, `reproduction` and `study`.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from quietarm.studies.contest.held import contest
    from quietarm.studies.contest.measures import Arena, Field

__all__ = ["Arena", "Field", "contest"]
_LATER = {"Arena": "measures", "Field": "measures", "contest": "held"}


def __getattr__(name: str) -> object:
    """Import what takes long to load when it is first asked for."""
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"quietarm.studies.contest.{_LATER[name]}"), name)
