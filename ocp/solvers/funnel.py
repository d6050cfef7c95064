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

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, ClassVar, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.solvers.quadratic import Model, Multipliers, Steps, convexify, least_steps

if TYPE_CHECKING:
    from quietarm.ocp.solvers.sqp import Sqp

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Flags = NDArray[np.bool_]

WIDTHS = (0.5, 0.15, 0.05, 0.015, 0.005, 0.0)
"""Widths over which the objective is rounded off, stage by stage."""
SHARP = (0.0,)
"""The widths for a start next to a minimum."""


class RowPrograms(Protocol):
    """The programs to solve, a row each: so many equalities c = 0, and lower <= v <= upper.

    The last `linear` entries of v are linear.
    """

    @property
    def equalities(self) -> int:
        """The number of entries of c."""
        ...

    @property
    def linear(self) -> int:
        """The number of linear entries of v."""
        ...

    @property
    def lower(self) -> Array:
        """Shape (rows, entries of v)."""
        ...

    @property
    def upper(self) -> Array:
        """Shape (rows, entries of v)."""
        ...

    def evaluate(self, rows: Index, x: Array, multipliers: Multipliers, width: Array) -> Model:
        """Models of these rows at points, of the objectives rounded off over widths."""
        ...


class End(Enum):
    """The ways in which a row can end."""

    SOLVED = "a local optimum"
    CREEPING = "feasible, and hardly better for many iterations"
    VANISHED = "feasible, and no step within the trust region is better"
    INFEASIBLE = "no smaller violation nearby"
    UNFINISHED = "the iterations ran out"
    AGREED = "stopped, since another start led to the same point, or others agreed"


class Course(NamedTuple):
    """Settings by which rows are led to their minima.

    By the options of a solver: a row is solved where the model promises less than its tolerance, as
    a share of f; it has at most so many iterations, and with a log each is a line. The objective is
    smoothed over the widths, one after another, the last of them 0. Trust regions have the radius
    `reach` at first.
    """

    solver: Sqp
    widths: tuple[float, ...] = WIDTHS
    reach: float = 0.25


@dataclass(frozen=True)
class Ended:
    """The ends of the rows: points (rows, n), multipliers, reasons, numbers of iterations (rows,).

    The violation (rows,) is the largest distance from c = 0 and from the bounds of v.
    """

    x: Array
    violation: Array
    multipliers: Multipliers
    ends: list[End]
    iterations: NDArray[np.intp]


def minimise(
    programs: RowPrograms,
    x: Array,
    course: Course,
    *,
    groups: Index | None = None,
) -> Ended:
    """Minimise every row from its start.

    Parameters
    ----------
    programs : RowPrograms
        What is minimised. The linear entries of v are within their bounds from the start on.
    x : ndarray, shape (rows, n)
        The starts.
    course : Course
        How they are led.
    groups : ndarray, shape (rows,), optional
        Rows of one number are starts of one program: once half of them, and more than one, agree on
        the least f, the others are stopped.
    """
    solver = course.solver
    descent = _Descent(programs, x, groups, course)
    if solver.log:
        print("iter  starts   objective  violation     radius  smoothing")
    for number in range(solver.iterations):
        if not len(descent.going):
            break
        if solver.log:
            print(descent.log_line(number))
        descent.iterate()
    ends = [End.UNFINISHED if end is None else end for end in descent.ends]
    return Ended(
        descent.x,
        descent.violation,
        descent.multipliers,
        ends,
        descent.iterations,
    )


class _TriedSteps(NamedTuple):
    """A step of each row that is going, and what comes of it.

    `promised` is the descent of the quadratic model, `sharper` whether the row goes on to the next
    stage, `trial` the model after the step, `for_f` whether the objective has to fall, and `good`
    whether the step is accepted. A correction changes step, trial and good in place.
    """

    step: Steps
    promised: Array
    sharper: Flags
    trial: Model
    for_f: Flags
    good: Flags

    @property
    def size(self) -> Array:
        """The largest change of an unknown."""
        return np.abs(self.step.d).max(axis=1)


class _Descent:
    """The rows on their way. Arrays by row; `model` has those of the rows still `going`."""

    fine: ClassVar[float] = 1e-2
    """A stage ends where the model promises less than this share of its width,"""
    near: ClassVar[float] = 1e-3
    """and with no larger violation."""
    met: ClassVar[float] = 1e-10
    """A row is solved with no larger violation."""
    feasible: ClassVar[float] = 1e-7
    """A row that ends otherwise is feasible with no larger violation."""
    within: ClassVar[float] = 0.9
    """Share of the funnel's width to stay within, where f may rise."""
    least_descent: ClassVar[float] = 1e-4
    """Share of the promised descent to reach."""
    switch: ClassVar[float] = 0.1
    """Share of the squared violation that a promise has to exceed for the descent to count."""
    smallest: ClassVar[float] = 1e-9
    """Least radius of a trust region."""
    shrink: ClassVar[tuple[float, float]] = (0.1, 0.5)
    """Least and largest factor by which it shrinks."""
    grow: ClassVar[float] = 2.5
    """Factor by which it grows."""
    patience: ClassVar[int] = 40
    creep: ClassVar[float] = 1e-5
    """A row creeps where in so many iterations f falls by less than this share."""
    alike: ClassVar[float] = 1e-6
    """Rows whose f differ by no more than this share agree."""
    meeting: ClassVar[float] = 2e-3
    """Rows whose points are no farther apart in the same stage, past the first, go on as one."""

    def __init__(
        self, programs: RowPrograms, x: Array, groups: Index | None, course: Course
    ) -> None:
        self.programs = programs
        self.x = x.copy()
        self.groups = groups
        self.widths = np.array(course.widths)
        self.tolerance = course.solver.tolerance
        rows, bounded = programs.lower.shape
        self.going = np.arange(rows)
        self.stage = np.zeros(rows, dtype=int)
        self.ends: list[End | None] = [None] * rows
        self.iterations = np.zeros(rows, dtype=int)
        self.count = np.ones(rows, dtype=int)  # of the starts that lead here
        self.multipliers = Multipliers(
            np.zeros((rows, programs.equalities)),
            np.zeros((rows, bounded)),
        )
        self.model = programs.evaluate(
            self.going,
            x,
            self.multipliers,
            self.width(self.going),
        )
        self.f = self.model.objective.copy()
        self.violation = self._violation(self.going, self.model)
        self.funnel = np.maximum(0.1, 1.1 * self.violation)
        self.radius = np.full(rows, course.reach)
        # f, and the number of the iteration, since when a row may creep
        self.mark = self.f.copy()
        self.marked = np.zeros(rows, dtype=int)

    def width(self, rows: Index) -> Array:
        return self.widths[self.stage[rows]]

    def log_line(self, number: int) -> str:
        """Describe the row with the least objective, scaled, and how many rows are going."""
        row = self.going[np.argmin(self.f[self.going])]
        return (
            f"{number:4}{len(self.going):8}{self.f[row]:12.6f}{self.violation[row]:11.1e}"
            f"{self.radius[row]:11.1e}{self.widths[self.stage[row]]:11.3f}"
        )

    def iterate(self) -> None:
        """One iteration of all rows that are going."""
        rows = self.going
        self.iterations[rows] += 1
        hessian = convexify(self.model)
        attempt = self._attempt(hessian)
        self._correct(hessian, attempt)
        at_side = attempt.size > 0.99 * self.radius[rows]
        self._resize(attempt, at_side)
        self._move(attempt)
        scale = np.abs(self.model.objective)
        small = (np.abs(attempt.promised) <= self.tolerance * scale) & ~at_side & attempt.step.met
        last = ~attempt.sharper & (self.width(rows) == 0)
        self._end(small & last & (self.violation[rows] <= self.met))

    def _attempt(self, hessian: Array) -> _TriedSteps:
        """The step of least quadratic model, and whether it is accepted."""
        rows = self.going
        model = self.model
        step = self._steps(rows, model._replace(hessian=hessian))
        promised = -np.einsum("rn,rn->r", model.gradient, step.d)
        promised -= 0.5 * np.einsum("rn,rnm,rm->r", step.d, hessian, step.d)
        sharper = self._sharper(step, promised)
        width = self.widths[self.stage[rows] + sharper]
        trial = self.programs.evaluate(
            rows,
            self.x[rows] + step.d,
            step.multipliers,
            width,
        )
        good = self._accepted(np.arange(len(rows)), step, step.d, promised, trial)
        # of another width f says nothing; so small a step need not lower it
        violation = self._violation(rows, trial)
        good = np.where(
            sharper,
            violation <= np.maximum(self.funnel[rows], self.met),
            good,
        )
        for_f = (promised > self.switch * self.violation[rows] ** 2) & ~sharper
        return _TriedSteps(step, promised, sharper, trial, for_f, good)

    def _sharper(self, step: Steps, promised: Array) -> Flags:
        """Return which rows go on to the next stage with this step."""
        rows = self.going
        width = self.width(rows)
        little = np.abs(promised) <= self.fine * width * np.abs(self.model.objective)
        return step.met & (width > 0) & (self.violation[rows] <= self.near) & little

    def _violation(self, rows: Index, model: Model) -> Array:
        return self._farthest(rows, model.equality, model.bounded)

    def _farthest(self, rows: Index, c: Array, v: Array) -> Array:
        """The largest distance from c = 0 and from the bounds of v."""
        lower = self.programs.lower[rows]
        upper = self.programs.upper[rows]
        beyond = np.maximum(np.maximum(v - upper, lower - v), 0.0)
        return np.maximum(np.abs(c).max(axis=1, initial=0.0), beyond.max(axis=1, initial=0.0))

    def _accepted(
        self,
        places: Index,
        step: Steps,
        d: Array,
        promised: Array,
        trial: Model,
    ) -> Flags:
        """Return which rows at these places of the model accept their steps d."""
        rows = self.going[places]
        model = self.model.take(places)
        before = self.violation[rows]
        after = self._violation(rows, trial)
        with np.errstate(invalid="ignore"):
            size = np.abs(model.objective)
            descends = (
                model.objective - trial.objective >= self.least_descent * promised - 1e-13 * size
            )
            within = after <= np.maximum(self.funnel[rows], self.met)
            nearer = after <= np.maximum(self.within * self.funnel[rows], self.met)
            # far from feasible a large step may cost any f, and lead to another minimum
            cheap = trial.objective <= model.objective + size + 0.5
            for_f = promised > self.switch * before**2
            good = np.where(for_f, within & descends, nearer & cheap)
            linearised = self._farthest(
                rows,
                model.equality + _times(model.equality_jacobian, d),
                model.bounded + _times(model.bounded_jacobian, d),
            )
            restores = (after < before) & (before - after >= 0.1 * (before - linearised))
            good = np.where(step.met[places], good, restores)
        return good & np.isfinite(trial.objective) & np.isfinite(after)

    def _correct(self, hessian: Array, attempt: _TriedSteps) -> None:
        """Second-order corrections of the steps that are not good."""
        step = attempt.step
        trial = attempt.trial
        missed = self._violation(self.going, trial) > self.met
        again = np.flatnonzero(~attempt.good & missed & np.isfinite(trial.objective))
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
        second = self.programs.evaluate(
            rows,
            self.x[rows] + corrected.d,
            step.multipliers.take(again),
            self.width(rows),
        )
        promised = attempt.promised[again]
        better = self._accepted(again, step, corrected.d, promised, second)
        better &= corrected.met | ~step.met[again]
        attempt.good[again[better]] = True
        step.d[again[better]] = corrected.d[better]
        trial.put(again[better], second.take(better))

    def _resize(self, attempt: _TriedSteps, at_side: Flags) -> None:
        """Trust regions that shrink to where a parabola through f has its least, or grow."""
        good = attempt.good
        for_f = attempt.for_f
        gained = self.model.objective - attempt.trial.objective
        promised = np.where(attempt.promised == 0, 1.0, attempt.promised)
        share = np.where(for_f, gained / promised, -1.0)
        share = np.nan_to_num(share, nan=-1e3, posinf=1.0, neginf=-1e3)
        shrunk = attempt.size * np.clip(0.5 / (1 - np.minimum(share, 0.5)), *self.shrink)
        radius = self.radius[self.going]
        growing = good & at_side & ((share > 0.75) | ~for_f)
        poor = good & for_f & (share < 0.25)
        following = np.where(poor, 0.5 * radius, radius)
        following = np.where(growing, self.grow * radius, following)
        self.radius[self.going] = np.where(good, following, np.minimum(shrunk, radius))

    def _move(self, attempt: _TriedSteps) -> None:
        """Take the good steps."""
        rows = self.going
        good = attempt.good
        reached = attempt.trial.take(good)
        self.multipliers.put(rows, attempt.step.multipliers)
        moved = rows[good]
        self.x[moved] += attempt.step.d[good]
        self.model.put(np.flatnonzero(good), reached)
        self.violation[moved] = self._violation(moved, reached)
        self.f[moved] = reached.objective
        nearer = rows[good & ~attempt.for_f]
        self.funnel[nearer] = 0.45 * self.funnel[nearer] + 0.5 * self.violation[nearer]
        self.stage[rows] += attempt.sharper & good
        self.mark[rows[attempt.sharper]] = np.inf

    def _end(self, solved: Flags) -> None:
        """Drop the rows that are solved, stuck, creeping, or left because others agree."""
        rows = self.going
        for row in rows[solved]:
            self.ends[row] = End.SOLVED
        for row in rows[~solved & (self.radius[rows] < self.smallest)]:
            is_feasible = self.violation[row] <= self.feasible
            self.ends[row] = End.VANISHED if is_feasible else End.INFEASIBLE
        due = rows[self.iterations[rows] - self.marked[rows] >= self.patience]
        slow = due[self.mark[due] - self.f[due] <= self.creep * np.abs(self.f[due])]
        for row in slow[self.violation[slow] <= self.feasible]:
            self.ends[row] = self.ends[row] or End.CREEPING
        self.mark[due] = self.f[due]
        self.marked[due] = self.iterations[due]
        if self.groups is not None:
            for group in np.unique(self.groups[rows]):
                self._leave(np.flatnonzero(self.groups == group), bool(solved.any()))
        stays = np.array([self.ends[row] is None for row in rows])
        if not stays.all():
            self.going = rows[stays]
            self.model = self.model.take(stays)

    def _leave(self, group: Index, anew: bool) -> None:
        """Leave rows of a group that have met another of it, or whose others agree."""
        going = [row for row in group if self.ends[row] is None]
        going.sort(key=self.f.__getitem__)
        for row in going[1:]:
            first = going[0]
            same = self.stage[row] == self.stage[first] > 0
            near = np.abs(self.x[row] - self.x[first]).max() <= self.meeting
            if same and near and self.f[row] <= self.f[first] * (1 + self.meeting):
                self.ends[row] = End.AGREED
                self.count[first] += self.count[row]
        done = [row for row in group if self.ends[row] is End.SOLVED]
        least = self.f[done].min(initial=np.inf)
        agree = self.count[done][self.f[done] <= least * (1 + self.alike)].sum()
        if anew and agree >= max(2, len(group) / 2):
            for row in going:
                self.ends[row] = self.ends[row] or End.AGREED

    def _steps(self, rows: Index, model: Model) -> Steps:
        """Solve the quadratic programs of rows whose models these are."""
        lower = self.programs.lower[rows]
        upper = self.programs.upper[rows]
        return least_steps(
            model,
            lower,
            upper,
            self.radius[rows],
            self.programs.linear,
        )


def _times(matrices: Array, d: Array) -> Array:
    return np.einsum("rkn,rn->rk", matrices, d)
