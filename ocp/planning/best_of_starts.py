"""Starts of a solver, the best of what it finds, and what is tried where it finds nothing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.errors import InfeasibleTaskError, SolveStatus
from quietarm.ocp.figures import ENERGY
from quietarm.ocp.limits import RESIDUAL
from quietarm.ocp.planning.remedies import explain, least_peaks_of
from quietarm.ocp.solvers.choice import stand_in
from quietarm.ocp.solvers.least_excess import least_excess
from quietarm.ocp.solvers.problem import Program, Solution
from quietarm.ocp.solvers.solver import Solver

Array = NDArray[np.float64]
SAME = 1e-5
"""Solutions whose objectives differ by less than this share count as one motion."""
BRIEF = 100
"""Iterations where no motion is to be seen as such soon; those that are found take 10 to 75."""


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
            yield briefly(substitute, problem, tried), starts[:2]

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


def shortened(solver: Solver) -> Solver:
    """Return the solver with `BRIEF` iterations at most."""
    return replace(solver, iterations=min(BRIEF, solver.iterations))


def briefly(solver: Solver, problem: Program, tried: Sequence[Solution]) -> Solver:
    """Return the solver with fewer iterations if all that was tried ended beyond a limit."""
    infeasible = all(solution.status is SolveStatus.INFEASIBLE for solution in tried)
    return shortened(solver) if infeasible and problem.task.limits else solver


def is_beyond(problem: Program, start: Array, share: float = 0.05) -> bool:
    """Return whether linear programs say that the limits have to be wider by more than a share."""
    if not any(limit.name != RESIDUAL for limit in problem.limits):
        return False
    if problem.peak is not None:
        return False
    excess = least_excess(problem, start)
    return excess.holds and excess.share > share


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


def better(solution: Solution, known: Solution, problem: Program) -> bool:
    """Return whether a solution is lower than a known one by more than the solver's tolerance."""
    minimum = minimum_of(solution, problem)
    known_minimum = minimum_of(known, problem)
    if known_minimum == np.inf:
        return minimum < np.inf
    return minimum < known_minimum - SAME * abs(known_minimum)


def minimum_of(solution: Solution, problem: Program) -> float:
    """Return the minimised value; infinite where nothing was solved."""
    values = {**solution.peaks, ENERGY: solution.energy}
    minimum = sum(weight * values[name] for name, weight in problem.minimise.items())
    return minimum if solution.status.solved else np.inf
