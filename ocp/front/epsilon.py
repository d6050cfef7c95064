"""The front by epsilon-constraint: the least energy at one residual limit after another."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from quietarm.ocp.checks import positive
from quietarm.ocp.front.answer import Front
from quietarm.ocp.front.checking import RESIDUAL_LIMIT, all_checked, checked
from quietarm.ocp.front.curve import Ends, find_ends, front_of
from quietarm.ocp.front.points import FailedPoint, FrontPoint
from quietarm.ocp.front.sweep import Guess, Report, Sweep, better, no_report
from quietarm.ocp.interrupts import note_interrupts, one_at_a_time
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.profiles.polynomial import CycloidPolynomial
from quietarm.ocp.record import SolveSettings, digits, number_of_points
from quietarm.ocp.solvers.solution import STILL, Solution
from quietarm.ocp.solvers.solving import Solver
from quietarm.ocp.task import PointToPoint

_SCOUTS = 5
"""Limits between the ends that are solved first, from both ends and a random start."""
_AUDITED = 4
"""One point in so many is also tried from random starts."""
_ROUNDS = 3
"""Most times that points are solved again from better neighbours."""
_JUST_BELOW = 1 - 1e-4
"""The residual limit is this share of the residual wanted: the verified one may be a little
above."""

Best = dict[float, Solution]
"""The best solution until now at each residual limit [m]."""


@one_at_a_time
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
    between: bool = True,
    report: Report = no_report,
    solver: Solver = "sqp",
) -> Front:
    """Find the front of residual and energy by the gradient, least energy at each residual limit.

    Both ends are found first, from several starts. Then come a few limits between them, from both
    ends and a random start, all at once. These tell how to space the points so that they lie
    evenly in both objectives; all points are then solved at once, each from the solutions on either
    side.

    Parameters
    ----------
    task : PointToPoint
        The move and its limits.
    profile : JointProfile, optional
        How the joint moves; the cycloid of a polynomial of six terms by default.
    bound : float, optional
        Largest absolute coefficient; none by default.
    points : int
        Number of points, the ends included.
    at : sequence of float, optional
        Residuals [m] at which there is to be a point as well, where they lie between the ends.
    starts : int
        Starts of the ends; from two on one random start tries the first limits and some points.
    seed : int
        Seed of the random starts.
    steps : int, optional
        Steps of the solver's discretisation, as for `plan_move`.
    between : bool
        Whether the residual of an uncertain task is what a motion leaves at worst, whatever the
        error within the ranges; else at the plant's samples alone, as in a search.
    report : callable, optional
        Called with the number of points done and of all.
    solver : {"sqp", "ipopt"}
        As for `plan_move`.

    Returns
    -------
    Front
        Method ``"epsilon"``; figures by the independent integrator. Points that could not be found
        are in its `failures`. Of an uncertain plant its task has the samples that this took, and
        its `excess` is the share by which what a point leaves between them may pass its
        residual. After Ctrl-C what was found until then, with ``complete`` false.

    Raises
    ------
    ValueError
        When an argument is out of range.
    InfeasibleTaskError
        When no motion of this profile keeps the task's limits.
    SolverFailedError
        When an end of the front could not be found for another reason.
    """
    profile = CycloidPolynomial() if profile is None else profile
    points = number_of_points(points)
    at = [positive("residual", one, "m") for one in at]
    sweep = Sweep(
        task,
        profile,
        SolveSettings(bound=bound, starts=starts, seed=seed, steps=steps, solver=solver),
    )
    ends = find_ends(sweep, between=between)
    found: list[FrontPoint | FailedPoint] = [ends.still_point]
    asked = {RESIDUAL_LIMIT: ends.cheapest.residual}
    found.append(checked(sweep, ends.cheapest, asked, free=True))
    wanted = _limits_at(ends, at)
    total = points + len(wanted)
    first, best, complete = Best(), Best(), True
    try:
        report(2, total)
        scouts = _scouted(sweep, ends, points, first)
        limits = sorted([*_spaced_limits(ends, scouts, points), *wanted])
        report(2 + len(limits) // 3, total)
        _solve_between(sweep, ends, scouts, limits, best)
        report(total, total)
    except KeyboardInterrupt:
        best, complete = {**first, **best}, False
    with note_interrupts() as late:
        tried = [(one, {RESIDUAL_LIMIT: limit}) for limit, one in best.items()]
        solved = [(one, ask) for one, ask in tried if one.status.solved]
        failed = [FailedPoint(ask, one.status.text) for one, ask in tried if not one.status.solved]
        inner, whole = all_checked(sweep, solved, interrupted=not complete)
        found = [*found, *(failed if complete else []), *inner]
    complete = complete and whole and not late
    also = {"at": ", ".join(map(digits, at))} if at else {}
    return front_of(sweep, "epsilon", found, points, complete=complete, between=between, also=also)


def _scouted(sweep: Sweep, ends: Ends, points: int, best: Best) -> list[Solution]:
    """Solutions at some limits between the ends, from both ends and a random start."""
    if ends.are_one or points == 2:
        return []
    count = max(2, min(_SCOUTS, points - 2))
    shares = (np.arange(1, count + 1) / (count + 1)) ** 1.5
    limits = (ends.still.residual + shares * ends.width).tolist()
    starts = [ends.still.coefficients, ends.cheapest.coefficients, *sweep.guesses[1:2]]
    _improve(sweep, best, [(limit, start) for limit in limits for start in starts])
    return [best[limit] for limit in limits if best[limit].status.solved]


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


def _solve_between(
    sweep: Sweep, ends: Ends, scouts: Sequence[Solution], limits: Sequence[float], best: Best
) -> None:
    """The best solution at each limit, from the solutions on either side and between them.

    One in so many is also tried from a random start. A point that is better for that, or was not
    found, is passed on to its neighbours, and they to it, as long as that helps.
    """
    known, starts = [ends.still, *scouts, ends.cheapest], list[tuple[float, Guess]]()
    for limit in limits:
        after = next(k for k, one in enumerate(known) if one.residual >= limit or one is known[-1])
        low, high = known[max(after - 1, 0)], known[after]
        share = (limit - low.residual) / max(high.residual - low.residual, STILL)
        on_the_line = low.coefficients + np.clip(share, 0, 1) * (
            high.coefficients - low.coefficients
        )
        starts += [(limit, a) for a in (on_the_line, low.coefficients, high.coefficients)]
    _improve(sweep, best, starts, warm=True)
    audited = limits[_AUDITED // 2 :: _AUDITED]
    changed = _improve(sweep, best, [(limit, a) for limit in audited for a in sweep.guesses[1:2]])
    changed |= {limit for limit in limits if not best[limit].status.solved}
    for _ in range(_ROUNDS):
        pairs = {pair for pair in pairwise(limits) if changed & set(pair)}
        both = [*pairs, *(pair[::-1] for pair in pairs)]
        starts = [(to, best[of].coefficients) for of, to in both if best[of].status.solved]
        changed = _improve(sweep, best, starts, warm=True)
        if not changed:
            break


def _improve(
    sweep: Sweep, best: Best, starts: Sequence[tuple[float, Guess]], warm: bool = False
) -> set[float]:
    """Solve at limits from coefficients, and keep what is better; tells at which it is.

    After Ctrl-C what was solved is kept as well.
    """
    if not starts:
        return set()
    rows, changed = [(start, sweep.ask(limit)) for limit, start in starts], set[float]()
    places = np.unique([limit for limit, _ in starts], return_inverse=True)[1].tolist()
    found, complete = sweep.solved(rows, warm=warm, groups=None if warm else places)
    for (limit, _), one in zip(starts, found, strict=True):
        if limit not in best or better(one, best[limit]):
            best[limit] = one
            changed.add(limit)
    if not complete:
        raise KeyboardInterrupt
    return changed
