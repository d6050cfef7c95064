"""Find a reference front: the gradient's sweep, random starts at every point, and a polish.

    python benchmarks/reference_fronts/make.py FOLDER [NAME ...]

The fronts of the package were made so with the sweep on 48 to 192 steps; `polish` has 500.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from polish import polished

from quietarm.metaheuristics import PROBLEMS
from quietarm.ocp import (
    Front,
    FrontPoint,
    JointProfile,
    JudgedMotion,
    PointToPoint,
    QuietarmError,
    epsilon_front,
    non_dominated,
)
from quietarm.ocp.front.points import LEVELS
from quietarm.ocp.planning.plan_along import plan_from_starts
from quietarm.ocp.planning.request import Request
from quietarm.ocp.solvers.ipopt import Ipopt
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp

POINTS = 300
"""Points of a reference front, beside those at `LEVELS`: with motions between them, the hypervolume
is that of twice as many within 1e-5."""
STARTS = 12
"""Starts of the ends of a front."""
COLD_STARTS = 3
"""Random starts of every point between: with ten terms and more, a sweep may follow a branch of
minima that another one passes below."""
LIMITED_STEPS = 192
"""Steps of the solver where the task has limits: a peak between coarser ones costs up to 3e-4."""
SEED = 1000
"""Seed of these starts: they are others than the sweep's."""
_BETTER = 1e-6
"""A motion is better that takes less energy by more than this share; its residual may be larger by
this share."""


def swept_front(task: PointToPoint, profile: JointProfile, bound: float) -> Front:
    """The front by the gradient's sweep alone, for problems that have no exact one in a file.

    On six named problems without limits its hypervolume is that of the reference front within
    1.4e-5.
    """
    front = epsilon_front(
        task, profile, bound=bound, points=POINTS, at=LEVELS, starts=STARTS,
        steps=LIMITED_STEPS if task.limits else None,
    )  # fmt: skip
    points = [point for point in front.points if _keeps_limits(front, point)]
    return replace(front, points=non_dominated(points))


def exact_front(
    task: PointToPoint,
    profile: JointProfile,
    bound: float,
    known: Sequence[FrontPoint] = (),
) -> Front:
    """The least energy at one residual after another; known motions are starts as well."""
    front = swept_front(task, profile, bound)
    points = list(front.points)
    inner = range(1, len(points) - 1)
    for i in inner:
        near = min(known, key=lambda one: abs(one.residual - points[i].residual), default=None)
        points[i] = _better(front, points[i], bound, starts=1 + COLD_STARTS, guess=near)
    # every branch of minima is followed to both sides; by IPOPT, whose barrier leads past corners
    # where the residual passes from one sample to the next, 1e-4 above the front at worst
    for i in inner:
        points[i] = _better(front, points[i], bound, Ipopt(), guess=points[i - 1])
    for i in reversed(inner):
        points[i] = _better(front, points[i], bound, Ipopt(), guess=points[i + 1])
    points = [point for point in points if _keeps_limits(front, point)]
    front, _ = polished(replace(front, points=non_dominated(points)), bound)
    return front


def _keeps_limits(front: Front, point: FrontPoint) -> bool:
    """Return whether a point keeps the limits by CVODES, without the room that a plan has."""
    if not front.task.limits:
        return True
    candidate = JudgedMotion.of_profile(front.task.certain, front.profile, point.coefficients)
    return not candidate.figures.exceeded(front.task.limits, _BETTER)


def _better(
    front: Front,
    point: FrontPoint,
    bound: float,
    solver: Solver = Sqp(),
    starts: int = 1,
    guess: FrontPoint | None = None,
) -> FrontPoint:
    """The best motion of a point's residual from some starts, or the point itself."""
    steps = front.record.settings["steps"]
    assert isinstance(steps, int)
    try:
        coefficients = None if guess is None else guess.coefficients
        asked = Request(front.task, front.profile, solver, bound, starts, SEED, steps, coefficients)
        # not `plan_move`: a front's residual is that at the samples of an uncertain plant
        request = asked.within(point.residual)
        plan, _ = plan_from_starts(request, request.guesses)
    except QuietarmError:
        return point
    found = FrontPoint(plan.coefficients, plan.residual, plan.energy)
    within = found.residual <= point.residual * (1 + _BETTER)
    return found if within and found.energy < point.energy * (1 - _BETTER) else point


def main() -> None:
    """Find the fronts of the problems that are named, or all, anew, into a folder."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*", default=list(PROBLEMS))
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    for name in given.names:
        problem = PROBLEMS[name]
        for (part, task), known in zip(problem.tasks().items(), problem.fronts(), strict=True):
            front = exact_front(task, problem.profile, problem.bound, known.points)
            front.save(given.folder / f"{part}.json")
            print(f"{part}: {len(front.points)} points", flush=True)
        if problem.peak_limits:
            surface = epsilon_front(
                problem.task,
                problem.profile,
                bound=problem.bound,
                points=600,
                at=LEVELS,
                objectives=problem.objectives,
                starts=12,
                steps=192,
            )
            surface.save(given.folder / f"{name}.json")
            print(f"{name}: {len(surface.points)} points", flush=True)


if __name__ == "__main__":
    main()
