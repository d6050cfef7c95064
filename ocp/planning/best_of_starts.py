"""Where a solver starts, the best of what it finds, and what would be feasible if it finds none."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from typing import NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.errors import InfeasibleTaskError, SolverFailedError, SolveStatus
from quietarm.ocp.figures import ENERGY
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.limits import RESIDUAL, Limit
from quietarm.ocp.planning.certify import by_cvodes, certify_one
from quietarm.ocp.solvers.choice import stand_in
from quietarm.ocp.solvers.least_excess import least_excess
from quietarm.ocp.solvers.problem import MOST_SOLVER_STEPS, STILL, Program, Solution
from quietarm.ocp.solvers.solver import Solver

Array = NDArray[np.float64]
SAME = 1e-5
"""Solutions whose objectives differ by less than this share count as one motion."""
_ROOM = 1.001
"""A least value is quoted with this margin, so that a user who asks for it gets a plan."""


def minimum_of(solution: Solution, problem: Program) -> float:
    """What was minimised; infinite where nothing was solved."""
    values = {**solution.peaks, ENERGY: solution.energy}
    minimum = sum(weight * values[name] for name, weight in problem.minimise.items())
    return minimum if solution.status.solved else np.inf


def better(solution: Solution, known: Solution, problem: Program) -> bool:
    """Whether a solution is lower than a known one by more than the solver's tolerance."""
    minimum = minimum_of(solution, problem)
    known_minimum = minimum_of(known, problem)
    if known_minimum == np.inf:
        return minimum < np.inf
    return minimum < known_minimum - SAME * abs(known_minimum)


def best_of_starts(
    problems: Sequence[Program],
    starts: Sequence[Sequence[Array]],
    solver: Solver,
    *,
    warm: bool = False,
    leave: bool = True,
) -> list[Solution]:
    """The best solution of each problem from its starts, all solved at once.

    Iterations are those of all its starts. Starts are left where others agree, if that is wanted.
    """
    problem_of_start = [i for i, guesses in enumerate(starts) for _ in guesses]
    all_starts = [start for guesses in starts for start in guesses]
    has_several = len(all_starts) > len(problems)
    solutions = solver.solve(
        [problems[i] for i in problem_of_start],
        all_starts,
        warm=warm,
        groups=problem_of_start if leave and has_several else None,
    )
    remaining = iter(solutions)
    best: list[Solution] = []
    for problem, guesses in zip(problems, starts):
        of_problem = list(islice(remaining, len(guesses)))
        best.append(_lowest(of_problem, problem))
    return best


def _lowest(solutions: Sequence[Solution], problem: Program) -> Solution:
    """The best of some solutions, with the iterations of all."""
    lowest = min(solutions, key=lambda solution: minimum_of(solution, problem))
    return replace(lowest, iterations=sum(solution.iterations for solution in solutions))


def solve_from_starts(
    problem: Program,
    starts: Sequence[Array],
    solver: Solver,
    *,
    quick: bool = False,
    thorough: bool = True,
    has_stand_in: bool = True,
) -> tuple[Solution, list[Solution]]:
    """The best solution from several starts, and all, the best first.

    Where none of them leads to a solution, motions of least peaks are tried as starts, then what
    stands in for the solver.
    InfeasibleTaskError says what would be feasible; SolverFailedError has another reason. A quick
    solve ends with its starts, and says nothing of that; one that is not thorough has no stand-in,
    and says nothing either.
    """
    tried: list[Solution] = []
    least: dict[str, Solution] = {}

    def attempts() -> Iterator[tuple[Solver, Sequence[Array]]]:
        yield solver, starts
        if quick:
            return
        if problem.limits:
            least.update(least_peaks_of(problem, starts[:2], solver))
            yield solver, [solution.coefficients for solution in least.values()]
        substitute = stand_in(solver) if thorough and has_stand_in else None
        if substitute is not None and not is_beyond(problem, starts[0]):
            yield _briefly(substitute, problem, tried), starts[:2]

    for attempting, guesses in attempts():
        if not guesses:
            continue
        count = len(guesses)
        tried += attempting.solve([problem] * count, guesses, groups=[0] * count)
        if any(solution.status.solved for solution in tried):
            break
    solved = [solution for solution in tried if solution.status.solved]
    if not solved and (quick or not thorough):
        raise InfeasibleTaskError(f"no start was solved: {tried[0].reason}")
    if not solved:
        raise explain(problem, tried, least, solver)
    solved.sort(key=lambda solution: minimum_of(solution, problem))
    iterations = sum(solution.iterations for solution in tried)
    return replace(solved[0], iterations=iterations), solved


def _briefly(
    solver: Solver, problem: Program, tried: Sequence[Solution], iterations: int = 120
) -> Solver:
    """The solver with fewer iterations where all that was tried ended beyond a limit on the way."""
    infeasible = all(solution.status is SolveStatus.INFEASIBLE for solution in tried)
    if not (infeasible and problem.task.limits):
        return solver
    return replace(solver, iterations=min(iterations, solver.iterations))


def is_beyond(problem: Program, start: Array, share: float = 0.05) -> bool:
    """Whether linear programs say that the limits have to be wider by more than a share."""
    if not any(limit.name != RESIDUAL for limit in problem.limits):
        return False
    if problem.peak is not None:
        return False
    excess = least_excess(problem, start)
    return excess.holds and excess.share > share


class Attempt(Protocol):
    """A run of the solver: over coefficients, or over all joint motions."""

    @property
    def status(self) -> SolveStatus:
        """How it ended."""
        ...

    @property
    def peaks(self) -> Mapping[str, float]:
        """Each limited quantity [SI units]."""
        ...


AnyAttempt = TypeVar("AnyAttempt", bound=Attempt)


def least_peaks(
    limits: Sequence[Limit], solve_least: Callable[[Sequence[Limit], str], Sequence[AnyAttempt]]
) -> dict[str, AnyAttempt]:
    """Make each limited quantity in turn as small as it can be while the other limits are kept."""
    best: dict[str, AnyAttempt] = {}
    for name in (limit.name for limit in limits):
        remaining = [limit for limit in limits if limit.name != name]
        attempts = solve_least(remaining, name)
        solved = [attempt for attempt in attempts if attempt.status.solved]
        if solved:
            best[name] = min(solved, key=lambda attempt, name=name: attempt.peaks[name])
    return best


def least_peaks_of(
    problem: Program, starts: Sequence[Array], solver: Solver
) -> dict[str, Solution]:
    """The same of a problem, from several starts."""

    def solve_least(limits: Sequence[Limit], name: str) -> list[Solution]:
        relaxed = problem.asking(limits=tuple(limits), minimise={name: 1.0})
        return solver.solve([relaxed] * len(starts), starts)

    return least_peaks(problem.limits, solve_least)


def true_peaks(
    limits: Sequence[Limit],
    least: Mapping[str, AnyAttempt],
    resimulated: Callable[[AnyAttempt], JudgedMotion],
) -> dict[str, float]:
    """The least peaks as they are between the nodes as well, by what simulates a run's motion."""

    def peak_of(limit: Limit, attempt: AnyAttempt) -> float:
        at_nodes = attempt.peaks[limit.name]
        try:
            return max(at_nodes, limit.peak_of(resimulated(attempt).figures))
        except SolverFailedError:
            return at_nodes

    return {
        limit.name: peak_of(limit, least[limit.name]) for limit in limits if limit.name in least
    }


def explain(
    problem: Program,
    tried: Sequence[Solution],
    least: Mapping[str, Solution],
    solver: Solver,
) -> SolverFailedError:
    """The error for a problem that no start solved; other arguments as for `unmet`."""
    profile = problem.profile
    bound = problem.bound
    sought = Sought(
        f"motion of {profile.amount}",
        f"more {profile.term}s or a longer duration",
        box="" if bound is None else f", coefficients within +-{bound:g}",
    )
    confirmed = _confirm(problem, least, solver)
    return unmet(sought, problem.limits, tried, confirmed)


def _confirm(problem: Program, least: Mapping[str, Solution], solver: Solver) -> dict[str, float]:
    """Those least peaks with which there is a plan, as CVODES finds them."""
    limits = problem.limits

    def resimulated(solution: Solution) -> JudgedMotion:
        return by_cvodes(problem, solution.coefficients)

    peaks = true_peaks(limits, least, resimulated)
    return {
        limit.name: peaks[limit.name]
        for limit in limits
        if limit.name in peaks
        and has_a_plan(
            _widened(problem, limit, peaks[limit.name]),
            least[limit.name].coefficients,
            solver,
        )
    }


def offers_for(problem: Program, starts: Sequence[Array], solver: Solver) -> str:
    """Limits with which there is a plan, each with all else unchanged; nothing where none is."""
    least = least_peaks_of(problem, starts[:2], solver)
    return _offers(problem.limits, _confirm(problem, least, solver))


def _offers(limits: Sequence[Limit], least: Mapping[str, float]) -> str:
    """Least peaks that a limit does not keep, as limits that would do."""
    remedies = [
        f"{limit.label} limit {limit.describe(least[limit.name] * _ROOM)}"
        for limit in limits
        if limit.name in least and not limit.keeps(least[limit.name], at_rest=STILL)
    ]
    return f"feasible with all else unchanged: {' or '.join(remedies)}" if remedies else ""


def _widened(problem: Program, limit: Limit, peak: float) -> Program:
    """The problem with a limit that is as wide as would be offered."""
    offered = limit.widened_to(peak * _ROOM)
    limits = problem.limits
    replaced = tuple(offered if known is limit else known for known in limits)
    return problem.asking(limits=replaced)


def has_a_plan(problem: Program, start: Array, solver: Solver, most_refined: int = 2) -> bool:
    """Whether a plan is found from one start, and CVODES confirms it.

    It may take so many times the steps: where a remedy needs finer ones, it is at its own edge, and
    every doubling takes as long as all before.
    """
    (solution,) = solver.solve([problem], [start])
    if not solution.status.solved:
        return False
    steps = min(most_refined * problem.steps, MOST_SOLVER_STEPS)
    try:
        certify_one(problem, solution, solver, most_steps=steps)
    except SolverFailedError:
        return False
    return True


class Sought(NamedTuple):
    """What was looked for, in words, and what may help where nothing else does.

    The box is what is added where coefficients are bounded; `otherwise` helps where a solver did
    not end at an infeasible motion.
    """

    motion: str
    remedy: str
    box: str = ""
    otherwise: str = ""


def unmet(
    sought: Sought, limits: Sequence[Limit], runs: Sequence[Attempt], least: Mapping[str, float]
) -> SolverFailedError:
    """The error for limits that no start met, in words, to be raised by the caller."""
    statuses = [run.status for run in runs]
    if SolveStatus.INFEASIBLE not in statuses:
        ended = statuses[0].text
        if sought.otherwise:
            ended = f"{ended.partition(';')[0]}; {sought.otherwise}"
        return SolverFailedError(f"none of {len(statuses)} starts was solved: {ended}")
    bounds = ", ".join(_stated(limit) for limit in limits if limit.size < np.inf)
    several = "removing any single one of these limits does not help, so widen several"
    feasible = _offers(limits, least) or several
    return InfeasibleTaskError(
        f"found no {sought.motion} with {bounds}{sought.box}; {feasible}",
        f"{sought.remedy} may also do",
    )


def _stated(limit: Limit) -> str:
    """A limit in words."""
    if limit.name == RESIDUAL and limit.size == 0:
        return "the tip at rest on arrival"
    return f"{limit.label} {'<=' if limit.is_peak else 'within'} {limit.bounds}"
