"""`quietarm front --over duration`: what time is worth."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from quietarm.ocp import InfeasibleTaskError, PointToPoint
from quietarm.ocp.checks import whole
from quietarm.ocp.front.durations import plans_over_duration
from quietarm.studies.cli.ending import finish, interruption
from quietarm.studies.cli.options import refuse_typed
from quietarm.studies.display.progress import count
from quietarm.studies.display.saving import drawing
from quietarm.studies.reports.durations import durations_document, durations_table
from rich.console import Console

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FEW, _MOST = 15, 1000
"""Durations by default, and at most."""
_OF_DURATIONS = ("points", "bound", "starts", "solver")


def checked_range(
    durations: tuple[float, float] | None, settings: Mapping[str, Any]
) -> tuple[float, float]:
    """The range; ValueError names what has no meaning over one."""
    if durations is None:
        raise ValueError("--over duration takes a range; give it as --duration 600ms:1.4s")
    if durations[0] >= durations[1]:
        raise ValueError(
            f"--duration {durations[0]:g}:{durations[1]:g} is no range; give the shorter one first"
        )
    idle = {"method", "output", *settings} - {*_OF_DURATIONS}
    refuse_typed(idle, "is not for --over duration; leave it out")
    return durations


def found_over(
    task: PointToPoint,
    durations: tuple[float, float],
    points: int,
    settings: Mapping[str, Any],
    files: tuple[Path | None, Path | None],
    quiet: bool,
) -> None:
    """Plan the move over the range, write table and picture, and show the table."""
    at = np.linspace(*durations, whole("points", points, 2, _MOST)).round(9)  # ns
    with count(len(at), "durations", Console(stderr=True), quiet=quiet) as report:
        found = plans_over_duration(task, at.tolist(), report=report, **settings)
    if found.complete and all(one.plan is None for one in found.points):
        raise InfeasibleTaskError(f"no duration has a plan; the longest: {found.points[-1].why}")
    if not found.points:
        raise KeyboardInterrupt

    def picture() -> Figure:
        from quietarm.studies.figures.durations import durations_figure

        return durations_figure(found)

    csv_file, figure = files
    finish(
        [(csv_file, durations_table(found).save_csv), (figure, drawing(picture))],
        durations_document(found),
        trouble=None if found.complete else interruption(),
    )
