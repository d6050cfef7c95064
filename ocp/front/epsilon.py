"""The front by epsilon-constraint: the least energy at one residual limit after another."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.checks import positive, several, takes
from quietarm.ocp.front.curve import RESIDUAL_LIMIT, Curve, Report, no_report
from quietarm.ocp.front.ends import Ends, find_ends
from quietarm.ocp.front.front import Front
from quietarm.ocp.planning.best_of_starts import best_of_starts, better
from quietarm.ocp.planning.choose_profile import choose_profile
from quietarm.ocp.planning.setup import Setup
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import digits, number_of_points
from quietarm.ocp.solvers.problem import STILL, Solution
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.task import PointToPoint

Array = NDArray[np.float64]
_SCOUTS = 5
"""Limits between the ends that are solved first, from both ends and a random start."""
_AUDITED = 4
"""One point in so many is also tried from random starts."""
_ROUNDS = 3
"""Most times that points are solved again from better neighbours."""
_JUST_BELOW = 1 - 1e-4
"""The residual limit is this share of the residual wanted: the verified one may be a little
above."""

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
    report: Report = no_report,
) -> Front:
    """Find the front of residual and energy by the gradient, with the epsilon-constraint method.

    The energy is minimised for each of many residual limits. Both ends are found first, from
    several starts. A few limits between them follow, from both ends and a random start, all at
    once. From these the points are spaced evenly in both objectives; all points are then solved at
    once, each from the solutions on either side.

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
    profile = choose_profile(task) if profile is None else profile
    points = number_of_points(points)
    at = [positive("residual", one, "m") for one in several("at", at, "residuals")]
    setup = Setup(solver, bound, starts, seed, steps)
    began, ends = time.perf_counter(), find_ends(Curve.begin(task, profile, setup))
    wanted = _limits_at(ends, at)
    total = points + len(wanted)
    report(2, total)
    scouts = _scout(ends, points)
    limits = sorted([*_spaced_limits(ends, list(scouts.values()), points), *wanted])
    report(2 + len(limits) // 3, total)
    best = _solve_between(ends, list(scouts.values()), limits)
    report(total, total)
    between = [(one, {RESIDUAL_LIMIT: limit}) for limit, one in best.items()]
    return ends.curve.to_front(
        "epsilon",
        [*ends.certificates, *ends.curve.certify(between)],
        points,
        time.perf_counter() - began,
        iterations=sum(one.iterations for one in scouts.values()),
        also={"at": ", ".join(map(digits, at))} if at else {},
    )


def _scout(ends: Ends, points: int) -> Best:
    """Solutions at some limits between the ends, from both ends and a random start."""
    if ends.are_one or points == 2:
        return {}
    count = max(2, min(_SCOUTS, points - 2))
    shares = (np.arange(1, count + 1) / (count + 1)) ** 1.5
    limits = (ends.still.residual + shares * ends.width).tolist()
    starts = [ends.still.coefficients, ends.cheapest.coefficients, *ends.curve.starts[1:2]]
    best, _ = _improve(ends.curve, {}, dict.fromkeys(limits, starts))
    return {limit: one for limit, one in best.items() if one.status.solved}


def _spaced_limits(ends: Ends, scouts: Sequence[Solution], points: int) -> list[float]:
    """Residual limits at which the points between the ends lie at even distances.

    Both objectives are scaled to the ends.
    """
    if ends.are_one or points == 2:
        return []
    known = [ends.still, *scouts, ends.cheapest]
    residuals = np.array([one.residual for one in known])
    energies = np.array([one.energy for one in known])
    along = np.hypot(np.diff(residuals) / ends.width, np.diff(energies) / ends.height).cumsum()
    along = np.concatenate([[0.0], along])
    return np.interp(np.linspace(0.0, along[-1], points)[1:-1], along, residuals).tolist()


def _limits_at(ends: Ends, at: Sequence[float]) -> list[float]:
    """Residual limits for those of these residuals that lie between the ends."""
    limits = [_JUST_BELOW * residual for residual in at]
    return [one for one in limits if ends.still.residual < one < ends.cheapest.residual]


def _solve_between(ends: Ends, scouts: Sequence[Solution], limits: Sequence[float]) -> Best:
    """The best solution at each limit, from the solutions on either side and between them.

    One in so many is also tried from a random start. A point that is better for that, or was not
    found, is passed on to its neighbours, and they to it, as long as that helps.
    """
    curve, known = ends.curve, [ends.still, *scouts, ends.cheapest]
    beside = {limit: _starts_beside(known, limit) for limit in limits}
    best, _ = _improve(curve, {}, beside, warm=True)
    audited = limits[_AUDITED // 2 :: _AUDITED]
    best, changed = _improve(curve, best, dict.fromkeys(audited, curve.starts[1:2]))
    changed |= {limit for limit in limits if not best[limit].status.solved}
    for _ in range(_ROUNDS):
        starts: dict[float, list[Array]] = {}
        for pair in pairwise(limits):
            if changed & set(pair):
                for to, of in (pair, pair[::-1]):
                    if best[of].status.solved:
                        starts.setdefault(to, []).append(best[of].coefficients)
        best, changed = _improve(curve, best, starts, warm=True)
        if not changed:
            break
    return best


def _starts_beside(known: Sequence[Solution], limit: float) -> list[Array]:
    """The known solutions on either side of a limit, and the motion between them."""
    after = next(k for k, one in enumerate(known) if one.residual >= limit or one is known[-1])
    low, high = known[max(after - 1, 0)], known[after]
    share = (limit - low.residual) / max(high.residual - low.residual, STILL)
    between = low.coefficients + np.clip(share, 0, 1) * (high.coefficients - low.coefficients)
    return [between, low.coefficients, high.coefficients]


def _improve(
    curve: Curve, best: Best, starts: Mapping[float, Sequence[Array]], warm: bool = False
) -> tuple[Best, set[float]]:
    """The best at each limit, known or from these starts; and where these are better."""
    limits = [limit for limit, own in starts.items() if own]
    if not limits:
        return best, set()
    problems = [curve.problem(limit) for limit in limits]
    found = best_of_starts(
        problems, [starts[limit] for limit in limits], curve.solver, warm=warm, leave=not warm
    )
    changed = {
        limit
        for limit, problem, one in zip(limits, problems, found)
        if limit not in best or better(one, best[limit], problem.scalarization)
    }
    improved = dict(best)
    for limit, one in zip(limits, found):
        spent = one.iterations + (best[limit].iterations if limit in best else 0)
        improved[limit] = replace(one if limit in changed else best[limit], iterations=spent)
    return improved, changed
