"""Grids of moves: a certified plan a cell, in a Zarr store that a killed run goes on with."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from quietarm.studies.sweep.library import MoveLibrary
    from quietarm.studies.sweep.made import sweep

__all__ = ["MoveLibrary", "sweep"]
_LATER = {"MoveLibrary": "library", "sweep": "made"}


def __getattr__(name: str) -> object:
    """Import what takes long to load when it is first asked for."""
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"quietarm.studies.sweep.{_LATER[name]}"), name)
