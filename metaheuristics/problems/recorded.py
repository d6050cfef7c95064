"""A problem's function that keeps what another library asks of it, as a contest keeps its runs."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.metaheuristics.budget.record import Mark, Record, Scale, Visits
from quietarm.metaheuristics.objective.population import UNUSABLE
from quietarm.metaheuristics.problems.function import MoveFunction
from quietarm.metaheuristics.runs.front import front_through
from quietarm.ocp import Front
from quietarm.ocp.checks import whole
from quietarm.ocp.saved import Saved

if TYPE_CHECKING:
    from quietarm.metaheuristics.problems.catalogue import NamedProblem

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RecordedRun(Saved):
    """A run of another library: what it found, and what it had found on the way.

    Attributes
    ----------
    problem : str
        Name of the problem.
    front : Front
        The motions that no other dominates, by CVODES; with method, seed and evaluations.
    scale : Scale
        The exact front's extent.
    marks : tuple of Mark
        Hypervolume and processor time on the way.
    visits : Visits
        Where the candidates lie.
    """

    kind: ClassVar[str] = "recorded-run"
    version: ClassVar[int] = 1

    problem: str
    front: Front
    scale: Scale
    marks: tuple[Mark, ...]
    visits: Visits


class RecordedFunction(MoveFunction):
    """A problem's function that keeps every candidate, in their order.

    Parameters
    ----------
    problem : NamedProblem
        A problem with two objectives.
    **settings
        As for `MoveFunction`: steps and threads.

    Raises
    ------
    ValueError
        When the problem has a third objective.
    """

    def __init__(self, problem: NamedProblem, **settings: Any) -> None:
        if problem.peak:
            raise ValueError(
                f"{problem.name} has a third objective, and a run is measured by residual and "
                "energy alone; give another problem"
            )
        super().__init__(problem.task, problem.profile, bound=problem.bound, **settings)
        self.problem = problem
        self._asked: list[tuple[Array, Array, NDArray[np.bool_], float]] = []
        self._began = time.thread_time()

    def __call__(self, candidates: ArrayLike) -> tuple[Array, Array]:
        """Evaluate candidates, as `MoveFunction` does, and keep them."""
        found, violations = super().__call__(candidates)
        table = np.array(candidates, dtype=float)
        inside = (table >= self.lower) & (table <= self.upper)
        good = [inside, found < UNUSABLE, violations <= 0]
        usable = np.concatenate(good, axis=1).all(axis=1)
        self._asked.append(
            (table, found.copy(), np.asarray(usable), time.thread_time() - self._began)
        )
        return found, violations

    @property
    def evaluations(self) -> int:
        """Candidates until now."""
        return sum(len(table) for table, *_ in self._asked)

    def run(
        self, method: str, seed: int | None = None, evaluations: int | None = None
    ) -> RecordedRun:
        """What was asked until now, as a run of a method.

        Parameters
        ----------
        method : str
            What the method is called.
        seed : int, optional
            Its seed.
        evaluations : int, optional
            How many candidates count, the first ones, where the library asked for more than the
            contest gives; all by default.

        Raises
        ------
        ValueError
            When nothing was asked, or not so many.
        """
        if not self.evaluations:
            raise ValueError("no candidate was asked for; let the library call the function first")
        budget = self.evaluations
        if evaluations is not None:
            budget = whole("evaluations", evaluations, 1, budget, "no more were asked for")
        (exact,) = self.problem.fronts()
        scale = Scale.of(exact)
        record, seconds = Record(budget, scale, len(self.variables)), 0.0
        for table, found, usable, after in self._asked:
            first = slice(budget - record.spent)
            if len(table[first]):
                seconds = after
                record.add(table[first], found[first], usable[first], seconds)
        front = front_through(
            record.non_dominated()[0], self.task, self.profile,
            method=method, settings={"bound": self.bound}, seed=seed, seconds=seconds,
            evaluations=record.spent,
        )  # fmt: skip
        return RecordedRun(self.problem.name, front, scale, tuple(record.marks), record.visits)

    def save(
        self,
        path: str | Path,
        method: str,
        seed: int | None = None,
        evaluations: int | None = None,
    ) -> None:
        """Write the run as a file for ``quietarm contest --import``; arguments as for `run`."""
        self.run(method, seed, evaluations).save(path)
