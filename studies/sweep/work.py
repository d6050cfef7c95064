"""Plan the chunks of a grid that are missing, each a piece of work."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import groupby
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics.sharing.pieces import (
    Done,
    Listener,
    Piece,
    Say,
)
from quietarm.metaheuristics.sharing.running import run_pieces
from quietarm.metaheuristics.sharing.workers import Workers
from quietarm.ocp import (
    InfeasibleTaskError,
    PointToPoint,
    QuietarmError,
    SolveStatus,
    epsilon_front,
    plan_move,
    plan_moves,
)
from quietarm.ocp.interrupts import note_interrupts
from quietarm.ocp.robustness.perturbed import sensitivities_of_moves
from quietarm.ocp.task import QUANTITIES
from quietarm.studies.sweep.asked import COEFFICIENTS, STATES, STATUS, Sweep
from quietarm.studies.sweep.store import Store

Array = NDArray[np.float64]
Found = dict[str, Array]
_CHECKED, _COLD_STARTS = 10, 4
"""One cell in so many, at random, is planned from so many starts of its own as well."""
_ABOVE = 1e-4
"""Share of the energy by which none of these may be cheaper; else all of the chunk are."""


class _Cell(NamedTuple):
    """The plan of a move; where there is none its status says why."""

    status: SolveStatus
    figures: Mapping[str, float] = {}
    coefficients: Array | None = None

    @property
    def energy(self) -> float:
        return self.figures.get("energy", np.inf)


def run_sweep(
    store: Store, part: tuple[int, int], workers: Workers, begin: Callable[[str], None]
) -> Done:
    """Plan what is missing; every chunk is in the store as soon as it is done."""
    sweep, kept = store.sweep, set[object]()
    of = len(sweep.grid.chunks)
    pieces = [
        Piece(number, f"chunk {number + 1} of {of}", partial(planned, sweep, number))
        for number in store.missing(part)
    ]

    def keep(number: int, found: Found) -> None:
        store.keep(number, found)
        kept.add(number)
        found.clear()  # else a large grid would be in memory as well

    done = run_pieces(pieces, Listener(begin, ended=keep), workers=workers)
    with note_interrupts():
        for number, found in done.answers.items():
            if number not in kept:  # it was on its way when Ctrl-C came
                keep(int(str(number)), found)
        if not store.missing():
            store.mark_jumps()
    return done


def planned(sweep: Sweep, number: int, done: Done, say: Say) -> Found:
    """The variables of a chunk; its moves are planned together as far as they have one plant."""
    tasks = sweep.grid.tasks(sweep.grid.chunks[number])
    groups = [list(each) for _, each in groupby(tasks, key=lambda task: task.plant)]
    each = [_variables(sweep, group, number) for group in groups]
    return {name: np.concatenate([one[name] for one in each]) for name in each[0]}


def _variables(sweep: Sweep, tasks: list[PointToPoint], seed: int) -> Found:
    cells, excess = _not_above_cold(sweep, tasks, seed)
    sizes = {name: [size for _, size in one.beside] for name, one in sweep.variables.items()}
    found = {name: np.full([len(tasks), *beside], np.nan) for name, beside in sizes.items()}
    found[STATUS] = np.array([STATES.index(cell.status.value) for cell in cells], np.int8)
    found["cold_excess"] = excess
    solved = [k for k, cell in enumerate(cells) if cell.coefficients is not None]
    for k in solved:
        found[COEFFICIENTS][k] = cells[k].coefficients
        for name, value in cells[k].figures.items():
            found[name][k] = value
        if sweep.front:
            _add_front(sweep, tasks[k], {name: found[f"front_{name}"][k] for name in _OF_FRONT})
    if solved:
        changes = sensitivities_of_moves(
            [tasks[k] for k in solved], sweep.profile, found[COEFFICIENTS][solved]
        )
        for name, (energy, residual) in changes.items():
            found[f"energy_by_{name}"][solved] = energy
            found[f"residual_by_{name}"][solved] = residual
    return found


def _not_above_cold(
    sweep: Sweep, tasks: list[PointToPoint], seed: int
) -> tuple[list[_Cell], Array]:
    """Cells, started from their neighbours, and of a tenth the excess over cold plans."""
    plans = _robust_plans if tasks[0].ranges else _plans
    cells, excess = plans(sweep, tasks, sweep.settings.starts), np.full(len(tasks), np.nan)
    solved = [k for k, cell in enumerate(cells) if cell.coefficients is not None]
    count, random = -(-len(solved) // _CHECKED), np.random.default_rng(seed)
    checked = random.choice(solved, count, replace=False).tolist() if solved else []
    cold = plans(sweep, [tasks[k] for k in checked], _COLD_STARTS) if checked else []
    if any(
        cells[k].energy > (1 + _ABOVE) * one.energy for k, one in zip(checked, cold, strict=True)
    ):
        others = plans(sweep, tasks, _COLD_STARTS)
        cells = [min(pair, key=lambda cell: cell.energy)
                 for pair in zip(cells, others, strict=True)]  # fmt: skip
    for k, one in zip(checked, cold, strict=True):
        excess[k] = cells[k].energy / one.energy - 1
    return cells, excess


def _plans(sweep: Sweep, tasks: list[PointToPoint], starts: int) -> list[_Cell]:
    settings = sweep.settings
    moves = plan_moves(
        tasks, sweep.profile, residual_limit=settings.residual_limit, bound=settings.bound,
        starts=starts, seed=settings.seed, solver=settings.solver,
    )  # fmt: skip
    columns = {"energy": moves.energy, "residual": moves.residual, "iterations": moves.iterations}
    columns |= {f"peak_{name}": values for name, values in moves.peaks.items()}

    def cell(k: int, prices: Mapping[str, float]) -> _Cell:
        if not np.isfinite(moves.energy[k]):
            return _Cell(moves.status[k])
        figures = {name: float(values[k]) for name, values in columns.items()}
        figures |= {f"price_{name}": price for name, price in prices.items()}
        return _Cell(moves.status[k], figures, moves.coefficients[k])

    return [cell(k, prices) for k, prices in enumerate(moves.shadow_prices)]


def _robust_plans(sweep: Sweep, tasks: Sequence[PointToPoint], starts: int) -> list[_Cell]:
    """Plans of uncertain plants one after another, each from the last one's coefficients."""
    settings, guess, cells = sweep.settings, None, list[_Cell]()
    for task in tasks:
        try:
            plan = plan_move(
                task, sweep.profile, residual_limit=settings.residual_limit or None,
                bound=settings.bound, starts=starts, seed=settings.seed, solver=settings.solver,
                guess=guess if starts == 1 else None,
            )  # fmt: skip
        except QuietarmError as error:
            infeasible = isinstance(error, InfeasibleTaskError)
            cells.append(
                _Cell(SolveStatus.INFEASIBLE if infeasible else SolveStatus.ITERATION_LIMIT)
            )
            continue
        guess = np.array(plan.coefficients)
        figures = {"energy": plan.energy, "residual": plan.residual}
        figures |= {one.peak: plan.motion.peak(name) for name, one in QUANTITIES.items()}
        cells.append(_Cell(plan.status, figures, guess))
    return cells


_OF_FRONT = ("residual", "energy", "coefficients")


def _add_front(sweep: Sweep, task: PointToPoint, rows: Mapping[str, Array]) -> None:
    """Fill in the front of a move, as far as it has points; one without a range has none."""
    settings = sweep.settings
    try:
        front = epsilon_front(
            task, sweep.profile, bound=settings.bound, points=sweep.front,
            starts=max(settings.starts, 2), seed=settings.seed, solver=settings.solver,
        )  # fmt: skip
    except QuietarmError:
        return
    for k, point in enumerate(front.points):
        for name in _OF_FRONT:
            rows[name][k] = getattr(point, name)
