"""Give the solver's solutions the figures of the independent integrator."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence

import numpy as np
from quietarm.ocp.candidate import Candidate
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.front.points import FailedPoint, FrontPoint
from quietarm.ocp.front.sweep import Sweep
from quietarm.ocp.interrupts import note_interrupts
from quietarm.ocp.planning.verification import (
    CHECK_EVERY,
    FINER_AGREEMENT,
    OF_A_PLAN,
    Care,
    finer_values,
    verified,
)
from quietarm.ocp.simulation.free_vibration import after_arrival
from quietarm.ocp.solvers.solution import RESIDUAL, STILL, Solution

RESIDUAL_LIMIT = "residual_limit"
_TIME_AFTER_CTRL_C = 0.6
"""How long [s] points are still checked after Ctrl-C."""
SAMPLING = 1e-4
"""Share by which the residual between samples, or by CVODES, may pass that of the solver."""


def care_of(sweep: Sweep) -> Care:
    """How exact a point between the ends must be: less than a plan; its steps are doubled once."""
    return Care(agreement=1e-4, most_steps=2 * sweep.steps)


def front_point(sweep: Sweep, found: Solution, simulated: Candidate) -> FrontPoint:
    """A solution's coefficients with the figures of the independent integrator."""
    coefficients = sweep.profile.checked(found.coefficients)
    return FrontPoint(coefficients, simulated.residual, simulated.energy)


def checked(
    sweep: Sweep,
    found: Solution,
    asked: Mapping[str, float],
    most_residual: float = np.inf,
    free: bool = False,
) -> FrontPoint | FailedPoint:
    """Give a solution the figures of the independent integrator."""
    kept = {**sweep.task.limits, RESIDUAL: most_residual}
    try:
        limit = np.inf if free else found.residual
        care = OF_A_PLAN if free else care_of(sweep)
        solver = sweep.settings.solver
        point, simulated, _ = verified(sweep.program, sweep.ask(limit), found, solver, care, kept)
    except SolverFailedError as error:
        return FailedPoint(asked, str(error))
    sweep.iterations += point.iterations - found.iterations  # more steps, or tighter limits
    return front_point(sweep, point, simulated)


def all_checked(
    sweep: Sweep,
    found: Sequence[tuple[Solution, Mapping[str, float]]],
    *,
    interrupted: bool = False,
) -> tuple[list[FrontPoint | FailedPoint], bool]:
    """Check many solutions; after Ctrl-C as many as there is time for, spread evenly."""
    done, until = dict[int, FrontPoint | FailedPoint](), np.inf
    with note_interrupts() as came:
        fine = _by_finer_rule(sweep, [one for one, _ in found])
        evenly = sorted(range(len(found)), key=lambda i: f"{i:032b}"[::-1])  # ever finer
        for i in evenly:
            if i in fine:
                done[i] = fine[i]
                continue
            if interrupted or came:
                until = min(until, time.monotonic() + _TIME_AFTER_CTRL_C)
            if time.monotonic() > until:
                break
            done[i] = checked(sweep, *found[i])
    return [done[i] for i in sorted(done)], len(done) == len(found)


def _by_finer_rule(sweep: Sweep, found: Sequence[Solution]) -> dict[int, FrontPoint]:
    """Points with the figures of many more steps, all in a call, where CVODES confirms every tenth.

    None where it does not, where the solver's own figures differ, or where limits are set, which
    also have to hold between the nodes.
    """
    task, profile = sweep.task, sweep.profile
    if len(found) < CHECK_EVERY or task.limits or task.uncertainty is not None:
        return {}
    table = np.array([one.coefficients for one in found])
    values = finer_values([sweep.program] * len(table), table)
    points = dict[int, FrontPoint]()
    for i, (one, energy) in enumerate(zip(found, values.energy.tolist(), strict=True)):
        if abs(one.energy - energy) <= care_of(sweep).agreement * energy:
            residual = float(after_arrival(task)[0].peak(task.missed(values.arrival[i])))
            points[i] = FrontPoint(profile.checked(one.coefficients), residual, energy)
    for i in list(points)[::CHECK_EVERY]:
        exact, point = Candidate.of_profile(task, profile, points[i].coefficients), points[i]
        differs = [
            abs(exact.energy - point.energy) > FINER_AGREEMENT * exact.energy,
            abs(exact.residual - point.residual) > FINER_AGREEMENT * exact.residual + STILL,
        ]
        if any(differs):
            return {}
    return points
