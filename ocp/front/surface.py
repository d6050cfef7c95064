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

from quietarm.ocp.candidate import Candidate
from quietarm.ocp.errors import SolverFailedError, SolveStatus
from quietarm.ocp.front.curve import RESIDUAL_LIMIT, Curve, Progress
from quietarm.ocp.front.ends import find_ends
from quietarm.ocp.front.front import Front, reference_corner
from quietarm.ocp.front.points import FailedPoint, FrontPoint, non_dominated, point_of
from quietarm.ocp.limits import QUANTITIES, RESIDUAL, Limit
from quietarm.ocp.objectives import peak_quantities, with_peaks_measured
from quietarm.ocp.planning.best_of_starts import best_of_starts, better
from quietarm.ocp.planning.certify import Certified, Tolerances, certify
from quietarm.ocp.planning.request import Request
from quietarm.ocp.record import Setting, digits
from quietarm.ocp.solvers.problem import (
    LEAST_ENERGY,
    Program,
    Solution,
    first_steps,
    still_of,
)
from quietarm.ocp.task import PointToPoint

Array = NDArray[np.float64]
Cell = tuple[int, ...]
"""A cell of the grid: of each axis the number of its limit, from the tightest."""
_ROOM = 1e-4
"""Share by which the tightest limit exceeds the least value that was found: at that value itself
nothing is left to minimise."""


@dataclass(frozen=True)
class Surface:
    """A task whose residual and peaks are limited.

    Attributes
    ----------
    objectives : tuple of str
        Names of the objectives.
    program : Program
        The task on its steps, with the peaks measured.
    request : Request
        The move, and how it is solved.
    """

    objectives: tuple[str, ...]
    program: Program
    request: Request

    @property
    def task(self) -> PointToPoint:
        """The move."""
        return self.request.task

    @property
    def axes(self) -> tuple[str, ...]:
        """What is limited: the residual, and the quantities of the peaks."""
        return RESIDUAL, *peak_quantities(self.objectives)

    @property
    def starts(self) -> list[Array]:
        """Coefficients to start from."""
        return self.request.guesses

    def problem(
        self, sizes: Mapping[str, float], minimise: Mapping[str, float] = LEAST_ENERGY
    ) -> Program:
        """The problem within limits of these sizes, and those of the task."""
        limits = {limit.name: limit for limit in self.task.limits}
        for name in self.axes[1:]:
            size = min(sizes.get(name, inf), limits[name].size if name in limits else inf)
            if size < inf:
                limits[name] = self.program.limits_of_task[name].widened_to(size)
        residual = Limit.of_residual(sizes.get(RESIDUAL, inf), self.task.plant.tip_unit)
        return self.program.asking(
            limits=(residual, *limits.values()), bound=self.request.bound, minimise=minimise
        )

    def solve(
        self, problems: Sequence[Program], starts: Sequence[Sequence[Array]]
    ) -> list[Solution]:
        """The best solution of each problem from its starts."""
        return best_of_starts(problems, starts, self.request.solver)

    @classmethod
    def of_front(cls, front: Front, request: Request) -> Surface:
        """The surface of a front that is there already."""
        measured = with_peaks_measured(front.task, peak_quantities(front.objectives))
        program = Program.of(measured, front.profile, request.steps)
        return cls(front.objectives, program, request)

    def certify(
        self,
        solutions: Sequence[Solution],
        problems: Sequence[Program],
        limits: Sequence[Limit] | None = None,
    ) -> list[FrontPoint | SolverFailedError]:
        """Solutions as points by CVODES, within these limits or those of the task alone."""
        tip_unit = self.task.plant.tip_unit
        outcomes = certify(
            problems,
            solutions,
            self.request.solver,
            Tolerances(energy=1e-4, most_steps=2 * self.program.steps),
            limits or (Limit.of_residual(inf, tip_unit), *self.task.limits),
        )
        return [self._point_of(outcome) for outcome in outcomes]

    def _point_of(self, outcome: Certified | SolverFailedError) -> FrontPoint | SolverFailedError:
        if isinstance(outcome, SolverFailedError):
            return outcome
        profile = self.program.profile
        coefficients = profile.checked(outcome.solution.coefficients)
        motion = Candidate.of_profile(self.task, profile, coefficients)
        prices = outcome.solution.shadow_prices
        return replace(point_of(motion, self.objectives), shadow_prices=prices)


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
        """How many motions the cells have."""
        return len({id(solution) for solution in self.best.values()})

    @property
    def shape(self) -> tuple[int, ...]:
        """How many limits each axis has."""
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
        """Whether a solution is within the limits of a cell."""
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
    surface, still, cheapest = _begin(request, objectives)
    payoffs = {RESIDUAL: still} | {
        name: _least_peak(surface, name, [still, cheapest]) for name in surface.axes[1:]
    }
    dimensions = len(surface.axes)
    count = max(3, _count(points / 4, dimensions))
    grid = _solved_grid(surface, payoffs, cheapest, count, residuals)
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
        grid = _solved_grid(surface, payoffs, cheapest, count, residuals)
        grid.iterations += iterations
    report(points, points)
    return _front_of(surface, grid, cheapest, points, residuals)


def _count(cells: float, dimensions: int) -> int:
    """Limits of each axis for about so many cells."""
    return max(2, round(cells ** (1 / dimensions)))


def _solved_grid(
    surface: Surface,
    payoffs: Mapping[str, Solution],
    cheapest: Solution,
    count: int,
    residuals: Sequence[float],
) -> Grid:
    """A grid of so many limits of each axis, every cell solved or left out."""
    grid = _grid_of(surface, payoffs, cheapest, count, residuals)
    for wave in grid.waves():
        _solve_wave(surface, grid, wave)
    _improve_from_tighter(surface, grid)
    return grid


def _begin(request: Request, objectives: tuple[str, ...]) -> tuple[Surface, Solution, Solution]:
    """The surface on its steps, its motion of least residual, and the cheapest."""
    task = request.task
    profile = request.profile
    measured = with_peaks_measured(task, peak_quantities(objectives))
    ends = find_ends(Curve.begin(request))
    steps = request.steps or max(ends.curve.program.steps, first_steps(measured, profile))
    surface = Surface(objectives, Program(measured, profile, steps), request)
    at_rest = ends.still.residual <= still_of(task)
    least = 0.0 if at_rest else ends.still.residual * (1 + _ROOM)
    problems = [surface.problem({RESIDUAL: least}), surface.problem({})]
    starts = [[end.coefficients] for end in (ends.still, ends.cheapest)]
    still, cheapest = surface.solve(problems, starts)
    for solution in (still, cheapest):
        if not solution.status.solved:
            raise SolverFailedError(f"an end of the front was not solved: {solution.status.text}")
    iterations = ends.still.iterations + ends.cheapest.iterations
    return surface, still, replace(cheapest, iterations=cheapest.iterations + iterations)


def _grid_of(
    surface: Surface,
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
    for name in surface.axes:
        values = [solution.peaks[name] for solution in table]
        least = payoffs[name].peaks[name]
        at_rest = name == RESIDUAL and least <= still_of(surface.task)
        tightest = 0.0 if at_rest else least * (1 + _ROOM)
        along = shares**1.5 if name == RESIDUAL else shares
        sizes = tightest + along * max(max(values) - tightest, 0.0)
        if name == RESIDUAL:
            between = [size for size in residuals if tightest < size < sizes[-1]]
            sizes = np.sort([*sizes, *between])
        limits[name] = tuple(sizes.tolist())
    iterations = sum(solution.iterations for solution in table)
    return Grid(limits, payoffs, iterations=iterations)


def _least_peak(surface: Surface, name: str, ends: Sequence[Solution]) -> Solution:
    """The cheapest motion of the least peak of a quantity."""
    guesses = [*(end.coefficients for end in ends), *surface.starts]
    (least,) = surface.solve([surface.problem({}, {name: 1.0})], [guesses])
    if not least.status.solved:
        raise SolverFailedError(f"the least peak {name} was not found: {least.status.text}")
    within = {name: least.peaks[name] * (1 + _ROOM)}
    (solution,) = surface.solve(
        [surface.problem(within)], [[least.coefficients, *guesses[: len(ends)]]]
    )
    iterations = least.iterations + solution.iterations
    return replace(solution if solution.status.solved else least, iterations=iterations)


def _solve_wave(surface: Surface, grid: Grid, wave: Sequence[Cell], audited: int = 4) -> None:
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
    problems = [surface.problem(grid.sizes(cell)) for cell in open_cells]
    starts = list[list[Array]]()
    for place, cell in enumerate(open_cells):
        known = [grid.best[near] for near in grid.beside(cell, 1) if near in grid.best]
        tight = [grid.payoffs[name] for name, at in zip(grid.limits, cell) if at == 0]
        guesses = [
            solution.coefficients for solution in [*known, *(tight or grid.payoffs.values())]
        ]
        if place % audited == 0:
            guesses += surface.starts[1:2]
        starts.append(guesses)
    for cell, solution in zip(open_cells, surface.solve(problems, starts) if problems else []):
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


def _improve_from_tighter(surface: Surface, grid: Grid, rounds: int = 3) -> None:
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
        problems = [surface.problem(grid.sizes(cell)) for cell in starts]
        solutions = surface.solve(problems, list(starts.values()))
        for cell, problem, solution in zip(starts, problems, solutions):
            known = grid.best.get(cell)
            grid.iterations += solution.iterations
            improves = known is None or better(solution, known, problem)
            if solution.status.solved and improves:
                grid.best[cell] = solution
                grid.infeasible.discard(cell)
                grid.failed.pop(cell, None)


def _front_of(
    surface: Surface, grid: Grid, cheapest: Solution, points: int, residuals: Sequence[float]
) -> Front:
    """The front of all cells and payoffs, whose record says what became of the grid."""
    cells = {id(solution): cell for cell, solution in grid.best.items()}
    solutions = {id(solution): solution for solution in grid.best.values()}
    distinct = list(solutions.values())
    problems = [surface.problem(grid.sizes(cells[id(solution)])) for solution in distinct]
    for solution in (*grid.payoffs.values(), cheapest):
        distinct.append(solution)
        problems.append(surface.problem({name: solution.peaks[name] for name in surface.axes}))
    certified = surface.certify(distinct, problems)
    failures = [FailedPoint(_place(grid, cell), why) for cell, why in grid.failed.items()]
    for solution, point in zip(distinct, certified):
        if not isinstance(point, FrontPoint):
            place = {RESIDUAL_LIMIT: solution.residual}
            place |= {QUANTITIES[name].limit: solution.peaks[name] for name in surface.axes[1:]}
            failures.append(FailedPoint(place, str(point)))
    settings: dict[str, Setting] = {
        "points": points,
        "steps": surface.program.steps,
        "grid": " x ".join(map(str, grid.shape)),
        "infeasible_cells": len(grid.infeasible),
        "cells_left_out": grid.left_out,
    }
    if residuals:
        settings["at"] = ", ".join(map(digits, residuals))
    task = surface.task
    return Front(
        task=task,
        profile=surface.program.profile,
        points=non_dominated(
            [point for point in certified if isinstance(point, FrontPoint)], surface.objectives
        ),
        record=surface.request.record("epsilon", grid.iterations, 0.0, **settings),
        reference=reference_corner(task, surface.objectives),
        failed=len(failures),
        failures=tuple(failures),
        objectives=surface.objectives,
    )


def _place(grid: Grid, cell: Cell) -> dict[str, float]:
    """The limits of a cell, by the names of their options."""
    sizes = {name: values[place] for (name, values), place in zip(grid.limits.items(), cell)}
    return {f"{name}_limit": size for name, size in sizes.items()}
