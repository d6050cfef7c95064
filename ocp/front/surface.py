"""The front of three objectives and more: the least energy at the cells of a grid of limits.

One axis of the grid for the residual and one for each peak. Its ends are those of a table of
payoffs: each objective at its least, and of such motions the cheapest, so that every limit between
means something (lexicographic payoffs, Mavrotas 2009 [1]_). Limits are tightened one step at a
time: a cell whose wider neighbour has a solution within its limits has the same one, and where a
neighbour has none, there is none either; neither is solved (as AUGMECON2 leaves cells out [2]_).

References
----------
.. [1] Mavrotas, Applied Mathematics and Computation 213, 2009, pp. 455-465.
.. [2] Mavrotas and Florios, Applied Mathematics and Computation 219, 2013, pp. 9652-9669.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from math import inf

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.errors import SolverFailedError, SolveStatus
from quietarm.ocp.front.ends import find_ends
from quietarm.ocp.front.front import Front
from quietarm.ocp.front.points import FailedPoint, FrontPoint
from quietarm.ocp.front.tradeoff import RESIDUAL_LIMIT, Certificate, Tradeoff
from quietarm.ocp.limits import QUANTITIES, RESIDUAL
from quietarm.ocp.planning.best_of_starts import best_of_starts, better
from quietarm.ocp.planning.request import Request
from quietarm.ocp.record import Setting, digits
from quietarm.ocp.rest import still_of
from quietarm.ocp.solvers.problem import (
    Program,
    Solution,
)
from quietarm.ocp.told_progress import Progress

Array = NDArray[np.float64]
Cell = tuple[int, ...]
"""A cell of the grid: of each axis the number of its limit, from the tightest."""
_ROOM = 1e-4
"""Share by which the tightest limit exceeds the least value that was found: at that value itself
nothing is left to minimise."""


@dataclass
class Grid:
    """The limits of every axis, and what is known of the cells.

    Attributes
    ----------
    limits : mapping of str to tuple of float
        Of each axis, from the tightest to the widest.
    payoffs : mapping of str to Solution
        The cheapest motion at the least value of each axis, by the axis.
    best : dict of Cell to Solution
        The best solution of each cell that has one.
    infeasible, failed : set of Cell, dict of Cell to str
        Cells without a motion; those that were not solved for another reason.
    """

    limits: Mapping[str, tuple[float, ...]]
    payoffs: Mapping[str, Solution]
    best: dict[Cell, Solution] = field(default_factory=dict)
    infeasible: set[Cell] = field(default_factory=set)
    failed: dict[Cell, str] = field(default_factory=dict)
    left_out: int = 0
    iterations: int = 0

    @property
    def distinct(self) -> int:
        """Number of different motions in the cells."""
        return len({id(solution) for solution in self.best.values()})

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of limits on each axis."""
        return tuple(map(len, self.limits.values()))

    def sizes(self, cell: Cell) -> dict[str, float]:
        """The limits of a cell by axis; the widest is none, since no payoff is beyond it."""
        sizes = zip(self.limits, cell, self.limits.values())
        return {
            name: values[place] if place < len(values) - 1 else inf for name, place, values in sizes
        }

    def waves(self) -> Iterable[list[Cell]]:
        """The cells, those of as many steps from the widest at a time."""
        cells = list(product(*map(range, self.shape)))
        widest = sum(self.shape) - len(self.shape)
        for steps in range(widest + 1):
            yield [cell for cell in cells if sum(cell) == widest - steps]

    def beside(self, cell: Cell, step: int) -> list[Cell]:
        """The neighbours that are wider (1) or tighter (-1) in one axis."""
        moved = [(*cell[:axis], place + step, *cell[axis + 1 :]) for axis, place in enumerate(cell)]
        return [
            neighbour
            for neighbour in moved
            if all(0 <= place < count for place, count in zip(neighbour, self.shape))
        ]

    def holds(self, cell: Cell, solution: Solution, rounding: float = 1e-9) -> bool:
        """Return whether a solution is within the limits of a cell."""
        return all(
            solution.peaks[name] <= size * (1 + rounding) for name, size in self.sizes(cell).items()
        )


def surface_front(
    request: Request,
    objectives: tuple[str, ...],
    points: int,
    residuals: Sequence[float],
    report: Progress,
) -> Front:
    """The front of residual, energy and peaks, of about so many cells; arguments checked.

    Errors are those of `epsilon_front`.
    """
    tradeoff, still, cheapest = _begin(request, objectives)
    payoffs = {RESIDUAL: still} | {
        name: _least_peak(tradeoff, name, [still, cheapest]) for name in tradeoff.axes[1:]
    }
    dimensions = len(tradeoff.axes)
    count = max(3, _count(points / 4, dimensions))
    grid = _solved_grid(tradeoff, payoffs, cheapest, count, residuals)
    # a coarse grid tells which share of the cells has a motion of its own, and so how fine the next
    # has to be
    finer_grids = 2
    enough = 0.8
    for _ in range(finer_grids):
        if grid.distinct >= enough * points:
            break
        report(min(grid.distinct, points), points)
        share = max(grid.distinct, 1) / int(np.prod(grid.shape))
        count = max(count + 1, _count(points / share, dimensions))
        iterations = grid.iterations
        grid = _solved_grid(tradeoff, payoffs, cheapest, count, residuals)
        grid.iterations += iterations
    report(points, points)
    return _front_of(tradeoff, grid, cheapest, points, residuals)


def _solve(
    tradeoff: Tradeoff, problems: Sequence[Program], starts: Sequence[Sequence[Array]]
) -> list[Solution]:
    """The best solution of each program from its starts."""
    return best_of_starts(problems, starts, tradeoff.solver)


def _count(cells: float, dimensions: int) -> int:
    """Limits of each axis for about so many cells."""
    return max(2, round(cells ** (1 / dimensions)))


def _solved_grid(
    tradeoff: Tradeoff,
    payoffs: Mapping[str, Solution],
    cheapest: Solution,
    count: int,
    residuals: Sequence[float],
) -> Grid:
    """A grid of so many limits of each axis, every cell solved or left out."""
    grid = _grid_of(tradeoff, payoffs, cheapest, count, residuals)
    for wave in grid.waves():
        _solve_wave(tradeoff, grid, wave)
    _improve_from_tighter(tradeoff, grid)
    return grid


def _begin(request: Request, objectives: tuple[str, ...]) -> tuple[Tradeoff, Solution, Solution]:
    """The trade-off on its steps, its motion of least residual, and the cheapest."""
    ends = find_ends(Tradeoff.begin(request))
    request = ends.tradeoff.request
    tradeoff = Tradeoff.measured(request, objectives)
    if request.steps is None and tradeoff.program.steps < ends.tradeoff.program.steps:
        tradeoff = Tradeoff.measured(request, objectives, ends.tradeoff.program.steps)
    at_rest = ends.still.residual <= still_of(request.task)
    least = 0.0 if at_rest else ends.still.residual * (1 + _ROOM)
    problems = [tradeoff.within({RESIDUAL: least}), tradeoff.within({})]
    starts = [[end.coefficients] for end in (ends.still, ends.cheapest)]
    still, cheapest = _solve(tradeoff, problems, starts)
    for solution in (still, cheapest):
        if not solution.status.solved:
            raise SolverFailedError(f"an end of the front was not solved: {solution.status.text}")
    iterations = ends.still.iterations + ends.cheapest.iterations
    return tradeoff, still, replace(cheapest, iterations=cheapest.iterations + iterations)


def _grid_of(
    tradeoff: Tradeoff,
    payoffs: Mapping[str, Solution],
    cheapest: Solution,
    count: int,
    residuals: Sequence[float],
) -> Grid:
    """The grid between the table of payoffs' least and largest values.

    Residual limits are closer together near rest, where the energy falls most; the residuals that
    are given stand among them.
    """
    table = [*payoffs.values(), cheapest]
    shares = np.linspace(0.0, 1.0, count)
    limits = dict[str, tuple[float, ...]]()
    for name in tradeoff.axes:
        values = [solution.peaks[name] for solution in table]
        least = payoffs[name].peaks[name]
        at_rest = name == RESIDUAL and least <= still_of(tradeoff.task)
        tightest = 0.0 if at_rest else least * (1 + _ROOM)
        along = shares**1.5 if name == RESIDUAL else shares
        sizes = tightest + along * max(max(values) - tightest, 0.0)
        if name == RESIDUAL:
            between = [size for size in residuals if tightest < size < sizes[-1]]
            sizes = np.sort([*sizes, *between])
        limits[name] = tuple(sizes.tolist())
    iterations = sum(solution.iterations for solution in table)
    return Grid(limits, payoffs, iterations=iterations)


def _least_peak(tradeoff: Tradeoff, name: str, ends: Sequence[Solution]) -> Solution:
    """The cheapest motion of the least peak of a quantity."""
    guesses = [*(end.coefficients for end in ends), *tradeoff.starts]
    (least,) = _solve(tradeoff, [tradeoff.within({}, {name: 1.0})], [guesses])
    if not least.status.solved:
        raise SolverFailedError(f"the least peak {name} was not found: {least.status.text}")
    within = {name: least.peaks[name] * (1 + _ROOM)}
    (solution,) = _solve(
        tradeoff, [tradeoff.within(within)], [[least.coefficients, *guesses[: len(ends)]]]
    )
    iterations = least.iterations + solution.iterations
    return replace(solution if solution.status.solved else least, iterations=iterations)


def _solve_wave(tradeoff: Tradeoff, grid: Grid, wave: Sequence[Cell], audited: int = 4) -> None:
    """Solve cells whose wider neighbours are known; one in so many from a random start as well."""
    open_cells = list[Cell]()
    for cell in wave:
        wider = grid.beside(cell, 1)
        if any(neighbour in grid.infeasible for neighbour in wider):
            grid.infeasible.add(cell)
            grid.left_out += 1
            continue
        within = [
            grid.best[neighbour]
            for neighbour in wider
            if neighbour in grid.best and grid.holds(cell, grid.best[neighbour])
        ]
        if within:
            grid.best[cell] = within[0]
            grid.left_out += 1
        else:
            open_cells.append(cell)
    problems = [tradeoff.within(grid.sizes(cell)) for cell in open_cells]
    starts = list[list[Array]]()
    for place, cell in enumerate(open_cells):
        known = [grid.best[near] for near in grid.beside(cell, 1) if near in grid.best]
        tight = [grid.payoffs[name] for name, at in zip(grid.limits, cell) if at == 0]
        guesses = [
            solution.coefficients for solution in [*known, *(tight or grid.payoffs.values())]
        ]
        if place % audited == 0:
            guesses += tradeoff.starts[1:2]
        starts.append(guesses)
    for cell, solution in zip(open_cells, _solve(tradeoff, problems, starts) if problems else []):
        _note(grid, cell, solution)


def _note(grid: Grid, cell: Cell, solution: Solution) -> None:
    """Note the outcome of a cell that was solved for the first time."""
    grid.iterations += solution.iterations
    if solution.status.solved:
        grid.best[cell] = solution
    elif solution.status is SolveStatus.INFEASIBLE:
        grid.infeasible.add(cell)
    else:
        grid.failed[cell] = solution.status.text


def _improve_from_tighter(tradeoff: Tradeoff, grid: Grid, rounds: int = 3) -> None:
    """Solve cells again that cost more than a tighter neighbour, or have none although it has one.

    What is within tighter limits is within wider ones.
    """
    for _ in range(rounds):
        starts = dict[Cell, list[Array]]()
        for cell in product(*map(range, grid.shape)):
            known = grid.best.get(cell)
            for tighter in grid.beside(cell, -1):
                solution = grid.best.get(tighter)
                if solution is None or solution is known:
                    continue
                if known is None or solution.energy < known.energy * (1 - 1e-6):
                    starts.setdefault(cell, []).append(solution.coefficients)
        if not starts:
            return
        problems = [tradeoff.within(grid.sizes(cell)) for cell in starts]
        solutions = _solve(tradeoff, problems, list(starts.values()))
        for cell, problem, solution in zip(starts, problems, solutions):
            known = grid.best.get(cell)
            grid.iterations += solution.iterations
            improves = known is None or better(solution, known, problem)
            if solution.status.solved and improves:
                grid.best[cell] = solution
                grid.infeasible.discard(cell)
                grid.failed.pop(cell, None)


def _front_of(
    tradeoff: Tradeoff, grid: Grid, cheapest: Solution, points: int, residuals: Sequence[float]
) -> Front:
    """The front of all cells and payoffs, whose record says what became of the grid."""
    cells = {id(solution): cell for cell, solution in grid.best.items()}
    solutions = {id(solution): solution for solution in grid.best.values()}
    distinct = list(solutions.values())
    problems = [tradeoff.within(grid.sizes(cells[id(solution)])) for solution in distinct]
    for solution in (*grid.payoffs.values(), cheapest):
        distinct.append(solution)
        problems.append(tradeoff.within({name: solution.peaks[name] for name in tradeoff.axes}))
    certified = tradeoff.certify_within(distinct, problems)
    failed = [FailedPoint(_place(grid, cell), why) for cell, why in grid.failed.items()]
    found = list[FrontPoint | FailedPoint](failed)
    for solution, outcome in zip(distinct, certified):
        if isinstance(outcome, Certificate):
            found.append(outcome.point)
        else:
            place = {RESIDUAL_LIMIT: solution.residual}
            place |= {QUANTITIES[name].limit: solution.peaks[name] for name in tradeoff.axes[1:]}
            found.append(FailedPoint(place, str(outcome)))
    settings: dict[str, Setting] = {
        "grid": " x ".join(map(str, grid.shape)),
        "infeasible_cells": len(grid.infeasible),
        "cells_left_out": grid.left_out,
    }
    if residuals:
        settings["at"] = ", ".join(map(digits, residuals))
    # the grid's iterations are those of all its cells
    certificates = [Certificate(point, 0) for point in found]
    return tradeoff.to_front(
        "epsilon", certificates, points, iterations=grid.iterations, settings=settings
    )


def _place(grid: Grid, cell: Cell) -> dict[str, float]:
    """The limits of a cell, by the names of their options."""
    sizes = {name: values[place] for (name, values), place in zip(grid.limits.items(), cell)}
    return {f"{name}_limit": size for name, size in sizes.items()}
