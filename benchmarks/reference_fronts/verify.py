"""Verify reference fronts by a program that shares no grid with the one that made them.

    python benchmarks/reference_fronts/verify.py [NAME ...] [--record] [--mend]

Every point is evaluated by CVODES, every fifth is solved again from itself by the rival; some are
also tried from random starts. What the rival finds counts by CVODES: its energy, its residual and
its limits. The best of a front is confirmed by DOP853.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from rival import STEPS, Rival, by_dop853

from quietarm.metaheuristics import PROBLEMS, NamedProblem
from quietarm.metaheuristics.problems.catalogue import FRONTS
from quietarm.ocp import Front, FrontPoint, JudgedMotion, PointToPoint, QuietarmError, non_dominated

EVERY = 5
"""One point in so many is solved again from itself, and the last."""
TRIED = 10
"""Points that are also tried from random starts."""
STARTS = 2
SEED = 3000
"""Of the random starts: others than found the front."""
BEATEN = 1e-5
"""A front holds where nothing is cheaper than a point by more than this share of its energy."""
SAME_ENERGY, SAME_RESIDUAL = 1e-6, 1e-7
"""And where CVODES gives the stated energies within this share, and residuals within this [m]."""
_STILL = 1e-8
_KEPT = 1e-6
"""Share by which a motion may pass a limit, as the points of a front."""
_BELOW = 1 - 5e-7
"""The rival's residual limit is this share of a point's: its figures differ from those of CVODES
by as much."""
_ROUNDS = 4
"""How often limits are tightened."""

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Certificate:
    """Certificate of a reference front.

    The largest differences from what CVODES gives, of the energies as a share and of the residuals
    [m]; how many points the rival solved from themselves, and from how many random starts; the
    largest share by which any of its motions is cheaper than the point, by CVODES, and by DOP853
    (NaN where the residual is of several scenarios); and the better motions by their places.
    """

    front: str
    points: int
    solved_again: int
    energy_difference: float
    residual_difference: float
    tried: int
    gained: float
    gained_by_dop853: float
    better: dict[int, FrontPoint]

    @property
    def holds(self) -> bool:
        """Return whether what was found is within the tolerances."""
        same = self.energy_difference <= SAME_ENERGY and self.residual_difference <= SAME_RESIDUAL
        return same and self.gained <= BEATEN


def certified(
    problem: NamedProblem, report: Callable[[str], None] = lambda name: None
) -> list[Certificate]:
    """Check the reference fronts of a problem anew; `report` is called with each one's name."""
    certificates = list[Certificate]()
    for (name, task), front in zip(problem.tasks().items(), problem.fronts(), strict=True):
        report(name)
        certificates.append(_certified(name, task, front, problem.bound))
    return certificates


def _certified(name: str, task: PointToPoint, front: Front, bound: float) -> Certificate:
    motions = [
        JudgedMotion.of_profile(task, front.profile, point.coefficients) for point in front.points
    ]
    energies = np.array([motion.energy for motion in motions])
    residuals = np.array([motion.residual for motion in motions])
    rival, better = Rival(task, front.profile, bound), dict[int, FrontPoint]()

    def try_from(place: int, start: Array) -> None:
        known = better.get(place, front.points[place])
        motion = _motion_of(rival, front.points[place], start)
        if motion is not None and motion.energy < known.energy:
            better[place] = motion

    again = sorted({*range(0, len(motions), EVERY), len(motions) - 1})
    for place in again:
        try_from(place, np.array(front.points[place].coefficients))
    random, box = np.random.default_rng(SEED), front.profile.start_box(bound)
    places = np.unique(np.linspace(0, len(motions) - 1, TRIED).astype(int)).tolist()
    for place in places:
        for _ in range(STARTS):
            try_from(place, random.uniform(*box))
    gains = {place: 1 - one.energy / front.points[place].energy for place, one in better.items()}
    most = max(gains, key=lambda place: gains[place], default=None)
    return Certificate(
        front=name,
        points=len(motions),
        solved_again=len(again),
        energy_difference=float(np.abs(energies / front.energies - 1).max()),
        residual_difference=float(np.abs(residuals - front.residuals).max()),
        tried=len(places) * STARTS,
        gained=0.0 if most is None else gains[most],
        gained_by_dop853=_by_dop853(task, front, better, most),
        better=better,
    )


def _motion_of(rival: Rival, point: FrontPoint, start: Array) -> FrontPoint | None:
    """The rival's motion at a point's residual, with the figures of CVODES; None where it fails."""
    residual = point.residual * _BELOW if point.residual > _STILL else 0.0
    room, task = 0.0, rival.task
    for _ in range(_ROUNDS):
        found = rival.solve(residual, start, room)
        if found is None:
            return None
        coefficients = rival.profile.checked(found)
        motion = JudgedMotion.of_profile(task, rival.profile, coefficients)
        try:
            figures = motion.residual, motion.energy
        except QuietarmError:
            return None
        if figures[0] > max(point.residual * (1 + _KEPT), _STILL):
            return None
        exceeded = motion.figures.exceeded(task.limits, _KEPT) if task.limits else {}
        if not exceeded:
            return FrontPoint(coefficients, *figures)
        room += max(exceeded.values()) - 1
        start = found
        if room > 0.1:
            return None
    return None


def _by_dop853(
    task: PointToPoint, front: Front, better: dict[int, FrontPoint], place: int | None
) -> float:
    """The gain at a place by another integrator: 0 where there is none, NaN of several scenarios.

    ValueError where it gives another residual.
    """
    if place is None:
        return 0.0
    if task.uncertainty is not None:
        return np.nan
    before, after = front.points[place], better[place]
    energies = list[float]()
    for point in (before, after):
        residual, energy = by_dop853(task, front.profile, np.array(point.coefficients))
        if abs(residual - point.residual) > _KEPT * point.residual + _STILL:
            raise ValueError(f"DOP853 gives a residual of {residual:g} m, not {point.residual:g} m")
        energies.append(energy)
    return 1 - energies[1] / energies[0]


def mended(front: Front, certificate: Certificate) -> Front:
    """The front with better motions in place of the points that they beat, figures by CVODES."""
    points = list[FrontPoint]()
    for place, known in enumerate(front.points):
        best = certificate.better.get(place, known)
        motion = JudgedMotion.of_profile(front.task, front.profile, best.coefficients)
        points.append(FrontPoint(best.coefficients, motion.residual, motion.energy))
    return replace(front, points=non_dominated(points))


def recorded(front: Front, certificate: Certificate) -> Front:
    """The front that says in its record how it was tried, and what the best gained."""
    outcome = {
        "verified_points": certificate.solved_again,
        "verified_steps": STEPS,
        "tried_starts": certificate.tried,
        "best_improvement": float(f"{max(certificate.gained, 0.0):.2e}"),
    }
    return front.restated(settings={**front.record.settings, **outcome})


def main() -> None:
    """Verify the reference fronts of the problems that are named, or all."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("names", nargs="*", default=list(PROBLEMS))
    parser.add_argument("--record", action="store_true", help="write the outcome into the files")
    parser.add_argument("--mend", action="store_true", help="put better motions into the files")
    given = parser.parse_args()
    for name in given.names:
        problem = PROBLEMS[name]
        for one, front in zip(certified(problem), problem.fronts(), strict=True):
            words = "holds" if one.holds else "does not hold"
            tried = f"{one.solved_again} points and {one.tried} random starts"
            differs = f"{one.energy_difference:.0e} and {one.residual_difference:.0e} m"
            print(
                f"{one.front}: {words}; gained {one.gained:.1e} at most, from {tried} "
                f"({one.gained_by_dop853:.1e} by DOP853); CVODES differs by {differs}",
                flush=True,
            )
            after = mended(front, one) if given.mend else front
            if given.record or given.mend:
                (path,) = FRONTS.rglob(f"{one.front}.json")
                (recorded(after, one) if given.record else after).save(path)


if __name__ == "__main__":
    main()
