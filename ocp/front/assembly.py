"""Put a sweep's points together to a front."""

from __future__ import annotations

import time
from collections.abc import Sequence

from quietarm.ocp.base.interrupts import note_interrupts
from quietarm.ocp.front.answer import Front, reference_corner
from quietarm.ocp.front.points import FailedPoint, FrontPoint, non_dominated
from quietarm.ocp.front.robust import held_between
from quietarm.ocp.front.sweep import Sweep


def front_of(
    sweep: Sweep,
    method: str,
    found: Sequence[FrontPoint | FailedPoint],
    points: int,
    *,
    gaps: Sequence[tuple[float, float]] = (),
    iterations: int = 0,
    complete: bool = True,
    seconds: float = 0.0,
    between: bool = True,
) -> Front:
    """Put points together to a front."""
    excess = None
    if between and complete:
        found, excess, complete = held_between(sweep, found)
    with note_interrupts():  # the points are found; the rest takes a moment
        reference = reference_corner(sweep.task)
    failures = tuple(point for point in found if isinstance(point, FailedPoint))
    settings = sweep.settings
    return Front(
        task=sweep.task,
        profile=sweep.profile,
        points=non_dominated(point for point in found if isinstance(point, FrontPoint)),
        method=method,
        settings={"bound": settings.bound, "points": points, "starts": settings.starts,
                  "steps": sweep.steps, "solver": settings.solver},
        seed=settings.seed,
        reference=reference,
        iterations=sweep.iterations + iterations,
        failed=len(failures),
        failures=failures,
        gaps=tuple(gaps),
        excess=excess,
        complete=complete,
        seconds=seconds + time.perf_counter() - sweep.began,
    )  # fmt: skip
