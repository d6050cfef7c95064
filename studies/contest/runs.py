"""A run of a contest: one method on one problem from one seed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, NamedTuple, Self

from quietarm.metaheuristics.budget.record import Mark, Scale, Visits
from quietarm.metaheuristics.budget.run import BudgetRun
from quietarm.ocp import Front
from quietarm.ocp.answers.saved import Saved
from quietarm.ocp.base.ranges import CountFromOne
from quietarm.studies.contest.problems import Yardstick


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
