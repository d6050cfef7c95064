"""The plan of the same task with another arrival state, and perhaps another plant."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import NamedTuple

from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.planning.plan import Plan
from quietarm.ocp.planning.plan_along import plan_along
from quietarm.ocp.planning.request import Request
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.task import ModalState, PointToPoint


class NextPlan(NamedTuple):
    """The plan of the next move.

    With the share of the way to its arrival state that it makes, and the energy of the same move on
    the plant as it is [J]: that of the last plan, where the plant did not change.
    """

    plan: Plan
    share: float
    energy_before: float


def plan_again(plan: Plan, task: PointToPoint, dearer: float, solver: Solver) -> NextPlan:
    """The plan of a task that is a little other than that of a plan, from its coefficients.

    The share of the way is less than 1 where all of it would take more energy by more than a share,
    than the plan, or where the plant is another than the same move to the plan's arrival.

    Raises
    ------
    SolverFailedError
        When no motion within the limits is found.
    ValueError
        When a part of the way takes too much energy, too.
    """
    began = time.perf_counter()
    again, share = _from(plan, task, solver), 1.0
    before = plan
    if again.energy > (1 + dearer) * plan.energy and task.plant != plan.task.plant:
        # the plan's own energy is that of a model which is wrong
        before = _from(plan, replace(task, final=plan.task.final), solver)
    more = again.energy / before.energy - 1
    if more > dearer:
        share = 0.9 * dearer / more
        softer = replace(task, final=_between(plan.task.final, task.final, share))
        again = _from(plan, softer, solver)
    if again.energy > (1 + dearer) * before.energy:
        raise ValueError(
            f"the next plan takes {100 * more:.2g} % more energy for what was left; allow that by "
            f"--dearer {100 * more + 0.1:.2g}%"
        )
    restated = again.restated(settings=plan.record.settings, seconds=time.perf_counter() - began)
    return NextPlan(restated, share, before.energy)


def _between(first: ModalState | None, last: ModalState | None, share: float) -> ModalState | None:
    """A state between two."""
    if last is None:
        return None
    before = first or ModalState((0.0,) * len(last.W), (0.0,) * len(last.W))
    mixed = [
        tuple((1 - share) * a + share * b for a, b in zip(*both))
        for both in ((before.W, last.W), (before.dW, last.dW))
    ]
    return ModalState(*mixed)


def _from(plan: Plan, task: PointToPoint, solver: Solver) -> Plan:
    """The plan of a task from another plan's coefficients."""
    request = Request(
        task, plan.profile, solver, plan.record.bound, starts=1, steps=plan.steps, quick=True
    )
    # the arrival state makes up for what the machine leaves: it may vibrate beyond the task's band
    limit = plan.residual_limit or task.band_limit
    request = request.within(limit) if limit else request.stating(None)
    try:
        return plan_along(request.from_guess(plan.coefficients))
    except SolverFailedError as error:
        raise SolverFailedError(
            f"no motion within the limits makes up for what was left ({error}); learn from a plan "
            "with a duration that is a per cent longer, or wider limits"
        ) from None
