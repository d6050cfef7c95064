"""Where a solver starts, the best of what it finds, and what would be feasible if it finds none."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from typing import NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.errors import InfeasibleTaskError, SolverFailedError, SolveStatus
from quietarm.ocp.limits import Limit, Ranged
from quietarm.ocp.planning.certify import certify_one, judge
from quietarm.ocp.solvers.choice import stand_in
from quietarm.ocp.solvers.problem import ENERGY, STILL, Problem, Scalarization, Solution
from quietarm.ocp.solvers.solver import Solver

Array = NDArray[np.float64]
SAME = 1e-5
"""Solutions whose objectives differ by less than this share count as one motion."""
_ROOM = 1.001
"""A least value is quoted with this margin, so that a user who asks for it gets a plan."""


def objective_of(solution: Solution, scalarization: Scalarization) -> float:
    """What was minimised; infinite where nothing was solved."""
    values = {**solution.peaks, ENERGY: solution.energy}
    value = sum(weight * values[name] for name, weight in scalarization.minimise.items())
    return value if solution.status.solved else np.inf


def better(one: Solution, other: Solution, scalarization: Scalarization) -> bool:
    """Whether one solution is lower than another by more than the solver's tolerance."""
    values = objective_of(one, scalarization), objective_of(other, scalarization)
    limit = np.inf if values[1] == np.inf else values[1] - SAME * abs(values[1])
    return values[0] < limit


def best_of_starts(
    problems: Sequence[Problem],
    starts: Sequence[Sequence[Array]],
    solver: Solver,
    *,
    warm: bool = False,
    leave: bool = True,
) -> list[Solution]:
    """The best solution of each problem from starts of its own, all solved at once.

    Iterations are those of all its starts. Starts are left where others agree, if that is wanted.
    """
    groups = [i for i, own in enumerate(starts) for _ in own]
    flat = [start for own in starts for start in own]
    grouped = groups if leave and len(flat) > len(problems) else None
    found = solver.solve([problems[i] for i in groups], flat, warm=warm, groups=grouped)
    remaining, best = iter(found), list[Solution]()
    for problem, guesses in zip(problems, starts):
        own = list(islice(remaining, len(guesses)))
        lowest = min(own, key=lambda one: objective_of(one, problem.scalarization))
        best.append(replace(lowest, iterations=sum(one.iterations for one in own)))
    return best


def solve_from_starts(
    problem: Problem,
    starts: Sequence[Array],
    solver: Solver,
    *,
    quick: bool = False,
    thorough: bool = True,
) -> tuple[Solution, list[Solution]]:
    """The best solution from several starts, and all, the best first.

    Where none of them leads to a solution, motions of least peaks are tried as starts, then what
    stands in for the solver.
    InfeasibleTaskError says what would be feasible; SolverFailedError has another reason. A quick
    solve ends with its starts, and says nothing of that; one that is not thorough has no stand-in,
    and says nothing either.
    """
    tried, least = list[Solution](), dict[str, Solution]()

    def attempts() -> Iterator[tuple[Solver, Sequence[Array]]]:
        yield solver, starts
        if quick:
            return
        if problem.scalarization.limits:
            least.update(least_peaks_of(problem, starts[:2], solver))
            yield solver, [one.coefficients for one in least.values()]
        if thorough and (substitute := stand_in(solver)) is not None:
            yield substitute, starts[:2]

    for by, guesses in attempts():
        if not guesses:
            continue
        tried += by.solve([problem] * len(guesses), guesses, groups=[0] * len(guesses))
        if any(one.status.solved for one in tried):
            break
    solved = sorted(
        (one for one in tried if one.status.solved),
        key=lambda one: objective_of(one, problem.scalarization),
    )
    if not solved and (quick or not thorough):
        raise InfeasibleTaskError(f"no start was solved: {tried[0].reason}")
    if not solved:
        raise explain(problem, tried, least, solver)
    return replace(solved[0], iterations=sum(one.iterations for one in tried)), solved


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


Found = TypeVar("Found", bound=Attempt)


def least_peaks(
    limits: Sequence[Limit], solve_least: Callable[[Sequence[Limit], str], Sequence[Found]]
) -> dict[str, Found]:
    """Make each limited quantity in turn as small as it can be while the other limits are kept."""
    best: dict[str, Found] = {}
    for name in (limit.name for limit in limits):
        others = [other for other in limits if other.name != name]
        solved = [one for one in solve_least(others, name) if one.status.solved]
        if solved:
            best[name] = min(solved, key=lambda one, name=name: one.peaks[name])
    return best


def least_peaks_of(
    problem: Problem, starts: Sequence[Array], solver: Solver
) -> dict[str, Solution]:
    """The same of a problem, from several starts."""
    transcription, asked = problem

    def solve_least(others: Sequence[Limit], name: str) -> list[Solution]:
        alone = Problem(transcription, asked._replace(limits=tuple(others), minimise={name: 1.0}))
        return solver.solve([alone] * len(starts), starts)

    return least_peaks(asked.limits, solve_least)


def true_peaks(
    limits: Sequence[Limit], least: Mapping[str, Found], resimulated: Callable[[Found], Ranged]
) -> dict[str, float]:
    """The least peaks as they are between the nodes as well, by what simulates a run's motion."""

    def peak_of(limit: Limit, found: Found) -> float:
        try:
            return max(found.peaks[limit.name], limit.peak_of(resimulated(found)))
        except SolverFailedError:
            return found.peaks[limit.name]

    return {one.name: peak_of(one, least[one.name]) for one in limits if one.name in least}


def explain(
    problem: Problem,
    tried: Sequence[Solution],
    least: Mapping[str, Solution],
    solver: Solver,
) -> SolverFailedError:
    """The error for a problem that no start solved; other arguments as for `unmet`."""
    transcription, asked = problem
    peaks = true_peaks(asked.limits, least, lambda one: judge(transcription, one.coefficients))
    confirmed = {
        limit.name: peaks[limit.name]
        for limit in asked.limits
        if limit.name in peaks
        and _has_a_plan(problem, limit, peaks[limit.name], least[limit.name].coefficients, solver)
    }
    sought = Sought(
        f"motion of {transcription.profile.amount}",
        f"more {transcription.profile.term}s or a longer duration",
        box="" if asked.bound is None else f", coefficients within +-{asked.bound:g}",
    )
    return unmet(sought, asked.limits, tried, confirmed)


def _has_a_plan(problem: Problem, limit: Limit, peak: float, start: Array, solver: Solver) -> bool:
    """Whether a plan exists with a limit that is as wide as would be offered."""
    transcription, asked = problem
    offered = limit.widened_to(peak * _ROOM)
    limits = tuple(offered if other is limit else other for other in asked.limits)
    relaxed = Problem(transcription, asked._replace(limits=limits))
    (solution,) = solver.solve([relaxed], [start])
    if not solution.status.solved:
        return False
    try:
        certify_one(relaxed, solution, solver)
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
    bounds = ", ".join(
        f"{limit.label} {'<=' if limit.is_peak else 'within'} {limit.bounds}"
        for limit in limits
        if limit.size < np.inf
    )
    remedies = [
        f"{limit.label} limit {limit.describe(least[limit.name] * _ROOM)}"
        for limit in limits
        if limit.name in least and not limit.keeps(least[limit.name], at_rest=STILL)
    ]
    feasible = (
        f"feasible with all else unchanged: {' or '.join(remedies)}"
        if remedies
        else "removing any single one of these limits does not help, so widen several"
    )
    return InfeasibleTaskError(
        f"found no {sought.motion} with {bounds}{sought.box}; {feasible}",
        f"{sought.remedy} may also do",
    )
