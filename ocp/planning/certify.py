"""Compare a solver's answer with the independent integrator, and correct it where they differ."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.candidate import Candidate
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.limits import Limit, Ranged
from quietarm.ocp.solvers.choice import Solver
from quietarm.ocp.solvers.problem import Problem, Solution
from quietarm.ocp.solvers.transcription import (
    MOST_SOLVER_STEPS,
    STILL,
    STILL_SHARE,
    Transcription,
)

_RESIDUAL_AGREEMENT = 5e-3
AT_REST = 0.3
"""Of a limit, and of rest: by these shares may the two integrators' residuals differ."""
_ROUNDS = 12
_BELOW = 1 + 2e-8
"""A limit that is passed is tightened by this share beyond the excess: the solver's own tolerance,
else the next peak passes the limit by as little again."""
OVERRUN = 1e-3
"""Share of a limit by which a verified peak may pass it when tightening found nothing better."""


@dataclass(frozen=True)
class Tolerances:
    """When a solution counts as certified.

    Attributes
    ----------
    energy : float
        Share by which the energies of solver and integrator may differ.
    most_steps : int
        The solver's steps are doubled up to this many.
    """

    energy: float = 1e-5
    most_steps: int = MOST_SOLVER_STEPS


OF_A_PLAN = Tolerances()
"""The solver's cheapest motion is then the independent integrator's within 1e-6, in all but one of
56 plans tried (6e-6)."""


@dataclass(frozen=True)
class FinerFigures:
    """Energy [J] and residual [m] by much finer steps; whether CVODES judged the motion, too."""

    energy: float
    residual: float
    by_cvodes: bool = False


Checked = TypeVar("Checked", Candidate, FinerFigures, covariant=True)


@dataclass(frozen=True)
class Certified(Generic[Checked]):
    """A solution with the figures of another integrator, and the problem, tightened, it solves."""

    solution: Solution
    checked: Checked
    problem: Problem

    @property
    def steps(self) -> int:
        """The solver's steps."""
        return self.problem.transcription.steps


def certify(
    problem: Problem,
    solution: Solution,
    solver: Solver,
    tolerances: Tolerances = OF_A_PLAN,
    limits: Sequence[Limit] | None = None,
) -> Certified[Candidate]:
    """Compare with CVODES; correct the arrival, double the steps, tighten what is exceeded.

    The solver's few steps miss the state on arrival by a little; limits hold at its nodes only, and
    the residual limit at its samples. The differences that the independent integrator finds are
    given to the solver, which goes on from where it stopped.

    Parameters
    ----------
    problem : Problem
        What was solved.
    solution : Solution
        Its solution.
    solver : Solver
        What solves it again.
    tolerances : Tolerances
        When both count as equal.
    limits : sequence of Limit, optional
        What has to hold by CVODES; the problem's own limits by default.

    Raises
    ------
    SolverFailedError
        When a limit is exceeded all the same.
    """
    (transcription, asked), best = problem, solution
    limits, tightened = asked.limits if limits is None else limits, asked.limits
    still = max(STILL, STILL_SHARE * transcription.plain_residual)
    tolerated = max(AT_REST * still, _RESIDUAL_AGREEMENT * asked.residual_limit)
    tried: list[Certified[Candidate]] = []

    def check(problem: Problem, found: Solution) -> Candidate:
        tried.append(Certified(found, judge(transcription, found.coefficients), problem))
        return tried[-1].checked

    simulated = check(problem, best)
    for _ in range(_ROUNDS):
        tightened = tighten(tightened, simulated, limits)
        rough = abs(best.energy - simulated.energy) > tolerances.energy * simulated.energy
        missed = abs(best.residual - simulated.residual) > tolerated
        again = None
        if not rough and (missed or simulated.exceeded(limits)):
            offset = simulated.arrival - transcription.evaluate(best.coefficients).arrival
            problem = Problem(transcription, asked._replace(limits=tightened, offset=offset))
            (again,) = solve_again([problem], [best], solver)
        elif not rough:
            break
        if again is None or not again.status.solved:
            if 2 * transcription.steps > tolerances.most_steps:
                break
            transcription = transcription.refine()
            problem = Problem(transcription, asked)
            (again,) = solve_again([problem], [best], solver)
            tightened = asked.limits
            if not again.status.solved:
                break
        best, simulated = again, check(problem, again)
    cheapest = _cheapest_kept(tried, limits, still)
    remedy = "bound the coefficients or use fewer terms"
    refuse_exceeded(
        cheapest.checked,
        limits,
        f"the solver's steps are too coarse for this motion; {remedy}",
        still,
    )
    return cheapest


def solve_again(
    problems: Sequence[Problem], solutions: Sequence[Solution], solver: Solver
) -> list[Solution]:
    """Solve problems from solutions close by, whose iterations count as well."""
    found = solver.solve(problems, [one.coefficients for one in solutions], warm=True)
    return [
        replace(new, iterations=old.iterations + new.iterations)
        for new, old in zip(found, solutions, strict=True)
    ]


def judge(transcription: Transcription, coefficients: NDArray[np.float64]) -> Candidate:
    """The motion of coefficients, for CVODES."""
    return Candidate.of_profile(transcription.task, transcription.profile, coefficients)


def tighten(limits: Sequence[Limit], motion: Ranged, kept: Sequence[Limit]) -> tuple[Limit, ...]:
    """The limits to give the solver, each less by as much as the verified motion exceeds it."""
    exceeded = motion.exceeded(kept)
    return tuple(
        one.tightened(_BELOW * exceeded[one.name]) if one.name in exceeded else one
        for one in limits
    )


def refuse_exceeded(
    motion: Ranged, limits: Sequence[Limit], remedy: str, still: float = 0.0
) -> None:
    """Refuse a verified motion that exceeds a limit although limits were tightened."""
    for limit in limits:
        peak = limit.peak_of(motion)
        if not limit.keeps(peak, OVERRUN, still):
            raise SolverFailedError(
                f"the verified {limit.name} is {limit.describe(peak)}, above its limit of "
                f"{limit.bounds}: {remedy}"
            )


def _cheapest_kept(
    tried: list[Certified[Candidate]], kept: Sequence[Limit], still: float
) -> Certified[Candidate]:
    """The cheapest of the verified motions that keep every limit; else the last."""
    keeping = [
        one
        for one in tried
        if all(limit.keeps(limit.peak_of(one.checked), at_rest=still) for limit in kept)
    ]
    return min(keeping, key=lambda one: one.checked.energy) if keeping else tried[-1]
