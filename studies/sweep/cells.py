"""Plan the cells of a chunk from their neighbours, and a tenth from cold starts as well."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp import (
    InfeasibleTaskError,
    PointToPoint,
    QuietarmError,
    SolveStatus,
    epsilon_front,
    plan_move,
    plan_moves,
)
from quietarm.ocp.interrupts import one_at_a_time
from quietarm.ocp.limits import QUANTITIES
from quietarm.ocp.robustness.perturbed import sensitivities_of_moves
from quietarm.studies.sweep.definition import COEFFICIENTS, STATES, STATUS, Definition

Columns = dict[str, NDArray[Any]]
"""Variables by name, a row a cell; NaN where a cell has no plan."""
_CHECKED, _COLD_STARTS = 10, 4
"""One cell in so many, at random, is planned from so many starts of its own as well."""
_ABOVE = 1e-4
"""Share of the energy by which none of these may be cheaper; else all of the chunk are."""


@one_at_a_time
def plan_chunk(definition: Definition, number: int) -> Columns:
    """The variables of a chunk; its moves are planned together as far as they have one plant."""
    tasks = definition.tasks(number)
    groups = [list(each) for _, each in groupby(tasks, key=lambda task: task.plant)]
    each = [_plan_group(definition, group, number) for group in groups]
    return {name: np.concatenate([columns[name] for columns in each]) for name in each[0]}


def _plan_group(definition: Definition, tasks: list[PointToPoint], seed: int) -> Columns:
    """The variables of moves of one plant."""
    columns = _plan_checked(definition, tasks, seed)
    solved = np.flatnonzero(np.isfinite(columns["energy"]))
    if len(solved):
        some = [tasks[k] for k in solved]
        changes = sensitivities_of_moves(some, definition.profile, columns[COEFFICIENTS][solved])
        for name, (energy, residual) in changes.items():
            columns[f"energy_by_{name}"][solved] = energy
            columns[f"residual_by_{name}"][solved] = residual
    for k in solved.tolist() if definition.front else ():
        _add_front(definition, tasks[k], columns, k)
    return columns


def _plan_checked(definition: Definition, tasks: list[PointToPoint], seed: int) -> Columns:
    """Plans from neighbours, and of a tenth the excess over cold plans; the cheaper ones stay."""
    columns = _plan(definition, tasks, definition.settings.starts)
    solved = np.flatnonzero(np.isfinite(columns["energy"]))
    if not len(solved):
        return columns
    random = np.random.default_rng(seed)
    checked = random.choice(solved, -(-len(solved) // _CHECKED), replace=False)
    cold = _plan(definition, [tasks[k] for k in checked], _COLD_STARTS)["energy"]
    if (columns["energy"][checked] > (1 + _ABOVE) * cold).any():
        others = _plan(definition, tasks, _COLD_STARTS)
        cheaper = others["energy"] < columns["energy"]
        cheaper |= np.isnan(columns["energy"])
        for name, values in others.items():
            columns[name][cheaper] = values[cheaper]
    columns["cold_excess"][checked] = columns["energy"][checked] / cold - 1
    return columns


def plan_energies(
    definition: Definition, tasks: Sequence[PointToPoint], starts: int
) -> NDArray[np.float64]:
    """Energies of the plans of moves, whatever their plants; NaN where one has no plan."""
    energies = np.full(len(tasks), np.nan)
    for plant in {task.plant for task in tasks}:
        places = [k for k, task in enumerate(tasks) if task.plant == plant]
        columns = _plan(definition, [tasks[k] for k in places], starts)
        energies[places] = columns["energy"]
    return energies


def _plan(definition: Definition, tasks: Sequence[PointToPoint], starts: int) -> Columns:
    plan = _plan_robust if tasks[0].ranges else _plan_certain
    return plan(definition, tasks, starts)


def _empty(definition: Definition, cells: int) -> Columns:
    columns = {
        name: np.full([cells, *(size for _, size in variable.beside)], np.nan)
        for name, variable in definition.variables.items()
    }
    return columns | {STATUS: np.zeros(cells, np.int8)}


def _number_of(status: SolveStatus) -> int:
    return STATES.index(status.value)


def _plan_certain(definition: Definition, tasks: Sequence[PointToPoint], starts: int) -> Columns:
    """Plans of certain plants, all at once."""
    settings, columns = definition.settings, _empty(definition, len(tasks))
    moves = plan_moves(
        tasks, definition.profile, residual_limit=settings.residual_limit, bound=settings.bound,
        starts=starts, seed=settings.seed, solver=settings.solver,
    )  # fmt: skip
    columns[STATUS][:] = [_number_of(status) for status in moves.status]
    solved = np.isfinite(moves.energy)
    peaks = {f"peak_{name}": values for name, values in moves.peaks.items()}
    for name, values in {
        "energy": moves.energy, "residual": moves.residual, "iterations": moves.iterations,
        COEFFICIENTS: moves.coefficients, **peaks,
    }.items():  # fmt: skip
        columns[name][solved] = values[solved]
    for k, prices in enumerate(moves.shadow_prices):
        for name, price in prices.items() if solved[k] else ():
            columns[f"price_{name}"][k] = price
    return columns


def _plan_robust(definition: Definition, tasks: Sequence[PointToPoint], starts: int) -> Columns:
    """Plans of uncertain plants one after another, each from the last one's coefficients."""
    settings, columns, guess = definition.settings, _empty(definition, len(tasks)), None
    for k, task in enumerate(tasks):
        try:
            plan = plan_move(
                task, definition.profile, residual_limit=settings.residual_limit or None,
                bound=settings.bound, starts=starts, seed=settings.seed, solver=settings.solver,
                guess=guess if starts == 1 else None,
            )  # fmt: skip
        except QuietarmError as error:
            infeasible = isinstance(error, InfeasibleTaskError)
            status = SolveStatus.INFEASIBLE if infeasible else SolveStatus.ITERATION_LIMIT
            columns[STATUS][k] = _number_of(status)
            continue
        guess = np.array(plan.coefficients)
        columns[STATUS][k], columns[COEFFICIENTS][k] = _number_of(plan.status), guess
        columns["energy"][k], columns["residual"][k] = plan.energy, plan.residual
        for name, quantity in QUANTITIES.items():
            columns[quantity.peak][k] = plan.motion.peak(name)
    return columns


def _add_front(definition: Definition, task: PointToPoint, columns: Columns, k: int) -> None:
    """Fill in the front of a move, as far as it has points; one without a range has none."""
    settings = definition.settings
    try:
        front = epsilon_front(
            task, definition.profile, bound=settings.bound, points=definition.front,
            starts=max(settings.starts, 2), seed=settings.seed, solver=settings.solver,
        )  # fmt: skip
    except QuietarmError:
        return
    for i, point in enumerate(front.points):
        columns["front_residual"][k, i] = point.residual
        columns["front_energy"][k, i] = point.energy
        columns["front_coefficients"][k, i] = point.coefficients
