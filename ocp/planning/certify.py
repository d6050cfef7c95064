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

from quietarm.ocp.candidate import Candidate
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.limits import QUANTITIES, Limit, Quantity, Ranged
from quietarm.ocp.profiles.check_profile import check_motion
from quietarm.ocp.simulation.evaluator import Evaluation, Evaluator
from quietarm.ocp.simulation.mesh import default_steps
from quietarm.ocp.solvers.problem import (
    MOST_SOLVER_STEPS,
    STILL,
    STILL_SHARE,
    Problem,
    Solution,
    Transcription,
    evaluate,
    transcribe,
)
from quietarm.ocp.solvers.solver import Solver

Array = NDArray[np.float64]
_RESIDUAL_AGREEMENT, _AT_REST = 5e-3, 0.3
"""Of a limit, and of rest: by these shares may the two integrators' residuals differ."""
_ROUNDS = 12
_BELOW = 1 + 2e-8
"""A limit that is passed is tightened by this share beyond the excess: the solver's own tolerance,
else the next peak passes the limit by as little again."""
OVERRUN = 1e-3
"""Share of a limit by which a verified peak may pass it when tightening found nothing better."""
_EVERY, _AGREEMENT, _FINER = 10, 1e-6, 3
"""CVODES checks one motion in so many, and its figures may differ by this share from those of so
many times the solver's steps."""


@dataclass(frozen=True)
class Tolerances:
    """Share by which the energies of solver and integrator may differ; most steps of the solver."""

    energy: float = 1e-5
    most_steps: int = MOST_SOLVER_STEPS


OF_A_PLAN = Tolerances()
"""The solver's cheapest motion is then the independent integrator's within 1e-6, in all but one of
56 plans tried (6e-6)."""


@dataclass(frozen=True)
class FinerFigures(Ranged):
    """Energy [J], residual [m] and state on arrival by finer steps; whether CVODES confirmed them.

    The state has shape (1, 2 * modes).
    """

    energy: float
    residual: float
    arrival: Array
    by_cvodes: bool = False

    def range_of(self, quantity: Quantity) -> tuple[float, float]:
        """As of `Ranged`, of the residual alone."""
        del quantity
        return -self.residual, self.residual


Figures = Candidate | FinerFigures


@dataclass(frozen=True)
class Certified:
    """A solution with the figures of another integrator, and the problem, tightened, it solves."""

    solution: Solution
    checked: Figures
    problem: Problem

    @property
    def steps(self) -> int:
        """The solver's steps."""
        return self.problem.transcription.steps


Outcome = Certified | SolverFailedError


def certify(
    problems: Sequence[Problem],
    solutions: Sequence[Solution],
    solver: Solver,
    tolerances: Tolerances = OF_A_PLAN,
    limits: Sequence[Limit] | None = None,
) -> list[Outcome]:
    """Compare with CVODES; correct arrivals, double the steps, tighten what is exceeded.

    The solver's few steps miss the state on arrival by a little; limits hold at its nodes only, and
    the residual limit at its samples. The differences that the independent integrator finds are
    given to the solver, which goes on from where it stopped. The problems are of one plant and
    profile; what has to hold by CVODES are their own limits by default. An error stands for a
    motion that exceeds a limit all the same.
    """
    pairs = zip(problems, solutions)
    rows = [_Row(*pair, tolerances, limits) for pair in pairs]
    found = dict[int, Outcome]()
    many = [
        i for i, row in enumerate(rows)
        if not row.transcription.task.limits and row.transcription.task.uncertainty is None
    ]  # fmt: skip
    if len(many) >= _EVERY:
        own = _confirm(_settle([rows[i] for i in many], solver, _judge_by_finer_steps))
        found = dict(zip(many, own))
    others = [i for i in range(len(rows)) if not isinstance(found.get(i), Certified)]
    anew = [_Row(problems[i], solutions[i], tolerances, limits) for i in others]
    found |= dict(zip(others, _settle(anew, solver, _judge_by_cvodes)))
    return [found[i] for i in range(len(rows))]


def certify_one(
    problem: Problem,
    solution: Solution,
    solver: Solver,
    tolerances: Tolerances = OF_A_PLAN,
    limits: Sequence[Limit] | None = None,
) -> Certified:
    """The same of one solution; its error is raised."""
    (found,) = certify([problem], [solution], solver, tolerances, limits)
    if isinstance(found, SolverFailedError):
        raise found
    return found


class _Row:
    """A solution on its way: the problem that it solves, and all that was judged."""

    def __init__(
        self,
        problem: Problem,
        solution: Solution,
        tolerances: Tolerances,
        limits: Sequence[Limit] | None,
    ) -> None:
        self.problem, self.best, self.asked = problem, solution, problem.scalarization
        self.tolerances, self.tightened = tolerances, self.asked.limits
        self.limits = self.asked.limits if limits is None else limits
        self.still = max(STILL, STILL_SHARE * self.transcription.plain_residual)
        self.tried = list[Certified]()
        self.failure: SolverFailedError | None = None

    @property
    def transcription(self) -> Transcription:
        """The task on the steps that it takes now."""
        return self.problem.transcription

    @property
    def figures(self) -> Figures:
        """Of the last motion."""
        return self.tried[-1].checked

    def judged(self, figures: Figures | SolverFailedError) -> None:
        """Note what another integrator says of the last solution."""
        if isinstance(figures, SolverFailedError):
            self.failure = figures
        else:
            self.tried.append(Certified(self.best, figures, self.problem))
            self.tightened = tighten(self.tightened, figures, self.limits)

    @property
    def is_rough(self) -> bool:
        """Whether the solver's steps are too few for the energy."""
        energy = self.figures.energy
        share = max(self.tolerances.energy, self.transcription.profile.energy_agreement)
        return abs(self.best.energy - energy) > share * energy

    @property
    def differs(self) -> bool:
        """Whether the residuals differ, or a limit is exceeded."""
        tolerated = max(_AT_REST * self.still, _RESIDUAL_AGREEMENT * self.asked.residual_limit)
        missed = abs(self.best.residual - self.figures.residual) > tolerated
        return missed or bool(self.figures.exceeded(self.limits))

    def outcome(self) -> Outcome:
        """The cheapest of the motions that keep every limit; else the last, or what it exceeds."""
        if self.failure is not None:
            return self.failure
        keeping = [
            one
            for one in self.tried
            if all(
                limit.keeps(limit.peak_of(one.checked), 0.0, self.still) for limit in self.limits
            )
        ]
        if keeping:
            return min(keeping, key=lambda one: one.checked.energy)
        remedy = (
            "the solver's steps are too coarse for this motion; bound the coefficients, use fewer "
            "terms, or give a longer duration"
        )
        return excess_error(self.figures, self.limits, remedy, self.still) or self.tried[-1]


def _settle(rows: Sequence[_Row], solver: Solver, judge_all: Judge) -> list[Outcome]:
    """Judge and solve again until nothing differs, or no solution is nearer."""
    judge_all(rows)
    going = rows
    for _ in range(_ROUNDS):
        going = [row for row in going if row.failure is None]
        rough = [row for row in going if row.is_rough]
        differ = [row for row in going if not row.is_rough and row.differs]
        corrected = _correct(differ, solver)
        rough += [row for row in differ if row not in corrected]
        going = [*corrected, *_refine(rough, solver)]
        if not going:
            break
        judge_all(going)
    return [row.outcome() for row in rows]


def _correct(rows: Sequence[_Row], solver: Solver) -> list[_Row]:
    """Solve rows with tighter limits, and with what the steps miss of their states on arrival."""
    solved = list[_Row]()
    for own in _alike(rows):
        by_steps = evaluate([row.transcription for row in own], _table(own))
        problems = [
            Problem(row.transcription, row.asked._replace(
                limits=row.tightened, offset=row.figures.arrival - motion.arrival))
            for row, motion in zip(own, by_steps)
        ]  # fmt: skip
        solved += _solve_again(own, problems, solver)
    return solved


def _refine(rows: Sequence[_Row], solver: Solver) -> list[_Row]:
    """Solve rows on twice the steps, if they may have as many."""
    solved = list[_Row]()
    rows = [row for row in rows if 2 * row.transcription.steps <= row.tolerances.most_steps]
    for own in _alike(rows):
        one, tasks = own[0].transcription, [row.transcription.task for row in own]
        finer = transcribe(tasks, one.profile, 2 * one.steps)
        for row in own:
            row.tightened = row.asked.limits
        pairs = zip(finer, own)
        solved += _solve_again(own, [Problem(each, row.asked) for each, row in pairs], solver)
    return solved


def _solve_again(
    rows: Sequence[_Row], problems: Sequence[Problem], solver: Solver
) -> Iterable[_Row]:
    """The rows that are solved from their solutions, whose iterations count as well."""
    found = solver.solve(problems, [row.best.coefficients for row in rows], warm=True)
    for row, problem, new in zip(rows, problems, found):
        if new.status.solved:
            row.best = replace(new, iterations=row.best.iterations + new.iterations)
            row.problem = problem
            yield row


Judge = Callable[[Sequence[_Row]], None]


def _judge_by_cvodes(rows: Sequence[_Row]) -> None:
    for row in rows:
        candidate = judge(row.transcription, row.best.coefficients)
        try:
            _ = candidate.energy, candidate.residual  # in all scenarios
        except SolverFailedError as error:
            row.judged(error)
        else:
            row.judged(candidate)


def _judge_by_finer_steps(rows: Sequence[_Row]) -> None:
    for own in _alike(rows):
        of = [row.transcription for row in own]
        finer = _by_finer_steps(of, _table(own))
        figures = zip(finer.energy[:, 0], finer.residual[:, 0], finer.arrival)
        for row, (energy, residual, arrival) in zip(own, figures):
            check_motion(of[0].profile, row.best.coefficients, *row.transcription.task.move)
            row.judged(FinerFigures(float(energy), float(residual), arrival))


def _confirm(found: Sequence[Outcome]) -> Sequence[Outcome]:
    """Figures by finer steps with CVODES' word at every tenth; none where that is another."""
    confirmed = list(found)
    for i, one in enumerate(found):
        if i % _EVERY or isinstance(one, SolverFailedError):
            continue
        exact, figures = judge(one.problem.transcription, one.solution.coefficients), one.checked
        assert isinstance(figures, FinerFigures)
        energy_differs = abs(exact.energy - figures.energy) > _AGREEMENT * exact.energy
        room = _AGREEMENT * exact.residual + STILL
        if energy_differs or abs(exact.residual - figures.residual) > room:
            return []
        confirmed[i] = replace(one, checked=replace(figures, by_cvodes=True))
    return confirmed


def _alike(rows: Sequence[_Row]) -> list[list[_Row]]:
    """The rows of the same steps."""

    def key(row: _Row) -> int:
        return row.transcription.steps

    return [list(own) for _, own in groupby(sorted(rows, key=key), key)]


def _table(rows: Sequence[_Row]) -> Array:
    return np.array([row.best.coefficients for row in rows])


def finer_peaks(of: Sequence[Transcription], coefficients: Array) -> dict[str, Array]:
    """Peaks of every quantity of one motion of each task, at the nodes of finer steps."""
    finer = _by_finer_steps(of, coefficients, tuple(QUANTITIES.values()))
    return {name: finer.largest(name)[:, 0] for name in QUANTITIES}


def _by_finer_steps(
    of: Sequence[Transcription], coefficients: Array, quantities: Sequence[Quantity] = ()
) -> Evaluation:
    """A motion of each task, on its nominal plant."""
    first = of[0]
    steps = max(default_steps(first.task), _FINER * first.steps)
    tasks = [transcription.task.certain for transcription in of]
    evaluator = Evaluator(tasks, first.profile, steps, quantities=quantities)
    return evaluator(coefficients)


def judge(transcription: Transcription, coefficients: Array) -> Candidate:
    """The motion of coefficients, for CVODES."""
    return Candidate.of_profile(transcription.task, transcription.profile, coefficients)


def tighten(limits: Sequence[Limit], motion: Ranged, kept: Sequence[Limit]) -> tuple[Limit, ...]:
    """The limits to give the solver, each less by as much as the verified motion exceeds it."""
    exceeded = motion.exceeded(kept)
    return tuple(
        one.tightened(_BELOW * exceeded[one.name]) if one.name in exceeded else one
        for one in limits
    )


def excess_error(
    motion: Ranged, limits: Sequence[Limit], remedy: str, still: float = 0.0
) -> SolverFailedError | None:
    """What to say of a verified motion that exceeds a limit although limits were tightened."""
    for limit in limits:
        peak = limit.peak_of(motion)
        if not limit.keeps(peak, OVERRUN, still):
            return SolverFailedError(
                f"the verified {limit.label} is {limit.describe(peak)}, above its limit of "
                f"{limit.bounds}: {remedy}"
            )
    return None
