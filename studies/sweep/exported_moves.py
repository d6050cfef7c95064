"""The moves of a sweep, as formats take them."""

from __future__ import annotations

from pathlib import Path

from quietarm.ocp import InfeasibleTaskError
from quietarm.studies.sweep.library import MoveLibrary


def moves_to_export(dataset: Path) -> MoveLibrary:
    """The moves of a sweep; InfeasibleTaskError where moves between its cells break a limit."""
    library = MoveLibrary(dataset)
    between = library.between()
    if not between.keeps_limits:
        raise InfeasibleTaskError(
            f"moves between the cells of {dataset} break their limits by up to "
            f"{between.of_limits - 1:.1%}, and nothing was written; {between.remedy}"
        )
    return library
