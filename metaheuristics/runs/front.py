"""The front of a search."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np

from metaheuristics.algorithms.provenance import flat
from metaheuristics.objective.population import PopulationObjective
from metaheuristics.runs.loop import Loop
from metaheuristics.runs.settings import search_versions
from ocp import Front, FrontPoint, non_dominated
from ocp.simulation.rollout import default_steps

WITHIN = 1e-6
"""Share by which a peak of the finer rollout may exceed its limit: the search kept it exactly."""


def front_of(loop: Loop) -> Front:
    """What a search has found so far, with figures of a finer rollout.

    Parameters
    ----------
    loop : Loop
        The search.

    Returns
    -------
    Front
        Its points, settings and history.
    """
    spec, threads = loop.spec, loop.problem.objective.threads
    return Front(
        task=spec.task,
        profile=spec.profile,
        points=_points(loop, threads),
        method=spec.method,
        settings={**asdict(spec.settings), **dict(flat(spec.algorithm))},
        seed=spec.seed,
        reference=loop.reference,
        evaluations=loop.evaluations,
        failed=loop.problem.failed,
        infeasible=loop.problem.infeasible,
        history=tuple(loop.history),
        versions=search_versions(),
        seconds=loop.seconds,
    )


def _points(loop: Loop, threads: int) -> tuple[FrontPoint, ...]:
    task, profile = loop.spec.task, loop.spec.profile
    X, _ = loop.found()
    fine = PopulationObjective(task, profile, steps=default_steps(task), threads=threads)
    values = fine(X)
    kept = np.flatnonzero((values.violations <= WITHIN).all(axis=1)).tolist()
    return non_dominated(
        FrontPoint(tuple(X[i].tolist()), float(values.residual[i]), float(values.energy[i]))
        for i in kept
    )
