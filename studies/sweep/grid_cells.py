"""Plan the cells of a chunk from their neighbours, and a tenth from cold starts as well."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from quietarm.ocp import (
    InfeasibleTaskError,
    JudgedMotion,
    PointToPoint,
    QuietarmError,
    SolverFailedError,
    SolveStatus,
    epsilon_front,
    plan_move,
    plan_moves,
)
from quietarm.ocp.limits import QUANTITIES
from quietarm.ocp.robustness import sensitivities_of_moves
from quietarm.ocp.solvers.solver import NAME
from quietarm.studies.sweep.definition import (
    COEFFICIENTS,
    SOLVED_BY,
    STATES,
    STATUS,
    Definition,
    number_of_solver,
)
from quietarm.studies.sweep.move_grid import by_plant

Cells = Iterator[dict[str, Any]]
_COLD_STARTS = 4
"""Of a cell that does not start from its neighbours, at least."""


def plan_chunk(definition: Definition, number: int) -> tuple[int, pd.DataFrame]:
    """The number of a chunk, and its cells; those of one plant are planned together."""
    tasks = definition.planned.tasks(definition.chunks[number])
    tables = [_plan_checked(definition, group, number) for group in by_plant(tasks)]
    cells = pd.concat(tables, ignore_index=True)
    if definition.front:
        planned = zip(tasks, cells["energy"].notna())
        fronts = [_front_of(definition, task) if solved else {} for task, solved in planned]
        cells = cells.join(pd.DataFrame(fronts, index=cells.index))
    return number, cells


def plan_cells(
    definition: Definition, tasks: Sequence[PointToPoint], *, cold: bool
) -> pd.DataFrame:
    """Variables of moves of one plant, a row each; without a plan the status alone."""
    plan = _plan_robust if tasks[0].ranges else _plan_certain
    cells = pd.DataFrame([*plan(definition, tasks, cold)])
    return cells if "energy" in cells else cells.assign(energy=np.nan)


def _plan_checked(definition: Definition, tasks: list[PointToPoint], seed: int) -> pd.DataFrame:
    """Plans from neighbours, and of a tenth the excess over cold plans; the cheaper ones stay."""
    # share of the energy by which none of these may be cheaper; else all of the chunk are
    tolerated = 1e-4
    cells = plan_cells(
        definition,
        tasks,
        cold=not definition.settings.from_neighbours,
    )
    solved = np.flatnonzero(cells["energy"].notna())
    if not len(solved):
        return cells
    random = np.random.default_rng(seed)
    tenth = -(-len(solved) // 10)
    checked = random.choice(solved, tenth, replace=False)
    cold = plan_cells(
        definition,
        [tasks[k] for k in checked],
        cold=True,
    )["energy"].to_numpy()
    if (cells["energy"].to_numpy()[checked] > (1 + tolerated) * cold).any():
        # what has no plan was tried from all cold starts already
        cold_cells = plan_cells(definition, [tasks[k] for k in solved], cold=True)
        cold_cells = cold_cells.set_axis(solved).reindex(cells.index)
        cheaper = cold_cells["energy"] < cells["energy"].fillna(np.inf)
        both = cells.columns.union(cold_cells.columns, sort=False)
        cells = cells.reindex(columns=both).mask(cheaper, cold_cells.reindex(columns=both))
    cells.loc[checked, "cold_excess"] = cells["energy"].to_numpy()[checked] / cold - 1
    solved = np.flatnonzero(cells["energy"].notna())
    coefficients = np.array(cells[COEFFICIENTS].to_numpy()[solved].tolist())
    solved_tasks = [tasks[k] for k in solved]
    changes = sensitivities_of_moves(solved_tasks, definition.profile, coefficients)
    for name, (energy, residual) in changes.items():
        cells.loc[solved, f"energy_by_{name}"] = energy
        cells.loc[solved, f"residual_by_{name}"] = residual
    for figure in definition.figures:
        cells.loc[solved, figure.name] = np.nan
    for k, task, row in zip(solved, solved_tasks, coefficients):
        for name, value in _figures(definition, task, row).items():
            cells.loc[k, name] = value
    return cells


def _figures(
    definition: Definition, task: PointToPoint, coefficients: NDArray[np.float64]
) -> dict[str, float]:
    """Return the user's own figures of a planned move, by CVODES; those that it has."""
    if not definition.figures:
        return {}
    figures = JudgedMotion.of_profile(task, definition.profile, coefficients).figures
    names = [figure.name for figure in definition.figures]
    try:
        return {name: figures[name] for name in names if name in figures}
    except SolverFailedError:  # of CVODES, which has not judged every cell before
        return {}


def _plan_certain(definition: Definition, tasks: Sequence[PointToPoint], cold: bool) -> Cells:
    """Plans of certain plants, all at once."""
    settings = definition.settings
    moves = plan_moves(
        tasks,
        definition.profile,
        residual_limit=settings.residual_limit,
        bound=settings.bound,
        starts=max(settings.starts, _COLD_STARTS),
        neighbours=not cold,
        solver=settings.solver,
    )
    for k, status in enumerate(moves.status):
        row: dict[str, Any] = {STATUS: STATES.index(status.value), SOLVED_BY: number_of_solver("")}
        if np.isfinite(moves.energy[k]):
            for name in ("energy", "residual", "iterations", COEFFICIENTS):
                row[name] = getattr(moves, name)[k]
            row |= {f"peak_{name}": values[k] for name, values in moves.peaks.items()}
            row |= {f"price_{name}": price for name, price in moves.shadow_prices[k].items()}
            row[SOLVED_BY] = number_of_solver(str(moves.solved_by[k].get(NAME)))
        yield row


def _plan_robust(definition: Definition, tasks: Sequence[PointToPoint], cold: bool) -> Cells:
    """Plans of uncertain plants one after another, each from the last one's coefficients."""
    settings = definition.settings
    guess = None
    for task in tasks:
        try:
            plan = plan_move(
                task,
                definition.profile,
                residual_limit=settings.residual_limit or None,
                bound=settings.bound,
                starts=max(settings.starts, _COLD_STARTS) if cold else 1,
                guess=None if cold else guess,
                solver=settings.solver,
            )
        except QuietarmError as error:
            infeasible = isinstance(error, InfeasibleTaskError)
            status = SolveStatus.INFEASIBLE if infeasible else SolveStatus.ITERATION_LIMIT
            yield {STATUS: STATES.index(status.value), SOLVED_BY: number_of_solver("")}
            continue
        guess = plan.coefficients
        peaks = {quantity.peak: plan.motion.peak(name) for name, quantity in QUANTITIES.items()}
        yield {
            STATUS: STATES.index(plan.status.value),
            COEFFICIENTS: guess,
            "energy": plan.energy,
            "residual": plan.residual,
            SOLVED_BY: number_of_solver(plan.record.method),
            **peaks,
        }


def _front_of(definition: Definition, task: PointToPoint) -> dict[str, Any]:
    """The front of a move, as far as it has points; one without a range has none."""
    # of the ends of a front, at least
    least_starts = 2
    settings = definition.settings
    points = definition.front
    try:
        front = epsilon_front(
            task,
            definition.profile,
            bound=settings.bound,
            points=points,
            starts=max(settings.starts, least_starts),
            solver=settings.solver,
        )
    except QuietarmError:
        return {}
    names = ("residual", "energy", COEFFICIENTS)
    return {f"front_{name}": [getattr(point, name) for point in front.points] for name in names}
