"""Solve points of a front by the other solver."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.checks import takes
from quietarm.ocp.front.front import Front
from quietarm.ocp.front.points import FrontPoint
from quietarm.ocp.front.tradeoff import Tradeoff
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.limits import RESIDUAL, Limit
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY
from quietarm.ocp.planning.certify import OVERRUN, by_cvodes
from quietarm.ocp.record import number_of_points
from quietarm.ocp.solvers.choice import other_solver, stated_solver
from quietarm.ocp.solvers.problem import Program
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.told_progress import Progress, no_report


@dataclass(frozen=True)
class Compared:
    """One point by both solvers."""

    residual: float
    energy: float
    other: float

    @property
    def difference(self) -> float:
        """Excess of the other energy, as a share of the energy."""
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
    report: Progress = no_report,
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
        When the front has no point, or other objectives than residual and energy, or
        `checked_points` is out of range.
    """
    if front.objectives != RESIDUAL_AND_ENERGY:
        raise ValueError(
            "a cross check is of residual and energy; find the front again by the other solver, "
            "and compare the two"
        )
    count = min(number_of_points(checked_points), len(front.points))
    if solver is None:
        solver = other_solver(stated_solver(front.record.settings) or Sqp())
    tradeoff = Tradeoff.of_front(front, starts=4, solver=solver)
    checked = np.linspace(0, len(front.points) - 1, count).round().astype(int)
    compared: list[Compared] = []
    for i in checked:
        compared.append(_compare(tradeoff, front.points[i]))
        report(len(compared), count)
    return CrossCheck(solver, tuple(compared))


def _compare(tradeoff: Tradeoff, point: FrontPoint, same: float = 1e-6) -> Compared:
    """A point by both, within the same limits at the nodes of the same steps.

    Energies that differ by no more than the share `same` agree.
    """
    problem = tradeoff.problem()
    coefficients = np.array(point.coefficients)
    motion = by_cvodes(problem, coefficients)
    limits = _limits_at_nodes(problem, motion, coefficients)
    problem = problem.asking(limits=tuple(limits))
    best = np.nan
    starts = [(start, False) for start in tradeoff.starts]
    for start, warm in [*starts, (coefficients, True)]:
        (solution,) = tradeoff.solver.solve([problem], [start], warm=warm)
        if solution.status.solved:
            energy = by_cvodes(problem, solution.coefficients).energy
            best = float(np.nanmin([best, energy]))
        if best <= motion.energy * (1 + same):
            break
    return Compared(point.residual, motion.energy, best)


def _limits_at_nodes(
    problem: Program, motion: JudgedMotion, coefficients: NDArray[np.float64]
) -> Iterator[Limit]:
    """The limits that a point's motion keeps at the nodes of the steps.

    A limit that it is at was tightened until it held between the nodes as well.
    """
    at_nodes = problem.measure(problem.evaluate(coefficients))
    peaks = at_nodes.peaks_of(0)
    for limit in problem.task.limits:
        if limit.keeps(limit.peak_of(motion.figures), -OVERRUN):
            yield limit
        else:
            yield limit.tightened(limit.size / peaks[limit.name])
    yield Limit.of_residual(peaks[RESIDUAL])
