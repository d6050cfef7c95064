"""What the commands do with the gradient's fronts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from quietarm.ocp import (
    Front,
    PointToPoint,
    SolverFailedError,
    cross_check,
)
from quietarm.studies.display.progress import count
from quietarm.studies.display.saving import drawing, finish, interruption
from quietarm.studies.registry.methods import Method
from quietarm.studies.runs.files import FrontFiles
from quietarm.studies.runs.reports.sweep import failure_lines, print_sweep
from rich.console import Console

if TYPE_CHECKING:
    from matplotlib.figure import Figure


_CHECKED = 7
"""Points that the other solver finds again."""


def run_sweep(
    task: PointToPoint,
    method: Method,
    options: dict[str, Any],
    files: FrontFiles,
    quiet: bool,
) -> None:
    """Sweep the front by the gradient, write what was found, and show it."""
    files.refuse_same()
    check = options.pop("check", False)
    weights = options.get("weights", ())
    asked_for = 2 + len(weights) if weights else options["points"]  # the ends come with weights
    front = _swept(task, method, dict(options), quiet)
    asked_for = max(asked_for, len(front.points) + len(front.failures))  # epsilon's own residuals
    if not front.points:
        reasons = (line.strip() for line in failure_lines(front, asked_for)[1:])
        raise SolverFailedError(f"no point was found: {'; '.join(reasons)}")

    found, complete = None, front.complete
    if check and complete:
        try:
            with count(_CHECKED, "checked points", Console(stderr=True), quiet=quiet) as report:
                found = cross_check(front, _CHECKED, report)
        except KeyboardInterrupt:  # the front is there
            complete = False

    def picture() -> Figure:
        from quietarm.studies.figures import sweep_figure

        return sweep_figure(front)

    finish(
        [
            (files.output, front.save),
            (files.csv, front.save_csv),
            (files.figure, drawing(picture)),
        ],
        lambda console: print_sweep(console, front, asked_for, found),
        trouble=None if complete else interruption(),
    )


def _swept(task: PointToPoint, method: Method, options: dict[str, Any], quiet: bool) -> Front:
    errors = Console(stderr=True)
    weights = options.pop("weights", ())
    if weights:
        options["weights"] = weights
    total = len(weights) or options["points"]
    with count(total, "weights" if weights else "points", errors, quiet=quiet) as report:
        return method.sweep(task, report=report, **options)
