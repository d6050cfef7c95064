"""When a task cannot be met: find out which limit is in the way, and what would do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ocp.base.errors import InfeasibleTaskError, SolverFailedError
from ocp.base.status import SolveStatus
from ocp.program.problem import Problem
from ocp.program.solution import Solution
from ocp.program.transcription import RESIDUAL
from ocp.task.quantities import QUANTITIES

_UNITS = {RESIDUAL: "m", **{name: quantity.unit for name, quantity in QUANTITIES.items()}}
_ROOM = 1.001
"""A found least value is quoted with this room, so that asking for it is feasible."""


def least_peaks(problem: Problem, starts: int | None = None) -> dict[str, Solution]:
    """Make each limited quantity in turn as small as it can be while the other limits are kept.

    Parameters
    ----------
    problem : Problem
        What was not solved.
    starts : int, optional
        How many of its starts; all by default.

    Returns
    -------
    dict of str to Solution
        The best solution found for each quantity; a quantity without any is left out.
    """
    best: dict[str, Solution] = {}
    for name in problem.limits:
        others = {key: value for key, value in problem.limits.items() if key != name}
        rest = problem.within(others)
        found = [rest.solve(guess, {name: 1.0}) for guess in problem.guesses[:starts]]
        solved = [solution for solution in found if solution.status.solved]
        if solved:
            best[name] = min(solved, key=lambda solution: solution.peaks[name])
    return best


def explain(
    problem: Problem, solutions: Sequence[Solution], least: Mapping[str, Solution]
) -> SolverFailedError:
    """The error for a problem that no start solved, to be raised by the caller.

    Parameters
    ----------
    problem : Problem
        What was not solved.
    solutions : sequence of Solution
        The runs that failed.
    least : mapping of str to Solution
        What `least_peaks` found.

    Returns
    -------
    SolverFailedError
        An InfeasibleTaskError where the runs ended at infeasible motions.
    """
    size, bound = problem.program.profile.size, problem.bound
    terms = f"{size} term{'s' if size > 1 else ''}"
    return unmet(
        f"motion of {terms}",
        problem.limits,
        [solution.status for solution in solutions],
        {name: found.peaks[name] for name, found in least.items()},
        "more terms or a longer duration",
        "" if bound is None else f", coefficients within +-{bound:g}",
    )


def unmet(
    motion: str,
    limits: Mapping[str, float],
    statuses: Sequence[SolveStatus],
    least: Mapping[str, float],
    remedy: str,
    box: str = "",
) -> SolverFailedError:
    """The error for limits that no start met, in words.

    Parameters
    ----------
    motion : str
        What was looked for.
    limits : mapping of str to float
        Residual [m] and peaks [SI units] that were asked for.
    statuses : sequence of SolveStatus
        How the runs ended.
    least : mapping of str to float
        The least that was found possible of each quantity, the others kept.
    remedy : str
        What else may do.
    box : str
        What else was asked.

    Returns
    -------
    SolverFailedError
        An InfeasibleTaskError where a run ended at an infeasible motion.
    """
    if SolveStatus.INFEASIBLE not in statuses:
        return SolverFailedError(f"none of {len(statuses)} starts was solved: {statuses[0].text}")
    asked = ", ".join(
        f"{name} <= {limit:g} {_UNITS[name]}" for name, limit in limits.items() if limit < np.inf
    )
    remedies = [
        f"{name} limit {peak * _ROOM:.4g} {_UNITS[name]}"
        for name, peak in least.items()
        if peak > limits[name]
    ]
    feasible = (
        f"feasible with the rest kept: {' or '.join(remedies)}"
        if remedies
        else "taking any one of these limits away does not help, so widen several"
    )
    return InfeasibleTaskError(
        f"found no {motion} with {asked}{box}; {feasible}; {remedy} may also do"
    )
