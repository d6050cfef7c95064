"""The rule for rest on arrival: a small move has to be stiller than others."""

from __future__ import annotations

from quietarm.ocp.task import PointToPoint

REST = 1e-6
"""Residual [m] below which a report says that the tip is at rest: nobody sees a difference."""
STILL = 1e-8
"""Residual [m] up to which a solver's motion keeps a limit of none."""


def rest_of(task: PointToPoint) -> float:
    """Residual below which reports say that the tip is at rest [tip's unit]."""
    return REST * task.smallness


def is_at_rest(residual: float, task: PointToPoint) -> bool:
    """Return whether a residual counts as rest on arrival, or as the state that is wanted then."""
    return residual < rest_of(task)


def still_of(task: PointToPoint) -> float:
    """Residual up to which a solver's motion keeps a limit of none [tip's unit]."""
    return STILL * task.smallness
