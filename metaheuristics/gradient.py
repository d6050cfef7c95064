"""The gradient as a method among others: fronts, random starts, and a search that is polished."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from quietarm.metaheuristics.archive import search_versions
from quietarm.ocp import Front, JointProfile, Mark, PointToPoint, epsilon_front, weighted_front
from quietarm.ocp.checks import has_no, whole
from quietarm.ocp.cost import COST, Cost
from quietarm.ocp.front.curve import RESIDUAL_LIMIT, Curve
from quietarm.ocp.front.points import LEVELS
from quietarm.ocp.front.polish import polish_front
from quietarm.ocp.planning.best_of_starts import SOLVERS, SolverName
from quietarm.ocp.record import SolveSettings


def multistart_front(
    task: PointToPoint,
    profile: JointProfile,
    *,
    bound: float,
    seed: int = 0,
    solver: SolverName = "sqp",
    starts: int = 100,
) -> Front:
    """Solve from random starts, one for each of as many residual limits, drawn at random.

    The first has no limit; the others are between zero and the residual of the first.
    """
    starts = whole("starts", starts, 2)
    began = time.perf_counter()
    settings = SolveSettings(bound=bound, starts=1, seed=seed, solver=solver)
    curve, random = Curve.begin(task, profile, settings), np.random.default_rng(seed)
    begins = random.uniform(*profile.box(bound), (starts, profile.size))
    (cheapest,) = curve.solver.solve([curve.problem()], [begins[0]])
    limits = random.uniform(0.0, cheapest.residual, starts - 1)
    found = curve.solver.solve([curve.problem(float(one)) for one in limits], list(begins[1:]))
    solved = [
        (one, {RESIDUAL_LIMIT: one.residual}) for one in [cheapest, *found] if one.status.solved
    ]
    return curve.to_front("multistart", curve.certify(solved), starts, time.perf_counter() - began)


_FRONTS: Mapping[str, tuple[Callable[..., Front], str]] = {
    "epsilon": (partial(epsilon_front, at=LEVELS), "points"),
    "weighted": (weighted_front, "points"),
    "multistart": (multistart_front, "starts"),
}
"""By name, and what each may be set to."""
GRADIENT = tuple(f"{name}{'' if s == 'sqp' else ':' + s}" for name in _FRONTS for s in SOLVERS)
"""Names of the methods of the gradient; without a solver it is the own SQP."""


def gradient_front(
    task: PointToPoint,
    profile: JointProfile,
    method: str,
    *,
    bound: float,
    seed: int,
    settings: Mapping[str, Any],
) -> Front:
    """The front of a method of `GRADIENT`, with its cost as its only mark."""
    name, _, solver = method.partition(":")
    find, own = _FRONTS[name]
    for one in settings:
        if one != own:
            raise ValueError(has_no(method, "setting", one, [own]))
    before, began = COST.copy(), time.thread_time()
    front = find(task, profile, bound=bound, seed=seed, solver=solver or "sqp", **settings)
    return _with_cost(front.restated(method=method), before, began)


def polished(front: Front) -> Front:
    """The front of a search, each point improved at its own residual; one mark more."""
    before, began = COST.copy(), time.thread_time()
    method = f"{front.record.method}+polish"
    if not front.points:
        return front.restated(method=method)
    better = polish_front(front).front
    return _with_cost(better.restated(method=method), before, began, front.record.seconds)


def _with_cost(front: Front, before: Cost, began: float, earlier: float = 0.0) -> Front:
    """The front with a mark of what its gradient cost, on top of its last one."""
    spent, seconds = COST.since(before), time.thread_time() - began
    last = front.history[-1] if front.history else Mark(0)
    mark = Mark(
        evaluations=last.evaluations + spent.candidates,
        seconds=last.seconds + max(seconds - spent.checks - spent.builds, 0.0),
        gradients=last.gradients + spent.gradients,
        hessians=last.hessians + spent.hessians,
    )
    return replace(front, history=(*front.history, mark)).restated(
        evaluations=mark.evaluations, versions=search_versions(), seconds=seconds + earlier
    )
