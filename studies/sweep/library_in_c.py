"""The moves of a sweep as C: a table, and what interpolates it."""

from __future__ import annotations

from pathlib import Path

from quietarm.ocp import InfeasibleTaskError
from quietarm.studies.sweep.library import MoveLibrary
from quietarm.views.formats.formats import write_c


def export_moves(dataset: Path, path: Path) -> list[Path]:
    """Write the moves of a sweep as C: a table, and what interpolates it.

    InfeasibleTaskError where moves between its cells break a limit.
    """
    library = MoveLibrary(dataset)
    between = library.between()
    if not between.keeps_limits:
        raise InfeasibleTaskError(
            f"moves between the cells of {dataset} break their limits by up to "
            f"{between.of_limits - 1:.1%}, and nothing was written; {between.remedy}"
        )
    return write_c(library, path)
