"""The plan of the same task with another arrival state, and perhaps another plant."""

from __future__ import annotations

import time
from dataclasses import replace

from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.planning.plan import Plan
from quietarm.ocp.planning.plan_along import plan_along
from quietarm.ocp.planning.request import Request
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.task import PointToPoint


def plan_again(plan: Plan, task: PointToPoint, dearer: float, solver: Solver) -> Plan:
    """The plan of a task that is a little other than that of a plan, from its coefficients.

    Raises
    ------
    SolverFailedError
        When no motion within the limits is found.
    ValueError
        When it would take more energy by more than a share: than the plan, or where the plant is
        another than the same move from rest to rest.
    """
    began = time.perf_counter()
    again = _from(plan, task, solver)
    more = again.energy / plan.energy - 1
    if more > dearer and task.plant != plan.task.plant:
        # the plan's own energy is that of a model which is wrong
        at_rest = _from(plan, replace(task, final=plan.task.final), solver)
        more = again.energy / at_rest.energy - 1
    if more > dearer:
        raise ValueError(
            f"the next plan takes {100 * more:.2g} % more energy, {again.energy:.4g} J, for what "
            f"was left; allow that by --dearer {100 * more + 0.1:.2g}%"
        )
    return again.restated(settings=plan.record.settings, seconds=time.perf_counter() - began)


def _from(plan: Plan, task: PointToPoint, solver: Solver) -> Plan:
    """The plan of a task from another plan's coefficients."""
    request = Request(
        task, plan.profile, solver, plan.record.bound, starts=1, steps=plan.steps, quick=True
    ).stating(plan.residual_limit or None)
    try:
        return plan_along(request.from_guess(plan.coefficients))
    except SolverFailedError as error:
        raise SolverFailedError(
            f"no motion within the limits makes up for what was left ({error}); learn from a plan "
            "with a duration that is a little longer, or wider limits"
        ) from None
