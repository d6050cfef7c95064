"""The front of a search, at its end and on the way."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics.objective.population import PopulationObjective
from quietarm.metaheuristics.runs.loop import Loop
from quietarm.metaheuristics.runs.progress import Report, SearchProgress, now_and_then
from quietarm.metaheuristics.runs.settings import search_versions
from quietarm.ocp import (
    Front,
    FrontPoint,
    JointProfile,
    PointToPoint,
    non_dominated,
    reference_corner,
)
from quietarm.ocp.simulation.grid import default_steps

WITHIN = 1e-6
"""Share by which a peak of the finer rollout may exceed its limit: the search kept it exactly."""


def handing_over(loop: Loop, found: Callable[[Front], None]) -> Report:
    """Hand over the front so far: after the first generation, and every second or so."""

    def hand_over(progress: SearchProgress) -> None:
        found(replace(front_of(loop), complete=False))

    return now_and_then(hand_over, shortest=1.0, longest=5.0, begin=0.0)


def front_of(loop: Loop) -> Front:
    """What a search has found so far, with figures of a finer rollout."""
    spec, problem = loop.spec, loop.problem
    return front_through(
        loop.found()[0], spec.task, spec.profile, problem.objective.threads,
        method=spec.method, settings={**asdict(spec.settings), **spec.algorithm}, seed=spec.seed,
        seconds=loop.seconds, evaluations=loop.evaluations, failed=problem.failed,
        infeasible=problem.infeasible, history=tuple(loop.history),
    )  # fmt: skip


def front_through(
    X: NDArray[np.float64], task: PointToPoint, profile: JointProfile, threads: int = 1, **rest: Any
) -> Front:
    """The front of a search's motions, with figures of a finer rollout than that of the search."""
    fine = PopulationObjective(task, profile, steps=default_steps(task), threads=threads)
    values = fine(X)
    kept = np.flatnonzero((values.violations <= WITHIN).all(axis=1)).tolist()
    points = non_dominated(
        FrontPoint(tuple(X[i].tolist()), float(values.residual[i]), float(values.energy[i]))
        for i in kept
    )
    return Front(
        task, profile, points, reference=reference_corner(task), versions=search_versions(), **rest
    )
