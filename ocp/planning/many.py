"""Plans of many moves at once, a row each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.candidate import Candidate
from quietarm.ocp.errors import SolverFailedError, SolveStatus
from quietarm.ocp.interrupts import one_at_a_time
from quietarm.ocp.planning.starts import first_steps, start_coefficients
from quietarm.ocp.planning.verification import (
    CHECK_EVERY,
    FINER_AGREEMENT,
    OF_A_PLAN,
    finer_peaks,
    finer_values,
    verified,
)
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.profiles.polynomial import CycloidPolynomial
from quietarm.ocp.record import SolveSettings
from quietarm.ocp.simulation.free_vibration import FreeVibration, fastest_of_moves
from quietarm.ocp.solvers.batch import Values
from quietarm.ocp.solvers.program import Program, programs_of
from quietarm.ocp.solvers.solution import RESIDUAL, STILL, Scalarization, Solution
from quietarm.ocp.solvers.solving import STOPPED, Row, Solved, Solver, solve
from quietarm.ocp.task import QUANTITIES, PointToPoint

Array = NDArray[np.float64]
_PILOTS, _SAME_MOVE = 8, 1e-9
"""One move in so many is solved first; moves that differ by no more than this share are one."""
_ROUNDS, _AT_REST = 4, 0.3
"""Most corrections of the state on arrival, until a residual is below this share of `STILL`."""


@dataclass(frozen=True, eq=False)
class Moves:
    """Plans of many moves.

    Attributes
    ----------
    tasks : tuple of PointToPoint
        The moves.
    profile : JointProfile
        How the joint moves.
    coefficients : ndarray, shape (moves, profile.size)
        Coefficients; NaN where there is no plan.
    energy, residual : ndarray, shape (moves,)
        F2 [J] and F1 [m]; NaN where there is no plan.
    peaks : dict of str to ndarray, shape (moves,)
        Largest absolute values on the way by quantity [SI units]; NaN where there is no plan.
    status : tuple of SolveStatus
        How each ended.
    reasons : tuple of str
        The same in the solver's words.
    iterations : ndarray, shape (moves,)
        Iterations of the solver.
    prices : tuple of mapping of str to float
        By how much each least energy falls if a limit is widened [J by the limit's unit]; of the
        residual, too, where rest on arrival is asked for.
    by_cvodes : ndarray of bool, shape (moves,)
        Whose figures CVODES computed; the others are by a finer rule that it confirmed.
    complete : bool
        Whether no Ctrl-C came.
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
    prices: tuple[Mapping[str, float], ...]
    by_cvodes: NDArray[np.bool_]
    complete: bool


@one_at_a_time
def plan_moves(
    tasks: Sequence[PointToPoint],
    profile: JointProfile | None = None,
    *,
    residual_limit: float = 0.0,
    bound: float | None = None,
    starts: int = 1,
    seed: int = 0,
    solver: Solver = "sqp",
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
        The plans. Moves at rest and without limits are certified together, by a finer rule in one
        call, and by CVODES at one in ten and wherever the two differ; all others by CVODES. After
        Ctrl-C those that were solved until then.

    Raises
    ------
    ValueError
        When there is no task, plants, energies or limits differ, or an argument is out of range.
    """
    profile = CycloidPolynomial() if profile is None else profile
    settings = SolveSettings(residual_limit, bound, starts, seed, solver=solver)
    _check(tasks, profile)
    programs = programs_of(tasks, profile, _steps(tasks, profile, settings))
    asks = [
        Scalarization({RESIDUAL: settings.residual_limit, **task.limits}, bound) for task in tasks
    ]
    first = start_coefficients(profile, settings)
    random = start_coefficients(profile, replace(settings, starts=4))[1:]
    best: list[Solution | None] = [None] * len(tasks)
    complete = True
    if starts == 1:
        found, complete = _from_neighbours(programs, asks, first[0], settings)
        best = [*found]
    attempts: list[tuple[Solver, list[Array]]]
    attempts = [(solver, first), (solver, random), ("ipopt", first[:1])]
    for by, guesses in attempts:
        left = [i for i, one in enumerate(best) if one is None or not one.status.solved]
        rows = [Row(programs[i], asks[i], guess) for i in left for guess in guesses]
        if not rows or not complete:
            break
        groups = np.repeat(left, len(guesses)).tolist()
        found, complete = solve(rows, by, groups=groups if len(guesses) > 1 else None)
        for i, one in zip(groups, found, strict=True):
            held = best[i]
            if held is None or _preferred(one) < _preferred(held):
                best[i] = one
    return _certified(programs, asks, [one for one in best if one], settings, complete)


def _from_neighbours(
    programs: Sequence[Program],
    asks: Sequence[Scalarization],
    start: Array,
    settings: SolveSettings,
) -> Solved:
    """Solve a share of the moves from one start, then all of them from the nearest of these."""
    count, by = len(programs), settings.solver
    pilots = np.random.default_rng(settings.seed).permutation(count)[: -(-count // _PILOTS)]
    found, complete = solve([Row(programs[i], asks[i], start) for i in pilots], by)
    solved = [k for k, one in enumerate(found) if one.status.solved]
    starts = np.repeat(start[None], count, axis=0)
    if solved:
        moves = np.array([program.row for program in programs])
        moves /= np.ptp(moves, axis=0) + _SAME_MOVE
        known = moves[pilots[solved]]
        nearest = [int(np.argmin(np.abs(known - move).sum(axis=1))) for move in moves]
        starts = np.array([found[solved[k]].coefficients for k in nearest])
    if not complete:
        none = replace(found[0], status=SolveStatus.ITERATION_LIMIT, reason=STOPPED, iterations=0)
        by_place = dict(zip(pilots.tolist(), found, strict=True))
        return Solved([by_place.get(i, none) for i in range(count)], False)
    rows = [Row(*one) for one in zip(programs, asks, starts, strict=True)]
    return solve(rows, by, warm=bool(solved))


def _steps(tasks: Sequence[PointToPoint], profile: JointProfile, settings: SolveSettings) -> int:
    """Steps that do for all: those of the move that takes the most periods."""
    starts, targets, durations = np.array([task.move for task in tasks]).T
    radians = durations * fastest_of_moves(tasks[0].plant, starts, targets)
    return first_steps(tasks[int(np.argmax(radians))], profile, settings)


def _certified(
    programs: Sequence[Program],
    asks: Sequence[Scalarization],
    found: list[Solution],
    settings: SolveSettings,
    complete: bool,
) -> Moves:
    """Correct what the steps miss, and give the figures of finer steps or of CVODES."""
    count, profile = len(found), programs[0].profile
    moves = Moves(
        tasks=tuple(program.task for program in programs),
        profile=profile,
        coefficients=np.full((count, profile.size), np.nan),
        energy=np.full(count, np.nan),
        residual=np.full(count, np.nan),
        peaks={name: np.full(count, np.nan) for name in QUANTITIES},
        status=tuple(one.status for one in found),
        reasons=tuple(one.reason for one in found),
        iterations=np.array([one.iterations for one in found]),
        prices=tuple(one.prices for one in found),
        by_cvodes=np.zeros(count, dtype=bool),
        complete=complete,
    )
    solved = [i for i, one in enumerate(found) if one.status.solved]
    together = [i for i in solved if asks[i].at_rest and not programs[i].task.limits]
    doubtful = set(solved) - set(together)
    if together:
        rows = [_Found(i, programs[i], asks[i], found[i]) for i in together]
        doubtful |= _together(moves, rows, settings.solver)
    for i in sorted(doubtful):
        try:
            best, checked, _ = verified(programs[i], asks[i], found[i], settings.solver)
        except SolverFailedError:
            moves.coefficients[i] = moves.energy[i] = moves.residual[i] = np.nan
            continue
        moves.coefficients[i], moves.by_cvodes[i] = best.coefficients, True
        moves.energy[i], moves.residual[i] = checked.energy, checked.residual
        for name, values in moves.peaks.items():
            values[i] = checked.motion.peak(name)
    return moves


class _Found(NamedTuple):
    """A move's place, what was asked and what was found."""

    place: int
    program: Program
    ask: Scalarization
    solution: Solution


def _together(moves: Moves, rows: list[_Found], solver: Solver, doublings: int = 2) -> set[int]:
    """Certify moves at rest in a few calls; the places of those left to CVODES alone.

    Those whose energy the finer steps do not confirm are solved again on twice the steps.
    """
    one, places = rows[0].program, [row.place for row in rows]
    table = np.array([row.solution.coefficients for row in rows])
    values = finer_values([row.program for row in rows], table)
    energy = np.array([row.solution.energy for row in rows])
    rough = np.abs(energy - values.energy) > OF_A_PLAN.agreement * values.energy
    doubtful = set[int]()
    if rough.any():
        doubtful = {places[k] for k in np.flatnonzero(rough)}
        if doublings:
            again = _on_twice_the_steps([rows[k] for k in np.flatnonzero(rough)], solver)
            doubtful = _together(moves, again, solver, doublings - 1)
        kept = np.flatnonzero(~rough)
        rows, table = [rows[k] for k in kept], table[kept]
        if not rows:
            return doubtful
    table, values, residual = _corrected(rows, table, solver)
    places = [row.place for row in rows]
    moves.coefficients[places], moves.energy[places] = table, values.energy
    moves.residual[places] = residual
    for name, largest in finer_peaks([row.program for row in rows], table).items():
        moves.peaks[name][places] = largest
    doubtful |= {places[k] for k in np.flatnonzero(residual > STILL)}
    for k in range(0, len(rows), CHECK_EVERY):
        exact = Candidate.of_profile(rows[k].program.task, one.profile, table[k])
        differs = abs(exact.energy - values.energy[k]) > FINER_AGREEMENT * exact.energy
        if differs or exact.residual > STILL:
            return doubtful | set(places)
        moves.by_cvodes[places[k]] = True
    return doubtful


def _on_twice_the_steps(rows: list[_Found], solver: Solver) -> list[_Found]:
    tasks, one = [row.program.task for row in rows], rows[0].program
    programs = programs_of(tasks, one.profile, 2 * one.steps)
    given = [
        Row(program, row.ask, row.solution.coefficients)
        for program, row in zip(programs, rows, strict=True)
    ]
    found = solve(given, solver, warm=True).solutions
    return [
        row._replace(program=program, solution=solution)
        for row, program, solution in zip(rows, programs, found, strict=True)
    ]


def _corrected(rows: list[_Found], table: Array, solver: Solver) -> tuple[Array, Values, Array]:
    """Coefficients, figures and residuals, corrected by what the steps miss on arrival."""
    programs = [row.program for row in rows]
    one, targets = programs[0].task, [program.task.target for program in programs]
    vibrations = FreeVibration(one.plant, targets, one.residual_window)
    by_steps = np.array([row.solution.arrival[0] for row in rows])
    rounds = 0
    while True:
        values = finer_values(programs, table)
        missed = values.arrival - [program.wanted for program in programs]
        residual = vibrations.peak(missed)
        again = np.flatnonzero(residual > _AT_REST * STILL)
        if not again.size or rounds == _ROUNDS:
            return table, values, residual
        rounds += 1
        offset = values.arrival - by_steps
        given = [Row(programs[k], rows[k].ask._replace(offset=offset[k]), table[k]) for k in again]
        for k, found in zip(again, solve(given, solver, warm=True).solutions, strict=True):
            table[k], by_steps[k] = found.coefficients, found.arrival[0] - offset[k]


def _check(tasks: Sequence[PointToPoint], profile: JointProfile) -> None:
    if not tasks:
        raise ValueError("no moves are given; give one task or more")
    for i, task in enumerate(tasks, start=1):
        if task.uncertainty is not None:
            raise ValueError(f"the plant of move {i} is uncertain; plan such moves by plan_move")
        mine, first = ((one.plant, one.energy, {*one.limits}) for one in (task, tasks[0]))
        if mine != first:
            raise ValueError(
                f"move {i} has another plant or energy, or other limits, than move 1; plan them "
                "apart"
            )
    profile.refuse_no_choice()


def _preferred(found: Solution) -> tuple[bool, float]:
    return not found.status.solved, found.energy
