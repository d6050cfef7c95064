"""Conditions of one's own: a problem for every cell of a grid."""

from __future__ import annotations

from math import degrees

from quietarm.metaheuristics import NamedProblem
from quietarm.ocp import JointProfile
from quietarm.studies.sweep.grid import Grid

MOST_CONDITIONS = 1000


def conditions(grid: Grid, profile: JointProfile, bound: float | None) -> tuple[NamedProblem, ...]:
    """The moves of a grid as problems, named after their plant and what differs.

    Parameters
    ----------
    grid : Grid
        The moves.
    profile : JointProfile
        How the joint moves.
    bound : float or None
        Largest absolute coefficient; the profile's own by default.

    Raises
    ------
    ValueError
        When there are too many, or there is no bound.
    """
    if grid.cells > MOST_CONDITIONS:
        raise ValueError(
            f"the grid has {grid.cells} conditions; give at most {MOST_CONDITIONS}: each has its "
            "exact front, and many runs"
        )
    bound = profile.default_bound if bound is None else bound
    if bound is None:
        raise ValueError("give --bound, the box of the coefficients that is searched, as 0.2")
    tasks = grid.tasks([slice(None)] * len(grid.axes))
    parameters = [axis.name for axis in grid.axes if axis.name not in ("target", "duration")]
    found = list[NamedProblem]()
    for task in tasks:
        own = task.plant.parameters
        values = [f"{name}-{own.get(name, degrees(task.start)):.6g}" for name in parameters]
        move = f"{degrees(task.target):.6g}deg", f"{task.duration:.6g}s"
        name = "-".join([task.plant.name, *values, *move])
        found.append(NamedProblem(name, task, profile, bound))
    return tuple(found)
