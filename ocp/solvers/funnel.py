"""Sequential quadratic programming: many small nonlinear programs, a row each, side by side.

Every row minimises f(x) with c(x) = 0 and lower <= v(x) <= upper. In an iteration all rows are
evaluated in one call; each solves a quadratic program of its own within a trust region.

- Curvature is exact. Along the linearised equalities, where it has to be positive, negative
  curvature counts as positive.
- A step is accepted by a funnel (Kiessling, Leyffer and Vanaret, 2024, after Gould and Toint,
  2010): the violation of the constraints stays within a width that shrinks; where the model
  promises more than feasibility can cost, the objective has to fall. Unlike a merit function this
  has no weight that could be too large to see the objective, or too small to see 1e-9 m.
- A step that is not accepted for the curvature of the constraints is corrected to second order
  (Nocedal and Wright, Numerical Optimization, 2nd ed., section 18.3).
- The objective has kinks that a quadratic model does not see before it is beyond them: where the
  power, hardly away from zero, changes its sign. So it is rounded off over a width that shrinks
  from stage to stage, as the barrier does it for an interior-point method; the last stage has none.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.solvers.quadratic import Model, Multipliers, Steps, convexify, least_steps

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Flags = NDArray[np.bool_]

WIDTHS = (0.5, 0.15, 0.05, 0.015, 0.005, 0.0)
"""Widths over which the objective is rounded off, stage by stage."""
SHARP = (0.0,)
"""The widths for a start next to a minimum."""
_FINE = 1e-2
"""A stage ends where the model promises less than this share of its width."""
_MET = 1e-10
"""A row is solved with no larger violation."""
FEASIBLE = 1e-7
"""A row that ends otherwise is feasible with no larger violation."""
_NEAR = 1e-3
"""A stage ends with no larger violation."""
_FUNNEL = 0.9
_DESCENT = 1e-4
_SWITCH = 0.1
"""Share of the funnel's width to stay within, of the promised descent to reach, and of the squared
violation that a promise has to exceed for the descent to count."""
_SMALLEST = 1e-9
_SHRINK = (0.1, 0.5)
_GROW = 2.5
"""Least radius of a trust region; limits of the factor by which it shrinks; by which it grows."""
_PATIENCE = 40
_CREEP = 1e-5
"""A row creeps where in so many iterations f falls by less than this share."""
_ALIKE = 1e-6
"""Rows whose f differ by no more than this share agree."""
_MEETING = 2e-3
"""Rows whose points are no farther apart in the same stage, past the first, go on as one."""

Evaluate = Callable[[Index, Array, Multipliers, Array], Model]
"""(rows, points, multipliers, widths) -> model at these points."""


_LOG_HEAD = "iter  starts   objective  violation     radius  smoothing"
_LOG_LINE = "{:4}{:8}{:12.6f}{:11.1e}{:11.1e}{:11.3f}"


class End(Enum):
    """How a row ended."""

    SOLVED = "a local optimum"
    CREEPING = "feasible, and hardly better for many iterations"
    VANISHED = "feasible, and no step within the trust region is better"
    INFEASIBLE = "no smaller violation nearby"
    UNFINISHED = "the iterations ran out"
    AGREED = "stopped, since another start led to the same point, or others agreed"


class Course(NamedTuple):
    """How rows are led to their minima.

    The objective is smoothed over the widths, one after another, the last of them 0. Trust regions
    have the radius `reach` at first. A row is solved where the model promises less than the
    `tolerance`, as a share of f; it has at most so many iterations. With a `log` each is a line.
    """

    widths: tuple[float, ...] = WIDTHS
    reach: float = 0.25
    tolerance: float = 1e-9
    iterations: int = 500
    log: bool = False


COURSE = Course()


@dataclass(frozen=True)
class Ended:
    """Where the rows ended: points (rows, n), multipliers, why, after how many iterations (rows,).

    The violation (rows,) is the largest distance from c = 0 and from the bounds of v.
    """

    x: Array
    violation: Array
    multipliers: Multipliers
    ends: list[End]
    iterations: NDArray[np.intp]


def minimise(
    evaluate: Evaluate,
    x: Array,
    lower: Array,
    upper: Array,
    *,
    equalities: int = 0,
    linear: int = 0,
    groups: Index | None = None,
    course: Course = COURSE,
) -> Ended:
    """Minimise every row from its start, with so many equalities and lower <= v <= upper.

    The last `linear` entries of v are linear and kept from the start on. Rows of one number in
    `groups` are starts of one program: once half of them, and more than one, agree on the least f,
    the others are stopped.
    """
    run = _Run(evaluate, x, lower, upper, equalities, linear, groups, course)
    if course.log:
        print(_LOG_HEAD)
    for number in range(course.iterations):
        if not len(run.going):
            break
        if course.log:
            print(run.log_line(number))
        run.iterate()
    ends = [End.UNFINISHED if end is None else end for end in run.ends]
    return Ended(run.x, run.violation, run.multipliers, ends, run.iterations)


class _Run:
    """The rows on their way. Arrays by row; `model` has those of the rows still `going`."""

    def __init__(
        self,
        evaluate: Evaluate,
        x: Array,
        lower: Array,
        upper: Array,
        equalities: int,
        linear: int,
        groups: Index | None,
        course: Course,
    ) -> None:
        self.evaluate = evaluate
        self.x = x.copy()
        self.lower = lower
        self.upper = upper
        self.linear = linear
        self.groups = groups
        self.widths = np.array(course.widths)
        self.tolerance = course.tolerance
        rows, k = lower.shape
        self.going = np.arange(rows)
        self.stage = np.zeros(rows, dtype=int)
        self.ends: list[End | None] = [None] * rows
        self.iterations = np.zeros(rows, dtype=int)
        self.count = np.ones(rows, dtype=int)  # of the starts that lead here
        self.multipliers = Multipliers(np.zeros((rows, equalities)), np.zeros((rows, k)))
        self.model = evaluate(self.going, x, self.multipliers, self.width(self.going))
        self.f = self.model.objective.copy()
        self.violation = self._violation(self.going, self.model)
        self.funnel = np.maximum(0.1, 1.1 * self.violation)
        self.radius = np.full(rows, course.reach)
        self.mark = self.f.copy()
        self.marked = np.zeros(rows, dtype=int)

    def width(self, rows: Index) -> Array:
        return self.widths[self.stage[rows]]

    def log_line(self, number: int) -> str:
        """Of the row with the least objective, scaled; and how many are going."""
        row = self.going[[np.argmin(self.f[self.going])]]
        values = *self.f[row], *self.violation[row], *self.radius[row], *self.width(row)
        return _LOG_LINE.format(number, len(self.going), *values)

    def iterate(self) -> None:
        """One iteration of all rows that are going."""
        rows = self.going
        model = self.model
        self.iterations[rows] += 1
        hessian = convexify(model)
        every = np.arange(len(rows))
        step = self._steps(rows, model._replace(hessian=hessian))
        promised = -np.einsum("rn,rn->r", model.gradient, step.d)
        promised -= 0.5 * np.einsum("rn,rnm,rm->r", step.d, hessian, step.d)
        sharper = self._sharper(step, promised)
        width = self.widths[self.stage[rows] + sharper]
        trial = self.evaluate(rows, self.x[rows] + step.d, step.multipliers, width)
        good = self._accepted(every, step, step.d, promised, trial)
        # of another width f says nothing; so small a step need not lower it
        after = self._violation(rows, trial)
        good = np.where(sharper, after <= np.maximum(self.funnel[rows], _MET), good)
        self._correct(hessian, step, promised, trial, good)
        for_f = (promised > _SWITCH * self.violation[rows] ** 2) & ~sharper
        size = np.abs(step.d).max(axis=1)
        bound = size > 0.99 * self.radius[rows]
        self._resize(good, for_f, bound, size, promised, self.model.objective - trial.objective)
        self._move(good, for_f, step, trial)
        self.stage[rows] += sharper & good
        self.mark[rows[sharper]] = np.inf
        small = (np.abs(promised) <= self.tolerance * np.abs(model.objective)) & ~bound & step.met
        self._end(small & ~sharper & (self.violation[rows] <= _MET) & (width == 0))

    def _sharper(self, step: Steps, promised: Array) -> Flags:
        """Which rows go on to the next stage with this step."""
        rows = self.going
        width = self.width(rows)
        little = np.abs(promised) <= _FINE * width * np.abs(self.model.objective)
        return step.met & (width > 0) & (self.violation[rows] <= _NEAR) & little

    def _violation(self, rows: Index, model: Model) -> Array:
        return _farthest(model.equality, model.bounded, self.lower[rows], self.upper[rows])

    def _accepted(
        self, which: Index, step: Steps, d: Array, promised: Array, trial: Model
    ) -> Flags:
        """Whether the rows at these places of the model accept their steps d."""
        rows = self.going[which]
        model = self.model.take(which)
        before = self.violation[rows]
        after = self._violation(rows, trial)
        with np.errstate(invalid="ignore"):
            size = np.abs(model.objective)
            descends = model.objective - trial.objective >= _DESCENT * promised - 1e-13 * size
            within = after <= np.maximum(self.funnel[rows], _MET)
            nearer = after <= np.maximum(_FUNNEL * self.funnel[rows], _MET)
            # far from feasible a large step may cost any f, and lead to another minimum
            cheap = trial.objective <= model.objective + size + 0.5
            for_f = promised > _SWITCH * before**2
            good = np.where(for_f, within & descends, nearer & cheap)
            linearised = _farthest(
                model.equality + _times(model.equality_jacobian, d),
                model.bounded + _times(model.bounded_jacobian, d),
                self.lower[rows],
                self.upper[rows],
            )
            restores = (after < before) & (before - after >= 0.1 * (before - linearised))
            good = np.where(step.met[which], good, restores)
        return good & np.isfinite(trial.objective) & np.isfinite(after)

    def _correct(
        self, hessian: Array, step: Steps, promised: Array, trial: Model, good: Flags
    ) -> None:
        """Second-order corrections of the steps that are not good."""
        missed = self._violation(self.going, trial) > _MET
        again = np.flatnonzero(~good & missed & np.isfinite(trial.objective))
        if not again.size:
            return
        rows = self.going[again]
        d = step.d[again]
        model = self.model.take(again)
        bent = model._replace(
            equality=trial.equality[again] - _times(model.equality_jacobian, d),
            bounded=trial.bounded[again] - _times(model.bounded_jacobian, d),
            hessian=hessian[again],
        )
        corrected = self._steps(rows, bent)
        multipliers = step.multipliers.take(again)
        second = self.evaluate(rows, self.x[rows] + corrected.d, multipliers, self.width(rows))
        better = self._accepted(again, step, corrected.d, promised[again], second)
        better &= corrected.met | ~step.met[again]
        good[again[better]] = True
        step.d[again[better]] = corrected.d[better]
        trial.put(again[better], second.take(better))

    def _resize(
        self, good: Flags, for_f: Flags, bound: Flags, size: Array, promised: Array, gained: Array
    ) -> None:
        """Trust regions that shrink to where a parabola through f has its least, or grow."""
        share = np.where(for_f, gained / np.where(promised == 0, 1.0, promised), -1.0)
        share = np.nan_to_num(share, nan=-1e3, posinf=1.0, neginf=-1e3)
        shrunk = size * np.clip(0.5 / (1 - np.minimum(share, 0.5)), *_SHRINK)
        radius = self.radius[self.going]
        growing = good & bound & ((share > 0.75) | ~for_f)
        poor = good & for_f & (share < 0.25)
        kept = np.where(growing, _GROW * radius, np.where(poor, 0.5 * radius, radius))
        self.radius[self.going] = np.where(good, kept, np.minimum(shrunk, radius))

    def _move(self, good: Flags, for_f: Flags, step: Steps, trial: Model) -> None:
        rows = self.going
        self.multipliers.put(rows, step.multipliers)
        moved = rows[good]
        self.x[moved] += step.d[good]
        self.model.put(np.flatnonzero(good), trial.take(good))
        self.violation[moved] = self._violation(moved, trial.take(good))
        self.f[moved] = trial.objective[good]
        nearer = rows[good & ~for_f]
        self.funnel[nearer] = 0.45 * self.funnel[nearer] + 0.5 * self.violation[nearer]

    def _end(self, solved: Flags) -> None:
        """Drop the rows that are solved, stuck, creeping, or left because others agree."""
        rows = self.going
        for row in rows[solved]:
            self.ends[row] = End.SOLVED
        for row in rows[~solved & (self.radius[rows] < _SMALLEST)]:
            kept = self.violation[row] <= FEASIBLE
            self.ends[row] = End.VANISHED if kept else End.INFEASIBLE
        due = rows[self.iterations[rows] - self.marked[rows] >= _PATIENCE]
        slow = due[self.mark[due] - self.f[due] <= _CREEP * np.abs(self.f[due])]
        for row in slow[self.violation[slow] <= FEASIBLE]:
            self.ends[row] = self.ends[row] or End.CREEPING
        self.mark[due], self.marked[due] = self.f[due], self.iterations[due]
        if self.groups is not None:
            self._leave(bool(solved.any()))
        stays = np.array([self.ends[row] is None for row in rows])
        if not stays.all():
            self.going = rows[stays]
            self.model = self.model.take(stays)

    def _leave(self, anew: bool) -> None:
        """Leave rows that have met another of their group, or whose others agree."""
        assert self.groups is not None
        for group in np.unique(self.groups[self.going]):
            own = np.flatnonzero(self.groups == group)
            going = [row for row in own if self.ends[row] is None]
            going.sort(key=self.f.__getitem__)
            for row in going[1:]:
                first = going[0]
                same = self.stage[row] == self.stage[first] > 0
                near = np.abs(self.x[row] - self.x[first]).max() <= _MEETING
                if same and near and self.f[row] <= self.f[first] * (1 + _MEETING):
                    self.ends[row] = End.AGREED
                    self.count[first] += self.count[row]
            done = [row for row in own if self.ends[row] is End.SOLVED]
            least = self.f[done].min(initial=np.inf)
            agree = self.count[done][self.f[done] <= least * (1 + _ALIKE)].sum()
            if anew and agree >= max(2, len(own) / 2):
                for row in going:
                    self.ends[row] = self.ends[row] or End.AGREED

    def _steps(self, rows: Index, model: Model) -> Steps:
        """Solve the quadratic programs of rows whose models these are."""
        bounds = self.lower[rows], self.upper[rows]
        return least_steps(model, *bounds, self.radius[rows], self.linear)


def _times(matrices: Array, d: Array) -> Array:
    return np.einsum("rkn,rn->rk", matrices, d)


def _farthest(c: Array, v: Array, lower: Array, upper: Array) -> Array:
    """The largest distance from c = 0 and from the bounds of v."""
    beyond = np.maximum(np.maximum(v - upper, lower - v), 0.0)
    return np.maximum(np.abs(c).max(axis=1, initial=0.0), beyond.max(axis=1, initial=0.0))
