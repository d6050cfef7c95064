"""Motions that were found elsewhere, with the figures of the independent integrator."""

from __future__ import annotations

import reprlib
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.ocp.base.checks import positive
from quietarm.ocp.base.errors import SolverFailedError
from quietarm.ocp.front.points import FrontPoint, non_dominated
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.resimulation import resimulate
from quietarm.ocp.task.point_to_point import PointToPoint

_KEPT = 1e-9
"""Share of a limit within which a peak that CVODES gives counts as at it."""

_ROUNDING = 1e-9
"""Share of its size by which a coefficient may pass its box: what decimals in a file may lose."""


class Evaluated(NamedTuple):
    """What became of motions: the points of their front, how many are not in it, and why."""

    points: tuple[FrontPoint, ...]
    failed: int
    infeasible: int


def table_of(coefficients: ArrayLike) -> NDArray[np.float64]:
    """Coefficients, one row for each motion."""
    try:
        table = np.asarray(coefficients, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(
            f"coefficients are {reprlib.repr(coefficients)}; give a row of numbers for each motion"
        ) from None
    if table.ndim != 2 or len(table) == 0:
        raise ValueError(
            f"coefficients have shape {table.shape}; give (motions, coefficients), one row for "
            "each motion"
        )
    return table


def refuse_beyond_box(
    profile: JointProfile,
    table: NDArray[np.float64],
    bound: object,
    remedy: str = "; correct it, or state a wider bound",
) -> None:
    """Refuse coefficients beyond the box of a profile for the bound that is stated."""
    if bound is None:
        return
    most = positive("its bound", bound)
    lower, upper = profile.box(most)
    room = _ROUNDING * np.maximum(np.abs(lower), np.abs(upper))
    beyond = np.argwhere((table < lower - room) | (table > upper + room))
    if len(beyond):
        row, column = beyond[0]
        raise ValueError(
            f"point {row + 1} of {len(table)} has the coefficient {table[row, column]:.4g}, "
            f"beyond the stated bound of {most:g}{remedy}"
        )


def evaluated(
    task: PointToPoint,
    profile: JointProfile,
    table: NDArray[np.float64],
    bound: object = None,
) -> Evaluated:
    """The front of motions by CVODES; those that fail or break a limit of the task are counted."""
    points, failed, infeasible = list[FrontPoint](), 0, 0
    rows = [profile.checked(row, task.duration) for row in table]
    refuse_beyond_box(profile, table, bound)
    for coefficients in rows:
        try:
            motion = resimulate(task, profile, coefficients)
        except SolverFailedError:
            failed += 1
            continue
        if all(motion.peak(name) <= most * (1 + _KEPT) for name, most in task.limits.items()):
            points.append(FrontPoint(coefficients, motion.residual, motion.energy))
        else:
            infeasible += 1
    return Evaluated(non_dominated(points), failed, infeasible)
