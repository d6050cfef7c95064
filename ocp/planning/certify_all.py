"""Certify many solutions at once: by much finer steps, which CVODES confirms at every tenth."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.limits import QUANTITIES, Limit, Quantity
from quietarm.ocp.planning.certify import (
    AT_REST,
    OF_A_PLAN,
    Certified,
    FinerFigures,
    Tolerances,
    certify,
    judge,
    solve_again,
)
from quietarm.ocp.simulation.free_vibration import FreeVibration
from quietarm.ocp.simulation.grid import default_steps
from quietarm.ocp.solvers.batch import Batch, Values, batch
from quietarm.ocp.solvers.choice import Solver
from quietarm.ocp.solvers.problem import Problem, Solution
from quietarm.ocp.solvers.transcription import STILL, Transcription, transcribe

Array = NDArray[np.float64]
_EVERY, _AGREEMENT = 10, 1e-6
"""CVODES checks one motion in so many, and its figures may differ by this share."""
_FINER, _DOUBLINGS, _ROUNDS = 3, 2, 4
"""Times the solver's steps; most doublings of these; most corrections of the state on arrival."""
Outcome = Certified[Any] | SolverFailedError


def certify_all(
    problems: Sequence[Problem],
    solutions: Sequence[Solution],
    solver: Solver,
    tolerances: Tolerances = OF_A_PLAN,
    limits: Sequence[Limit] | None = None,
) -> list[Outcome]:
    """Certify solved problems of one plant and profile; arguments as for `certify`.

    Those without limits, and of certain tasks, are judged together where there are ten or more;
    all others, and where the integrators differ, one after another. An error stands for a motion
    that exceeds its limits.
    """
    rows = [
        (i, *row)
        for i, row in enumerate(zip(problems, solutions, strict=True))
        if not row[0].transcription.task.limits and row[0].transcription.task.uncertainty is None
    ]
    found: dict[int, Outcome] = {}
    if len(rows) >= _EVERY:
        found |= _confirm(rows, solver, tolerances, _DOUBLINGS)
    for i, (problem, solution) in enumerate(zip(problems, solutions, strict=True)):
        if i not in found:
            try:
                found[i] = certify(problem, solution, solver, tolerances, limits)
            except SolverFailedError as error:
                found[i] = error
    return [found[i] for i in range(len(problems))]


_Row = tuple[int, Problem, Solution]


def _confirm(
    rows: list[_Row], solver: Solver, tolerances: Tolerances, doublings: int
) -> dict[int, Certified[FinerFigures]]:
    """Those that finer steps confirm, by place, at rest with the state on arrival corrected.

    Those whose energy they do not confirm are solved again on twice the steps. None where CVODES
    does not confirm the finer steps.
    """
    found: dict[int, Certified[FinerFigures]] = {}
    energy = np.array([solution.energy for _, _, solution in rows])
    finer = _finer_values(rows).energy
    rough = np.flatnonzero(np.abs(energy - finer) > tolerances.energy * finer)
    steps = rows[0][1].transcription.steps
    if rough.size and doublings and 2 * steps <= tolerances.most_steps:
        again = _refine([rows[k] for k in rough], solver)
        found = _confirm(again, solver, tolerances, doublings - 1)
    refined = set(rough.tolist())
    rows = [row for k, row in enumerate(rows) if k not in refined]
    if not rows:
        return found
    rows, values, residual = _correct_arrivals(rows, solver)
    own = dict[int, Certified[FinerFigures]]()
    for k, (i, problem, solution) in enumerate(rows):
        figures = FinerFigures(float(values.energy[k]), float(residual[k]), k % _EVERY == 0)
        if k % _EVERY == 0:
            exact = judge(problem.transcription, solution.coefficients)
            energy_differs = abs(exact.energy - figures.energy) > _AGREEMENT * exact.energy
            room = _AGREEMENT * exact.residual + STILL
            if energy_differs or abs(exact.residual - figures.residual) > room:
                return found
        if not problem.scalarization.at_rest or figures.residual <= STILL:
            own[i] = Certified(solution, figures, problem)
    return found | own


def _refine(rows: list[_Row], solver: Solver) -> list[_Row]:
    """The rows on twice the steps."""
    one, places = rows[0][1].transcription, [i for i, _, _ in rows]
    tasks = [problem.transcription.task for _, problem, _ in rows]
    problems = [
        Problem(transcription, problem.scalarization)
        for transcription, (_, problem, _) in zip(
            transcribe(tasks, one.profile, 2 * one.steps), rows, strict=True
        )
    ]
    found = solve_again(problems, [solution for _, _, solution in rows], solver)
    return list(zip(places, problems, found, strict=True))


def _correct_arrivals(rows: list[_Row], solver: Solver) -> tuple[list[_Row], Values, Array]:
    """The rows, at rest corrected by what the steps miss on arrival; their figures, residuals."""
    rows, tasks = list(rows), [problem.transcription.task for _, problem, _ in rows]
    targets, window = [task.target for task in tasks], tasks[0].residual_window
    vibrations = FreeVibration(tasks[0].plant, targets, window)
    at_rest = np.array([problem.scalarization.at_rest for _, problem, _ in rows])
    by_steps = np.array([solution.arrival[0] for _, _, solution in rows])
    wanted = np.array([task.final_state for task in tasks])
    rounds = 0
    while True:
        values = _finer_values(rows)
        residual = vibrations.peak(values.arrival - wanted)
        again = np.flatnonzero(at_rest & (residual > AT_REST * STILL))
        if not again.size or rounds == _ROUNDS:
            return rows, values, residual
        rounds += 1
        offset = values.arrival - by_steps
        problems = [
            Problem(one.transcription, one.scalarization._replace(offset=offset[k]))
            for k in again
            for one in [rows[k][1]]
        ]
        found = solve_again(problems, [rows[k][2] for k in again], solver)
        for k, problem, solution in zip(again, problems, found, strict=True):
            rows[k] = (rows[k][0], problem, solution)
            by_steps[k] = solution.arrival[0] - offset[k]


def _finer_values(rows: Sequence[_Row]) -> Values:
    """Figures on three times the solver's steps or more."""
    transcriptions = [problem.transcription for _, problem, _ in rows]
    table = np.array([solution.coefficients for _, _, solution in rows])
    return _values(_finer(transcriptions[0]), transcriptions, table)


def finer_peaks(of: Sequence[Transcription], coefficients: Array) -> dict[str, Array]:
    """Peaks of every quantity of one motion of each task, at the nodes of these steps."""
    finer = _finer(of[0], tuple(QUANTITIES.values()))
    limited = _values(finer, of, coefficients).limited
    return {name: np.abs(limited[:, place]).max(axis=1) for name, place in finer.places.items()}


def _finer(one: Transcription, quantities: tuple[Quantity, ...] = ()) -> Batch:
    steps = max(default_steps(one.task), _FINER * one.steps)
    return batch(one.task.plant, one.profile, steps, quantities, energy=one.task.energy)


def _values(finer: Batch, of: Sequence[Transcription], coefficients: Array) -> Values:
    move = np.array([one.task.row for one in of])
    return finer.values(coefficients, move, np.zeros((len(of), 0)))
