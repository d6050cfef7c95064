"""The front by weighted sums of both objectives, and what no weight reaches."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.checks import not_negative
from quietarm.ocp.front.curve import RESIDUAL_LIMIT, Certificate, Curve, Report, no_report
from quietarm.ocp.front.ends import Ends, find_ends
from quietarm.ocp.front.front import Front
from quietarm.ocp.front.points import FailedPoint
from quietarm.ocp.interrupts import one_at_a_time
from quietarm.ocp.limits import RESIDUAL
from quietarm.ocp.planning.best_of_starts import best_of_starts, objective_of
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import SolveSettings, digits, number_of_points
from quietarm.ocp.solvers.choice import SolverName
from quietarm.ocp.solvers.problem import Solution
from quietarm.ocp.solvers.transcription import ENERGY
from quietarm.ocp.task import PointToPoint

_FLAT = 1e-5
"""A minimum closer to the chord than this share of its length counts as one of the chord's ends."""
_DIAGONAL = 2**0.5
Array = NDArray[np.float64]


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
    solver: SolverName = "sqp",
) -> Front:
    """Find points of the front by the gradient, as minima of weighted sums of both objectives.

    Both objectives are scaled to the ends of the front, which are found first. Weights are those of
    the chord between neighbouring points (the non-inferior set estimation of Cohon, Church and
    Sheer, 1979), the longest first. If the minimum does not lie below the chord, no weight has a
    point between its ends, because the front is not convex there.

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
        Method ``"weighted"``; values by CVODES. Its `gaps` are the ranges of the residual that no
        weight reaches, unless weights were given; these are in ``settings["weights"]``.

    Raises
    ------
    ValueError
        When an argument is out of range, or a weight negative, or both of a pair zero.
    InfeasibleTaskError, SolverFailedError
        When no motion of this profile keeps the limits, or an end is not found for another reason.
    """
    profile = CycloidPolynomial() if profile is None else profile
    points = number_of_points(points)
    chosen = None if weights is None else _pairs(weights)
    settings = SolveSettings(bound=bound, starts=starts, seed=seed, steps=steps, solver=solver)
    began, ends = time.perf_counter(), find_ends(Curve.begin(task, profile, settings))
    if ends.are_one:
        sums = _Sums()
    elif chosen is None:
        sums = _along_chords(ends, points, report)
    else:
        sums = _at_weights(ends, chosen, report)
    solved = [(one, {RESIDUAL_LIMIT: one.residual}) for one in sums.found]
    stated = ", ".join(f"{digits(residual)}:{digits(energy)}" for residual, energy in chosen or ())
    return ends.curve.to_front(
        "weighted",
        [*ends.certificates, *ends.curve.certify(solved), *sums.failures],
        points,
        time.perf_counter() - began,
        gaps=sorted(sums.gaps),
        also={"weights": stated} if stated else {},
    )


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


@dataclass
class _Sums:
    """Minima of weighted sums, what failed, and ranges of the residual that no weight reaches."""

    found: list[Solution] = field(default_factory=list)
    failures: list[Certificate] = field(default_factory=list)
    gaps: list[tuple[float, float]] = field(default_factory=list)

    def add(self, found: Solution, of_residual: float, of_energy: float) -> None:
        """Add a minimum, or why there is none."""
        if found.status.solved:
            self.found.append(found)
            return
        asked = {"residual_weight": of_residual, "energy_weight": of_energy}
        self.failures.append(Certificate(FailedPoint(asked, found.status.text), found.iterations))


def _minimise(
    ends: Ends, of_residual: float, of_energy: float, starts: Sequence[Array]
) -> Solution:
    """The best minimum of one weighted sum, weights of the scaled objectives."""
    weights = {RESIDUAL: of_residual / ends.width, ENERGY: of_energy / ends.height}
    problem, solver = ends.curve.problem(minimise=weights), ends.curve.solver
    # far starts lead past a dearer minimum, near ones keep to the minimum beside them
    found = [best_of_starts([problem], [starts], solver, warm=warm)[0] for warm in (False, True)]
    return min(found, key=lambda one: objective_of(one, problem.scalarization))


def _along_chords(ends: Ends, points: int, report: Report) -> _Sums:
    """Weights from the chords between neighbours, the longest first."""
    sums, chords = _Sums(), [(ends.still, ends.cheapest)]
    while chords and 2 + len(sums.found) < points:
        lengths = [np.hypot(*_sides(ends, *chord)) for chord in chords]
        still, cheap = chords.pop(int(np.argmax(lengths)))
        wide, high = _sides(ends, still, cheap)
        found = _minimise(ends, high, wide, [cheap.coefficients, still.coefficients])
        if not found.status.solved:
            sums.add(found, high, wide)
            continue
        to_right, down = _sides(ends, still, found)
        length = np.hypot(wide, high)
        if (wide * down - high * to_right) / length > _FLAT * length and 0 < to_right < wide:
            sums.add(found, high, wide)
            chords += [(still, found), (found, cheap)]
        elif length > 2 * _DIAGONAL / (points - 1):
            sums.gaps.append((still.residual, cheap.residual))
        report(2 + len(sums.found), points)
    return sums


def _at_weights(ends: Ends, weights: Sequence[tuple[float, float]], report: Report) -> _Sums:
    """Given weights, sorted from most weight on the energy to most on the residual."""
    sums, beside = _Sums(), ends.cheapest.coefficients
    for i, pair in enumerate(sorted(weights, key=lambda pair: pair[0] / sum(pair)), start=1):
        if min(pair) > 0:  # with one weight 0 it is an end of the front
            found = _minimise(ends, *pair, [beside, ends.still.coefficients])
            sums.add(found, *pair)
            beside = found.coefficients if found.status.solved else beside
        report(i, len(weights))
    return sums


def _sides(ends: Ends, still: Solution, cheap: Solution) -> tuple[float, float]:
    """How far apart two solutions are in both objectives, scaled to the ends."""
    return (
        (cheap.residual - still.residual) / ends.width,
        (still.energy - cheap.energy) / ends.height,
    )
