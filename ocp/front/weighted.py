"""The front by weighted sums of both objectives, and what no weight reaches."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from quietarm.ocp.checks import not_negative
from quietarm.ocp.front.answer import Front
from quietarm.ocp.front.checking import RESIDUAL_LIMIT, all_checked
from quietarm.ocp.front.curve import Ends, find_ends, front_of
from quietarm.ocp.front.points import FailedPoint, FrontPoint
from quietarm.ocp.front.sweep import Guess, Report, Sweep, best_of, no_report
from quietarm.ocp.interrupts import one_at_a_time
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.profiles.polynomial import CycloidPolynomial
from quietarm.ocp.record import SolveSettings, digits, number_of_points
from quietarm.ocp.solvers.solution import ENERGY, RESIDUAL, Solution
from quietarm.ocp.solvers.solving import Solver
from quietarm.ocp.task import PointToPoint

_FLAT = 1e-5
"""A minimum closer to the chord than this share of its length counts as one of the chord's ends."""
_DIAGONAL = 2**0.5


@one_at_a_time
def weighted_front(
    task: PointToPoint,
    profile: JointProfile | None = None,
    *,
    bound: float | None = None,
    points: int = 50,
    weights: Sequence[tuple[float, float]] | None = None,
    starts: int = 4,
    seed: int = 0,
    steps: int | None = None,
    report: Report = no_report,
    solver: Solver = "sqp",
) -> Front:
    """Find points of the front by the gradient, as minima of weighted sums of both objectives.

    Both objectives are scaled to the ends of the front, which are found first. Weights are those of
    the chord between neighbouring points (the non-inferior set estimation of Cohon, Church and
    Sheer, 1979), the longest first: where such a solve ends no further below than its chord, no
    weight has a point between its ends, because the front bends the wrong way there.

    Parameters
    ----------
    task, profile, bound, seed, steps, report, solver
        As for `epsilon_front`.
    points : int
        Most points, the ends included.
    weights : sequence of (float, float), optional
        Weights of the scaled residual and energy to be used instead.
    starts : int
        Starts of the ends.

    Returns
    -------
    Front
        Method ``"weighted"``; figures by the independent integrator. Its `gaps` are the ranges of
        the residual that no weight reaches, where the weights were not given; given ones stand in
        ``settings["weights"]``. After Ctrl-C what was found until then, with ``complete`` false.

    Raises
    ------
    ValueError
        When an argument is out of range, or a weight negative, or both of a pair zero.
    InfeasibleTaskError
        When no motion of this profile keeps the task's limits.
    SolverFailedError
        When an end of the front could not be found for another reason.
    """
    profile = CycloidPolynomial() if profile is None else profile
    points = number_of_points(points)
    chosen = None if weights is None else _pairs(weights)
    sweep = Sweep(
        task,
        profile,
        SolveSettings(bound=bound, starts=starts, seed=seed, steps=steps, solver=solver),
    )
    sums = _Sums(sweep, find_ends(sweep))
    complete = True
    try:
        if chosen is None:
            sums.by_chords(points, report)
        else:
            sums.by_weights(chosen, report)
    except KeyboardInterrupt:
        complete = False
    found, whole = sums.checked(interrupted=not complete)
    complete = complete and whole
    stated = ", ".join(f"{digits(residual)}:{digits(energy)}" for residual, energy in chosen or ())
    also = {"weights": stated} if stated else {}
    return front_of(sweep, "weighted", found, points, gaps=sums.gaps, complete=complete, also=also)


def _pairs(weights: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """The weights that were given, each pair checked."""
    pairs = [
        (not_negative("weight", of_residual), not_negative("weight", of_energy))
        for of_residual, of_energy in weights
    ]
    if not pairs:
        raise ValueError("no weights are given; give a pair of residual and energy, or none at all")
    if (0.0, 0.0) in pairs:
        raise ValueError("both weights are 0, which asks for nothing; give one above 0")
    return pairs


class _Sums:
    """The minima of weighted sums found so far."""

    def __init__(self, sweep: Sweep, ends: Ends) -> None:
        self.sweep, self.ends = sweep, ends
        self.found: list[Solution] = []
        self.failures: list[FailedPoint] = []
        self.gaps: list[tuple[float, float]] = []

    def solve(self, of_residual: float, of_energy: float, guesses: Sequence[Guess]) -> Solution:
        """The best minimum of one weighted sum, weights of the scaled objectives."""
        minimise = {RESIDUAL: of_residual / self.ends.width, ENERGY: of_energy / self.ends.height}
        ask = self.sweep.ask(minimise=minimise)
        # far starts lead past a dearer minimum, near ones keep to the minimum beside them
        return best_of([self.sweep.best(guesses, ask, warm=warm) for warm in (False, True)], ask)

    def by_chords(self, points: int, report: Report) -> None:
        """Weights from the chords between neighbours, the longest first."""
        if self.ends.are_one:
            return
        chords: list[tuple[Solution, Solution]] = [(self.ends.still, self.ends.cheapest)]
        while chords and 2 + len(self.found) < points:
            lengths = [np.hypot(*self._sides(*chord)) for chord in chords]
            still, cheap = chords.pop(int(np.argmax(lengths)))
            wide, high = self._sides(still, cheap)
            found = self.solve(high, wide, [cheap.coefficients, still.coefficients])
            if not found.status.solved:
                self._failed(high, wide, found)
                continue
            to_right, down = self._sides(still, found)
            below = (wide * down - high * to_right) / np.hypot(wide, high)
            if below > _FLAT * np.hypot(wide, high) and 0 < to_right < wide:
                self.found.append(found)
                chords += [(still, found), (found, cheap)]
            elif np.hypot(wide, high) > 2 * _DIAGONAL / (points - 1):
                self.gaps.append((still.residual, cheap.residual))
            report(2 + len(self.found), points)
        self.gaps.sort()

    def by_weights(self, weights: Sequence[tuple[float, float]], report: Report) -> None:
        """Given weights, sorted from most weight on the energy to most on the residual."""
        if self.ends.are_one:
            return
        beside = self.ends.cheapest.coefficients
        still = self.ends.still.coefficients
        for i, pair in enumerate(sorted(weights, key=lambda pair: pair[0] / sum(pair)), start=1):
            if min(pair) > 0:  # with one weight 0 it is an end of the front
                found = self.solve(*pair, [beside, still])
                if found.status.solved:
                    self.found.append(found)
                    beside = found.coefficients
                else:
                    self._failed(*pair, found)
            report(i, len(weights))

    def checked(self, interrupted: bool) -> tuple[list[FrontPoint | FailedPoint], bool]:
        """Every point by the independent integrator, and the failures; whether all were done."""
        asked = [(one, {RESIDUAL_LIMIT: one.residual}) for one in (self.ends.cheapest, *self.found)]
        points, whole = all_checked(self.sweep, asked, interrupted=interrupted)
        return [self.ends.still_point, *points, *self.failures], whole

    def _sides(self, still: Solution, cheap: Solution) -> tuple[float, float]:
        return (
            (cheap.residual - still.residual) / self.ends.width,
            (still.energy - cheap.energy) / self.ends.height,
        )

    def _failed(self, of_residual: float, of_energy: float, found: Solution) -> None:
        asked = {"residual_weight": of_residual, "energy_weight": of_energy}
        self.failures.append(FailedPoint(asked, found.status.text))
