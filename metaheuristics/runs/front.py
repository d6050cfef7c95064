"""The front of a search, at its end and on the way."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics.objective.population import PopulationObjective
from quietarm.metaheuristics.runs.loop import Loop
from quietarm.metaheuristics.runs.progress import SearchProgress
from quietarm.metaheuristics.runs.settings import search_versions
from quietarm.ocp import (
    Front,
    FrontPoint,
    JointProfile,
    PointToPoint,
    non_dominated,
    reference_corner,
)
from quietarm.ocp.simulation.rollout import default_steps

WITHIN = 1e-6
"""Share by which a peak of the finer rollout may exceed its limit: the search kept it exactly."""


_HAND_OVER_PAUSE = (1.0, 5.0)
_HAND_OVER_SHARE = 0.05
"""Shortest and longest time [s] between fronts that are handed over, and the share of it that they
take between these."""


class HandingOver:
    """Hands over the front so far: after the first generation, and every second or so."""

    def __init__(self, loop: Loop, found: Callable[[Front], None]) -> None:
        self._loop, self._found, self._due = loop, found, 0.0

    def after_generation(self, progress: SearchProgress) -> None:
        """Hand over the front if the last one is old enough."""
        began = time.perf_counter()
        if began >= self._due:
            self._found(replace(front_of(self._loop), complete=False))
            ended = time.perf_counter()
            shortest, longest = _HAND_OVER_PAUSE
            pause = (ended - began) / _HAND_OVER_SHARE  # the first takes long: casadi builds
            self._due = ended + min(max(pause, shortest), longest)


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
