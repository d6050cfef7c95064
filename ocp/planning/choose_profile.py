"""The rule by which a task takes a profile if nobody names one: for plans, fronts and searches.

Without limits six terms are the paper's, and more only make the starts harder. Within the limits of
a drive they cost up to twice the least energy, or find no motion. Two terms more often save
nothing where four save a quarter, so the number is not looked for step by step: it follows from
the number of modes. `benchmarks/terms.py` measures how far from the floor that ends.

A plan that finds no motion of so many terms tries more, and then a spline that can cruise, before
it refuses the task.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from quietarm.ocp.errors import InfeasibleTaskError, SolverFailedError
from quietarm.ocp.planning.best_of_starts import best_of_starts, shortened
from quietarm.ocp.planning.least_time import SplineFit, fit_spline, least_time, shaped_duration
from quietarm.ocp.planning.plan import Plan
from quietarm.ocp.planning.plan_along import (
    excess_of,
    plan_along,
    refuse_far_beyond,
    worst_residual,
)
from quietarm.ocp.planning.remedies import has_a_plan, stated_limit
from quietarm.ocp.planning.request import Request
from quietarm.ocp.planning.too_short import arrives_at_rest, refuse_to_hold, refuse_too_short
from quietarm.ocp.planning.worst_scenarios import with_even_scenarios
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import Setting
from quietarm.ocp.simulation.mesh import default_steps
from quietarm.ocp.solvers.problem import Program, Solution
from quietarm.ocp.task import PointToPoint

SIX = CycloidPolynomial()
_HOPELESS = 0.5
"""Share by which limits have to be wider for the terms of a task, above which a spline, which may
cruise, is not tried: it needs some hundredths less."""
_OF_ONE_MODE = 18
_OF_SEVERAL_MODES = 24
"""Terms within limits. Where one mode swings for more than seven periods 24 come 2 % nearer to the
floor, but the solver may take minutes."""
CHOSEN = "chosen_terms"
OF_SIX = "energy_of_six_terms"
"""What a plan's record says of them."""


def choose_profile(task: PointToPoint) -> CycloidPolynomial:
    """The cycloid of a polynomial of six terms without limits; within them of 18, or 24.

    18 where the plant has one mode, 24 where it has several.
    """
    return more_terms(task) if task.limits else SIX


def more_terms(task: PointToPoint) -> CycloidPolynomial:
    """The number of terms that a plant takes within limits, or an uncertain one without them."""
    # without limits 24 terms are rough: a robust plan of them takes twice as long, and saves less
    few = task.plant.modes == 1 or (task.uncertainty is not None and not task.limits)
    return CycloidPolynomial(_OF_ONE_MODE if few else _OF_SEVERAL_MODES)


def plan_on_chosen_profile(request: Request) -> Plan:
    """The plan along the profile that a task takes, or along a richer one where it finds none.

    InfeasibleTaskError, where no profile does, has the duration that would do.
    """
    refuse_to_hold(request.task)
    try:
        refuse_too_short(request.task, arrives_at_rest(request.task, request.residual_limit))
        return _plan_on_first_that_will_do(request)
    except InfeasibleTaskError as error:
        raise _with_a_duration(error, request) from None


def _plan_on_first_that_will_do(request: Request) -> Plan:
    """The plan along the profile of a request, or on a spline, or of more terms."""
    if _is_hopeless(request):
        raise InfeasibleTaskError(f"found no motion with {_stated(request)}")
    plan = _plan_within_limits(request) if request.task.limits else _plan_without_limits(request)
    if plan is not None and (plan.residual_limit or 0.0) <= request.residual_limit:
        return plan
    # no motion was found, or the default residual limit was out of reach
    fit = _fit(request)
    on_spline = None if fit is None or not fit.keeps else _try_fit(request, fit)
    if on_spline is not None and (plan is None or worst_residual(on_spline) < worst_residual(plan)):
        return on_spline
    if plan is not None:
        return plan
    # to look for what would do with other limits takes longer, and a duration is soon found
    if _may_take_longer(request):
        motion = more_terms(request.task).amount
        raise InfeasibleTaskError(f"found no motion of {motion} with {_stated(request)}")
    # where the residual limit adapts, the stand-in was tried with these terms before
    last = replace(request, has_stand_in=not request.adapts)
    return _state_terms(plan_along(last.along(more_terms(request.task))))


def _may_take_longer(request: Request) -> bool:
    """Return whether a plan that has to keep a residual limit may be had in a longer duration.

    Within a box of the coefficients that need not help: other limits are looked for.
    """
    return request.is_held and request.bound is None


def _fit(request: Request) -> SplineFit | None:
    """The motion on a spline that comes nearest to the limits; None where there is none."""
    if not request.task.limits or request.bound is not None:
        return None
    try:
        return fit_spline(request.task, request.residual_limit, None)
    except ValueError:  # no motion is so slow that it keeps the limits
        return None


def _try_fit(request: Request, fit: SplineFit) -> Plan | None:
    """The plan on a spline from its motion; None where no motion was found."""
    return _try_along(request, fit.profile, fit.excess.coefficients)


def _is_hopeless(request: Request) -> bool:
    """Return whether limits are so far out of reach that no other profile will keep them either."""
    if not _may_take_longer(request):
        return False
    excess = excess_of(request.along(request.profile))
    return excess is not None and excess.is_beyond(_HOPELESS)


def _stated(request: Request) -> str:
    """The limits that no motion comes near to, in words."""
    limits = Program.of(request.task, SIX).within(request.residual_limit).limits
    return ", ".join(stated_limit(request.task, limit) for limit in limits)


def _plan_without_limits(request: Request) -> Plan | None:
    """The plan of six terms, or of more where these find no motion."""
    if request.is_held:
        plan = _try(request)
    else:
        with suppress(SolverFailedError):
            return plan_along(request)
        plan = None
    if plan is not None:
        return plan
    more = more_terms(request.task)
    plan = _try(replace(request, profile=more))
    return None if plan is None else _state_terms(plan)


def _plan_within_limits(request: Request) -> Plan | None:
    """The plan of the number of terms for limits; its record states what six would cost.

    One start does, the plain cycloid; another is what six terms give, where it leads nowhere, or
    where they are cheaper. None where no motion was found.
    """
    began = time.perf_counter()
    profile = request.profile
    uncertain = request.task.uncertainty is not None
    if request.is_held:
        try:
            refuse_far_beyond(request.along(profile))
        except InfeasibleTaskError:
            return None
    best = _try_along(request, profile) if uncertain else None
    if best is not None:  # the energy of six terms, of the nominal plant, is no measure for it
        return _state_terms(best, {"starts": request.starts}).restated(
            seconds=time.perf_counter() - began
        )
    six = _solve_with_six(request)
    if not uncertain:
        best = _try_along(request, profile)
    if six.status.solved and (best is None or six.energy < best.energy):
        padded = np.pad(six.coefficients, (0, profile.size - SIX.size))
        from_six = _try_along(request, profile, padded)
        if best is None or (from_six is not None and from_six.energy < best.energy):
            best = from_six
    if best is None:
        return None
    settings: dict[str, Setting] = {"starts": request.starts}
    if six.status.solved and not uncertain:
        settings[OF_SIX] = six.energy
    return _state_terms(best, settings).restated(
        iterations=six.iterations + best.record.iterations,
        seconds=time.perf_counter() - began,
    )


def _solve_with_six(request: Request) -> Solution:
    """Solve for the nominal plant with six terms, by the solver's own steps."""
    size = 0.0 if request.adapts else request.residual_limit
    nominal = request.on(request.task.certain).within(size)
    with_six = replace(nominal, profile=SIX)
    (six,) = best_of_starts([with_six.problem()], [with_six.guesses], request.solver)
    return six


def _try_along(
    request: Request, profile: JointProfile, guess: ArrayLike | None = None
) -> Plan | None:
    """The plan along another profile from one start; None where no motion was found."""
    return _try(request.along(profile, guess))


def _try(request: Request) -> Plan | None:
    """The plan that is asked for; None where no motion was found, and not why."""
    try:
        return plan_along(replace(request, quick=True))
    except SolverFailedError:
        return None


def _state_terms(plan: Plan, settings: Mapping[str, Setting] | None = None) -> Plan:
    """The plan whose record says how many terms were chosen, and these settings."""
    stated = {**plan.record.settings, CHOSEN: plan.profile.size, **(settings or {})}
    stated.pop("guess", None)
    return plan.restated(settings=stated)


def _with_a_duration(error: InfeasibleTaskError, request: Request) -> InfeasibleTaskError:
    """The error with the duration that would do, where a longer one does."""
    motion = f"motion of {more_terms(request.task).amount}"
    what = error.what.replace(motion, f"{motion} or on a spline", 1)
    if request.bound is not None:
        return InfeasibleTaskError(error.what)
    if request.task.limits:
        return InfeasibleTaskError(what, _remedy(request))
    if _may_take_longer(request):
        return InfeasibleTaskError(error.what, _longer(request))
    return InfeasibleTaskError(error.what)


def _longer(request: Request, growth: float = 1.5, middle: int = 3, most: int = 5) -> str:
    """Say which of some longer durations is the first that will do without limits; or nothing.

    Shorter ones are tried while they will do, else longer ones: what will not do takes longest.
    """
    durations = [_rounded(request.task.duration * growth**power) for power in range(1, most + 1)]
    *shorter, _ = durations[:middle]
    if not _will_do(request, durations[middle - 1]):
        longer = (duration for duration in durations[middle:] if _will_do(request, duration))
        first = next(longer, None)
        return "" if first is None else _say_duration(request, first)
    least = durations[middle - 1]
    for duration in reversed(shorter):
        if not _will_do(request, duration):
            break
        least = duration
    return _say_duration(request, least)


def _say_duration(request: Request, duration: float) -> str:
    """Say that a duration [s] will do; if it fails between scenarios, what else may."""
    if _keeps_the_range(request, duration):
        return f"a duration of {duration:g} s will do"
    return _beyond(request, duration)


def _keeps_the_range(request: Request, duration: float) -> bool:
    """Return whether a plan that lasts so long [s] is found and keeps all of the errors' range.

    Scenarios are some errors of the range: between them the worst case may be many times as large.
    """
    if request.task.uncertainty is None:
        return True
    lasting = request.on(replace(request.task, duration=duration))
    try:
        return _plan_on_first_that_will_do(lasting).worst is not None
    except SolverFailedError:
        return False


def _beyond(request: Request, failed: float = 0.0) -> str:
    """Say what may do where nothing is known to: wider limits, or more than failed [s]."""
    task = request.task
    longer = f"a duration above {max(failed, task.duration):g} s"
    if task.uncertainty is None:
        return f"wider limits or {longer} may do"
    size = "residual limit" if task.band is None else "band"
    errors = ", ".join(f"{name} +-{100 * share:.3g} %" for name, share in task.ranges.items())
    return f"a wider {size}, smaller errors than {errors} or {longer} may do"


def _will_do(request: Request, duration: float) -> bool:
    """Return whether there is a plan without limits in a duration [s]."""
    task = request.task
    longer = with_even_scenarios(replace(task, duration=duration))
    lasting = request.on(longer).along(more_terms(task))
    return has_a_plan(lasting.problem(), lasting.profile.plain, shortened(request.solver))


def _remedy(request: Request) -> str:
    """The duration that will do, or may, in words; what has to be wider where none was found."""
    task = request.task
    most_steps = 400
    try:
        shaped = replace(task, duration=shaped_duration(task))
        # to compile a spline of so many steps takes longer than to ask again
        if task.plant.steps_at_once > 1 or default_steps(shaped, least=1) > most_steps:
            return _may_do(request, shaped.duration)
    except ValueError:  # nothing limits the joint, or no task takes so long
        return ""
    even = with_even_scenarios(task)
    try:
        least = least_time(
            even,
            request.residual_limit,
            None,
            1e-2,
            rounds=0,
            most_steps=2 * most_steps,
            roughly=True,
        )
    except ValueError:
        return _may_do(request, shaped.duration)
    duration = _with_room(least.duration)
    if duration <= task.duration:
        return _beyond(request)
    lasting = request.on(replace(even, duration=duration)).along(least.profile)
    if not has_a_plan(lasting.problem(), least.coefficients, request.solver):
        return _may_do(request, max(shaped.duration, least.duration))
    return _say_duration(request, duration)


def _may_do(request: Request, least: float) -> str:
    """Say that a duration [s] may do, with some room; or what else may."""
    duration = _with_room(least)
    if duration > request.task.duration:
        return f"a duration of {duration:g} s may do"
    return _beyond(request)


def _with_room(duration: float, margin: float = 0.05) -> float:
    """Return a duration [s] that is longer by a share, so that a plan has room."""
    return _rounded((1 + margin) * duration)


def _rounded(duration: float) -> float:
    """Return a duration [s] in three digits, as it is said."""
    return float(f"{duration:.3g}")
