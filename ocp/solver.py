"""IPOPT: the plan of least energy."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import asdict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ocp.errors import SolverFailedError
from ocp.feasibility import explain, least_peaks
from ocp.objective import Motion
from ocp.plan import Plan, Provenance, SolveSettings, Verification
from ocp.profile import CycloidPolynomial, JointProfile
from ocp.program import Solution, TaskProgram
from ocp.resimulation import resimulate
from ocp.rollout import default_steps
from ocp.task import PointToPoint
from ocp.transcription import RESIDUAL

LEAST_STEPS = 80
MOST_STEPS = 3200
UNBOUNDED_SPREAD = 0.2
"""Random starts lie within this of the plain cycloid where the coefficients have no bound."""
STILL = 1e-8
"""Verified residual [m] up to which 'at rest on arrival' counts as kept."""
_ENERGY_AGREEMENT = _RESIDUAL_AGREEMENT = 1e-3
_ROUNDS = 6
_OVERRUN = 1e-3
"""Share of a limit by which a verified peak may pass it when tightening found nothing better."""


def plan_move(
    task: PointToPoint,
    profile: JointProfile | None = None,
    *,
    residual_limit: float = 0.0,
    bound: float | None = None,
    starts: int = 4,
    seed: int = 0,
    steps: int | None = None,
    guess: ArrayLike | None = None,
) -> Plan:
    """Find the motion of least energy whose residual vibration is within a limit.

    Parameters
    ----------
    task : PointToPoint
        The move and its limits.
    profile : JointProfile, optional
        How the joint moves; by default the cycloid of a polynomial of six terms.
    residual_limit : float
        Largest F1 [m]; 0 asks for rest on arrival.
    bound : float, optional
        Largest absolute coefficient; none by default.
    starts : int
        How many starts: the guess or the plain cycloid first, then random ones.
    seed : int
        Seed of the random starts.
    steps : int, optional
        Steps of the solver's discretisation, chosen from the task by default; they are doubled
        while the verification disagrees.
    guess : array_like, shape (profile.size,), optional
        Coefficients to start from first, such as a metaheuristic's, to be improved.

    Returns
    -------
    Plan
        The coefficients, with the figures of an independent integrator.

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
    settings = SolveSettings(residual_limit, bound, starts, seed, steps)
    if profile.size == 0:
        raise ValueError("a profile of 0 terms has nothing to choose; give 1 term or more")
    began = time.perf_counter()
    program = TaskProgram(
        task,
        profile,
        settings.steps or default_steps(task, least=LEAST_STEPS),
        with_residual=residual_limit > 0,
    )
    guesses, asked = start_coefficients(profile.size, settings), asdict(settings)
    if guess is not None:
        guesses[0] = np.array(profile.checked(guess))
        asked["guess"] = ", ".join(repr(value) for value in profile.checked(guess))
    limits = {RESIDUAL: residual_limit, **task.limits}
    solutions = [program.solve(guess, limits, bound) for guess in guesses]
    solved = [solution for solution in solutions if solution.status.solved]
    if not solved:
        least = least_peaks(program, profile, limits, bound, guesses[:2])
        rescues = [found.coefficients for name, found in least.items()
                   if found.peaks[name] <= limits[name]]  # fmt: skip
        solutions += [program.solve(guess, limits, bound) for guess in rescues]
        solved = [solution for solution in solutions if solution.status.solved]
        if not solved:
            raise explain(profile, limits, bound, solutions, least)
    best = min(solved, key=lambda solution: solution.energy)
    best, motion, steps_used = _verified(program, profile, best, limits, bound)
    return Plan(
        task=task,
        profile=profile,
        coefficients=profile.checked(best.coefficients),
        motion=motion,
        status=best.status,
        verification=Verification.between(
            steps_used, best.energy, best.peaks.get(RESIDUAL, 0.0), motion
        ),
        provenance=Provenance("ipopt", asked, seconds=time.perf_counter() - began),
    )


def start_coefficients(size: int, settings: SolveSettings) -> list[NDArray[np.float64]]:
    """Vectors of coefficients to start from: zeros, then random ones from the seed."""
    random = np.random.default_rng(settings.seed)
    spread = UNBOUNDED_SPREAD if settings.bound is None else settings.bound
    others = [random.uniform(-spread, spread, size) for _ in range(settings.starts - 1)]
    return [np.zeros(size), *others]


def _verified(
    program: TaskProgram,
    profile: JointProfile,
    best: Solution,
    limits: Mapping[str, float],
    bound: float | None,
) -> tuple[Solution, Motion, int]:
    """Verify; double the steps while the integrators disagree, tighten limits that are passed.

    The solver holds limits at its nodes and the residual at its samples; between them a quantity
    may pass its limit by a little, which the verification sees.
    """
    motion = resimulate(program.task, profile, best.coefficients)
    used = dict(limits)
    for _ in range(_ROUNDS):
        overrun = {name: motion.peak(name) / limit for name, limit in limits.items() if limit > 0}
        residual_gap = abs(best.peaks.get(RESIDUAL, 0.0) - motion.residual)
        disagree = (
            abs(best.energy - motion.energy) > _ENERGY_AGREEMENT * motion.energy
            or residual_gap > STILL + _RESIDUAL_AGREEMENT * limits[RESIDUAL]
        )
        guess: NDArray[np.float64] | Solution = best
        if disagree and 2 * program.steps <= MOST_STEPS:
            guess = best.coefficients
            program = TaskProgram(
                program.task, profile, 2 * program.steps, with_residual=limits[RESIDUAL] > 0
            )
        elif any(ratio > 1 for ratio in overrun.values()):
            used = {name: limit / max(overrun.get(name, 1.0), 1.0) for name, limit in used.items()}
        else:
            break
        again = program.solve(guess, used, bound)
        if not again.status.solved:
            break
        best, motion = again, resimulate(program.task, profile, again.coefficients)
    for name, limit in limits.items():
        if motion.peak(name) > max(limit * (1 + _OVERRUN), STILL):
            raise SolverFailedError(
                f"the verified {name} is {motion.peak(name):.4g}, above its limit of {limit:g}: "
                "the solver's steps are too coarse for this motion; bound the coefficients or use "
                "fewer terms"
            )
    return best, motion, program.steps
