"""Compare the solver's answer with the independent integrator, and correct it where they differ."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ocp.base.errors import SolverFailedError
from ocp.program.problem import Problem
from ocp.program.solution import STILL, STILL_SHARE, Solution
from ocp.program.transcription import RESIDUAL
from ocp.simulation.objective import WithPeaks
from ocp.simulation.resimulation import Resimulation

MOST_SOLVER_STEPS = 3200
"""The solver's steps are doubled up to this many."""
_RESIDUAL_AGREEMENT = 5e-3
_AT_REST = 0.3
"""A residual at rest is corrected until it is below this share of that."""
_ROUNDS = 12
_BELOW = 1 + 2e-8
"""A limit that is passed is tightened by this share beyond the excess: the solver's own tolerance,
else the next peak passes the limit by as little again."""
OVERRUN = 1e-3
"""Share of a limit by which a verified peak may pass it when tightening found nothing better."""


@dataclass(frozen=True)
class Care:
    """How much effort to spend on a solution that both integrators agree on.

    Attributes
    ----------
    agreement : float
        Share of the energy by which they may differ.
    enough_steps : int
        Steps from which on a solution is accepted although the solver did not settle there.
    most_steps : int
        Steps up to which they are doubled.
    """

    agreement: float = 1e-5
    enough_steps: int = 150
    most_steps: int = MOST_SOLVER_STEPS


OF_A_PLAN = Care()
"""The solver's cheapest motion is then the independent integrator's within 1e-6, in all but one of
56 plans tried (6e-6)."""
HURRIED = Care(agreement=np.inf, enough_steps=0, most_steps=0)
"""Correct the arrival and passed limits without adding steps: for after Ctrl-C."""


def verified(
    problem: Problem,
    best: Solution,
    *,
    care: Care = OF_A_PLAN,
    kept: Mapping[str, float] | None = None,
) -> tuple[Solution, Resimulation, int]:
    """Verify; correct the arrival, double the steps while energies disagree, tighten passed limits.

    The solver's few steps miss the state on arrival by a little; limits hold at its nodes only, and
    the residual limit at its samples. The differences that the independent integrator finds are
    passed to the solver, which goes on from where it stopped.

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
    Solution, Resimulation, int
        The solution, its simulation by CVODES, and the number of steps it was found with.

    Raises
    ------
    SolverFailedError
        When a limit stays passed.
    """
    program, limits = problem.program, problem.limits
    simulated = problem.resimulated(best)
    kept, used = limits if kept is None else kept, dict(limits)
    still = max(STILL, STILL_SHARE * program.of_cycloid)
    tolerated = max(_AT_REST * still, _RESIDUAL_AGREEMENT * limits.get(RESIDUAL, np.inf))
    tried: list[tuple[Solution, Resimulation, int]] = []
    for _ in range(_ROUNDS):
        steps = problem.program.steps
        tried.append((best, simulated, steps))
        used = tightened(used, simulated, kept)
        rough = abs(best.energy - simulated.energy) > care.agreement * simulated.energy
        unsettled = not best.settled and steps < care.enough_steps
        missed = abs(best.residual - simulated.residual) > tolerated
        again = None
        if not rough and (missed or simulated.passed(kept)):
            again = problem.within(used).corrected(best, simulated.arrival)
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
        simulated = problem.resimulated(best)
    else:
        tried.append((best, simulated, problem.program.steps))
    best, simulated, steps = _cheapest_kept(tried, kept, still)
    remedy = "bound the coefficients or use fewer terms"
    refuse_passed(
        simulated, kept, f"the solver's steps are too coarse for this motion; {remedy}", still
    )
    return best, simulated, steps


def tightened(
    limits: Mapping[str, float], motion: WithPeaks, kept: Mapping[str, float]
) -> dict[str, float]:
    """The limits to give the solver, each less by as much as the verified motion passes it.

    Parameters
    ----------
    limits : mapping of str to float
        What the solver was given.
    motion : WithPeaks
        The verified figures of what it found.
    kept : mapping of str to float
        What these must keep.

    Returns
    -------
    dict of str to float
        The tighter limits.
    """
    passed = motion.passed(kept)
    return {
        name: limit / (_BELOW * passed[name]) if name in passed else limit
        for name, limit in limits.items()
    }


def refuse_passed(
    motion: WithPeaks, limits: Mapping[str, float], remedy: str, still: float = 0.0
) -> None:
    """Refuse a verified motion that passes a limit although limits were tightened.

    Parameters
    ----------
    motion : WithPeaks
        The verified figures.
    limits : mapping of str to float
        What they must keep.
    remedy : str
        What is wrong and what would help.
    still : float
        Residual up to which a motion counts as at rest [m].

    Raises
    ------
    SolverFailedError
        When a peak is more than `OVERRUN` above its limit.
    """
    for name, limit in limits.items():
        if motion.peak(name) > max(limit * (1 + OVERRUN), still):
            raise SolverFailedError(
                f"the verified {name} is {motion.peak(name):.4g}, above its limit of {limit:g}: "
                + remedy
            )


def _cheapest_kept(
    tried: list[tuple[Solution, Resimulation, int]], kept: Mapping[str, float], still: float
) -> tuple[Solution, Resimulation, int]:
    """The cheapest of the verified motions that keep every limit; else the last."""
    keeping = [
        one
        for one in tried
        if all(one[1].peak(name) <= max(limit, still) for name, limit in kept.items())
    ]
    return min(keeping, key=lambda one: one[1].energy) if keeping else tried[-1]
