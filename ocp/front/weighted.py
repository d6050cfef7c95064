"""The front by weighted sums of both objectives, and what no weight reaches."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.checks import not_negative, quoted, takes
from quietarm.ocp.figures import ENERGY
from quietarm.ocp.front.ends import Ends, find_ends
from quietarm.ocp.front.front import Front
from quietarm.ocp.front.tradeoff import RESIDUAL_LIMIT, AskedPlace, Tradeoff
from quietarm.ocp.limits import RESIDUAL
from quietarm.ocp.planning.best_of_starts import best_of_starts, minimum_of
from quietarm.ocp.planning.choose_profile import choose_profile
from quietarm.ocp.planning.request import Request
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import digits, number_of_points
from quietarm.ocp.solvers.problem import Solution
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.task import PointToPoint
from quietarm.ocp.told_progress import Progress, no_report

Array = NDArray[np.float64]
Minimum = tuple[Solution, AskedPlace]
Gap = tuple[float, float]
"""Residuals [m] between which no weight has a point."""


@takes(task=PointToPoint, profile=JointProfile, solver=Solver)
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
    solver: Solver = Sqp(),
    report: Progress = no_report,
) -> Front:
    """Find points of the front by the gradient, as minima of weighted sums of both objectives.

    Both objectives are scaled to the ends of the front, which are found first. Weights are those of
    the chord between neighbouring points (the non-inferior set estimation of Cohon, Church and
    Sheer, 1979), the longest first. If the minimum does not lie below the chord, no weight has a
    point between its ends, because the front is not convex there.

    Parameters
    ----------
    task, profile, bound, seed, steps, solver, report
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
        Method ``"weighted"``; values by CVODES. Its `gaps` are the ranges of the residual that no
        weight reaches, unless weights were given; these are in ``settings["weights"]``.

    Raises
    ------
    ValueError
        When a weight is negative, or both of a pair are zero; else as `epsilon_front`.
    """
    began = time.perf_counter()
    profile = choose_profile(task) if profile is None else profile
    points = number_of_points(points)
    chosen = [] if weights is None else _pairs(weights)
    request = Request(task, profile, solver, bound, starts, seed, steps)
    ends = find_ends(Tradeoff.begin(request))
    minima: list[Minimum] = []
    gaps: list[Gap] = []
    if chosen and not ends.are_one:
        minima = _at_weights(ends, chosen, report)
    elif not ends.are_one:
        minima, gaps = _along_chords(ends, points, report)
    pairs = [f"{digits(residual)}:{digits(energy)}" for residual, energy in chosen]
    front = ends.tradeoff.to_front(
        "weighted",
        [*ends.certificates, *ends.tradeoff.certify(minima)],
        points,
        settings={"weights": ", ".join(pairs)} if pairs else {},
    )
    front = replace(front, gaps=tuple(sorted(gaps)))
    return front.restated(seconds=time.perf_counter() - began)


def _pairs(weights: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """The weights that a user gives, each pair checked."""
    try:
        both = [(of_residual, of_energy) for of_residual, of_energy in weights]
    except (TypeError, ValueError):
        raise ValueError(
            f"weights are {quoted(weights)}; give pairs of residual and energy, such as [(1, 0), "
            "(1, 3)]"
        ) from None
    pairs = [
        (not_negative("weight", of_residual), not_negative("weight", of_energy))
        for of_residual, of_energy in both
    ]
    if not pairs:
        raise ValueError("no weights are given; give a pair of residual and energy, or none at all")
    if (0.0, 0.0) in pairs:
        raise ValueError("both weights are 0, which asks for nothing; give one above 0")
    return pairs


def _minimise(ends: Ends, of_residual: float, of_energy: float, starts: Sequence[Array]) -> Minimum:
    """The best minimum of one weighted sum, weights of the scaled objectives."""
    solver = ends.tradeoff.solver
    problem = ends.tradeoff.problem(
        minimise={RESIDUAL: of_residual / ends.width, ENERGY: of_energy / ends.height}
    )
    # far starts lead past a dearer minimum, near ones keep to the minimum beside them
    (from_far,) = best_of_starts([problem], [starts], solver)
    (from_near,) = best_of_starts([problem], [starts], solver, warm=True)
    best = min(
        from_far,
        from_near,
        key=lambda solution: minimum_of(solution, problem),
    )
    best = replace(best, iterations=from_far.iterations + from_near.iterations)
    if best.status.solved:  # if it is not certified, its place is known
        return best, {RESIDUAL_LIMIT: best.residual}
    return best, {"residual_weight": of_residual, "energy_weight": of_energy}


def _along_chords(
    ends: Ends, points: int, report: Progress, flat: float = 1e-5
) -> tuple[list[Minimum], list[Gap]]:
    """Minima by the chords between neighbours, the longest first; and what no weight reaches.

    A minimum closer to the chord than the share `flat` of its length counts as one of its ends.
    """
    longest_gap = 2 * math.sqrt(2) / (points - 1)
    minima: list[Minimum] = []
    gaps: list[Gap] = []
    chords = [(ends.still, ends.cheapest)]
    done = 2
    while chords and done < points:
        lengths = [np.hypot(*_sides(ends, *chord)) for chord in chords]
        still, cheap = chords.pop(int(np.argmax(lengths)))
        wide, high = _sides(ends, still, cheap)
        minimum = _minimise(ends, high, wide, [cheap.coefficients, still.coefficients])
        solution, _ = minimum
        if not solution.status.solved:
            minima.append(minimum)
            continue
        to_right, down = _sides(ends, still, solution)
        length = np.hypot(wide, high)
        below_chord = (wide * down - high * to_right) / length
        if below_chord > flat * length and 0 < to_right < wide:
            minima.append(minimum)
            chords += [(still, solution), (solution, cheap)]
            done += 1
        elif length > longest_gap:
            gaps.append((still.residual, cheap.residual))
        report(done, points)
    return minima, gaps


def _at_weights(
    ends: Ends, weights: Sequence[tuple[float, float]], report: Progress
) -> list[Minimum]:
    """Minima of these weights, from most weight on the energy to most on the residual."""
    by_share = sorted(weights, key=lambda pair: pair[0] / sum(pair))
    minima: list[Minimum] = []
    beside = ends.cheapest.coefficients
    for i, pair in enumerate(by_share, start=1):
        if min(pair) > 0:  # with one weight 0 it is an end of the front
            minimum = _minimise(ends, *pair, [beside, ends.still.coefficients])
            minima.append(minimum)
            solution, _ = minimum
            if solution.status.solved:
                beside = solution.coefficients
        report(i, len(weights))
    return minima


def _sides(ends: Ends, still: Solution, cheap: Solution) -> tuple[float, float]:
    """Return how far apart two solutions are in both objectives, scaled to the ends."""
    return (
        (cheap.residual - still.residual) / ends.width,
        (still.energy - cheap.energy) / ends.height,
    )
