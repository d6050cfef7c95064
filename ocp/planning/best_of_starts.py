"""Where a solver starts, and the best of what it finds, certified."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.planning.feasibility import explain, least_peaks_of
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import SolveSettings
from quietarm.ocp.solvers.choice import Solver
from quietarm.ocp.solvers.ipopt import Ipopt
from quietarm.ocp.solvers.problem import Problem, Scalarization, Solution
from quietarm.ocp.solvers.transcription import ENERGY

Array = NDArray[np.float64]
SAME = 1e-5
"""Solutions whose objectives differ by less than this share count as one motion."""


def start_coefficients(profile: JointProfile, settings: SolveSettings) -> list[Array]:
    """Coefficients to start from: the guess or the plain cycloid, then random ones of the seed."""
    random = np.random.default_rng(settings.seed)
    within = profile.start_box(settings.bound)
    count = (settings.starts - 1) * profile.random_starts
    others = [random.uniform(*within) for _ in range(count)]
    first = profile.plain if settings.guess is None else np.array(settings.guess)
    return [first, *others]


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
    for problem, guesses in zip(problems, starts, strict=True):
        own = list(islice(remaining, len(guesses)))
        lowest = min(own, key=lambda one: objective_of(one, problem.scalarization))
        best.append(replace(lowest, iterations=sum(one.iterations for one in own)))
    return best


def solve_from_starts(
    problem: Problem, starts: Sequence[Array], solver: Solver
) -> tuple[Solution, list[Solution]]:
    """The best solution from several starts, and all, the best first.

    Where none of them leads to a solution, motions of least peaks are tried as starts, then IPOPT.

    Raises
    ------
    InfeasibleTaskError
        When no motion of the profile keeps the limits; the text says what would be feasible.
    SolverFailedError
        When nothing was solved for another reason.
    """
    tried, least = list[Solution](), dict[str, Solution]()

    def attempts() -> Iterator[tuple[Solver, Sequence[Array]]]:
        yield solver, starts
        if problem.scalarization.limits:
            least.update(least_peaks_of(problem, starts[:2]))
            yield solver, [one.coefficients for one in least.values()]
        if not isinstance(solver, Ipopt):
            yield Ipopt(), starts[:2]

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
    if not solved:
        raise explain(problem, tried, least)
    return replace(solved[0], iterations=sum(one.iterations for one in tried)), solved
