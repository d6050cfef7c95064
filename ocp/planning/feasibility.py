"""Where no start succeeds: start from motions of least peaks, or say what would be feasible."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.errors import InfeasibleTaskError, SolverFailedError, SolveStatus
from quietarm.ocp.limits import Limit, Ranged
from quietarm.ocp.planning.certify import judge
from quietarm.ocp.solvers.problem import Problem, Solution
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.solvers.transcription import STILL

_ROOM = 1.001
"""A least value is quoted with this margin, so that a user who asks for it gets a plan."""


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


def least_peaks_of(problem: Problem, starts: Sequence[NDArray[np.float64]]) -> dict[str, Solution]:
    """The same of a problem, from several starts."""
    transcription, asked = problem

    def solve_least(others: Sequence[Limit], name: str) -> list[Solution]:
        alone = Problem(transcription, asked._replace(limits=tuple(others), minimise={name: 1.0}))
        return Sqp().solve([alone] * len(starts), starts)

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
    problem: Problem, tried: Sequence[Solution], least: Mapping[str, Solution]
) -> SolverFailedError:
    """The error for a problem that no start solved; other arguments as for `unmet`."""
    transcription, asked = problem
    return unmet(
        f"motion of {transcription.profile.amount}",
        asked.limits,
        tried,
        true_peaks(asked.limits, least, lambda one: judge(transcription, one.coefficients)),
        f"more {transcription.profile.term}s or a longer duration",
        "" if asked.bound is None else f", coefficients within +-{asked.bound:g}",
    )


def unmet(
    motion: str,
    limits: Sequence[Limit],
    runs: Sequence[Attempt],
    least: Mapping[str, float],
    remedy: str,
    box: str = "",
    otherwise: str = "",
) -> SolverFailedError:
    """The error for limits that no start met, in words, to be raised by the caller."""
    statuses = [run.status for run in runs]
    if SolveStatus.INFEASIBLE not in statuses:
        ended = statuses[0].text
        if otherwise:
            ended = f"{ended.partition(';')[0]}; {otherwise}"
        return SolverFailedError(f"none of {len(statuses)} starts was solved: {ended}")
    asked = ", ".join(
        f"{one.name} {'<=' if one.is_peak else 'within'} {one.bounds}"
        for one in limits
        if one.size < np.inf
    )
    remedies = [
        f"{one.name} limit {one.describe(least[one.name] * _ROOM)}"
        for one in limits
        if one.name in least and not one.keeps(least[one.name], at_rest=STILL)
    ]
    feasible = (
        f"feasible with all else unchanged: {' or '.join(remedies)}"
        if remedies
        else "removing any single one of these limits does not help, so widen several"
    )
    return InfeasibleTaskError(
        f"found no {motion} with {asked}{box}; {feasible}; {remedy} may also do"
    )
