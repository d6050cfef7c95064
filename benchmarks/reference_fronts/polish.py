"""Polish reference fronts: finer steps, and a residual that is hardly sampled.

    python benchmarks/reference_fronts/polish.py [NAME ...]

The solver limits the residual at samples that miss up to 5e-5 of a peak. Between two of them it
ends at a corner that is not there, and its motion takes up to 2e-5 too much energy. So every point
is solved again from itself, and beside those that are better from their neighbours, until none is.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from quietarm.metaheuristics import PROBLEMS
from quietarm.metaheuristics.problems.catalogue import FRONTS
from quietarm.ocp import Front, FrontPoint, JudgedMotion, QuietarmError, non_dominated
from quietarm.ocp.limits import Limit
from quietarm.ocp.planning.best_of_starts import best_of_starts
from quietarm.ocp.planning.certify import Certified, certify
from quietarm.ocp.record import versions
from quietarm.ocp.rest import STILL
from quietarm.ocp.simulation.free_vibration import after_arrival
from quietarm.ocp.solvers.problem import Program
from quietarm.ocp.solvers.sqp import Sqp

STEPS = 500
"""Ten times those that found the fronts."""
RADIANS = 4e-3
"""Phase between samples of the residual: they miss 2e-6 of a peak."""
ROUNDS = 12
BETTER = 1e-7
"""Share of the energy by which a motion has to be better to take a point's place."""
_AGREEMENT = 1e-4
"""Share by which the energies of the solver and of CVODES may differ before steps are doubled."""


class FineProgram(Program):
    """A task whose residual is sampled finely."""

    @cached_property
    def tip_rows(self) -> list[NDArray[np.float64]]:
        """Rows of the tip as of a `Program`, at `RADIANS`."""
        return [vibration.rows_every(RADIANS) for vibration in after_arrival(self.task)]


def polished(front: Front, bound: float) -> tuple[Front, list[float]]:
    """The front with better motions where there are any, and what each place gained.

    A gain is a share of the energy that the point had, at its residual or a smaller one.
    """
    points = list(front.points)
    program = FineProgram.of(front.task, front.profile, STEPS)
    before = [point.energy for point in points]
    places, reach = list(range(len(points))), 0
    for _ in range(ROUNDS):
        found = _solved_from_neighbours(program, points, places, reach, bound)
        improved = set[int]()
        for place, motion in found.items():
            if motion.energy < points[place].energy * (1 - BETTER):
                points[place] = motion
                improved.add(place)
        if not improved:
            break
        reach = 1
        beside = {place + side for place in improved for side in (-1, 0, 1)}
        places = sorted(beside & set(range(len(points))))
    gains = [1 - point.energy / energy for point, energy in zip(points, before)]
    settings = {**front.record.settings, "polished_steps": STEPS, "residual_radians": RADIANS}
    record = replace(front.record, settings=settings, versions=versions())
    return replace(front, points=non_dominated(points), record=record), gains


def _solved_from_neighbours(
    program: Program,
    points: Sequence[FrontPoint],
    places: Sequence[int],
    reach: int,
    bound: float,
) -> dict[int, FrontPoint]:
    """The best motions, by place, that keep all limits by CVODES.

    From the points themselves, and from so many neighbours on either side.
    """
    problems = list[Program]()
    starts = list[list[NDArray[np.float64]]]()
    for place in places:
        residual = points[place].residual
        limits = (
            Limit.of_residual(residual if residual > STILL else 0.0),
            *program.task.limits,
        )
        problems.append(program.asking(limits=limits, bound=bound))
        near = points[max(place - reach, 0) : place + reach + 1]
        starts.append([np.array(point.coefficients) for point in near])
    solutions = best_of_starts(problems, starts, Sqp(), warm=True, leave=False)
    solved = [place for place in range(len(places)) if solutions[place].status.solved]
    outcomes = certify(
        [problems[place] for place in solved],
        [solutions[place] for place in solved],
        Sqp(),
        agreement=_AGREEMENT,
        most_steps=STEPS,
    )
    found = dict[int, FrontPoint]()
    for place, outcome in zip(solved, outcomes):
        if isinstance(outcome, Certified):
            point = _judged(program, outcome)
            if point is not None and _within(point, points[places[place]]):
                found[places[place]] = point
    return found


def _judged(program: Program, outcome: Certified) -> FrontPoint | None:
    """A certified motion as a point with the figures of CVODES; None where it breaks a limit."""
    task = program.task
    coefficients = program.profile.checked(outcome.solution.coefficients)
    motion = JudgedMotion.of_profile(task, program.profile, coefficients)
    try:
        figures = motion.residual, motion.energy
    except QuietarmError:
        return None
    nominal = JudgedMotion.of_profile(task.certain, program.profile, coefficients)
    if nominal.figures.exceeded(task.limits, BETTER):
        return None
    return FrontPoint(coefficients, *figures)


def _within(point: FrontPoint, known: FrontPoint) -> bool:
    """Return whether a motion's residual is that of a point, but for rounding, or smaller."""
    return point.residual <= max(known.residual * (1 + 1e-9), STILL)


def main() -> None:
    """Polish the fronts of the problems that are named, or all, and store them."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("names", nargs="*", default=list(PROBLEMS))
    for name in parser.parse_args().names:
        problem = PROBLEMS[name]
        for part, front in zip(problem.tasks(), problem.fronts(), strict=True):
            better, gains = polished(front, problem.bound)
            (path,) = FRONTS.rglob(f"{part}.json")
            better.save(path)
            more = sum(gain > 1e-5 for gain in gains)
            print(
                f"{part}: {more} of {len(gains)} points gained more than 1e-5, {max(gains):.1e} "
                f"at most; {len(better.points)} points",
                flush=True,
            )


if __name__ == "__main__":
    main()
