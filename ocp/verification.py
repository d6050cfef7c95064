"""Hold the solver's answer against the independent integrator, and mend it where they differ."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ocp.errors import SolverFailedError
from ocp.objective import Motion
from ocp.profile import JointProfile
from ocp.program import Solution, TaskProgram
from ocp.resimulation import resimulate
from ocp.transcription import RESIDUAL

MOST_STEPS = 3200
STILL = 1e-8
"""Verified residual [m] up to which 'at rest on arrival' counts as kept."""
_ENERGY_AGREEMENT = _RESIDUAL_AGREEMENT = 1e-3
_ROUNDS = 6
_OVERRUN = 1e-3
"""Share of a limit by which a verified peak may pass it when tightening found nothing better."""


def verified(
    program: TaskProgram,
    profile: JointProfile,
    best: Solution,
    limits: Mapping[str, float],
    bound: float | None,
    most_steps: int = MOST_STEPS,
) -> tuple[Solution, Motion, int]:
    """Verify; double the steps while the integrators disagree, tighten limits that are passed.

    The solver holds limits at its nodes and the residual at its samples; between them a quantity
    may pass its limit by a little, which the verification sees.

    Parameters
    ----------
    program : TaskProgram
        The program that was solved.
    profile : JointProfile
        How the joint moves.
    best : Solution
        Its solution.
    limits : mapping of str to float
        Largest residual [m] and peaks [SI units].
    bound : float or None
        Largest absolute coefficient.
    most_steps : int
        Steps up to which they are doubled.

    Returns
    -------
    Solution, Motion, int
        The solution, its figures by CVODES, and the number of steps it was found with.

    Raises
    ------
    SolverFailedError
        When a limit stays passed.
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
        if disagree and 2 * program.steps <= most_steps:
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
        best = replace(again, iterations=best.iterations + again.iterations)
        motion = resimulate(program.task, profile, best.coefficients)
    for name, limit in limits.items():
        if motion.peak(name) > max(limit * (1 + _OVERRUN), STILL):
            raise SolverFailedError(
                f"the verified {name} is {motion.peak(name):.4g}, above its limit of {limit:g}: "
                "the solver's steps are too coarse for this motion; bound the coefficients or use "
                "fewer terms"
            )
    return best, motion, program.steps
