"""Give the solver's solutions the figures of the independent integrator."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence

import numpy as np

from ocp.base.errors import SolverFailedError
from ocp.base.interrupts import note_interrupts
from ocp.front.points import FailedPoint, FrontPoint
from ocp.front.sweep import Sweep
from ocp.plan.verification import OF_A_PLAN, Care, verified
from ocp.program.solution import Solution
from ocp.program.transcription import RESIDUAL
from ocp.simulation.resimulation import Resimulation

RESIDUAL_LIMIT = "residual_limit"
_TIME_AFTER_CTRL_C = 0.6
"""How long [s] points are still checked after Ctrl-C."""
SAMPLING = 1e-4
"""Share by which the residual between samples, or by CVODES, may pass that of the solver."""


def care_of(sweep: Sweep) -> Care:
    """How exact a point between the ends must be: less than a plan; its steps are doubled once."""
    return Care(agreement=1e-4, enough_steps=2 * sweep.steps, most_steps=2 * sweep.steps)


def front_point(sweep: Sweep, found: Solution, simulated: Resimulation) -> FrontPoint:
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
    """Give a solution the figures of the independent integrator.

    Parameters
    ----------
    sweep : Sweep
        What was asked.
    found : Solution
        A solution of the program.
    asked : mapping of str to float
        What was asked for.
    most_residual : float
        Largest residual [m] that the point may have; it may be a little off that asked for.
    free : bool
        Whether the residual is free: an end of the front, which more steps may move.

    Returns
    -------
    FrontPoint or FailedPoint
        The point, or why it cannot be trusted.
    """
    kept = {**sweep.task.limits, RESIDUAL: most_residual}
    try:
        limit = np.inf if free else found.residual
        care = OF_A_PLAN if free else care_of(sweep)
        point, simulated, _ = verified(sweep.problem(limit), found, care=care, kept=kept)
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
    """Check many solutions; after Ctrl-C as many as there is time for, spread evenly.

    Parameters
    ----------
    sweep : Sweep
        What was asked.
    found : sequence of (Solution, mapping of str to float)
        As for `checked`.
    interrupted : bool
        Whether Ctrl-C came before.

    Returns
    -------
    list of FrontPoint or FailedPoint
        In the order given.
    bool
        Whether these are all.
    """
    done, until = dict[int, FrontPoint | FailedPoint](), np.inf
    with note_interrupts() as came:
        evenly = sorted(range(len(found)), key=lambda i: f"{i:032b}"[::-1])  # ever finer
        for i in evenly:
            if interrupted or came:
                until = min(until, time.monotonic() + _TIME_AFTER_CTRL_C)
            if time.monotonic() > until:
                break
            done[i] = checked(sweep, *found[i])
    return [done[i] for i in sorted(done)], len(done) == len(found)
