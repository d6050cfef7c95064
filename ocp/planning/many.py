"""Plans of many moves at once, a row each."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from quietarm.models import Plant
from quietarm.ocp.checks import takes
from quietarm.ocp.energy import Energy
from quietarm.ocp.errors import InfeasibleTaskError, SolverFailedError, SolveStatus
from quietarm.ocp.limits import QUANTITIES, Quantity
from quietarm.ocp.planning.best_of_starts import best_of_starts, briefly, is_beyond
from quietarm.ocp.planning.certify import Certified, certify, finer_peaks
from quietarm.ocp.planning.choose_profile import SIX, choose_profile
from quietarm.ocp.planning.request import Request
from quietarm.ocp.planning.too_short import arrives_at_rest, refuse_too_short
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import Setting
from quietarm.ocp.simulation.free_vibration import fastest_of_moves
from quietarm.ocp.solvers.choice import stand_in
from quietarm.ocp.solvers.problem import Program, Solution, first_steps, programs_of
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.task import PointToPoint

Array = NDArray[np.float64]


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
        Energy [J] and residual [m]; NaN where there is no plan.
    peaks : dict of str to ndarray, shape (moves,)
        Largest absolute values on the way by quantity [SI units]; NaN where there is no plan.
    status, reasons, iterations
        How each ended, the same in the solver's words, and after how many iterations.
    shadow_prices : tuple of mapping of str to float
        Decrease of each least energy per unit of a widened limit [J by the limit's unit]; of the
        residual also if rest on arrival is required. Empty where there is no plan.
    by_cvodes : ndarray of bool, shape (moves,)
        Which values are by CVODES; the others are by finer steps, which CVODES confirmed.
    solved_by : tuple of mapping
        The solver of each with its options, as a record states them: IPOPT where it stood in.
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
    solved_by: tuple[Mapping[str, Setting], ...]


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
    _check(tasks, profile)
    request = Request(tasks[0], profile, solver, bound, starts, seed).stating(residual_limit)
    on_steps = programs_of(tasks, profile, _steps(tasks, profile))
    problems = [program.within(request.residual_limit, request.bound) for program in on_steps]
    guesses = request.guesses
    plain = guesses[:1]
    random = guesses[1:]
    attempts: list[tuple[Solver, Sequence[Array]]] = []
    if neighbours:
        solutions = _from_neighbours(problems, request)
        attempts += [(solver, plain), (solver, random)]
    else:
        solutions = best_of_starts(problems, [guesses] * len(problems), solver)
    hopeless = _refuse_the_unsolved(problems, solutions)
    for attempting, starts_of_all in attempts:
        _solve_the_unsolved(problems, solutions, starts_of_all, attempting, hopeless)
    substitute = stand_in(solver)
    if substitute is not None:
        for i in _unsolved(solutions, hopeless):
            attempting = briefly(substitute, problems[i], [solutions[i]])
            _solve_these([i], problems, solutions, plain, attempting)
    moves = _MovesTable(problems, solutions)
    moves.certify(solver, guesses)
    return moves.to_moves()


def _refuse_the_unsolved(problems: Sequence[Program], solutions: list[Solution]) -> set[int]:
    """Say of moves without a solution that they cannot be, where that needs no solver."""
    refused = set[int]()
    for i, solution in enumerate(solutions):
        if solution.status.solved:
            continue
        task = problems[i].task
        try:
            refuse_too_short(task, arrives_at_rest(task, problems[i].residual_limit))
        except InfeasibleTaskError as error:
            refused.add(i)
            infeasible = SolveStatus.INFEASIBLE
            solutions[i] = replace(solution, status=infeasible, reason=str(error))
        else:
            if is_beyond(problems[i], solution.coefficients):
                refused.add(i)
    return refused


def _solve_the_unsolved(
    problems: Sequence[Program],
    solutions: list[Solution],
    starts: Sequence[Array],
    solver: Solver,
    hopeless: Collection[int],
) -> None:
    """Solve what has no solution yet from these starts, but for what is hopeless."""
    unsolved = _unsolved(solutions, hopeless)
    if unsolved and starts:
        _solve_these(unsolved, problems, solutions, starts, solver)


def _unsolved(solutions: Sequence[Solution], hopeless: Collection[int]) -> list[int]:
    """Return which moves have no solution yet, but for what is hopeless."""
    return [
        i
        for i, solution in enumerate(solutions)
        if not solution.status.solved and i not in hopeless
    ]


def _solve_these(
    these: Sequence[int],
    problems: Sequence[Program],
    solutions: list[Solution],
    starts: Sequence[Array],
    solver: Solver,
) -> None:
    """Solve some moves from these starts, and keep what was solved."""
    again = [problems[i] for i in these]
    for i, solution in zip(these, best_of_starts(again, [starts] * len(again), solver)):
        if solution.status.solved:
            solutions[i] = solution


def _from_neighbours(
    problems: Sequence[Program],
    request: Request,
    share: int = 8,
    same: float = 1e-9,
) -> list[Solution]:
    """Solve one move in so many from one start, then all of them from the nearest of these.

    Moves that differ by less than `same` of the spread of all are one.
    """
    solver = request.solver
    start = request.guesses[0]
    count = len(problems)
    shuffled = np.random.default_rng(request.seed).permutation(count)
    pilots = shuffled[: math.ceil(count / share)].tolist()
    solutions = solver.solve([problems[i] for i in pilots], [start] * len(pilots))
    solved = [k for k, solution in enumerate(solutions) if solution.status.solved]
    if not solved:
        return solver.solve(problems, [start] * count)
    moves = np.array([problem.task.row for problem in problems])
    moves /= np.ptp(moves, axis=0) + same
    known = moves[[pilots[k] for k in solved]]
    nearest = [int(np.argmin(np.abs(known - move).sum(axis=1))) for move in moves]
    starts = [solutions[solved[k]].coefficients for k in nearest]
    return solver.solve(problems, starts, warm=True)


def _steps(tasks: Sequence[PointToPoint], profile: JointProfile) -> int:
    """Steps that do for all: those of the move that takes the most periods."""
    starts, targets, durations = np.array([task.move for task in tasks]).T
    radians = durations * fastest_of_moves(tasks[0].plant, starts, targets)
    longest = tasks[int(np.argmax(radians))]
    return first_steps(longest, profile)


class _MovesTable:
    """The columns of `Moves`, empty until a solution is certified."""

    def __init__(self, problems: Sequence[Program], solutions: Sequence[Solution]) -> None:
        count = len(problems)
        self._problems = problems
        self._solutions = list(solutions)
        self._profile = problems[0].profile
        self._coefficients = np.full((count, self._profile.size), np.nan)
        self._energy = np.full(count, np.nan)
        self._residual = np.full(count, np.nan)
        self._peaks = {name: np.full(count, np.nan) for name in QUANTITIES}
        self._by_cvodes = np.zeros(count, dtype=bool)
        self._by_finer_steps: list[int] = []

    def certify(self, solver: Solver, starts: Sequence[Array]) -> None:
        """Fill in all that CVODES confirms, of the solutions or from other starts."""
        solved = [i for i, solution in enumerate(self._solutions) if solution.status.solved]
        outcomes = certify(
            [self._problems[i] for i in solved],
            [self._solutions[i] for i in solved],
            solver,
        )
        for i, outcome in zip(solved, outcomes):
            certified = outcome
            if isinstance(outcome, SolverFailedError):
                from_start = _certify_from_another_start(self._problems[i], starts, solver)
                certified = from_start or outcome
            if isinstance(certified, SolverFailedError):
                self._note_failure(i, certified)
            else:
                self._note(i, certified)
        self._add_finer_peaks()

    def _note_failure(self, i: int, error: SolverFailedError) -> None:
        """A move without a verified motion: it has no values."""
        self._solutions[i] = replace(
            self._solutions[i],
            status=SolveStatus.NOT_CERTIFIED,
            reason=str(error),
            shadow_prices={},
        )

    def _note(self, i: int, certified: Certified) -> None:
        """The values of a move; its peaks only if it was judged by CVODES alone."""
        figures = certified.figures
        self._solutions[i] = certified.solution
        self._coefficients[i] = certified.solution.coefficients
        self._energy[i] = figures.energy
        self._residual[i] = figures.residual
        self._by_cvodes[i] = certified.by_cvodes
        if figures.candidate is None:
            self._by_finer_steps.append(i)
            return
        for name, values in self._peaks.items():
            values[i] = figures.peak(name)

    def _add_finer_peaks(self) -> None:
        """The peaks of moves that finer steps judged, all at once."""
        rows = self._by_finer_steps
        if not rows:
            return
        problems = [self._problems[i] for i in rows]
        for name, values in finer_peaks(problems, self._coefficients[rows]).items():
            self._peaks[name][rows] = values

    def to_moves(self) -> Moves:
        """The plans."""
        solutions = self._solutions
        return Moves(
            tasks=tuple(problem.task for problem in self._problems),
            profile=self._profile,
            coefficients=self._coefficients,
            energy=self._energy,
            residual=self._residual,
            peaks=self._peaks,
            status=tuple(solution.status for solution in solutions),
            reasons=tuple(solution.reason for solution in solutions),
            iterations=np.array([solution.iterations for solution in solutions]),
            shadow_prices=tuple(
                solution.shadow_prices if solution.status.solved else {} for solution in solutions
            ),
            by_cvodes=self._by_cvodes,
            solved_by=tuple(solution.solved_by for solution in solutions),
        )


def _certify_from_another_start(
    problem: Program, starts: Sequence[Array], solver: Solver
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


def _check(tasks: Sequence[PointToPoint], profile: JointProfile) -> None:
    if not tasks:
        raise ValueError("no moves are given; give one task or more")
    first = _common(tasks[0])
    for i, task in enumerate(tasks, start=1):
        if task.uncertainty is not None:
            raise ValueError(f"the plant of move {i} is uncertain; plan such moves by plan_move")
        if _common(task) != first:
            raise ValueError(
                f"move {i} has another plant or energy, or other limits, than move 1; plan them "
                "apart"
            )
    profile.refuse_no_choice()


def _common(task: PointToPoint) -> tuple[Plant, Energy, set[Quantity]]:
    """Return what all moves have in common."""
    return task.plant, task.energy, {limit.quantity for limit in task.limits}
