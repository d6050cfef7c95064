"""Which profile a task takes where nobody names one: the one rule for plans, fronts and searches.

Without limits six terms are the paper's, and more only make the starts harder. Within the limits of
a drive they cost up to twice the least energy, or find no motion. Two terms more often save
nothing where four save a quarter, so the number is not looked for step by step: it follows from
the number of modes. `benchmarks/terms.py` measures how far from the floor that ends.

A plan that finds no motion of so many terms tries more, and then a spline that can cruise, before
it refuses the task.
"""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from quietarm.ocp.errors import InfeasibleTaskError, SolverFailedError
from quietarm.ocp.planning.best_of_starts import best_of_starts
from quietarm.ocp.planning.least_time import fitting_spline, least_time
from quietarm.ocp.planning.plan import Plan
from quietarm.ocp.planning.plan_along import plan_along
from quietarm.ocp.planning.residual_limit import ResidualLimit
from quietarm.ocp.planning.setup import Setup
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import Setting
from quietarm.ocp.solvers.problem import Problem, Solution, Transcription
from quietarm.ocp.task import PointToPoint

SIX = CycloidPolynomial()
_OF_ONE_MODE, _OF_SEVERAL_MODES = 18, 24
"""Terms within limits. Where one mode swings for more than seven periods 24 come 2 % nearer to the
floor, but the solver may take minutes."""
CHOSEN, OF_SIX = "chosen_terms", "energy_of_six_terms"
"""What a plan's record says of them."""
_LONGER = (0.01, 0.05)
"""Shares by which a duration that is offered is longer than the least time."""
_LEAST_TIME_TO = 2e-3


def choose_profile(task: PointToPoint) -> CycloidPolynomial:
    """The cycloid of a polynomial of six terms without limits; within them of 18, or 24.

    18 where the plant has one mode, 24 where it has several.
    """
    return more_terms(task) if task.limits else SIX


def more_terms(task: PointToPoint) -> CycloidPolynomial:
    """The number of terms that a plant takes within limits."""
    return CycloidPolynomial(_OF_ONE_MODE if task.plant.modes == 1 else _OF_SEVERAL_MODES)


def plan_on_chosen_profile(task: PointToPoint, setup: Setup, limit: ResidualLimit) -> Plan:
    """The plan along the profile that a task takes, or along a richer one where it finds none.

    InfeasibleTaskError, where no profile does, has the duration that would do.
    """
    best = _plan_quickly(task, setup, limit)
    if best is not None and (best.residual_limit or 0.0) <= limit.size:
        return best
    # no motion was found, or the default residual limit was out of reach
    on_spline = _plan_on_spline(task, setup, limit)
    if on_spline is not None and (best is None or _left(on_spline) < _left(best)):
        return on_spline
    if best is not None:
        return best
    profile = more_terms(task)
    try:
        return _stating_terms(plan_along(task, profile, replace(setup, starts=1), limit))
    except InfeasibleTaskError as error:
        raise _with_a_duration(error, task, setup, limit, profile.amount) from None


def _plan_quickly(task: PointToPoint, setup: Setup, limit: ResidualLimit) -> Plan | None:
    """Six terms without limits, and more where these find no motion; within limits more."""
    if task.limits:
        return _plan_with_more_terms(task, setup, limit)
    plan = _try(task, SIX, setup, limit, quick=False)
    if plan is None and (plan := _try(task, more_terms(task), setup, limit)) is not None:
        return _stating_terms(plan)
    return plan


def _try(
    task: PointToPoint,
    profile: JointProfile,
    setup: Setup,
    limit: ResidualLimit,
    *,
    quick: bool = True,
) -> Plan | None:
    """The plan along a profile; None where no motion was found."""
    try:
        return plan_along(task, profile, setup, limit, quick=quick)
    except SolverFailedError:
        return None


def _plan_on_spline(task: PointToPoint, setup: Setup, limit: ResidualLimit) -> Plan | None:
    """The plan on a spline that keeps the limits; None where none was found."""
    if not task.limits or setup.bound is not None:
        return None
    fitted = fitting_spline(task, limit.size, None)
    if fitted is None:
        return None
    spline, coefficients = fitted
    from_fit = replace(setup, starts=1, guess=tuple(coefficients.tolist()))
    return _try(task, spline, from_fit, limit)


def _left(plan: Plan) -> float:
    """What a plan leaves in the worst case [m]."""
    return plan.residual if plan.worst is None else plan.worst.residual


def _plan_with_more_terms(task: PointToPoint, setup: Setup, limit: ResidualLimit) -> Plan | None:
    """The plan of the number of terms for limits; its record states what six would cost.

    One start does, the plain cycloid; another is what six terms give, where it leads nowhere, or
    where they are cheaper. None where no motion was found.
    """
    began = time.perf_counter()
    profile = more_terms(task)
    six = _solve_with_six(task, setup, 0.0 if limit.adapts else limit.size)
    from_cycloid = replace(setup, starts=1)
    best = _try(task, profile, from_cycloid, limit)
    cheaper = best is None or (task.uncertainty is None and six.energy < best.energy)
    if six.status.solved and cheaper:
        padded = np.pad(six.coefficients, (0, profile.size - SIX.size))
        from_six = _try(task, profile, replace(from_cycloid, guess=tuple(padded.tolist())), limit)
        if best is None or (from_six is not None and from_six.energy < best.energy):
            best = from_six
    if best is None:
        return None
    stated: dict[str, Setting] = {"starts": setup.starts}
    if six.status.solved and task.uncertainty is None:
        stated[OF_SIX] = six.energy
    return _stating_terms(
        best, stated, six.iterations + best.record.iterations, time.perf_counter() - began
    )


def _stating_terms(
    plan: Plan,
    stated: dict[str, Setting] | None = None,
    iterations: int | None = None,
    seconds: float | None = None,
) -> Plan:
    """The plan whose record says how many terms were chosen."""
    settings = {**plan.record.settings, CHOSEN: plan.profile.size, **(stated or {})}
    settings.pop("guess", None)
    return plan.restated(
        settings=settings,
        iterations=plan.record.iterations if iterations is None else iterations,
        seconds=plan.record.seconds if seconds is None else seconds,
    )


def _solve_with_six(task: PointToPoint, setup: Setup, residual_limit: float) -> Solution:
    """What six terms give for the nominal plant, by the solver's own steps."""
    steps = Transcription.of(task.certain, SIX, setup.steps)
    problem = Problem.of(steps, residual_limit, setup.bound)
    (six,) = best_of_starts([problem], [setup.start_coefficients(SIX)], setup.solver)
    return six


def _with_a_duration(
    error: InfeasibleTaskError, task: PointToPoint, setup: Setup, limit: ResidualLimit, amount: str
) -> InfeasibleTaskError:
    """The error with the duration that would do, where a longer one does."""
    if not task.limits or setup.bound is not None:
        return InfeasibleTaskError(error.what, "")
    duration = _feasible_duration(task, setup, limit)
    remedy = f"a duration of {duration:g} s will also do" if duration else ""
    what = error.what.replace(f"motion of {amount}", f"motion of {amount} or on a spline", 1)
    return InfeasibleTaskError(what, remedy)


def _feasible_duration(task: PointToPoint, setup: Setup, limit: ResidualLimit) -> float | None:
    """A duration [s] for which there is a plan, hardly longer than the least one; None if none."""
    try:
        least = least_time(task, limit.size, None, _LEAST_TIME_TO)
    except ValueError:
        return None
    from_least = replace(setup, starts=1, guess=tuple(least.coefficients.tolist()))
    for longer in _LONGER:
        duration = float(f"{(1 + longer) * least.duration:.3g}")
        lasting = replace(task, duration=duration)
        if _try(lasting, least.profile, from_least, limit) is not None:
            return duration
    return None
