"""Solve programs from starts, by either solver, and say in SI units what came of it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Literal, NamedTuple, get_args

import daqp
import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.errors import SolveStatus
from quietarm.ocp.solvers.batch import Derivatives
from quietarm.ocp.solvers.interior import interior_point
from quietarm.ocp.solvers.program import Program, evaluated
from quietarm.ocp.solvers.solution import RESIDUAL, Scalarization, Solution
from quietarm.ocp.solvers.sqp import SHARP, WIDTHS, End, Rows, minimise
from quietarm.ocp.solvers.stack import Stack

Solver = Literal["sqp", "ipopt"]
SOLVERS: tuple[str, ...] = get_args(Solver)
_LITTLE = 1e-8
"""Curvature that makes a linear program a quadratic one."""
STOPPED = End.STOPPED.value
"""The reason of a solution that Ctrl-C ended."""
_NONE = 1e-8
"""A scaled state on arrival that is no larger counts as rest."""
_REACH, _WARM_REACH = 0.25, 0.02
"""How far the unknowns may move at first: minima of the paper's conditions lie within 0.2 of the
cycloid; and from a neighbouring minimum."""
_STATUS = {
    End.SOLVED: SolveStatus.OPTIMAL,
    End.CREEPING: SolveStatus.ACCEPTABLE,
    End.UNFINISHED: SolveStatus.ITERATION_LIMIT,
    End.INFEASIBLE: SolveStatus.INFEASIBLE,
    End.AGREED: SolveStatus.ITERATION_LIMIT,
    End.STOPPED: SolveStatus.ITERATION_LIMIT,
}


class Row(NamedTuple):
    """A program, what is asked of it, and coefficients to start from."""

    program: Program
    ask: Scalarization
    start: NDArray[np.float64]


class Solved(NamedTuple):
    """A solution for each row, and whether no Ctrl-C came on the way."""

    solutions: list[Solution]
    complete: bool


def solve(
    rows: Sequence[Row],
    solver: Solver = "sqp",
    *,
    warm: bool = False,
    groups: Sequence[int] | None = None,
) -> Solved:
    """Solve programs of one profile, number of steps and set of limits, each from its start.

    By `"sqp"` all rows go together, by `"ipopt"` one after another. Warm starts are beside minima;
    rows of one number in `groups` are starts of one program, as for `minimise`.
    """
    solutions: dict[int, Solution] = {}
    complete = True
    for places in _of_one_form(rows):
        stack = Stack([rows[i].program for i in places], [rows[i].ask for i in places])
        x = stack.start(np.array([rows[i].start for i in places]))
        if solver == "ipopt":
            ended = interior_point(stack, x, warm=warm)
        else:
            ended = minimise(
                stack.evaluate, x, stack.lower, stack.upper,
                linear=stack.linear,
                groups=None if groups is None else np.array([groups[i] for i in places]),
                widths=SHARP if warm else WIDTHS,
                reach=_WARM_REACH if warm else _REACH,
            )  # fmt: skip
        complete = complete and not ended.stopped
        solutions.update(
            zip(places, _in_units(stack, ended, [rows[i] for i in places]), strict=True)
        )
    return Solved([solutions[i] for i in range(len(rows))], complete)


def _of_one_form(rows: Sequence[Row]) -> Iterable[list[int]]:
    """The places of the rows that a stack takes together."""
    forms: dict[tuple[object, ...], list[int]] = {}
    for i, (program, ask, _) in enumerate(rows):
        free = np.isinf(ask.limits.get(RESIDUAL, np.inf))
        form = program.batch, ask.least, ask.at_rest, free, len(program.errors)
        forms.setdefault(form, []).append(i)
    return forms.values()


def _in_units(stack: Stack, ended: Rows, rows: Sequence[Row]) -> list[Solution]:
    """The rows as solutions."""
    coefficients = stack.coefficients(ended.x)
    boxes = np.array([row.program.profile.box(row.ask.bound) for row in rows])
    coefficients = np.clip(coefficients, boxes[:, 0], boxes[:, 1])  # passed by rounding
    found, programs = list[Solution](), [row.program for row in rows]
    for i, at in enumerate(evaluated(programs, coefficients)):
        program, ask, _ = rows[i]
        found.append(
            Solution(
                coefficients=coefficients[i],
                energy=float(at.energy[0]),
                peaks=_peaks(ended, i, program, ask, at),
                status=_STATUS[ended.ends[i]],
                iterations=int(ended.iterations[i]),
                arrival=at.arrival if ask.offset is None else at.arrival + ask.offset,
                prices=_prices(stack, ended, i, program, ask),
                reason=ended.ends[i].value,
            )
        )
    return found


def _peaks(
    ended: Rows, i: int, program: Program, ask: Scalarization, at: Derivatives
) -> dict[str, float]:
    """Peaks at the nodes; at rest the residual is none, to the solver's tolerance."""
    if ask.at_rest and ended.violation[i] <= _NONE:
        return {RESIDUAL: 0.0, **{name: program.peak(at, name) for name, _ in program.parts}}
    return program.peaks(at, ask.offset)


def _prices(
    stack: Stack, ended: Rows, i: int, program: Program, ask: Scalarization
) -> dict[str, float]:
    """What the least energy falls by if a limit is widened [J by its unit]."""
    prices, of_energy = dict[str, float](), stack.weights[i, 0]
    if of_energy == 0:
        return prices
    for name, part in stack.bounded.items():
        if name in ask.limits and name != ask.least:
            of = float(np.abs(ended.of_v[i, part]).sum())
            prices[name] = of / of_energy * program.energy / program.scale_of(name)
    if ask.at_rest:
        of_arrival = ended.of_c[i] / program.scale
        of = _price_of_rest(of_arrival, program.tip_rows[0])
        prices[RESIDUAL] = of / of_energy * program.energy
    return prices


def _price_of_rest(of_arrival: NDArray[np.float64], rests: NDArray[np.float64]) -> float:
    """The most that the objective falls by for a residual of 1 m, from its slope by the arrival.

    The largest product of that slope and a state on arrival whose residual is 1 m: a linear
    program, with a little curvature for the solver of quadratic ones.
    """
    scale = np.abs(rests).max(axis=0)
    slope, table = of_arrival / scale, rests / scale
    size, limit = len(slope), np.ones(len(table))
    steepest = np.abs(slope).max() or 1.0
    little = _LITTLE * np.eye(size)
    state, *_ = daqp.solve(little, -slope / steepest, table, limit, -limit)
    return float(slope @ np.asarray(state))
