"""A problem's function that keeps what it is asked, by a search of quietarm or another library."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.interrupts import interruptible
from quietarm.metaheuristics.archive import Archive
from quietarm.metaheuristics.evaluation.noise import Noise, times_evaluated
from quietarm.metaheuristics.evaluation.population import UNUSABLE
from quietarm.metaheuristics.problems.function import MoveFunction
from quietarm.metaheuristics.problems.problem_function import ProblemFunction, Rows
from quietarm.ocp import Front, JointProfile, PointToPoint
from quietarm.ocp.checks import instance, table_of, takes, whole
from quietarm.ocp.front.points import Entries, FrontPoint, beyond
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY
from quietarm.ocp.record import Record, Setting

Array = NDArray[np.float64]
Places = NDArray[np.int64]
_OF_PROBLEM = (
    "task", "profile", "bound", "lower", "upper", "variables", "objectives", "units", "constraints",
    "reference",
)  # fmt: skip
BLOCK = 10_000
"""Candidates that are evaluated at once: more would fill the memory and be no faster."""


class BudgetSpentError(BaseException):
    """Every candidate is spent, or no more are asked for: the search is over, wherever it was.

    No failure: a method that goes on after any Exception ends as well.
    """


class RecordedFunction(ProblemFunction):
    """A problem's function that records every candidate that no earlier one dominates.

    It has the accuracy of all searches.

    Parameters
    ----------
    task : PointToPoint or ProblemFunction
        The move; or any function of candidates, as a `GivenFunction`, which says all up to
        `threads` itself.
    profile, bound, objectives, threads
        As of a `MoveFunction`.
    budget : float
        Evaluations in all: the last call is cut short, and raises `BudgetSpentError`.
    problem : str
        Name of the problem, which a front then states.
    noise : float
        Standard deviation of residual and energy, as a share: each evaluation has its own. Peaks
        and violations have none. The front at the end has the true values, as ever.
    reevaluate : int
        How often a candidate is evaluated that no earlier one dominates; its mean counts, and each
        evaluation. A user's own function is called again, with or without such noise.
    seed : int
        Seed of the noise.

    Attributes
    ----------
    failed, infeasible : int
        Candidates so far whose values were not finite, and that violated a limit.
    after_call : callable, optional
        Called each time that candidates were evaluated and kept.
    """

    @takes(profile=JointProfile)
    def __init__(
        self,
        task: PointToPoint | ProblemFunction,
        profile: JointProfile | None = None,
        *,
        bound: float | None = None,
        objectives: Sequence[str] = RESIDUAL_AND_ENERGY,
        threads: int = 1,
        budget: float = inf,
        problem: str = "",
        noise: float = 0.0,
        reevaluate: int = 1,
        seed: int = 0,
    ) -> None:
        asked: PointToPoint | ProblemFunction = instance(
            "task", task, PointToPoint, ProblemFunction
        )
        problem_function: Any
        if isinstance(asked, ProblemFunction):
            problem_function = asked
        else:
            problem_function = MoveFunction(
                asked, profile, bound=bound, objectives=objectives, threads=threads
            )
        for name in _OF_PROBLEM:
            setattr(self, name, getattr(problem_function, name))
        self.asked: ProblemFunction = problem_function
        self.budget = budget if budget == inf else whole("budget", budget, 1)
        self.problem = problem
        self._noise = Noise(noise, whole("seed", seed, 0))
        self.noise = self._noise.share
        differs = self.noise if self.of_model else 1.0
        self.reevaluate = times_evaluated(reevaluate, differs)
        self.archive = Archive(problem_function, self.noise > 0)
        self.failed = 0
        self.infeasible = 0
        self.after_call: Callable[[], None] | None = None
        self._idle = 0
        # the box that is searched is not a method's to change
        self.lower.flags.writeable = False
        self.upper.flags.writeable = False

    @interruptible
    def __call__(self, candidates: ArrayLike) -> tuple[Array, Array]:
        """Evaluate candidates, as the problem's function does, and keep them.

        ValueError also when a coefficient is beyond the box, or is no number.
        """
        remaining = self.budget - self.archive.evaluations
        if isinstance(candidates, np.ndarray) and candidates.ndim and len(candidates) > remaining:
            candidates = candidates[: int(remaining) + 1]  # of a huge array no copy is made
        table = table_of(candidates, len(self.variables))
        for row, column in beyond(table, self.lower, self.upper):
            raise ValueError(
                f"{self.variables[column]} of candidate {self.archive.evaluations + row + 1} is "
                f"{table[row, column]:.4g}, not from {self.lower[column]:.4g} to "
                f"{self.upper[column]:.4g}; clip candidates to the function's lower and upper"
            )
        self._end_if_idle(len(table))
        blocks = [self._record(table[i : i + BLOCK]) for i in range(0, len(table) or 1, BLOCK)]
        objectives, violations = map(np.concatenate, zip(*blocks))
        return objectives, violations

    def _end_if_idle(self, rows: int) -> None:
        """End a search that asks for nothing again and again."""
        most_idle = 1_000
        self._idle = 0 if rows else self._idle + 1
        if self._idle >= most_idle:
            raise BudgetSpentError

    def _record(self, table: Array) -> tuple[Array, Array]:
        """Evaluate the candidates that are afforded, and keep them.

        Those that were evaluated are kept as well where the function fails or is stopped between
        them, before that goes on.
        """
        remaining = self.budget - self.archive.evaluations
        count = int(min(remaining, len(table)))
        afforded = np.clip(table[:count], self.lower, self.upper)
        places, values, stopped = self._ask(afforded)
        candidates = afforded[places]
        true, violations = np.hsplit(values, [len(self.objectives)])
        failed = np.asarray((true >= UNUSABLE).any(axis=1))
        broken = (violations > 0).any(axis=1)
        self.failed += int(failed.sum())
        self.infeasible += int((broken & ~failed).sum())
        objectives = self._noise.of(true, failed)
        if len(candidates):
            usable = np.logical_not(failed | broken)
            repeated = 0
            if stopped is None:
                repeated, stopped = self._evaluate_again(
                    candidates, objectives, true, usable, remaining - count
                )
            without_noise = true if self.noise else None
            self.archive.add(candidates, objectives, usable, without_noise, repeated)
        if stopped is not None:
            raise stopped
        if self.after_call is not None:
            self.after_call()
        if len(afforded) < len(table):
            raise BudgetSpentError
        return objectives, violations

    def _ask(self, candidates: Array) -> tuple[Places, Array, BaseException | None]:
        """Which candidates were evaluated, their values, and what stopped the others if it did."""
        values = np.full((len(candidates), len(self.objectives) + len(self.constraints)), np.nan)
        places = np.arange(len(candidates))
        try:
            self.asked.fill(candidates, values)
        except BaseException as error:  # of any kind, such as Ctrl-C
            places = np.flatnonzero(~np.isnan(values).any(axis=1))
            return places, values[places], error
        return places, values, None

    def _evaluate_again(
        self,
        candidates: Array,
        objectives: Array,
        true: Array,
        usable: NDArray[np.bool_],
        remaining: float,
    ) -> tuple[int, BaseException | None]:
        """Put means in the place of the objectives of rows that would enter the archive.

        Gives how many evaluations that took, of so many that remain, and what stopped it if
        something did.
        """
        if self.reevaluate == 1:
            return 0, None
        rows = self.archive.entering(objectives, usable)
        totals = objectives[rows]
        times = np.ones(len(rows))
        repeated = 0
        stopped = None
        for _ in range(self.reevaluate - 1):
            count = int(min(len(rows), remaining - repeated))
            places = np.arange(count)
            again = true[rows[:count]]
            if not self.of_model and count:
                places, values, stopped = self._ask(candidates[rows[:count]])
                again = values[:, : len(self.objectives)]
            totals[places] += self._noise.of(again, np.zeros(len(places), dtype=bool))
            times[places] += 1
            repeated += len(places)
            if stopped is not None:
                break
        objectives[rows] = totals / times[:, None]
        return repeated, stopped

    def charge(self, evaluations: int) -> None:
        """Count candidates that were simulated for derivatives; BudgetSpentError at the end."""
        remaining = self.budget - self.archive.evaluations
        self.archive.charge(int(min(evaluations, remaining)))
        if evaluations >= remaining:
            raise BudgetSpentError

    def front(
        self, method: str, seed: int | None = None, settings: Mapping[str, Setting] | None = None
    ) -> Front:
        """The candidates until now, as the front of a method; ValueError if there are none."""
        if not self.archive.evaluations:
            raise ValueError("no candidate was asked for; let the library call the function first")
        seed = None if seed is None else whole("seed", seed, 0)
        stated: dict[str, Any] = dict(settings or {})
        if self.problem:
            stated["problem"] = self.problem
        if self.noise or self.reevaluate > 1:
            stated |= {"noise": self.noise, "reevaluate": self.reevaluate}
        return self.archive.front(
            Record(method, stated, self.bound, seed),
            failed=self.failed,
            infeasible=self.infeasible,
        )

    @property
    def of_model(self) -> bool:
        """Return whether a plant's model stands behind it."""
        return self.asked.of_model

    @property
    def kept_free(self) -> float:
        """Return by how much a method that ends on constraints keeps violations below zero."""
        return self.asked.kept_free

    @property
    def corner(self) -> tuple[float, ...] | None:
        """Return the corner that hypervolumes are measured from."""
        return self.asked.corner

    def points_of(
        self, coefficients: Array, values: Array, bound: float | None
    ) -> tuple[FrontPoint, ...]:
        """Return the points of a front, as its problem's function makes them."""
        return self.asked.points_of(coefficients, values, bound)

    def entries_of(
        self, candidates: tuple[int, ...], coefficients: Rows, objectives: Rows, believed: Rows
    ) -> Entries:
        """Return the entries of a front, as its problem's function makes them."""
        return self.asked.entries_of(candidates, coefficients, objectives, believed)

    def front_with(self, points: tuple[FrontPoint, ...], record: Record, **entries: Any) -> Front:
        """Return a front, as its problem's function makes it."""
        return self.asked.front_with(points, record, **entries)

    @interruptible
    def save(self, path: str | Path, method: str, seed: int | None = None) -> None:
        """Write the run as a file for ``quietarm bench --import``; arguments as for `front`."""
        self.front(method, seed).save(path)
