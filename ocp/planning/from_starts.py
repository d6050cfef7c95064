"""A plan from given starts: solved, then certified."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.planning.best_of_starts import (
    first_steps,
    solve_from_starts,
    start_coefficients,
)
from quietarm.ocp.planning.certify import certify
from quietarm.ocp.planning.plan import Plan
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import Provenance, SolveSettings, Verification
from quietarm.ocp.solvers.choice import solver_of
from quietarm.ocp.solvers.problem import Problem, Scalarization
from quietarm.ocp.solvers.transcription import RESIDUAL, Transcription
from quietarm.ocp.task import PointToPoint


def plan_from_starts(
    task: PointToPoint,
    profile: JointProfile,
    settings: SolveSettings,
    starts: Sequence[NDArray[np.float64]] | None = None,
) -> tuple[Plan, list[NDArray[np.float64]]]:
    """The plan from starts, by default those of the settings, whose limit holds in all scenarios.

    And the coefficients of all that were solved, cheapest first. Errors are those of
    `solve_from_starts` and `certify`.
    """
    began, solver = time.perf_counter(), solver_of(settings.solver, settings.print_level)
    starts = start_coefficients(profile, settings) if starts is None else starts
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
