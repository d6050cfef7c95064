"""Compare a solver's answers with another integrator, and correct them where they differ.

CVODES judges them. Many without limits are judged by much finer steps, which CVODES confirms at
every tenth.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.figures import ENERGY, Figures
from quietarm.ocp.joint_words import passed_words
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.limits import QUANTITIES, RESIDUAL, Limit, Quantity
from quietarm.ocp.profiles.check_profile import check_motion
from quietarm.ocp.rest import still_of
from quietarm.ocp.simulation.evaluator import Evaluation, Evaluator
from quietarm.ocp.simulation.mesh import default_steps
from quietarm.ocp.solvers.problem import (
    MOST_SOLVER_STEPS,
    Program,
    Solution,
    evaluate,
    programs_of,
)
from quietarm.ocp.solvers.solver import Solver

Array = NDArray[np.float64]
_BELOW = 1 + 2e-8
"""A limit that is passed is tightened by this share beyond the excess: the solver's own tolerance,
else the next peak passes the limit by as little again."""
OVERRUN = 1e-3
"""Share of a limit by which a verified peak may pass it when tightening found nothing better."""
_EVERY = 10
"""CVODES checks one motion in so many of those that finer steps judge."""


OF_A_PLAN = 1e-5
"""Share by which the energies of solver and integrator may differ. The solver's cheapest motion is
then the independent integrator's within 1e-6, in all but one of 56 plans tried (6e-6)."""


@dataclass(frozen=True)
class Certified:
    """A solution with what another integrator says, and the problem, tightened, that it solves.

    The figures are those of a motion that CVODES judges; residual and energy are there by finer
    steps as well.
    `by_cvodes` is true if CVODES computed or confirmed them.
    """

    solution: Solution
    figures: Figures
    problem: Program
    by_cvodes: bool

    @property
    def steps(self) -> int:
        """The solver's steps."""
        return self.problem.steps

    @property
    def energy(self) -> float:
        """Energy [J] by the other integrator."""
        return self.figures.energy

    def keeps(self, limits: Sequence[Limit], still: float) -> bool:
        """Return whether no limit is passed; a residual up to `still` [m] counts as rest."""
        return all(limit.keeps(limit.peak_of(self.figures), 0.0, still) for limit in limits)


def certify(
    problems: Sequence[Program],
    solutions: Sequence[Solution],
    solver: Solver,
    limits: Sequence[Limit] | None = None,
    *,
    agreement: float = OF_A_PLAN,
    most_steps: int = MOST_SOLVER_STEPS,
) -> list[Certified | SolverFailedError]:
    """Compare with CVODES; correct arrivals, double the steps, tighten what is exceeded.

    The solver's few steps miss the state on arrival by a little; limits hold at its nodes only, and
    the residual limit at its samples. The differences that the independent integrator finds are
    given to the solver, which goes on from where it stopped. The problems are of one plant and
    profile; what has to hold by CVODES are their own limits by default. The energies of solver and
    integrator agree to a share, on at most so many of the solver's steps. An error stands for a
    motion that exceeds a limit all the same.
    """

    def rows_of(numbers: Iterable[int]) -> list[_Row]:
        return [_Row(problems[i], solutions[i], limits, agreement, most_steps) for i in numbers]

    outcomes: dict[int, Certified | SolverFailedError] = {}
    without_limits = [i for i, problem in enumerate(problems) if _is_without_limits(problem)]
    if len(without_limits) >= _EVERY:
        settled = _settle(rows_of(without_limits), solver, _judge_by_finer_steps)
        outcomes = dict(zip(without_limits, _confirm(settled)))
    uncertified = [i for i in range(len(problems)) if not isinstance(outcomes.get(i), Certified)]
    settled = _settle(rows_of(uncertified), solver, _judge_by_cvodes)
    outcomes |= dict(zip(uncertified, settled))
    return [outcomes[i] for i in range(len(problems))]


def _is_without_limits(problem: Program) -> bool:
    task = problem.task
    return not task.limits and task.uncertainty is None


def certify_one(
    problem: Program,
    solution: Solution,
    solver: Solver,
    limits: Sequence[Limit] | None = None,
    *,
    agreement: float = OF_A_PLAN,
    most_steps: int = MOST_SOLVER_STEPS,
) -> Certified:
    """Certify one solution; its error is raised."""
    (outcome,) = certify(
        [problem], [solution], solver, limits, agreement=agreement, most_steps=most_steps
    )
    if isinstance(outcome, SolverFailedError):
        raise outcome
    return outcome


class _Row:
    """A solution on its way: the problem that it solves, and all that was judged."""

    def __init__(
        self,
        problem: Program,
        solution: Solution,
        limits: Sequence[Limit] | None,
        agreement: float,
        most_steps: int,
    ) -> None:
        self.problem = problem
        self.solution = solution
        self.agreement = max(agreement, problem.profile.energy_agreement)
        self.most_steps = most_steps
        self.asked = problem
        self.tightened = problem.limits
        self.limits = problem.limits if limits is None else limits
        # a share of what the plain motion leaves counts as none as well
        self.still = max(still_of(problem.task), 1e-7 * problem.plain_residual)
        self.tried: list[Certified] = []
        self.arrival: Array = np.empty(0)
        self.failure: SolverFailedError | None = None

    @property
    def figures(self) -> Figures:
        """Figures of the last motion, by another integrator."""
        return self.tried[-1].figures

    def note(self, figures: Figures, arrival: Array) -> None:
        """Note what another integrator says of the last solution, and its states on arrival."""
        by_cvodes = figures.candidate is not None
        self.tried.append(Certified(self.solution, figures, self.problem, by_cvodes))
        self.arrival = arrival
        self.tightened = tighten(self.tightened, figures, self.limits)

    def go_on_from(self, solution: Solution, problem: Program) -> None:
        """Take another solution, whose iterations count as well; what found the first one stays."""
        iterations = self.solution.iterations + solution.iterations
        found_by = self.solution.solved_by
        self.solution = replace(solution, iterations=iterations, solved_by=found_by)
        self.problem = problem

    @property
    def is_rough(self) -> bool:
        """Return whether the solver's steps are too few for the energy."""
        energy = self.figures.energy
        return abs(self.solution.energy - energy) > self.agreement * energy

    @property
    def differs(self) -> bool:
        """Return whether the residuals differ, or a limit is exceeded.

        They may differ by a share of rest, or of the limit.
        """
        tolerated = max(0.3 * self.still, 5e-3 * self.asked.residual_limit)
        difference = abs(self.solution.residual - self.figures.residual)
        return difference > tolerated or bool(self.figures.exceeded(self.limits))

    def outcome(self) -> Certified | SolverFailedError:
        """The cheapest of the motions that keep every limit; else the last, or what it exceeds."""
        if self.failure is not None:
            return self.failure
        keeping = [
            certified for certified in self.tried if certified.keeps(self.limits, self.still)
        ]
        if keeping:
            return min(keeping, key=lambda certified: certified.energy)
        remedy = (
            "the solver's steps are too coarse for this motion; bound the coefficients, use fewer "
            "terms, or give a longer duration"
        )
        return excess_error(self.figures, self.limits, remedy, self.still) or self.tried[-1]


def _settle(
    rows: Sequence[_Row],
    solver: Solver,
    judge_all: Callable[[Sequence[_Row]], None],
    rounds: int = 12,
) -> list[Certified | SolverFailedError]:
    """Correct or refine what differs, until nothing does, at most `rounds` times.

    It ends as well where no row was solved again.
    """
    judge_all(rows)
    going = rows
    for _ in range(rounds):
        going = [row for row in going if row.failure is None]
        rough = [row for row in going if row.is_rough]
        differing = [row for row in going if not row.is_rough and row.differs]
        corrected = _correct(differing, solver)
        rough += [row for row in differing if row not in corrected]
        going = [*corrected, *_refine(rough, solver)]
        if not going:
            break
        judge_all(going)
    return [row.outcome() for row in rows]


def _correct(rows: Sequence[_Row], solver: Solver) -> list[_Row]:
    """Solve rows with tighter limits, and with what the steps miss of their states on arrival."""
    solved: list[_Row] = []
    for alike in _alike(rows):
        by_steps = evaluate([row.problem for row in alike], _table(alike))
        problems = []
        for row, motion in zip(alike, by_steps):
            missed = row.arrival - motion.arrival
            problems.append(row.problem.asking(limits=row.tightened, offset=missed))
        solved += _solve_again(alike, problems, solver)
    return solved


def _refine(rows: Sequence[_Row], solver: Solver) -> list[_Row]:
    """Solve rows on twice the steps, if they may have as many."""
    solved: list[_Row] = []
    refinable = [row for row in rows if 2 * row.problem.steps <= row.most_steps]
    for alike in _alike(refinable):
        coarse = alike[0].problem
        tasks = [row.problem.task for row in alike]
        finer = programs_of(tasks, coarse.profile, 2 * coarse.steps)
        problems = []
        for row, on_finer_steps in zip(alike, finer):
            row.tightened = row.asked.limits
            problems.append(row.asked.on_steps_of(on_finer_steps))
        solved += _solve_again(alike, problems, solver)
    return solved


def _solve_again(
    rows: Sequence[_Row], problems: Sequence[Program], solver: Solver
) -> Iterable[_Row]:
    """The rows that are solved from their solutions."""
    starts = [row.solution.coefficients for row in rows]
    solutions = solver.solve(problems, starts, warm=True)
    for row, problem, solution in zip(rows, problems, solutions):
        if solution.status.solved:
            row.go_on_from(solution, problem)
            yield row


def _judge_by_cvodes(rows: Sequence[_Row]) -> None:
    for row in rows:
        candidate = by_cvodes(row.problem, row.solution.coefficients)
        try:
            _ = candidate.energy
            _ = candidate.residual  # in all scenarios
        except SolverFailedError as error:
            row.failure = error
        else:
            row.note(candidate.figures, candidate.arrival)


def _judge_by_finer_steps(rows: Sequence[_Row]) -> None:
    for alike in _alike(rows):
        evaluation = _evaluate_finely([row.problem for row in alike], _table(alike))
        for i, row in enumerate(alike):
            task = row.problem.task
            check_motion(row.problem.profile, row.solution.coefficients, *task.move)
            figures = {
                ENERGY: float(evaluation.energy[i, 0]),
                RESIDUAL: float(evaluation.residual[i, 0]),
            }
            row.note(Figures(figures), evaluation.arrival[i])


def _confirm(
    outcomes: Sequence[Certified | SolverFailedError], agreement: float = 1e-6
) -> Sequence[Certified | SolverFailedError]:
    """Figures by finer steps with CVODES' word at every tenth; none where that is another.

    The two may differ by a share, the `agreement`.
    """
    confirmed = list(outcomes)
    for i in range(0, len(outcomes), _EVERY):
        outcome = outcomes[i]
        if isinstance(outcome, SolverFailedError):
            continue
        figures = outcome.figures
        exact = by_cvodes(outcome.problem, outcome.solution.coefficients)
        energy_differs = abs(exact.energy - figures.energy) > agreement * exact.energy
        tolerated = agreement * exact.residual + still_of(exact.task)
        if energy_differs or abs(exact.residual - figures.residual) > tolerated:
            return []
        confirmed[i] = replace(outcome, by_cvodes=True)
    return confirmed


def _alike(rows: Sequence[_Row]) -> list[list[_Row]]:
    """The rows of the same steps."""

    def steps(row: _Row) -> int:
        return row.problem.steps

    return [list(alike) for _, alike in groupby(sorted(rows, key=steps), steps)]


def _table(rows: Sequence[_Row]) -> Array:
    return np.array([row.solution.coefficients for row in rows])


def finer_peaks(problems: Sequence[Program], coefficients: Array) -> dict[str, Array]:
    """Peaks of every quantity of one motion of each task, at the nodes of finer steps."""
    evaluation = _evaluate_finely(problems, coefficients, tuple(QUANTITIES.values()))
    return {name: evaluation.largest(name)[:, 0] for name in QUANTITIES}


def _evaluate_finely(
    problems: Sequence[Program],
    coefficients: Array,
    quantities: Sequence[Quantity] = (),
    finer: int = 3,
) -> Evaluation:
    """A motion of each task, on its nominal plant, by so many times the solver's steps."""
    first = problems[0]
    steps = max(default_steps(first.task), finer * first.steps)
    tasks = [problem.task.certain for problem in problems]
    evaluator = Evaluator(tasks, first.profile, steps, quantities=quantities)
    return evaluator(coefficients)


def by_cvodes(problem: Program, coefficients: Array) -> JudgedMotion:
    """The motion of coefficients, for CVODES."""
    return JudgedMotion.of_profile(problem.task, problem.profile, coefficients)


def tighten(
    limits: Sequence[Limit], verified: Figures, to_keep: Sequence[Limit]
) -> tuple[Limit, ...]:
    """The limits to give the solver, each less by as much as the verified motion exceeds it."""
    exceeded = verified.exceeded(to_keep)
    return tuple(
        limit.tightened(_BELOW * exceeded[limit.name]) if limit.name in exceeded else limit
        for limit in limits
    )


def excess_error(
    verified: Figures, limits: Sequence[Limit], remedy: str, still: float = 0.0
) -> SolverFailedError | None:
    """Return the error of a verified motion that exceeds a limit although limits were tightened."""
    for limit in limits:
        peak = limit.peak_of(verified)
        if not limit.keeps(peak, OVERRUN, still):
            words = f"{limit.describe(peak)}, above its limit of {limit.bounds}"
            if verified.candidate is not None:
                words = passed_words(limit, verified.candidate, OVERRUN)
            return SolverFailedError(f"the verified {limit.label} is {words}: {remedy}")
    return None
