"""Solve points of a front by the other solver."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from quietarm.ocp.front.answer import Front
from quietarm.ocp.front.points import FrontPoint
from quietarm.ocp.front.sweep import Report, Sweep, no_report, sweep_of
from quietarm.ocp.interrupts import one_at_a_time
from quietarm.ocp.record import number_of_points
from quietarm.ocp.solvers.solution import RESIDUAL

_SAME = 1e-6
"""Energies that differ by no more than this share agree."""
_STARTS = 4
"""The plain cycloid first; the others only where it led to a dearer minimum."""


@dataclass(frozen=True)
class Compared:
    """One point by both solvers."""

    residual: float
    energy: float
    other: float

    @property
    def difference(self) -> float:
        """How much dearer the other one is, as a share of the energy."""
        return self.other / self.energy - 1


@dataclass(frozen=True)
class CrossCheck:
    """Points of a front by both solvers.

    Attributes
    ----------
    solver : str
        The other solver.
    points : tuple of Compared
        From the still end to the cheap one.
    """

    solver: str
    points: tuple[Compared, ...]

    @property
    def largest(self) -> float:
        """The largest difference, whichever is dearer; NaN where a point was not found."""
        return float(np.max(np.abs([point.difference for point in self.points])))


@one_at_a_time
def cross_check(front: Front, points: int = 7, report: Report = no_report) -> CrossCheck:
    """Solve points of a front by the solver that did not find them, from the plain cycloid.

    Parameters
    ----------
    front : Front
        A front of any method; what no setting names was found by sequential quadratic programs or
        by no gradient at all, and is checked by IPOPT.
    points : int
        How many points: both ends, and others spread evenly between.
    report : callable, optional
        Called with the number of points done and of all.

    Returns
    -------
    CrossCheck
        What both found. Where the plain cycloid leads to a dearer minimum, random starts follow.

    Raises
    ------
    ValueError
        When the front has no point, or `points` is out of range.
    KeyboardInterrupt
        After Ctrl-C.
    """
    count = min(number_of_points(points), len(front.points))
    solver = "sqp" if front.settings.get("solver") == "ipopt" else "ipopt"
    sweep, found = sweep_of(front, starts=_STARTS, solver=solver), list[Compared]()
    for i in np.linspace(0, len(front.points) - 1, count).round().astype(int):
        found.append(_compared(sweep, front.points[i]))
        report(len(found), count)
    return CrossCheck(solver, tuple(found))


def _compared(sweep: Sweep, point: FrontPoint) -> Compared:
    """A point by both, on the same steps; its residual there is the limit."""
    program = sweep.program
    at = program.evaluated(np.array(point.coefficients))
    ask = sweep.ask(program.peaks(at)[RESIDUAL])
    energy = float(at.energy[0])
    best = np.nan
    for start in sweep.guesses:
        found = sweep.solve([(start, ask)])[0]
        if found.status.solved:
            best = np.nanmin([best, found.energy])
        if best <= energy * (1 + _SAME):
            break
    return Compared(point.residual, energy, float(best))
