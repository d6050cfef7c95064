"""The front by epsilon-constraint: the least energy at one residual limit after another."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from ocp.answers.provenance import SolveSettings, number_of_points
from ocp.base.checks import listed, positive, report_given
from ocp.base.threads import one_at_a_time
from ocp.front.answer import Front
from ocp.front.assembly import front_of
from ocp.front.checking import RESIDUAL_LIMIT, all_checked, checked
from ocp.front.ends import Ends, find_ends
from ocp.front.points import FailedPoint, FrontPoint
from ocp.front.sweep import Guess, Report, Sweep, better, no_report
from ocp.profiles.joint_profile import JointProfile
from ocp.profiles.polynomial import CycloidPolynomial
from ocp.program.solution import Solution
from ocp.task.point_to_point import PointToPoint

_DOUBT = 1e-4
"""Random starts are added where the sweeps differ by more than this share of the energy.
Smaller differences are within the error of the fixed steps: the better of the two is taken."""
_SCOUTS = 12
"""Rough limit on the steps along the front that find the spacing of its points."""
_JUST_BELOW = 1 - 1e-4
"""The residual limit is this share of the residual wanted: the verified one may be a little
above."""
_STRIDE = 4
"""Stride of the sweep back while both sweeps agree, and of the points that get random starts where
they do not; a better motion is carried on to the points between."""

_Points = tuple[list[FrontPoint | FailedPoint], bool]
"""The points, and whether all were done."""


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
) -> Front:
    """Find the front of residual and energy by the gradient, least energy at each residual limit.

    Both ends are found first, from several starts. A few points along the front tell how to space
    the limits so that the points lie evenly in both objectives. The limits are swept from the cheap
    end, each solve starting from the solution beside it, and swept back from the still end; where
    the two disagree, random starts are added, and neighbours start again from any better solution.

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
        Starts of the ends, and of points that the sweeps do not agree on.
    seed : int
        Seed of the random starts.
    steps : int, optional
        Steps of the solver's discretisation, as for `plan_move`.
    between : bool
        Whether the residual of an `UncertainPlant` is what a motion leaves at worst, whatever the
        error within the ranges; else at the plant's samples alone, as in a search.
    report : callable, optional
        Called with the number of points done and of all.

    Returns
    -------
    Front
        Method ``"epsilon"``; figures by the independent integrator. Points that could not be found
        are in its `failures`. Of an uncertain plant its task has the samples that this took, and
        ``settings["excess"]`` is the share by which what a point leaves between them may pass its
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
    points, report = number_of_points(points), report_given(report)
    at = [positive("residual", one, "m") for one in listed("at", at, "a list, as [1e-3]")]
    sweep = Sweep(task, profile, SolveSettings(bound=bound, starts=starts, seed=seed, steps=steps))
    ends = find_ends(sweep, between=between)
    found: list[FrontPoint | FailedPoint] = [ends.still_point]
    asked = {RESIDUAL_LIMIT: ends.cheapest.residual}
    found.append(checked(sweep, ends.cheapest, asked, free=True))
    also = _between(ends, at)
    total = points + len(also)
    report(2, total)
    try:
        limits = sorted([*_spaced_limits(sweep, ends, points), *also], reverse=True)
        stretch = _Stretch(sweep, limits, total, report)
        inner, complete = stretch.run(ends.cheapest, ends.still.coefficients)
        found += inner
    except KeyboardInterrupt:
        complete = False
    front = front_of(sweep, "epsilon", found, points, complete=complete, between=between)
    extra = {"at": ", ".join(f"{residual:g}" for residual in at)} if at else {}
    return replace(front, settings={**front.settings, **extra})


def _spaced_limits(sweep: Sweep, ends: Ends, points: int) -> list[float]:
    """Residual limits, falling, at which the points between the ends lie at even distances.

    Scouts go along the front from its cheap end in steps of about equal length, both objectives
    scaled to the ends, by the slope that the solver's multiplier gives.
    """
    if ends.are_one or points == 2:
        return []
    stillest, width, height = ends.still.residual, ends.width, ends.height
    scouts, limit = [ends.cheapest], ends.cheapest.residual
    stride = 2 * width / min(_SCOUTS, points)  # the scaled front is between sqrt(2) and 2 long
    while True:
        limit -= stride / np.hypot(1.0, scouts[-1].slope * width / height)
        if limit <= stillest + stride / 4:
            break
        found = sweep.solve(scouts[-1], limit)
        if found.status.solved:
            scouts.append(found)
    residuals = np.array([*(one.residual for one in scouts), stillest])
    energies = np.array([*(one.energy for one in scouts), ends.still.energy])
    along = np.hypot(np.diff(residuals) / width, np.diff(energies) / height).cumsum()
    along = np.concatenate([[0.0], along])
    spaced = np.interp(np.linspace(0.0, along[-1], points)[1:-1], along, residuals)
    return spaced.tolist()


def _between(ends: Ends, at: Sequence[float]) -> list[float]:
    """Residual limits for those of these residuals that lie between the ends."""
    limits = [_JUST_BELOW * residual for residual in at]
    return [one for one in limits if ends.still.residual < one < ends.cheapest.residual]


def _differ(one: Solution, other: Solution) -> bool:
    """Whether two solutions at one limit differ by more than the error of the fixed steps."""
    if not (one.status.solved and other.status.solved):
        return True
    return abs(one.energy - other.energy) > _DOUBT * one.energy


class _Stretch:
    """The front between its ends: the limits, falling, and the best solution at each."""

    def __init__(
        self, sweep: Sweep, limits: Sequence[float], points: int, report: Report = no_report
    ) -> None:
        self.sweep, self.limits = sweep, list(limits)
        self.best: list[Solution | None] = [None] * len(self.limits)
        self.points, self.report = points, report
        self.done = 0

    def run(self, above: Guess, below: Guess) -> _Points:
        """Sweep down from the guess above and up from the one below; return the checked points."""
        complete = True
        try:
            self._sweep(above, below)
        except KeyboardInterrupt:
            complete = False
        points, whole = self._points(interrupted=not complete)
        return points, complete and whole

    def _sweep(self, above: Guess, below: Guess) -> None:
        order, before_sweeps = range(len(self.limits)), self.sweep.iterations
        for i in order:
            found = self._try(i, above, done=(i + 1) // 2)
            above = found if found.status.solved else above
        doubtful = self._back(below)
        # many terms have many minima that hardly differ: spend at most as much again as the sweeps
        most = 2 * self.sweep.iterations - before_sweeps
        for i, guess in product(sorted(doubtful)[::_STRIDE], self.sweep.guesses):
            if self.sweep.iterations < most:
                self._try(i, guess)
        self._carry_on(doubtful, most)
        self._tell(len(self.limits))

    def _tell(self, done: int) -> None:
        """Report how many limits are done, where that changes."""
        if done != self.done:
            self.done = done
            self.report(2 + done, self.points)  # the ends are found

    def _back(self, below: Guess) -> set[int]:
        """Sweep back from the still end; the points at which it ended elsewhere.

        Where it finds the same motion as the sweep before, it skips points, since both would go on
        alike; where it finds a better one it goes back to the points that it skipped.
        """
        count, doubtful = len(self.limits), set[int]()
        i, last = count - 1, count
        while i >= 0:
            before = self.best[i]
            found = self._try(i, below, done=count - (i + 1) // 2)
            below = found if found.status.solved else below
            improved = self.best[i] is not before
            if improved or before is None or _differ(before, found):
                doubtful.add(i)
            if improved:
                for k in range(i + 1, last):
                    self._try(k, below)
            last = i
            i -= 1 if improved else _STRIDE
        return doubtful

    def _try(self, i: int, guess: Guess, done: int | None = None) -> Solution:
        best = self.best[i]
        found = self.sweep.solve(guess, self.limits[i])
        if best is None or better(found, best):
            self.best[i] = found
        if done is not None:
            self._tell(done)
        return found

    def _carry_on(self, changed: Iterable[int], most: int) -> None:
        """Start the neighbours of changed points from these, and so on where that helps."""
        waiting = list(changed)
        while waiting and self.sweep.iterations < most:
            i = waiting.pop()
            for neighbour in (i - 1, i + 1):
                start = self.best[i]
                if 0 <= neighbour < len(self.limits) and start is not None and start.status.solved:
                    before = self.best[neighbour]
                    self._try(neighbour, start)
                    if self.best[neighbour] is not before:
                        waiting.append(neighbour)

    def _points(self, interrupted: bool) -> _Points:
        tried = [
            (best, {RESIDUAL_LIMIT: limit})
            for limit, best in zip(self.limits, self.best, strict=True)
            if best is not None  # interrupted before
        ]
        failed = [
            FailedPoint(asked, best.status.text) for best, asked in tried if not best.status.solved
        ]
        solved = [(best, asked) for best, asked in tried if best.status.solved]
        points, whole = all_checked(self.sweep, solved, interrupted=interrupted)
        return [*points, *failed], whole
