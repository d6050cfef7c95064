"""Hold the solver's answer against the independent integrator, and mend it where they differ."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ocp.base.errors import SolverFailedError
from ocp.program.problem import Problem
from ocp.program.solution import Solution
from ocp.program.transcription import RESIDUAL
from ocp.simulation.objective import Motion
from ocp.simulation.resimulation import resimulated

MOST_STEPS = 3200
STILL, STILL_SHARE = 1e-8, 1e-7
"""Verified residual up to which 'at rest on arrival' counts as kept: in metres, or as a share of
what the plain cycloid leaves, whichever is more."""
_RESIDUAL_AGREEMENT = 5e-3
_AT_REST = 0.3
"""Share of that which the residual at rest is brought below."""
_ROUNDS = 12
_BELOW = 1 + 2e-8
"""How far below a limit that is passed the solver is sent: by its own tolerance, else the next peak
passes the limit by as little again."""
OVERRUN = 1e-3
"""Share of a limit by which a verified peak may pass it when tightening found nothing better."""


@dataclass(frozen=True)
class Care:
    """How far to go for a solution that both integrators agree on.

    Attributes
    ----------
    agreement : float
        Share of the energy by which they may differ.
    enough_steps : int
        Steps with which a minimum counts though the solver did not settle there.
    most_steps : int
        Steps up to which they are doubled.
    """

    agreement: float = 1e-5
    enough_steps: int = 150
    most_steps: int = MOST_STEPS


OF_A_PLAN = Care()
"""The cheapest motion for the solver is then that for the independent integrator to 1e-6, in all
but one of 56 plans tried (6e-6)."""

HURRIED = Care(agreement=np.inf, enough_steps=0, most_steps=0)
"""Mend the arrival and passed limits with the steps that there are: for after Ctrl-C."""


def verified(
    problem: Problem,
    best: Solution,
    *,
    care: Care = OF_A_PLAN,
    kept: Mapping[str, float] | None = None,
) -> tuple[Solution, Motion, int]:
    """Verify; mend the arrival, double the steps while energies disagree, tighten passed limits.

    The few steps of the solver miss the state on arrival by a little, and it holds limits at its
    nodes and the residual at its samples. What the independent integrator finds of that is given
    back to the solver, which goes on from where it stopped.

    Parameters
    ----------
    problem : Problem
        What was solved.
    best : Solution
        Its solution.
    care : Care
        How far to go.
    kept : mapping of str to float, optional
        The limits that the verified figures must keep; all of them by default.

    Returns
    -------
    Solution, Motion, int
        The solution, its figures by CVODES, and the number of steps it was found with.

    Raises
    ------
    SolverFailedError
        When a limit stays passed.
    """
    program, limits = problem.program, problem.limits
    task, profile = program.task, program.profile
    motion, arrival = resimulated(task, profile, best.coefficients)
    kept, used = limits if kept is None else kept, dict(limits)
    still = max(STILL, STILL_SHARE * program.of_cycloid)
    tolerated = max(_AT_REST * still, _RESIDUAL_AGREEMENT * limits.get(RESIDUAL, np.inf))
    tried: list[tuple[Solution, Motion, int]] = []
    for _ in range(_ROUNDS):
        steps = problem.program.steps
        tried.append((best, motion, steps))
        overrun = {name: motion.peak(name) / limit for name, limit in kept.items() if limit > 0}
        passed = {name: _BELOW * ratio for name, ratio in overrun.items() if ratio > 1}
        used = {name: limit / passed.get(name, 1.0) for name, limit in used.items()}
        rough = abs(best.energy - motion.energy) > care.agreement * motion.energy
        unsettled = not best.settled and steps < care.enough_steps
        missed = abs(best.residual - motion.residual) > tolerated
        again = None
        if not rough and (missed or passed):
            again = problem.within(used).corrected(best, arrival)
        elif not (rough or unsettled):
            break
        if again is None or not again.status.solved:
            if 2 * steps > care.most_steps:
                break
            problem = problem.finer()
            again, used = problem.refined(best), dict(limits)
            if not again.status.solved:
                break
        best = again
        motion, arrival = resimulated(task, profile, best.coefficients)
    else:
        tried.append((best, motion, problem.program.steps))
    best, motion, steps = _cheapest_kept(tried, kept, still)
    for name, limit in kept.items():
        if motion.peak(name) > max(limit * (1 + OVERRUN), still):
            raise SolverFailedError(
                f"the verified {name} is {motion.peak(name):.4g}, above its limit of {limit:g}: "
                "the solver's steps are too coarse for this motion; bound the coefficients or use "
                "fewer terms"
            )
    return best, motion, steps


def _cheapest_kept(
    tried: list[tuple[Solution, Motion, int]], kept: Mapping[str, float], still: float
) -> tuple[Solution, Motion, int]:
    """The cheapest of the verified motions that keep every limit; else the last."""
    keeping = [
        one
        for one in tried
        if all(one[1].peak(name) <= max(limit, still) for name, limit in kept.items())
    ]
    return min(keeping, key=lambda one: one[1].energy) if keeping else tried[-1]
