"""The front by epsilon-constraint: the least energy at one residual limit after another."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.checks import positive, several, takes
from quietarm.ocp.front.ends import Ends, find_ends
from quietarm.ocp.front.front import Front
from quietarm.ocp.front.surface import surface_front
from quietarm.ocp.front.tradeoff import RESIDUAL_LIMIT, Tradeoff
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY, checked_objectives
from quietarm.ocp.planning.best_of_starts import best_of_starts, better
from quietarm.ocp.planning.choose_profile import choose_profile
from quietarm.ocp.planning.request import Request
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import digits, number_of_points
from quietarm.ocp.rest import STILL
from quietarm.ocp.solvers.problem import Solution
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.task import PointToPoint
from quietarm.ocp.told_progress import Progress, no_report

Array = NDArray[np.float64]

Best = Mapping[float, Solution]
"""The best solution at each residual limit [m]."""


@takes(task=PointToPoint, profile=JointProfile, solver=Solver)
def epsilon_front(
    task: PointToPoint,
    profile: JointProfile | None = None,
    *,
    bound: float | None = None,
    points: int = 50,
    at: Sequence[float] = (),
    starts: int = 4,
    seed: int = 0,
    steps: int | None = None,
    solver: Solver = Sqp(),
    report: Progress = no_report,
    objectives: Sequence[str] = RESIDUAL_AND_ENERGY,
) -> Front:
    """Find the front of residual and energy by the gradient, with the epsilon-constraint method.

    The energy is minimised for each of many residual limits. Both ends are found first, from
    several starts. A few limits between them follow, from both ends and a random start, all at
    once. From these the points are spaced evenly in both objectives; all points are then solved at
    once, each from the solutions on either side.

    With peaks among the objectives the energy is minimised at the cells of a grid of limits on the
    residual and on each peak, between the least values of a table of payoffs and its largest ones
    (`quietarm.ocp.front.surface`).

    Parameters
    ----------
    task, profile, bound, seed, steps, solver
        As for `plan_move`.
    points : int
        Number of points, the ends included.
    at : sequence of float, optional
        Residuals [m] at which there is to be a point as well, where they lie between the ends.
    starts : int
        Starts of the ends; from two on one random start tries the first limits and some points.
    report : callable, optional
        Called with the number of points done and of all.
    objectives : sequence of str
        Residual and energy, and peaks beside them, as ``"peak_torque"``.

    Returns
    -------
    Front
        Method ``"epsilon"``; values by CVODES. Points that could not be found are in its
        `failures`. For an uncertain task it is the front of the scenarios: a point's residual is
        the largest over them.

    Raises
    ------
    ValueError
        When an argument is out of range.
    InfeasibleTaskError, SolverFailedError
        When no motion of this profile keeps the limits, or an end is not found for another reason.
    """
    began = time.perf_counter()
    profile = choose_profile(task) if profile is None else profile
    points = number_of_points(points)
    names = checked_objectives(objectives)
    residuals = [positive("residual", residual, "m") for residual in several("at", at, "residuals")]
    request = Request(task, profile, solver, bound, starts, seed, steps)
    if names != RESIDUAL_AND_ENERGY:
        front = surface_front(request, names, points, residuals, report)
        return front.restated(seconds=time.perf_counter() - began)
    ends = find_ends(Tradeoff.begin(request))
    limits_at = _limits_at(ends, residuals)
    total = points + len(limits_at)
    report(2, total)
    scouts = _scout(ends, points)
    known = [ends.still, *scouts.values(), ends.cheapest]
    limits = sorted([*_spaced_limits(ends, known, points), *limits_at])
    report(2 + len(limits) // 3, total)
    best = _solve_between(ends.tradeoff, known, limits)
    report(total, total)
    between = [(solution, {RESIDUAL_LIMIT: limit}) for limit, solution in best.items()]
    front = ends.tradeoff.to_front(
        "epsilon",
        [*ends.certificates, *ends.tradeoff.certify(between)],
        points,
        iterations=sum(solution.iterations for solution in scouts.values()),
        settings={"at": ", ".join(map(digits, residuals))} if residuals else {},
    )
    return front.restated(seconds=time.perf_counter() - began)


def _scout(ends: Ends, points: int, most: int = 5) -> Best:
    """Solutions at some limits between the ends, from both ends and a random start."""
    if ends.are_one or points == 2:
        return {}
    count = max(2, min(most, points - 2))
    shares = (np.arange(1, count + 1) / (count + 1)) ** 1.5
    limits = (ends.still.residual + shares * ends.width).tolist()
    starts = [ends.still.coefficients, ends.cheapest.coefficients, *ends.tradeoff.starts[1:2]]
    best, _ = _improve(ends.tradeoff, {}, dict.fromkeys(limits, starts))
    return {limit: solution for limit, solution in best.items() if solution.status.solved}


def _spaced_limits(ends: Ends, known: Sequence[Solution], points: int) -> list[float]:
    """Residual limits at which the points between the ends lie at even distances.

    Both objectives are scaled to the ends.
    """
    if ends.are_one or points == 2:
        return []
    residuals = np.array([solution.residual for solution in known])
    energies = np.array([solution.energy for solution in known])
    steps = np.hypot(np.diff(residuals) / ends.width, np.diff(energies) / ends.height)
    along = np.concatenate([[0.0], steps.cumsum()])
    places = np.linspace(0.0, along[-1], points)[1:-1]
    return np.interp(places, along, residuals).tolist()


def _limits_at(ends: Ends, residuals: Sequence[float], just_below: float = 1 - 1e-4) -> list[float]:
    """Residual limits for those of these residuals that lie between the ends.

    A limit is somewhat less than its residual: the verified one may be a little above.
    """
    limits = [just_below * residual for residual in residuals]
    return [limit for limit in limits if ends.still.residual < limit < ends.cheapest.residual]


def _solve_between(
    tradeoff: Tradeoff,
    known: Sequence[Solution],
    limits: Sequence[float],
    *,
    audited: int = 4,
    rounds: int = 3,
) -> Best:
    """The best solution at each limit, from the solutions on either side and between them.

    One in so many is `audited`, also tried from a random start. A point that is better for that, or
    was not found, is passed on to its neighbours, and they to it, as long as that helps, but not
    for more `rounds`.
    """
    beside = {limit: _starts_beside(known, limit) for limit in limits}
    best, _ = _improve(tradeoff, {}, beside, warm=True)
    random = dict.fromkeys(limits[audited // 2 :: audited], tradeoff.starts[1:2])
    best, changed = _improve(tradeoff, best, random)
    changed |= {limit for limit in limits if not best[limit].status.solved}
    for _ in range(rounds):
        starts = _starts_from_neighbours(limits, best, changed)
        best, changed = _improve(tradeoff, best, starts, warm=True)
        if not changed:
            break
    return best


def _starts_from_neighbours(
    limits: Sequence[float], best: Best, changed: set[float]
) -> dict[float, list[Array]]:
    """Starts of limits one of whose neighbours changed, and of those that changed themselves."""
    starts: dict[float, list[Array]] = {}
    for below, above in pairwise(limits):
        if not changed & {below, above}:
            continue
        for limit, neighbour in ((below, above), (above, below)):
            if best[neighbour].status.solved:
                starts.setdefault(limit, []).append(best[neighbour].coefficients)
    return starts


def _starts_beside(known: Sequence[Solution], limit: float) -> list[Array]:
    """The known solutions on either side of a limit, and the motion between them."""
    after = next(
        (k for k, solution in enumerate(known) if solution.residual >= limit),
        len(known) - 1,
    )
    low = known[max(after - 1, 0)]
    high = known[after]
    share = (limit - low.residual) / max(high.residual - low.residual, STILL)
    between = low.coefficients + np.clip(share, 0, 1) * (high.coefficients - low.coefficients)
    return [between, low.coefficients, high.coefficients]


def _improve(
    tradeoff: Tradeoff, best: Best, starts: Mapping[float, Sequence[Array]], warm: bool = False
) -> tuple[Best, set[float]]:
    """The best at each limit, known or from these starts; and where these are better."""
    limits = [limit for limit, guesses in starts.items() if guesses]
    if not limits:
        return best, set()
    problems = [tradeoff.problem(limit) for limit in limits]
    solutions = best_of_starts(
        problems,
        [starts[limit] for limit in limits],
        tradeoff.solver,
        warm=warm,
        leave=not warm,
    )
    improved = dict(best)
    changed: set[float] = set()
    for limit, problem, solution in zip(limits, problems, solutions):
        known = best.get(limit)
        if known is None or better(solution, known, problem):
            changed.add(limit)
            improved[limit] = solution
        iterations = solution.iterations + (0 if known is None else known.iterations)
        improved[limit] = replace(improved[limit], iterations=iterations)
    return improved, changed
