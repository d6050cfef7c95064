"""Remedies for an infeasible task: the least peaks that a plan can have, in words."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.errors import InfeasibleTaskError, SolverFailedError, SolveStatus
from quietarm.ocp.joint_words import peaks_beyond
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.limits import RESIDUAL, Limit
from quietarm.ocp.planning.certify import Certified, by_cvodes, certify_one
from quietarm.ocp.planning.residual_limit import band_words
from quietarm.ocp.rest import still_of
from quietarm.ocp.solvers.problem import MOST_SOLVER_STEPS, Program, Solution
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.task import PointToPoint

Array = NDArray[np.float64]
_ROOM = 1.001
"""A least value is quoted with this margin, so that a user who asks for it gets a plan."""


def explain(
    problem: Program,
    tried: Sequence[Solution],
    least: Mapping[str, Solution],
    solver: Solver,
) -> SolverFailedError:
    """The error for a problem that no start solved; least peaks as of `least_peaks_of`."""
    profile = problem.profile
    bound = problem.bound
    return unmet(
        problem.task,
        problem.limits,
        tried,
        _confirm(problem, least, solver),
        motion=f"motion of {profile.amount}",
        within="" if bound is None else f", coefficients within +-{bound:g}",
        remedy=f"more {profile.term}s or a longer duration",
    )


def offers_for(problem: Program, starts: Sequence[Array], solver: Solver) -> str:
    """Limits with which there is a plan, each with all else unchanged; nothing where none is."""
    least = least_peaks_of(problem, starts[:2], solver)
    return _offers(problem.task, problem.limits, _confirm(problem, least, solver))


@dataclass(frozen=True)
class Offer:
    """A limit that would do.

    Attributes
    ----------
    peak : float
        Its size, without the room that is added to what is quoted [SI unit; shares of limits of
        joints].
    motion : JudgedMotion, optional
        A motion that keeps it, and all other limits.
    """

    peak: float
    motion: JudgedMotion | None = None


def _confirm(problem: Program, least: Mapping[str, Solution], solver: Solver) -> dict[str, Offer]:
    """Return those of the least peaks with which there is a plan, as CVODES finds them."""
    limits = problem.limits

    def resimulated(solution: Solution) -> JudgedMotion:
        return by_cvodes(problem, solution.coefficients)

    offers = dict[str, Offer]()
    for name, offer in true_peaks(limits, least, resimulated).items():
        (limit,) = (limit for limit in limits if limit.name == name)
        widened = _widened(problem, limit, offer.peak)
        certified = certified_plan(widened, least[name].coefficients, solver)
        if certified is not None:
            offers[name] = Offer(offer.peak, certified.figures.candidate)
    return offers


def _widened(problem: Program, limit: Limit, peak: float) -> Program:
    """The problem with a limit that is as wide as would be offered."""
    offered = limit.widened_to(peak * _ROOM)
    limits = problem.limits
    replaced = tuple(offered if known is limit else known for known in limits)
    return problem.asking(limits=replaced)


def has_a_plan(problem: Program, start: Array, solver: Solver) -> bool:
    """Return whether a plan is found from one start, and CVODES confirms it."""
    return certified_plan(problem, start, solver) is not None


def certified_plan(
    problem: Program, start: Array, solver: Solver, most_refined: int = 2
) -> Certified | None:
    """Return what is found from one start, if CVODES confirms it; None otherwise.

    It may take so many times the steps: where a remedy needs finer ones, it is at its own edge, and
    every doubling takes as long as all before.
    """
    (solution,) = solver.solve([problem], [start])
    if not solution.status.solved:
        return None
    steps = min(most_refined * problem.steps, MOST_SOLVER_STEPS)
    try:
        return certify_one(problem, solution, solver, most_steps=steps)
    except SolverFailedError:
        return None


class Attempt(Protocol):
    """A run of the solver: over coefficients, or over all joint motions."""

    @property
    def status(self) -> SolveStatus:
        """Status with which it ended."""
        ...

    @property
    def peaks(self) -> Mapping[str, float]:
        """Each limited quantity [SI units]."""
        ...


AnyAttempt = TypeVar("AnyAttempt", bound=Attempt)


def unmet(
    task: PointToPoint,
    limits: Sequence[Limit],
    runs: Sequence[Attempt],
    least: Mapping[str, Offer],
    *,
    motion: str,
    remedy: str,
    within: str = "",
    otherwise: str = "",
) -> SolverFailedError:
    """The error for limits that no start met, to be raised by the caller.

    In words, what was looked for, and within what beside the limits; what may help where nothing
    else does; what helps `otherwise`, where a solver did not end at an infeasible motion.
    """
    statuses = [run.status for run in runs]
    if SolveStatus.INFEASIBLE not in statuses:
        ended = statuses[0].text
        if otherwise:
            ended = f"{ended.partition(';')[0]}; {otherwise}"
        return SolverFailedError(f"none of {len(statuses)} starts was solved: {ended}")
    bounds = ", ".join(stated_limit(task, limit) for limit in limits if limit.size < np.inf)
    several = "removing any single one of these limits does not help, so widen several"
    feasible = _offers(task, limits, least) or several
    return InfeasibleTaskError(
        f"found no {motion} with {bounds}{within}; {feasible}", f"{remedy} may also do"
    )


def _offers(task: PointToPoint, limits: Sequence[Limit], least: Mapping[str, Offer]) -> str:
    """Least peaks that a limit does not keep, as limits that would do.

    Of an uncertain task they may: its scenarios keep them, and nothing between these was looked at.
    """
    remedies = [
        _offer(task, limit, least[limit.name])
        for limit in limits
        if limit.name in least and not limit.keeps(least[limit.name].peak, at_rest=still_of(task))
    ]
    if not remedies:
        return ""
    how = "feasible" if task.uncertainty is None else "what may be feasible"
    return f"{how} with all else unchanged: {' or '.join(remedies)}"


def _offer(task: PointToPoint, limit: Limit, offer: Offer) -> str:
    """A limit that would do; of a residual limit that follows from a band the band.

    Of several joints those are named whose limits have to be wider.
    """
    peak = offer.peak * _ROOM
    if limit.name == RESIDUAL and band_words(task, limit.size):
        return f"band {1e3 * task.margin * peak:.4g} mm"
    joints = [] if offer.motion is None else peaks_beyond(limit, offer.motion)
    if joints:
        wider = " and ".join(joint.times(_ROOM) for joint in joints)
        return f"{limit.label} limit {wider}"
    return f"{limit.label} limit {limit.describe(peak)}"


def stated_limit(task: PointToPoint, limit: Limit) -> str:
    """A limit in words; a residual limit that follows from a band with the band."""
    if limit.name == RESIDUAL and limit.size == 0:
        return "the tip at rest on arrival"
    band = band_words(task, limit.size) if limit.name == RESIDUAL else ""
    if band:
        return f"{limit.label} <= {1e3 * limit.size:.4g} mm ({band})"
    return f"{limit.label} {'<=' if limit.is_peak else 'within'} {limit.bounds}"


def least_peaks_of(
    problem: Program, starts: Sequence[Array], solver: Solver
) -> dict[str, Solution]:
    """Make each limited quantity in turn as small as it can be while the other limits are kept."""

    def solve_least(limits: Sequence[Limit], name: str) -> list[Solution]:
        relaxed = problem.asking(limits=tuple(limits), minimise={name: 1.0})
        return solver.solve([relaxed] * len(starts), starts)

    return least_peaks(problem.limits, solve_least)


def least_peaks(
    limits: Sequence[Limit], solve_least: Callable[[Sequence[Limit], str], Sequence[AnyAttempt]]
) -> dict[str, AnyAttempt]:
    """Return the attempts that make each quantity least within the limits that remain."""
    best: dict[str, AnyAttempt] = {}
    for name in (limit.name for limit in limits):
        remaining = [limit for limit in limits if limit.name != name]
        attempts = solve_least(remaining, name)
        solved = [attempt for attempt in attempts if attempt.status.solved]
        if solved:
            best[name] = min(solved, key=lambda attempt, name=name: attempt.peaks[name])
    return best


def true_peaks(
    limits: Sequence[Limit],
    least: Mapping[str, AnyAttempt],
    resimulated: Callable[[AnyAttempt], JudgedMotion],
) -> dict[str, Offer]:
    """The least peaks as they are between the nodes as well, by what simulates a run's motion."""

    def offer_of(limit: Limit, attempt: AnyAttempt) -> Offer:
        at_nodes = attempt.peaks[limit.name]
        try:
            motion = resimulated(attempt)
            return Offer(max(at_nodes, limit.peak_of(motion.figures)), motion)
        except SolverFailedError:
            return Offer(at_nodes)

    return {
        limit.name: offer_of(limit, least[limit.name]) for limit in limits if limit.name in least
    }
