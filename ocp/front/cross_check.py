"""Solve points of a front by the other solver."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from quietarm.ocp.checks import takes
from quietarm.ocp.front.curve import Curve, Report, curve_of, no_report
from quietarm.ocp.front.front import Front
from quietarm.ocp.front.points import FrontPoint
from quietarm.ocp.limits import RESIDUAL, Limit
from quietarm.ocp.planning.certify import OVERRUN, by_cvodes
from quietarm.ocp.record import number_of_points
from quietarm.ocp.solvers.choice import other_solver, stated_solver
from quietarm.ocp.solvers.problem import Problem
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp

_SAME = 1e-6
"""Energies that differ by no more than this share agree."""
_STARTS = 4
"""The plain cycloid first; where that leads to a dearer minimum random ones, and last the point."""


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
    solver : Solver
        The other solver.
    points : tuple of Compared
        From the smallest residual to the least energy.
    """

    solver: Solver
    points: tuple[Compared, ...]

    @property
    def largest(self) -> float:
        """The largest relative difference in energy; NaN if a point was not found."""
        return float(np.max(np.abs([point.difference for point in self.points])))


@takes(front=Front, solver=Solver)
def cross_check(
    front: Front,
    *,
    checked_points: int = 7,
    solver: Solver | None = None,
    report: Report = no_report,
) -> CrossCheck:
    """Solve points of a front by the solver that did not find them, from the plain cycloid.

    Parameters
    ----------
    front : Front
        A front of any method.
    checked_points : int
        How many points: both ends, and others spread evenly between.
    solver : Solver, optional
        What checks it; by default the solver that did not find it, with the same options, and
        IPOPT if the front's settings name none.
    report : callable, optional
        Called with the number of points done and of all.

    Returns
    -------
    CrossCheck
        The energies of both. If the plain cycloid leads to a higher energy, random starts
        follow, and in the end the point itself.

    Raises
    ------
    ValueError
        When the front has no point, or `checked_points` is out of range.
    """
    count = min(number_of_points(checked_points), len(front.points))
    if solver is None:
        solver = other_solver(stated_solver(front.record.settings) or Sqp())
    curve = curve_of(front, starts=_STARTS, solver=solver)
    found = list[Compared]()
    for i in np.linspace(0, len(front.points) - 1, count).round().astype(int):
        found.append(_compare(curve, front.points[i]))
        report(len(found), count)
    return CrossCheck(solver, tuple(found))


def _compare(curve: Curve, point: FrontPoint) -> Compared:
    """A point by both, within the same limits at the nodes of the same steps."""
    transcription, asked = curve.problem()
    motion = transcription.evaluate(np.array(point.coefficients))
    peaks = transcription.measure(motion).peaks_of(0)
    own = by_cvodes(transcription, np.array(point.coefficients))
    # a limit that the point is at was tightened until it held between the nodes as well
    limits = [
        one if one.keeps(one.peak_of(own), -OVERRUN) else one.tightened(one.size / peaks[one.name])
        for one in curve.task.limits
    ]
    limits.append(Limit.of_residual(peaks[RESIDUAL]))
    problem, best = Problem(transcription, asked._replace(limits=tuple(limits))), np.nan
    starts = [(start, False) for start in curve.starts]
    for start, warm in [*starts, (np.array(point.coefficients), True)]:
        (found,) = curve.solver.solve([problem], [start], warm=warm)
        if found.status.solved:
            energy = by_cvodes(transcription, found.coefficients).energy
            best = float(np.nanmin([best, energy]))
        if best <= own.energy * (1 + _SAME):
            break
    return Compared(point.residual, own.energy, best)
