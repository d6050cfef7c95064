"""Motions that were found elsewhere, with the figures of the independent integrator."""

from __future__ import annotations

import reprlib
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ocp.base.checks import positive
from ocp.base.errors import SolverFailedError
from ocp.front.points import FrontPoint, non_dominated
from ocp.profiles.joint_profile import JointProfile
from ocp.simulation.resimulation import resimulate
from ocp.task.point_to_point import PointToPoint

_KEPT = 1e-9
"""Share of a limit within which a peak that CVODES gives counts as at it."""


class Evaluated(NamedTuple):
    """What became of motions: the points of their front, and how many are none of it and why."""

    points: tuple[FrontPoint, ...]
    failed: int
    infeasible: int


def table_of(coefficients: ArrayLike, bound: object = None) -> NDArray[np.float64]:
    """Coefficients, a motion a row.

    Parameters
    ----------
    coefficients : array_like, shape (motions, size)
        Numbers.
    bound : float, optional
        Largest absolute coefficient.

    Returns
    -------
    ndarray, shape (motions, size)
        The same.

    Raises
    ------
    ValueError
        When they are no table of numbers, there is no motion, or one passes the bound.
    """
    try:
        table = np.asarray(coefficients, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(
            f"coefficients are {reprlib.repr(coefficients)}; give a row of numbers for each motion"
        ) from None
    if table.ndim != 2 or len(table) == 0:
        raise ValueError(
            f"coefficients have shape {table.shape}; give (motions, coefficients), a motion a row"
        )
    if bound is not None:
        largest, most = np.abs(table).max(initial=0.0), positive("bound", bound)
        if largest > most:
            raise ValueError(f"a coefficient is {largest:g}, beyond the bound of {most:g}")
    return table


def evaluated(task: PointToPoint, profile: JointProfile, table: NDArray[np.float64]) -> Evaluated:
    """The front of motions by CVODES; those that fail or break a limit of the task are counted.

    Parameters
    ----------
    task : PointToPoint
        The move.
    profile : JointProfile
        How the joint moves.
    table : ndarray, shape (motions, profile.size)
        Coefficients, a motion a row.

    Returns
    -------
    Evaluated
        What became of them.

    Raises
    ------
    ValueError
        When a row does not fit the profile, or is not finite.
    """
    points, failed, infeasible = list[FrontPoint](), 0, 0
    for row in table:
        coefficients = profile.checked(row, task.duration)
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
