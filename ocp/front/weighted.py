"""The front by weighted sums of both objectives, and what no weight reaches."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.checks import not_negative, takes
from quietarm.ocp.front.curve import RESIDUAL_LIMIT, Asked, Curve, Report, no_report
from quietarm.ocp.front.ends import Ends, find_ends
from quietarm.ocp.front.front import Front
from quietarm.ocp.limits import RESIDUAL
from quietarm.ocp.planning.best_of_starts import best_of_starts, minimum_of
from quietarm.ocp.planning.choose_profile import choose_profile
from quietarm.ocp.planning.setup import Setup
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import digits, number_of_points
from quietarm.ocp.solvers.problem import ENERGY, Solution
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.task import PointToPoint

_FLAT = 1e-5
"""A minimum closer to the chord than this share of its length counts as one of the chord's ends."""
_DIAGONAL = 2**0.5
Array = NDArray[np.float64]
Minimum = tuple[Solution, Asked]


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
    report: Report = no_report,
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
    profile = choose_profile(task) if profile is None else profile
    points = number_of_points(points)
    chosen = None if weights is None else _pairs(weights)
    setup = Setup(solver, bound, starts, seed, steps)
    began, ends = time.perf_counter(), find_ends(Curve.begin(task, profile, setup))
    found, gaps = list[Minimum](), list[tuple[float, float]]()
    if chosen is None and not ends.are_one:
        found, gaps = _along_chords(ends, points, report)
    elif chosen is not None and not ends.are_one:
        found = _at_weights(ends, chosen, report)
    stated = ", ".join(f"{digits(residual)}:{digits(energy)}" for residual, energy in chosen or ())
    return ends.curve.to_front(
        "weighted",
        [*ends.certificates, *ends.curve.certify(found)],
        points,
        time.perf_counter() - began,
        gaps=sorted(gaps),
        also={"weights": stated} if stated else {},
    )


def _pairs(weights: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """The weights that were given, each pair checked."""
    try:
        both = [(of_residual, of_energy) for of_residual, of_energy in weights]
    except (TypeError, ValueError):
        raise ValueError(
            f"weights are {weights!r}; give pairs of residual and energy, as [(1, 0), (1, 3)]"
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
    weights = {RESIDUAL: of_residual / ends.width, ENERGY: of_energy / ends.height}
    problem, solver = ends.curve.problem(minimise=weights), ends.curve.solver
    # far starts lead past a dearer minimum, near ones keep to the minimum beside them
    found = [best_of_starts([problem], [starts], solver, warm=warm)[0] for warm in (False, True)]
    best = min(found, key=lambda one: minimum_of(one, problem.scalarization))
    best = replace(best, iterations=sum(one.iterations for one in found))
    if best.status.solved:  # if it is not certified, its place is known
        return best, {RESIDUAL_LIMIT: best.residual}
    return best, {"residual_weight": of_residual, "energy_weight": of_energy}


def _along_chords(
    ends: Ends, points: int, report: Report
) -> tuple[list[Minimum], list[tuple[float, float]]]:
    """Minima by the chords between neighbours, the longest first; and what no weight reaches."""
    minima, gaps, chords = list[Minimum](), [], [(ends.still, ends.cheapest)]
    done = 2
    while chords and done < points:
        lengths = [np.hypot(*_sides(ends, *chord)) for chord in chords]
        still, cheap = chords.pop(int(np.argmax(lengths)))
        wide, high = _sides(ends, still, cheap)
        minimum = _minimise(ends, high, wide, [cheap.coefficients, still.coefficients])
        found = minimum[0]
        if not found.status.solved:
            minima.append(minimum)
            continue
        to_right, down = _sides(ends, still, found)
        length = np.hypot(wide, high)
        if (wide * down - high * to_right) / length > _FLAT * length and 0 < to_right < wide:
            minima.append(minimum)
            chords += [(still, found), (found, cheap)]
            done += 1
        elif length > 2 * _DIAGONAL / (points - 1):
            gaps.append((still.residual, cheap.residual))
        report(done, points)
    return minima, gaps


def _at_weights(
    ends: Ends, weights: Sequence[tuple[float, float]], report: Report
) -> list[Minimum]:
    """Minima of given weights, from most weight on the energy to most on the residual."""
    minima, beside = list[Minimum](), ends.cheapest.coefficients
    for i, pair in enumerate(sorted(weights, key=lambda pair: pair[0] / sum(pair)), start=1):
        if min(pair) > 0:  # with one weight 0 it is an end of the front
            minima.append(_minimise(ends, *pair, [beside, ends.still.coefficients]))
            found = minima[-1][0]
            beside = found.coefficients if found.status.solved else beside
        report(i, len(weights))
    return minima


def _sides(ends: Ends, still: Solution, cheap: Solution) -> tuple[float, float]:
    """How far apart two solutions are in both objectives, scaled to the ends."""
    return (
        (cheap.residual - still.residual) / ends.width,
        (still.energy - cheap.energy) / ends.height,
    )
