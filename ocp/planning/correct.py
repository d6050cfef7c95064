"""Correct a plan until it arrives at rest by the whole equations of a plant that is a reduction.

A robot's modes are linear. Where what it carries bends far, as along a path with sharp turns, it
leaves more than they say. What is missed is found by the whole equations, and the plan made again
to arrive in the state that makes up for it: a fixed point, which is as near after some rounds as
the modes are nearly right.
"""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from quietarm.ocp.checks import positive, takes
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.planning.plan import Plan
from quietarm.ocp.planning.plan_along import plan_along
from quietarm.ocp.planning.request import Request
from quietarm.ocp.simulation.full_dynamics import FullFigures
from quietarm.ocp.solvers.choice import STAND_IN, only_part, without_part
from quietarm.ocp.solvers.solver import NAME, Solver
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.task import ModalState, PointToPoint

_ROUNDS = 8
"""Most corrections: each leaves a tenth of what the one before left, where modes are 1 % off."""


@takes(plan=Plan, solver=Solver)
def correct_in_full(plan: Plan, *, left: float = 1e-5, solver: Solver = Sqp()) -> Plan:
    """Correct a plan until hardly anything is left after it by the whole equations.

    Parameters
    ----------
    plan : Plan
        Of a plant whose own equations are a reduction, as a robot's on its path, without errors.
    left : float
        Largest displacement of the tip after arrival [m], by `plan.candidate.in_full`.
    solver
        As for `plan_move`.

    Returns
    -------
    Plan
        The same where it leaves no more. Else one of a task whose `final` state makes up for what
        the plant's own equations miss: its `residual` is measured from that.

    Raises
    ------
    ValueError
        When the plant has no other equations than its own, or errors.
    SolverFailedError
        When no motion within the limits is found, or corrections do not settle.
    """
    left = positive("left", left, "m")
    refuse_correction(plan.task)
    began = time.perf_counter()
    before = np.inf
    for _ in range(_ROUNDS):
        figures = _figures(plan)
        if figures.residual <= left:
            return plan
        if figures.residual > before:
            break
        before = figures.residual
        corrected = _again(plan, figures, solver)
        plan = corrected.restated(seconds=time.perf_counter() - began)
    if _figures(plan).residual <= left:
        return plan
    raise SolverFailedError(
        f"by the whole equations {1e3 * before:.3g} mm remain, and corrections do not settle: what "
        "the robot carries bends too far for its modes; give a longer duration, a path that turns "
        "less sharply, or more modes"
    )


def refuse_correction(task: PointToPoint) -> None:
    """Refuse a task whose plant has nothing to be corrected by, or has errors."""
    if task.plant.in_full is None:
        raise ValueError(
            f"{task.plant.name} has no other equations than those by which it is planned; only "
            "plans of robots are corrected by the whole equations"
        )
    if task.uncertainty is not None:
        raise ValueError(
            "the task has errors of its plant, each of which would need another correction by the "
            "whole equations; leave the errors or the correction out"
        )


def _figures(plan: Plan) -> FullFigures:
    figures = plan.candidate.in_full
    assert figures is not None  # the plant has whole equations
    return figures


def _again(plan: Plan, figures: FullFigures, solver: Solver) -> Plan:
    """The plan of an arrival that makes up for what the last one missed."""
    task = plan.task
    equations = task.plant.in_full
    assert equations is not None  # it has figures
    state = equations.modal_state(task.target, figures.arrival)
    missed = state - np.asarray(plan.candidate.arrival)[0]
    amplitudes, rates = np.split(-missed, 2)
    final = ModalState(tuple(amplitudes), tuple(rates))
    corrected = replace(task, final=final)
    request = Request(
        corrected, plan.profile, solver, plan.record.bound, starts=1, steps=plan.steps, quick=True
    ).stating(plan.residual_limit or None)
    try:
        again = plan_along(request.from_guess(plan.coefficients))
    except SolverFailedError as error:
        raise SolverFailedError(
            f"by the whole equations {1e3 * figures.residual:.3g} mm remain, and no motion within "
            f"the limits corrects that ({error}); give a longer duration or wider limits"
        ) from None
    settings = dict(plan.record.settings)
    for part in (NAME, STAND_IN):  # of what corrected it, not of what found it
        settings = without_part(part, settings) | only_part(part, again.record.settings)
    return again.restated(settings=settings)
