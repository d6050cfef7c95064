"""`plan_move`: least energy within a residual limit, from several starts, certified."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.ocp.errors import InfeasibleTaskError
from quietarm.ocp.interrupts import one_at_a_time
from quietarm.ocp.planning.best_of_starts import (
    first_steps,
    solve_from_starts,
    start_coefficients,
)
from quietarm.ocp.planning.certify import OVERRUN, certify
from quietarm.ocp.planning.feasibility import UNITS
from quietarm.ocp.planning.plan import Plan, evaluate_coefficients
from quietarm.ocp.planning.robust import limit_of, robust_plan
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.profiles.polynomial import CycloidPolynomial
from quietarm.ocp.record import Provenance, SolveSettings, Verification
from quietarm.ocp.solvers.choice import SolverName, solver_of
from quietarm.ocp.solvers.problem import Problem, Scalarization
from quietarm.ocp.solvers.transcription import RESIDUAL, STILL, Transcription
from quietarm.ocp.task import PointToPoint


def only_motion(
    task: PointToPoint, profile: JointProfile, residual_limit: float | None = None
) -> Plan:
    """The figures of the only motion that a profile has, within the task's limits."""
    asked = 0.0 if residual_limit is None else residual_limit
    plan = evaluate_coefficients(
        task, [], profile=profile, method="evaluated", settings={"residual_limit": asked}
    )
    residual = {} if residual_limit is None else {"residual": max(residual_limit, STILL)}
    limits = {**residual, **task.limits}
    broken = [
        f"its {name} reaches {plan.motion.peak(name):.4g} {UNITS[name]}, above {limits[name]:g}"
        for name in plan.motion.exceeded(limits, OVERRUN)
    ]
    if broken:
        raise InfeasibleTaskError(
            f"the {profile.label} has one motion for this move, and {'; '.join(broken)}: "
            "widen what is broken, or give a longer duration or another profile"
        )
    return plan


@one_at_a_time
def plan_move(
    task: PointToPoint,
    profile: JointProfile | None = None,
    *,
    residual_limit: float | None = None,
    bound: float | None = None,
    starts: int = 4,
    seed: int = 0,
    steps: int | None = None,
    guess: ArrayLike | None = None,
    solver: SolverName = "sqp",
) -> Plan:
    """Find the motion of least energy whose residual vibration is within a limit.

    Parameters
    ----------
    task : PointToPoint
        The move and its limits.
    profile : JointProfile, optional
        How the joint moves; by default the cycloid of a polynomial of six terms. The only motion
        of a profile without coefficients, such as `shaped_cycloid`, is evaluated, not optimised.
    residual_limit : float, optional
        Largest F1 [m]; 0 asks for rest on arrival, or for the task's `final` state, where there
        are coefficients to choose. By default 0; of an uncertain task, which hardly ever arrives
        at rest whatever its errors, 5 % of how far the plain cycloid of the same duration bends the
        assumed plant's tip on its way.
    bound : float, optional
        Largest absolute coefficient; none by default.
    starts : int
        How many starts: the guess or the plain cycloid first, then random ones; all at once. Once
        half of them, and more than one, have ended at the least energy found, the others are left.
        Gaussians and networks take four random starts for each: they have many minima.
    seed : int
        Seed of the random starts.
    steps : int, optional
        Steps of the solver's discretisation, chosen from the task by default; they are doubled
        while the verification disagrees.
    guess : array_like, shape (profile.size,), optional
        Coefficients to start from first, such as a metaheuristic's, to be improved.
    solver : {"sqp", "ipopt"}
        Sequential quadratic programs, all starts at once, or IPOPT, one after another. Where the
        first solves no start, IPOPT takes over.

    Returns
    -------
    Plan
        The coefficients, with the figures of an independent integrator. Of an uncertain plant the
        residual limit holds between the samples as well, as its ``worst`` states; its task has the
        samples that this took.

    Raises
    ------
    ValueError
        When an argument is out of range.
    InfeasibleTaskError
        When no motion of this profile meets the task; the text says what would be feasible.
    SolverFailedError
        When no start ended at an optimum for another reason.
    """
    profile = CycloidPolynomial() if profile is None else profile
    if guess is not None:
        guess = profile.checked(guess)
    least = 0.0 if residual_limit is None else residual_limit
    settings = SolveSettings(least, bound, starts, seed, steps, guess, solver)
    if profile.size == 0:
        return only_motion(task, profile, residual_limit)
    settings = replace(settings, residual_limit=limit_of(task, residual_limit))
    if task.uncertainty is not None:
        return robust_plan(task, profile, settings, plan_from)
    return plan_at_samples(task, profile, settings)


def plan_at_samples(task: PointToPoint, profile: JointProfile, settings: SolveSettings) -> Plan:
    """The plan of a task whose residual limit holds at the plant's samples, if it has any."""
    return plan_from(task, profile, settings, start_coefficients(profile, settings))[0]


def plan_from(
    task: PointToPoint,
    profile: JointProfile,
    settings: SolveSettings,
    starts: Sequence[NDArray[np.float64]],
) -> tuple[Plan, list[NDArray[np.float64]]]:
    """The plan from given starts, and the coefficients of all that were solved, cheapest first."""
    began, solver = time.perf_counter(), solver_of(settings.solver)
    transcription = Transcription(task, profile, first_steps(task, profile, settings))
    limits = {RESIDUAL: settings.residual_limit, **task.limits}
    problem = Problem(transcription, Scalarization(limits, settings.bound))
    best, solved = solve_from_starts(problem, starts, solver)
    certified = certify(problem, best, solver)
    solution, motion = certified.solution, certified.checked.motion
    plan = Plan(
        task=task,
        profile=profile,
        coefficients=profile.checked(solution.coefficients),
        motion=motion,
        status=solution.status,
        verification=Verification.between(
            certified.steps, solution.energy, solution.residual, motion
        ),
        provenance=Provenance(settings.solver, settings, seconds=time.perf_counter() - began),
    )
    return plan, [one.coefficients for one in solved]
