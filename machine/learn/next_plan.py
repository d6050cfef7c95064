"""The plan of the same task with another arrival state, and perhaps another plant."""

from __future__ import annotations

import time

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
        When it would take more energy than the plan by more than a share.
    """
    began = time.perf_counter()
    request = Request(
        task, plan.profile, solver, plan.record.bound, starts=1, steps=plan.steps, quick=True
    ).stating(plan.residual_limit or None)
    try:
        again = plan_along(request.from_guess(plan.coefficients))
    except SolverFailedError as error:
        raise SolverFailedError(
            f"no motion within the limits makes up for what was left ({error}); learn from a plan "
            "with a duration that is a little longer, or wider limits"
        ) from None
    more = again.energy / plan.energy - 1
    if more > dearer:
        raise ValueError(
            f"the next plan takes {100 * more:.2g} % more energy than this one, "
            f"{again.energy:.4g} J; allow that by --dearer {100 * more + 0.1:.2g}%"
        )
    return again.restated(settings=plan.record.settings, seconds=time.perf_counter() - began)
