"""The worst cases of a motion as scenarios of its task, so that a solver sees them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.task import PointToPoint

_AT_CORNER = 1e-6
"""Share of the ranges within which a scenario is a corner of them."""


def new_scenarios(
    task: PointToPoint, peaks: Sequence[JudgedMotion], same: float = 1e-6
) -> list[list[float]]:
    """The errors of those peaks that are no scenario of the task yet.

    Errors that differ by less than the share `same` of their range are one scenario.
    """
    known = np.array(task.scenarios[1:])
    near = same * np.array(list(task.ranges.values()))
    errors = [list(peak.errors.values()) for peak in peaks]
    return [error for error in errors if (np.abs(known - error) > near).any(axis=1).all()]


def with_moved_scenarios(
    task: PointToPoint, scenarios: Sequence[Sequence[float]], near: float = 0.25
) -> PointToPoint:
    """The task with more scenarios, in place of those within a share of the ranges beside them.

    Corners stay.
    """
    largest = np.array(list(task.ranges.values()))
    added = np.array(scenarios) / largest
    known = np.array(task.scenarios[1:]) / largest
    is_corner = (np.abs(known) > 1 - _AT_CORNER).all(axis=1)
    is_far = (np.abs(known[:, None] - added).max(axis=2) > near).all(axis=1)
    kept = known[is_corner | is_far] * largest
    return task.with_samples([*kept.tolist(), *scenarios])


def with_even_scenarios(task: PointToPoint) -> PointToPoint:
    """The task with the middles between no error and the corners of its ranges as scenarios too.

    They stand for the worst cases where these are not looked for. A task that is certain stays.
    """
    if task.uncertainty is None:
        return task
    corners = np.array(task.scenarios[1:])
    return task.with_samples([*corners.tolist(), *(corners / 2).tolist()])
