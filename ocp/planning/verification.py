"""Compare the solver's answer with the independent integrator, and correct it where they differ."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.candidate import Candidate
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.simulation.grid import default_steps
from quietarm.ocp.simulation.objective import WithPeaks
from quietarm.ocp.solvers.batch import Batch, Values, batch
from quietarm.ocp.solvers.program import Program
from quietarm.ocp.solvers.solution import RESIDUAL, STILL, STILL_SHARE, Scalarization, Solution
from quietarm.ocp.solvers.solving import Row, Solver, solve
from quietarm.ocp.task import QUANTITIES

MOST_SOLVER_STEPS = 3200
"""The solver's steps are doubled up to this many."""
_RESIDUAL_AGREEMENT = 5e-3
_AT_REST = 0.3
"""Of a limit, and of rest: by these shares may the two integrators' residuals differ."""
_ROUNDS = 12
_BELOW = 1 + 2e-8
"""A limit that is passed is tightened by this share beyond the excess: the solver's own tolerance,
else the next peak passes the limit by as little again."""
OVERRUN = 1e-3
"""Share of a limit by which a verified peak may pass it when tightening found nothing better."""


@dataclass(frozen=True)
class Care:
    """How much effort to spend on a solution that both integrators agree on."""

    agreement: float = 1e-5
    most_steps: int = MOST_SOLVER_STEPS


OF_A_PLAN = Care()
"""The solver's cheapest motion is then the independent integrator's within 1e-6, in all but one of
56 plans tried (6e-6)."""
HURRIED = Care(agreement=np.inf, most_steps=0)
"""Correct the arrival and passed limits without adding steps: for after Ctrl-C."""


class Verified(NamedTuple):
    """A solution with the figures of CVODES, and the number of steps it was found with."""

    solution: Solution
    checked: Candidate
    steps: int


def verified(
    program: Program,
    ask: Scalarization,
    best: Solution,
    solver: Solver = "sqp",
    care: Care = OF_A_PLAN,
    kept: Mapping[str, float] | None = None,
) -> Verified:
    """Verify; correct the arrival, double the steps while energies disagree, tighten passed limits.

    The solver's few steps miss the state on arrival by a little; limits hold at its nodes only, and
    the residual limit at its samples. The differences that the independent integrator finds are
    passed to the solver, which goes on from where it stopped.
    """
    kept, used = ask.limits if kept is None else kept, dict(ask.limits)
    still = max(STILL, STILL_SHARE * program.plain_residual)
    tolerated = max(_AT_REST * still, _RESIDUAL_AGREEMENT * ask.limits.get(RESIDUAL, np.inf))
    tried: list[Verified] = []

    def add(found: Solution) -> Candidate:
        tried.append(Verified(found, judge(program, found), program.steps))
        return tried[-1].checked

    simulated = add(best)
    for _ in range(_ROUNDS):
        used = tightened(used, simulated, kept)
        rough = abs(best.energy - simulated.energy) > care.agreement * simulated.energy
        missed = abs(best.residual - simulated.residual) > tolerated
        again = None
        if not rough and (missed or simulated.exceeded(kept)):
            offset = simulated.arrival - program.evaluated(best.coefficients).arrival
            asked = ask._replace(limits=used, offset=offset)
            again = _from(program, asked, best, solver)
        elif not rough:
            break
        if again is None or not again.status.solved:
            if 2 * program.steps > care.most_steps:
                break
            program = Program(program.task, program.profile, 2 * program.steps)
            again, used = _from(program, ask, best, solver), dict(ask.limits)
            if not again.status.solved:
                break
        best, simulated = again, add(again)
    cheapest = _cheapest_kept(tried, kept, still)
    remedy = "bound the coefficients or use fewer terms"
    refuse_passed(
        cheapest.checked,
        kept,
        f"the solver's steps are too coarse for this motion; {remedy}",
        still,
    )
    return cheapest


def _from(program: Program, ask: Scalarization, found: Solution, solver: Solver) -> Solution:
    """Solve again from a solution close by."""
    rows = [Row(program, ask, found.coefficients)]
    again = solve(rows, solver, warm=True).solutions[0]
    return replace(again, iterations=found.iterations + again.iterations)


def judge(program: Program, found: Solution) -> Candidate:
    """The motion of a solution, for CVODES."""
    return Candidate.of_profile(program.task, program.profile, found.coefficients)


def tightened(
    limits: Mapping[str, float], motion: WithPeaks, kept: Mapping[str, float]
) -> dict[str, float]:
    """The limits to give the solver, each less by as much as the verified motion passes it."""
    exceeded = motion.exceeded(kept)
    return {
        name: limit / (_BELOW * exceeded[name]) if name in exceeded else limit
        for name, limit in limits.items()
    }


def refuse_passed(
    motion: WithPeaks, limits: Mapping[str, float], remedy: str, still: float = 0.0
) -> None:
    """Refuse a verified motion that passes a limit although limits were tightened."""
    for name, limit in limits.items():
        if motion.peak(name) > max(limit * (1 + OVERRUN), still):
            raise SolverFailedError(
                f"the verified {name} is {motion.peak(name):.4g}, above its limit of {limit:g}: "
                + remedy
            )


def _cheapest_kept(tried: list[Verified], kept: Mapping[str, float], still: float) -> Verified:
    """The cheapest of the verified motions that keep every limit; else the last."""
    keeping = [
        one
        for one in tried
        if all(one.checked.peak(name) <= max(limit, still) for name, limit in kept.items())
    ]
    return min(keeping, key=lambda one: one.checked.energy) if keeping else tried[-1]


CHECK_EVERY = 10
"""CVODES checks one motion in so many."""
FINER_AGREEMENT = 1e-6
"""The share by which its figures may then differ."""
_FINER = 3


def finer_values(programs: Sequence[Program], coefficients: NDArray[np.float64]) -> Values:
    """Figures of one motion of each program, on three times the solver's steps or more."""
    return _values_of(_finer(programs[0]), programs, coefficients)


def finer_peaks(
    programs: Sequence[Program], coefficients: NDArray[np.float64]
) -> dict[str, NDArray[np.float64]]:
    """Peaks of every quantity of one motion of each program, at the nodes of these steps."""
    finer = _finer(programs[0], tuple(QUANTITIES))
    limited = _values_of(finer, programs, coefficients).limited
    return {name: np.abs(limited[:, part]).max(axis=1) for name, part in finer.parts}


def _finer(program: Program, quantities: tuple[str, ...] = ()) -> Batch:
    steps = max(default_steps(program.task), _FINER * program.steps)
    return batch(program.plant, program.profile, steps, quantities, energy=program.task.energy)


def _values_of(
    finer: Batch, programs: Sequence[Program], coefficients: NDArray[np.float64]
) -> Values:
    move = np.array([program.row for program in programs])
    return finer.values(coefficients, move, np.zeros((len(programs), 0)))
