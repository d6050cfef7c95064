"""Methods on problems from several seeds, held against the problems' reference fronts.

Runs are files in a folder; whatever is measured, tested and drawn is worked out from these alone.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from quietarm.studies.bench.page import bench_report
    from quietarm.studies.bench.results import Results, quartiles

__all__ = ["Results", "bench_report", "quartiles"]
_LATER = {"Results": "results", "quartiles": "results", "bench_report": "page"}


def __getattr__(name: str) -> object:
    """Import what takes long to load when it is first asked for."""
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"quietarm.studies.bench.{_LATER[name]}"), name)
