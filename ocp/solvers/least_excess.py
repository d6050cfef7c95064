"""Find how near a motion can come to its limits, by one linear program after another.

Given its duration, a motion keeps its limits if their least excess is none. The excess is the share
by which all limits are widened alike; what has to hold exactly is the state on arrival, or the
residual's limit. Where the joint's path is linear in the coefficients and so is the plant, one
linear program gives the answer; elsewhere a few do, each linearised about the last one's motion.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import daqp
import numpy as np
from numpy.typing import NDArray

from quietarm.models.one_thread import on_one_thread
from quietarm.ocp.limits import RESIDUAL
from quietarm.ocp.solvers.batch import Derivatives
from quietarm.ocp.solvers.problem import Program

Array = NDArray[np.float64]


class Excess(NamedTuple):
    """The least excess of a problem's limits, the coefficients that have it, and whether it holds.

    Negative where all limits may be narrowed by that share. It holds where linearised and true
    excess agree. It is unsure where a linear program's motion does not arrive as it has to: that of
    the motion before says nothing of the least excess.
    """

    share: float
    coefficients: Array
    holds: bool
    is_unsure: bool

    def is_beyond(self, share: float) -> bool:
        """Return whether the limits surely have to be wider by more than a share."""
        # that far off linear programs need not agree with the motion
        hopeless = 1.0
        return not self.is_unsure and self.share > (share if self.holds else hopeless)


@on_one_thread
def least_excess(problem: Program, start: Array, reach: float = 3.0) -> Excess:
    """The least share by which all limits but the residual's have to be widened, from a start.

    Coefficients may move by the reach at first.
    """
    linearised = _Linearised(problem, start)
    # What a step may miss of the state on arrival, as a share of its scale; less with every step.
    funnel = 0.2
    # Of a motion that is the answer: how far linearised and true excess may differ, and what it
    # misses of the state on arrival, or of the residual's limit, as shares.
    agreement = 1e-4
    most_missed = 1e-4
    is_unsure = False
    for _ in range(12):
        step = linearised.step_of_least_excess(reach)
        if step is None:
            break
        following = _Linearised(problem, linearised.coefficients + step[:-1])
        near = following.missed <= most_missed
        if near and abs(following.excess - step[-1]) <= agreement:
            return Excess(following.excess, following.coefficients, holds=True, is_unsure=False)
        if following.missed <= max(linearised.missed, funnel):
            linearised = following
            funnel *= 0.5
        else:
            reach = 0.3 * float(np.abs(step[:-1]).max())
            is_unsure = True
    return Excess(linearised.excess, linearised.coefficients, holds=False, is_unsure=is_unsure)


class _Linearised:
    """A problem about a motion: rows of its limits, and of what is wanted on arrival."""

    def __init__(self, problem: Program, coefficients: Array) -> None:
        self.coefficients = coefficients
        self._box = problem.profile.box(problem.bound)
        motions = problem.evaluate(coefficients)
        self._limit_rows(problem, motions)
        self._arrival_rows(problem, motions)

    def _limit_rows(self, problem: Program, motions: Derivatives) -> None:
        """Values and their Jacobian as shares of the limits' sizes, and both bounds."""
        values = []
        tables = []
        uppers = []
        lowers = []
        for limit in problem.limits:
            if limit.name == RESIDUAL or not np.isfinite(limit.size):
                continue
            place = problem.batch.places[limit.name]
            counted = slice(None if limit.quantity.in_scenarios else 1)
            values.append(motions.limited[counted, place].ravel() / limit.size)
            table = motions.limited_jacobian[counted, place]
            tables.append(table.reshape(-1, table.shape[-1]) / limit.size)
            below, above = limit.sides
            uppers.append(np.full(len(values[-1]), above))
            lowers.append(np.full(len(values[-1]), below))
        self.values = np.concatenate(values)
        self.table = np.concatenate(tables)
        self.upper = np.concatenate(uppers)
        self.lower = np.concatenate(lowers)

    def _arrival_rows(self, problem: Program, motions: Derivatives) -> None:
        """Store the rows of the arrival: scaled states to be 0, or displacements within 1."""
        missed = motions.arrival - problem.wanted + problem.offset
        if problem.at_rest:
            scale = problem.arrival_scale
            self.arrival = missed[0] / scale
            self.arrival_table = motions.arrival_jacobian[0] / scale[:, None]
            self.allowed = 0.0
            return
        rows = list(zip(problem.tip_rows, missed, motions.arrival_jacobian))
        limit = problem.residual_limit
        self.arrival = np.concatenate([tips @ state / limit for tips, state, _ in rows])
        self.arrival_table = np.concatenate([tips @ table / limit for tips, _, table in rows])
        self.allowed = 1.0

    @property
    def excess(self) -> float:
        """The share by which the motion itself exceeds its limits."""
        return float(np.maximum(self.values / self.upper, self.values / self.lower).max()) - 1

    @property
    def missed(self) -> float:
        """Largest miss on arrival beyond what is allowed."""
        return float(np.abs(self.arrival).max(initial=0.0)) - self.allowed

    def step_of_least_excess(self, reach: float) -> Array | None:
        """The step within a reach, and then the linearised excess; None where there is none.

        Rows that the step exceeds join the program until there is none.
        """
        above = _Rows(self.table, self.upper - self.values, self.upper)
        below = _Rows(-self.table, self.values - self.lower, -self.lower)
        limits = above.and_(below)
        count = len(limits.room)
        chosen = np.zeros(count, dtype=bool)
        chosen[:: max(1, count // 200)] = True  # some 200 at first
        solution = None
        needed = None
        tolerated = 1e-5
        for _ in range(20):
            solution = self._solve(limits, np.flatnonzero(chosen), reach)
            if solution is None:
                return None
            needed = limits.excess_at(solution[:-1])
            if needed.max() <= solution[-1] + tolerated:
                break
            chosen |= _peaks(needed, solution[-1] + tolerated)
        assert solution is not None  # there is a round
        assert needed is not None
        return np.append(solution[:-1], needed.max())

    def _solve(self, limits: _Rows, chosen: NDArray[np.intp], reach: float) -> Array | None:
        """The step and the excess that least exceeds the chosen rows."""
        size = len(self.coefficients)
        most = np.minimum(reach, self._box[1] - self.coefficients)
        least = np.maximum(-reach, self._box[0] - self.coefficients)
        arrival = np.pad(self.arrival_table, ((0, 0), (0, 1)))
        rows = np.column_stack([limits.table[chosen], -limits.give[chosen]])
        table = np.vstack([arrival, rows])
        unlimited = np.full(len(chosen), np.inf)
        upper = np.concatenate([most, [np.inf], self.allowed - self.arrival, limits.room[chosen]])
        lower = np.concatenate([least, [-1.0], -self.allowed - self.arrival, -unlimited])
        marks = np.zeros(len(upper), dtype=np.int32)
        equality = 5  # by DAQP's convention, as is `solved`
        if self.allowed == 0:
            marks[size + 1 : size + 1 + len(arrival)] = equality
        # Curvature that makes a linear program a quadratic one, whose answer is unique; the
        # excess differs by less than 1e-5 from that of the linear program.
        tie = 1e-3
        excess = np.append(np.zeros(size), 1.0)
        solution, _, flag, _ = daqp.solve(
            tie * np.eye(size + 1), excess, table, upper, lower, marks
        )
        solved = 1
        if flag == solved:
            return np.asarray(solution)
        # Of a slow limit the plain motion is many times above, rows have entries of 1e4 and more:
        # by these and the curvature DAQP comes no nearer to them than 1e-5.
        return _solve_linear(excess, table, upper, lower)


def _solve_linear(costs: Array, table: Array, upper: Array, lower: Array) -> Array | None:
    """Solve a linear program by HiGHS, which scales it; None if there is no solution.

    Bounds are of the unknowns, then of the rows of the table.
    """
    from scipy.optimize import Bounds, LinearConstraint, milp  # not at the top: takes long to load

    # scipy's types say nothing of arrays
    low: list[Any] = np.split(lower, [len(costs)])
    high: list[Any] = np.split(upper, [len(costs)])
    result = milp(
        costs,
        bounds=Bounds(low[0], high[0]),
        constraints=LinearConstraint(table, low[1], high[1]),
    )
    return result.x


class _Rows(NamedTuple):
    """Linear limits: table times the step is at most the room, and the excess times what gives."""

    table: Array
    room: Array
    give: Array

    def and_(self, more: _Rows) -> _Rows:
        """Join these rows and others."""
        return _Rows(*map(np.concatenate, zip(self, more)))

    def excess_at(self, step: Array) -> Array:
        """The excess that a step needs of each row."""
        return (self.table @ step - self.room) / self.give


def _peaks(values: Array, above: float) -> NDArray[np.bool_]:
    """Return the places of values above a level that are no smaller than their neighbours."""
    before = np.append(-np.inf, values[:-1])
    after = np.append(values[1:], -np.inf)
    return (values > above) & (values >= before) & (values >= after)
