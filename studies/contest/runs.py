"""A run of a contest: one method on one problem from one seed."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import ClassVar, NamedTuple, Self

from quietarm.metaheuristics.budget.record import Mark, Scale, Visits
from quietarm.metaheuristics.budget.run import BudgetRun
from quietarm.ocp import Front
from quietarm.ocp.answers.saved import Saved
from quietarm.ocp.base.ranges import CountFromOne
from quietarm.studies.comparison.staircase import objectives
from quietarm.studies.contest.problems import Yardstick

REMEDY = "remove it to have it made again"
"""What helps where a file states what its run did not find."""
_AGREEMENT = 2e-3
"""Hypervolumes of a front and of its search differ by less: the front's figures are of finer
steps."""


class Key(NamedTuple):
    """What a run is kept under."""

    problem: str
    method: str
    seed: int


@dataclass(frozen=True)
class Run(Saved):
    """One method on one problem from one seed."""

    kind: ClassVar[str] = "contest-run"
    version: ClassVar[int] = 1

    problem: str
    method: str
    budget: CountFromOne
    population: int | None
    scale: Scale
    marks: tuple[Mark, ...]
    visits: Visits
    front: Front

    def __post_init__(self) -> None:
        if not self.marks or self.marks[-1].evaluations > self.budget:
            raise ValueError("it has no marks, or some beyond its evaluations")
        for before, mark in pairwise(self.marks):
            _check_order(before, mark)

    @classmethod
    def of(
        cls, yardstick: Yardstick, method: str, budget: int, population: int | None, run: BudgetRun
    ) -> Self:
        """The run of a method on the problem of a yardstick."""
        return cls(
            yardstick.problem, method, budget, population, yardstick.scale, run.marks, run.visits,
            run.front,
        )  # fmt: skip

    @property
    def key(self) -> Key:
        """What it is kept under."""
        return Key(self.problem, self.method, self.front.seed or 0)

    @property
    def evaluations(self) -> int:
        """How many it was given, as every other run of the contest."""
        return self.budget

    @property
    def words(self) -> str:
        """Which run it is, in words."""
        return f"{self.method} on {self.problem} from seed {self.key.seed}"


def check_end(run: Run, yardstick: Yardstick, path: Path) -> None:
    """Refuse a run whose last mark is not that of its front."""
    end, own = run.marks[-1], run.scale.hypervolume(objectives(run.front))
    states = (
        f"{path}: its mark after {end.evaluations} evaluations states hypervolume "
        f"{end.hypervolume:.6g}"
    )
    if end.hypervolume > yardstick.hypervolume + _AGREEMENT:
        best = yardstick.hypervolume
        raise ValueError(f"{states}, and the exact front has {best:.6g}; {REMEDY}")
    # with limits, motions that break one a little on the finer steps are not in the front
    beyond = own - end.hypervolume if run.front.task.limits else abs(own - end.hypervolume)
    if not beyond <= _AGREEMENT:
        raise ValueError(f"{states}, but its front dominates {own:.6g}; {REMEDY}")


def _check_order(before: Mark, mark: Mark) -> None:
    """ValueError where a mark falls behind the one before it: what was found stays found."""
    if mark.evaluations <= before.evaluations:
        raise ValueError(
            f"its mark after {mark.evaluations} evaluations follows that after {before.evaluations}"
        )
    for figure in ("hypervolume", "seconds"):
        earlier, later = getattr(before, figure), getattr(mark, figure)
        if later < earlier * (1 - 1e-9):
            raise ValueError(
                f"its {figure} falls from {earlier:.6g} to {later:.6g} at the mark after "
                f"{mark.evaluations} evaluations"
            )
