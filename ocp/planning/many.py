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
from quietarm.ocp.planning.best_of_starts import best_of_starts
from quietarm.ocp.planning.certify import Certified, certify, finer_peaks
from quietarm.ocp.planning.choose_profile import SIX, choose_profile
from quietarm.ocp.planning.residual_limit import ResidualLimit
from quietarm.ocp.planning.setup import Setup
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.free_vibration import fastest_of_moves
from quietarm.ocp.solvers.choice import stand_in
from quietarm.ocp.solvers.problem import Problem, Solution, first_steps, transcribe
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp
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


@takes(tasks=[PointToPoint], profile=JointProfile, solver=Solver)
def plan_moves(
    tasks: Sequence[PointToPoint],
    profile: JointProfile | None = None,
    *,
    residual_limit: float | None = None,
    bound: float | None = None,
    starts: int = 4,
    seed: int = 0,
    neighbours: bool = True,
    solver: Solver = Sqp(),
) -> Moves:
    """Find the motions of least energy of many moves of one plant.

    Parameters
    ----------
    tasks : sequence of PointToPoint
        Moves of one plant, none of them uncertain, with the same quantities limited.
    profile, residual_limit, bound, starts, seed, solver
        As for `plan_move`.
    neighbours : bool
        Whether every eighth move is solved from the plain cycloid first, and the others from the
        nearest of these; the starts are then for moves that are not solved so. Without it every
        move is solved from all its starts. What is not solved either way is tried by IPOPT.

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
    setup = Setup(solver, bound, starts, seed)
    _check(tasks, profile)
    limit = ResidualLimit.of(tasks[0], residual_limit).size
    problems = [
        Problem.of(transcription, limit, setup.bound)
        for transcription in transcribe(tasks, profile, _steps(tasks, profile))
    ]
    plain, *random = guesses = setup.start_coefficients(profile)
    if neighbours:
        best = _from_neighbours(problems, plain, setup)
        attempts = [(solver, [plain]), (solver, random)]
    else:
        best = best_of_starts(problems, [guesses] * len(problems), solver)
        attempts = []
    if (substitute := stand_in(solver)) is not None:
        attempts.append((substitute, [plain]))
    for solves, own_starts in attempts:
        _solve_the_unsolved(problems, best, own_starts, solves)
    return _moves_of(problems, best, solver, guesses)


def _solve_the_unsolved(
    problems: Sequence[Problem], best: list[Solution], starts: Sequence[Array], solver: Solver
) -> None:
    """Solve what has no solution yet from these starts."""
    unsolved = [i for i, solution in enumerate(best) if not solution.status.solved]
    if not unsolved or not starts:
        return
    again = [problems[i] for i in unsolved]
    for i, solution in zip(unsolved, best_of_starts(again, [starts] * len(again), solver)):
        if solution.status.solved:
            best[i] = solution


def _from_neighbours(problems: Sequence[Problem], start: Array, setup: Setup) -> list[Solution]:
    """Solve a share of the moves from one start, then all of them from the nearest of these."""
    solver = setup.solver
    count = len(problems)
    pilots = np.random.default_rng(setup.seed).permutation(count)[: -(-count // _PILOTS)].tolist()
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
