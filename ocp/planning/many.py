"""Plans of many moves at once, a row each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.candidate import Candidate
from quietarm.ocp.checks import takes
from quietarm.ocp.errors import SolverFailedError, SolveStatus
from quietarm.ocp.limits import QUANTITIES
from quietarm.ocp.planning.best_of_starts import (
    SolverName,
    best_of_starts,
    solver_of,
    start_coefficients,
)
from quietarm.ocp.planning.certify import Certified, certify, finer_peaks
from quietarm.ocp.planning.choose_profile import SIX, choose_profile
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import SolveSettings
from quietarm.ocp.simulation.free_vibration import fastest_of_moves
from quietarm.ocp.solvers.ipopt import Ipopt
from quietarm.ocp.solvers.problem import Problem, Solution, Solver, first_steps, transcribe
from quietarm.ocp.task import PointToPoint

Array = NDArray[np.float64]
_PILOTS, _SAME_MOVE = 8, 1e-9
"""One move in so many is solved first; moves that differ by no more than this share are one."""


@dataclass(frozen=True, eq=False)
class Moves:
    """Plans of many moves.

    Attributes
    ----------
    tasks, profile
        The moves, and how the joint moves.
    coefficients : ndarray, shape (moves, profile.size)
        Coefficients; NaN where there is no plan.
    energy, residual : ndarray, shape (moves,)
        F2 [J] and F1 [m]; NaN where there is no plan.
    peaks : dict of str to ndarray, shape (moves,)
        Largest absolute values on the way by quantity [SI units]; NaN where there is no plan.
    status, reasons, iterations
        How each ended, the same in the solver's words, and after how many iterations.
    shadow_prices : tuple of mapping of str to float
        Decrease of each least energy per unit of a widened limit [J by the limit's unit]; of the
        residual also if rest on arrival is required. Empty where there is no plan.
    by_cvodes : ndarray of bool, shape (moves,)
        Which values are by CVODES; the others are by finer steps, which CVODES confirmed.
    """

    tasks: tuple[PointToPoint, ...]
    profile: JointProfile
    coefficients: Array
    energy: Array
    residual: Array
    peaks: dict[str, Array]
    status: tuple[SolveStatus, ...]
    reasons: tuple[str, ...]
    iterations: NDArray[np.intp]
    shadow_prices: tuple[Mapping[str, float], ...]
    by_cvodes: NDArray[np.bool_]


@takes(tasks=[PointToPoint], profile=JointProfile)
def plan_moves(
    tasks: Sequence[PointToPoint],
    profile: JointProfile | None = None,
    *,
    residual_limit: float = 0.0,
    bound: float | None = None,
    starts: int = 1,
    seed: int = 0,
    solver: SolverName = "sqp",
) -> Moves:
    """Find the motions of least energy of many moves of one plant.

    Parameters
    ----------
    tasks : sequence of PointToPoint
        Moves of one plant, none of them uncertain, with the same quantities limited.
    profile, residual_limit, bound, starts, seed, solver
        As for `plan_move`. With one start, the default, every eighth move starts from the plain
        cycloid and the others from the nearest of these. A move that is not solved is tried from
        the plain cycloid, from three random starts, then by IPOPT.

    Returns
    -------
    Moves
        The plans. Moves at rest and without limits are verified together, with finer steps in one
        call, and by CVODES at one in ten and wherever the two differ; all others by CVODES. A move
        without a verified motion has a status that says so, and no values.

    Raises
    ------
    ValueError
        When there is no task, plants, energies or limits differ, or an argument is out of range.
    """
    if profile is None:
        profile = choose_profile(tasks[0]) if tasks else SIX
    settings = SolveSettings(residual_limit, bound, starts, seed, solver=solver)
    _check(tasks, profile)
    problems = [
        Problem.of(one, residual_limit, bound)
        for one in transcribe(tasks, profile, _steps(tasks, profile))
    ]
    chosen, first = solver_of(settings), start_coefficients(profile, settings)
    random = start_coefficients(profile, replace(settings, starts=4))[1:]
    attempts: list[tuple[Solver, list[Array]]]
    attempts = [(chosen, first), (chosen, random), (Ipopt(), first[:1])]
    if starts == 1:
        best = _from_neighbours(problems, first[0], chosen, seed)
    else:
        best = best_of_starts(problems, [first] * len(problems), chosen)
        attempts = attempts[1:]
    for by, guesses in attempts:
        unsolved = [i for i, one in enumerate(best) if not one.status.solved]
        if not unsolved or not guesses:
            continue
        own = [problems[i] for i in unsolved]
        found = best_of_starts(own, [guesses] * len(own), by)
        for i, one in zip(unsolved, found):
            if one.status.solved:
                best[i] = one
    return _moves_of(problems, best, chosen, [*first[:1], *random])


def _from_neighbours(
    problems: Sequence[Problem], start: Array, solver: Solver, seed: int
) -> list[Solution]:
    """Solve a share of the moves from one start, then all of them from the nearest of these."""
    count = len(problems)
    pilots = np.random.default_rng(seed).permutation(count)[: -(-count // _PILOTS)].tolist()
    found = solver.solve([problems[i] for i in pilots], [start] * len(pilots))
    solved = [k for k, one in enumerate(found) if one.status.solved]
    if not solved:
        return solver.solve(problems, [start] * count)
    moves = np.array([problem.transcription.task.row for problem in problems])
    moves /= np.ptp(moves, axis=0) + _SAME_MOVE
    known = moves[[pilots[k] for k in solved]]
    nearest = [int(np.argmin(np.abs(known - move).sum(axis=1))) for move in moves]
    starts = [found[solved[k]].coefficients for k in nearest]
    return solver.solve(problems, starts, warm=True)


def _steps(tasks: Sequence[PointToPoint], profile: JointProfile) -> int:
    """Steps that do for all: those of the move that takes the most periods."""
    starts, targets, durations = np.array([task.move for task in tasks]).T
    radians = durations * fastest_of_moves(tasks[0].plant, starts, targets)
    return first_steps(tasks[int(np.argmax(radians))], profile)


def _certify_from_another_start(
    problem: Problem, starts: Sequence[Array], solver: Solver
) -> Certified | None:
    """The first solution that CVODES confirms, of a move whose own it does not; None if none."""
    for start in starts:
        (solution,) = solver.solve([problem], [start])
        if not solution.status.solved:
            continue
        (outcome,) = certify([problem], [solution], solver)
        if isinstance(outcome, Certified):
            return outcome
    return None


def _moves_of(
    problems: Sequence[Problem],
    found: Sequence[Solution],
    solver: Solver,
    starts: Sequence[Array],
) -> Moves:
    """The solutions certified, as arrays; without figures where there is none.

    Those that are not confirmed are looked for again from other starts.
    """
    count, profile = len(found), problems[0].transcription.profile
    solved = [i for i, one in enumerate(found) if one.status.solved]
    outcomes = certify([problems[i] for i in solved], [found[i] for i in solved], solver)
    outcomes = [
        _certify_from_another_start(problems[i], starts, solver) or outcome
        if isinstance(outcome, SolverFailedError)
        else outcome
        for i, outcome in zip(solved, outcomes)
    ]
    ended, figures, of_moves = list(found), np.full((count, 2), np.nan), np.zeros(count, dtype=bool)
    coefficients = np.full((count, profile.size), np.nan)
    peaks = {name: np.full(count, np.nan) for name in QUANTITIES}
    finer = list[int]()
    for i, outcome in zip(solved, outcomes):
        if isinstance(outcome, SolverFailedError):
            ended[i] = replace(
                found[i], status=SolveStatus.NOT_CERTIFIED, reason=str(outcome), shadow_prices={}
            )
            continue
        ended[i], checked = outcome.solution, outcome.checked
        coefficients[i] = ended[i].coefficients
        figures[i] = checked.energy, checked.residual
        if isinstance(checked, Candidate):
            of_moves[i] = True
            for name, values in peaks.items():
                values[i] = checked.motion.peak(name)
        else:
            of_moves[i] = checked.by_cvodes
            finer.append(i)
    if finer:
        transcriptions = [problems[i].transcription for i in finer]
        for name, values in finer_peaks(transcriptions, coefficients[finer]).items():
            peaks[name][finer] = values
    return Moves(
        tasks=tuple(problem.transcription.task for problem in problems),
        profile=profile,
        coefficients=coefficients,
        energy=figures[:, 0],
        residual=figures[:, 1],
        peaks=peaks,
        status=tuple(one.status for one in ended),
        reasons=tuple(one.reason for one in ended),
        iterations=np.array([one.iterations for one in ended]),
        shadow_prices=tuple(one.shadow_prices if one.status.solved else {} for one in ended),
        by_cvodes=of_moves,
    )


def _check(tasks: Sequence[PointToPoint], profile: JointProfile) -> None:
    if not tasks:
        raise ValueError("no moves are given; give one task or more")
    for i, task in enumerate(tasks, start=1):
        if task.uncertainty is not None:
            raise ValueError(f"the plant of move {i} is uncertain; plan such moves by plan_move")
        mine, first = (
            (one.plant, one.energy, {limit.quantity for limit in one.limits})
            for one in (task, tasks[0])
        )
        if mine != first:
            raise ValueError(
                f"move {i} has another plant or energy, or other limits, than move 1; plan them "
                "apart"
            )
    profile.refuse_no_choice()
