"""Plan the cells of a chunk from their neighbours, and a tenth from cold starts as well."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import groupby
from typing import Any

import numpy as np
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

Row = dict[str, Any]
"""What is known of a cell: its variables by name; without a plan its status alone."""
_CHECKED, _COLD_STARTS = 10, 4
"""One cell in so many, at random, is planned from so many starts of its own as well."""
_ABOVE = 1e-4
"""Share of the energy by which none of these may be cheaper; else all of the chunk are."""


@one_at_a_time
def plan_chunk(definition: Definition, number: int) -> tuple[int, list[Row]]:
    """The number of a chunk, and its cells; those of one plant are planned together."""
    tasks = definition.planned.tasks(definition.chunks[number])
    rows = list[Row]()
    for group in _by_plant(tasks):
        found = _plan_checked(definition, group, number)
        _add_sensitivities(definition, group, found)
        rows += found
    for task, row in zip(tasks, rows, strict=True) if definition.front else ():
        if "energy" in row:
            row |= _front_of(definition, task)
    return number, rows


def plan_energies(
    definition: Definition, tasks: Iterable[PointToPoint], starts: int
) -> list[float]:
    """Energies of the plans of moves; NaN where one has no plan."""
    rows = [row for group in _by_plant(tasks) for row in _plan(definition, group, starts)]
    return [row.get("energy", np.nan) for row in rows]


def _by_plant(tasks: Iterable[PointToPoint]) -> Iterator[list[PointToPoint]]:
    return (list(group) for _, group in groupby(tasks, key=lambda task: task.plant))


def _plan_checked(definition: Definition, tasks: list[PointToPoint], seed: int) -> list[Row]:
    """Plans from neighbours, and of a tenth the excess over cold plans; the cheaper ones stay."""
    rows = _plan(definition, tasks, definition.settings.starts)
    solved = [k for k, row in enumerate(rows) if "energy" in row]
    if not solved:
        return rows
    random = np.random.default_rng(seed)
    checked = random.choice(solved, -(-len(solved) // _CHECKED), replace=False).tolist()
    energies = plan_energies(definition, [tasks[k] for k in checked], _COLD_STARTS)
    cold = dict(zip(checked, energies, strict=True))
    if any(rows[k]["energy"] > (1 + _ABOVE) * energy for k, energy in cold.items()):
        others = _plan(definition, tasks, _COLD_STARTS)
        rows = [min(both, key=lambda row: row.get("energy", np.inf))
                for both in zip(rows, others, strict=True)]  # fmt: skip
    for k, energy in cold.items():
        rows[k]["cold_excess"] = rows[k]["energy"] / energy - 1
    return rows


def _add_sensitivities(definition: Definition, tasks: list[PointToPoint], rows: list[Row]) -> None:
    solved = [k for k, row in enumerate(rows) if "energy" in row]
    if not solved:
        return
    coefficients = np.array([rows[k][COEFFICIENTS] for k in solved])
    some = [tasks[k] for k in solved]
    changes = sensitivities_of_moves(some, definition.profile, coefficients)
    for name, of_name in changes.items():
        for k, energy, residual in zip(solved, *of_name, strict=True):
            rows[k] |= {f"energy_by_{name}": energy, f"residual_by_{name}": residual}


def _plan(definition: Definition, tasks: list[PointToPoint], starts: int) -> list[Row]:
    """Plans of moves of one plant."""
    return [*(_plan_robust if tasks[0].ranges else _plan_certain)(definition, tasks, starts)]


def _plan_certain(definition: Definition, tasks: list[PointToPoint], starts: int) -> Iterator[Row]:
    """Plans of certain plants, all at once."""
    least, bound = definition.settings.residual_limit, definition.settings.bound
    moves = plan_moves(tasks, definition.profile, residual_limit=least, bound=bound, starts=starts)
    for k, status in enumerate(moves.status):
        row: Row = {STATUS: STATES.index(status.value)}
        if np.isfinite(moves.energy[k]):
            for name in ("energy", "residual", "iterations", COEFFICIENTS):
                row[name] = getattr(moves, name)[k]
            row |= {f"peak_{name}": values[k] for name, values in moves.peaks.items()}
            row |= {f"price_{name}": price for name, price in moves.shadow_prices[k].items()}
        yield row


def _plan_robust(definition: Definition, tasks: list[PointToPoint], starts: int) -> Iterator[Row]:
    """Plans of uncertain plants one after another, each from the last one's coefficients."""
    least, bound = definition.settings.residual_limit or None, definition.settings.bound
    guess = None
    for task in tasks:
        try:
            plan = plan_move(
                task, definition.profile, residual_limit=least, bound=bound, starts=starts,
                guess=guess if starts == 1 else None,
            )  # fmt: skip
        except QuietarmError as error:
            infeasible = isinstance(error, InfeasibleTaskError)
            status = SolveStatus.INFEASIBLE if infeasible else SolveStatus.ITERATION_LIMIT
            yield {STATUS: STATES.index(status.value)}
            continue
        guess = plan.coefficients
        peaks = {quantity.peak: plan.motion.peak(name) for name, quantity in QUANTITIES.items()}
        yield {STATUS: STATES.index(plan.status.value), COEFFICIENTS: guess,
               "energy": plan.energy, "residual": plan.residual, **peaks}  # fmt: skip


def _front_of(definition: Definition, task: PointToPoint) -> Row:
    """The front of a move, as far as it has points; one without a range has none."""
    settings, points = definition.settings, definition.front
    try:
        front = epsilon_front(
            task, definition.profile, bound=settings.bound, points=points,
            starts=max(settings.starts, 2),
        )  # fmt: skip
    except QuietarmError:
        return {}
    names = ("residual", "energy", COEFFICIENTS)
    return {f"front_{name}": [getattr(point, name) for point in front.points] for name in names}
