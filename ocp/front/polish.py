"""Improve a front by the gradient, each point at its own residual."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from quietarm.ocp.checks import takes
from quietarm.ocp.front.front import Front
from quietarm.ocp.front.points import FailedPoint, FrontPoint, non_dominated
from quietarm.ocp.front.tradeoff import RESIDUAL_LIMIT, Certificate, Tradeoff
from quietarm.ocp.limits import RESIDUAL
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY
from quietarm.ocp.record import versions
from quietarm.ocp.solvers.choice import as_part, without_part
from quietarm.ocp.solvers.problem import Solution
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.told_progress import Progress, no_report


@dataclass(frozen=True)
class Gain:
    """Energies [J] of one point before and after, the same where nothing better was found.

    Its residual [m] is the limit of the improved point.
    """

    residual: float
    before: float
    after: float

    @property
    def share(self) -> float:
        """Share of the energy that was saved."""
        return 1 - self.after / self.before


POLISH = "polish"
"""What a record calls the solver that polished, beside the one that found the front."""


@dataclass(frozen=True)
class Polish:
    """An improved front and what each point gained.

    Attributes
    ----------
    front : Front
        The improved points; of those that could not be improved the old ones, with the reason in
        its `failures`.
    gains : tuple of Gain
        One for every point of the front that is polished, in its order.
    """

    front: Front
    gains: tuple[Gain, ...]


@takes(front=Front, solver=Solver)
def polish_front(
    front: Front,
    *,
    steps: int | None = None,
    solver: Solver = Sqp(),
    report: Progress = no_report,
) -> Polish:
    """Start the gradient from every point of a front, within the point's residual and peaks.

    Parameters
    ----------
    front : Front
        A front of any method; the bound of its record is kept.
    steps, solver
        As for `plan_move`.
    report : callable, optional
        Called with the number of points done and of all.

    Returns
    -------
    Polish
        The improved front; its method is that of the front and ", polished", and its settings name
        the solver.

    Raises
    ------
    ValueError
        When the front has no point.
    """
    began = time.perf_counter()
    tradeoff = Tradeoff.of_front(front, starts=1, steps=steps, solver=solver)
    of_energy = front.objectives == RESIDUAL_AND_ENERGY
    improve_all = _along if of_energy else _within_peaks
    improved = list(improve_all(tradeoff, front, report))
    certificates = [certificate for of_point in improved for certificate in of_point]
    failures = tuple(
        certificate.point
        for certificate in certificates
        if isinstance(certificate.point, FailedPoint)
    )
    points = [
        certificate.point
        for certificate in certificates
        if isinstance(certificate.point, FrontPoint)
    ]
    iterations = sum(certificate.iterations for certificate in certificates)
    record = replace(
        front.record,
        method=f"{front.record.method}, polished",
        settings={
            **without_part(POLISH, front.record.settings),
            **as_part(POLISH, solver.stated),
            "steps": tradeoff.program.steps,
        },
        iterations=front.record.iterations + iterations,
        versions=versions(),
        seconds=front.record.seconds + time.perf_counter() - began,
    )
    polished = replace(
        front,
        points=non_dominated(points, front.objectives),
        record=record,
        failed=len(failures),
        infeasible=0,
        failures=failures,
        gaps=(),
    )
    return Polish(polished, tuple(map(_gain, front.points, improved)))


def _along(tradeoff: Tradeoff, front: Front, report: Progress) -> Iterator[list[Certificate]]:
    """Each point or a better one of no larger residual."""
    problems = [tradeoff.problem(point.residual) for point in front.points]
    starts = [np.array(point.coefficients) for point in front.points]
    solutions = tradeoff.solver.solve(problems, starts)
    for done, (point, solution) in enumerate(zip(front.points, solutions), start=1):
        yield _improve(tradeoff, point, solution)
        report(done, len(front.points))


def _within_peaks(
    tradeoff: Tradeoff, front: Front, report: Progress
) -> Iterator[list[Certificate]]:
    """Each point or a better one of no larger residual and no larger peaks."""
    sizes = [{RESIDUAL: point.residual, **point.peaks} for point in front.points]
    problems = [tradeoff.within(of_point) for of_point in sizes]
    starts = [np.array(point.coefficients) for point in front.points]
    solutions = tradeoff.solver.solve(problems, starts)
    rows = zip(front.points, problems, solutions)
    for done, (point, problem, solution) in enumerate(rows, start=1):
        outcome = solution.status.text
        if solution.status.solved:
            (outcome,) = tradeoff.certify_within([solution], [problem], problem.limits)
        if isinstance(outcome, Certificate) and isinstance(outcome.point, FrontPoint):
            better = outcome.point.energy < point.energy
            yield [Certificate(outcome.point if better else point, solution.iterations)]
        else:
            failed = FailedPoint({RESIDUAL_LIMIT: point.residual}, str(outcome))
            yield [Certificate(point, 0), Certificate(failed, solution.iterations)]
        report(done, len(front.points))


def _improve(tradeoff: Tradeoff, point: FrontPoint, solution: Solution) -> list[Certificate]:
    """The point or a better one; after the former the reason, if there is one."""
    place = {RESIDUAL_LIMIT: point.residual}
    (certificate,) = tradeoff.certify([(solution, place)], point.residual)
    if isinstance(certificate.point, FailedPoint):
        return [Certificate(point, 0), certificate]
    if certificate.point.energy < point.energy:
        return [certificate]
    return [Certificate(point, certificate.iterations)]


def _gain(point: FrontPoint, certificates: list[Certificate]) -> Gain:
    improved = certificates[0].point
    assert isinstance(improved, FrontPoint)
    return Gain(point.residual, point.energy, improved.energy)
