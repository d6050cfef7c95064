"""The folder of a contest: its exact fronts, runs, imported runs and local minima, a file each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import ClassVar, TypeVar

import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics import PROBLEMS, NamedProblem, problem_of
from quietarm.metaheuristics.budget.record import Mark, Scale, Visits
from quietarm.ocp import CycloidPolynomial, FileFormatError, Front
from quietarm.ocp.checks import CountFromOne, Positive
from quietarm.ocp.saved import Saved
from quietarm.studies.compare.staircase import filled
from quietarm.studies.contest.landscape import LEVEL, Landscape
from quietarm.studies.contest.names import folder_of, is_own
from quietarm.studies.reproduce.paper import CONDITIONS

_FILL = 2_000
"""Points of an exact front with the motions between them: with twenty times as many its hypervolume
differs by 4e-6 at most, on three problems."""


EVERY = "all"
"""In the place of names: every problem that a contest can be held on."""


def problems_of(names: Sequence[str]) -> tuple[NamedProblem, ...]:
    """Problems by their names; the paper's six conditions where none is given.

    `EVERY` stands for all that have two objectives.
    """
    every = [problem for problem in PROBLEMS.values() if not problem.peak]
    if EVERY in names:
        return tuple(every)
    if not names:
        wanted = [(case.task, CycloidPolynomial(), case.bound) for case in CONDITIONS]
        return tuple(one for one in every if (one.task, one.profile, one.bound) in wanted)
    for name in names:
        if is_own(name):
            raise ValueError(f"{name} is a method; give it as --methods {name}")
    problems = tuple(map(problem_of, dict.fromkeys(names)))
    for problem in problems:
        if problem.peak:
            raise ValueError(
                f"{problem.name} has a third objective, and a contest compares residual and "
                "energy alone; leave it out"
            )
    return problems


_EXACT = "exact/{}.json"


def exact_of(problem: NamedProblem) -> str:
    """The place of a problem's yardstick."""
    return _EXACT.format(problem.name)


@dataclass(frozen=True)
class Yardstick(Saved):
    """What the methods are measured against on a problem."""

    kind: ClassVar[str] = "yardstick"
    version: ClassVar[int] = 1

    problem: str
    bound: Positive
    front: Front
    scale: Scale
    hypervolume: Positive

    @classmethod
    def of(cls, problem: NamedProblem) -> Yardstick:
        """The yardstick of a problem; ValueError where its exact front is a single motion."""
        (front,) = problem.fronts()
        scale = Scale.of(front)
        volume = scale.hypervolume_of_line(filled(front, _FILL))
        return cls(problem.name, problem.bound, front, scale, volume)

    @property
    def place(self) -> str:
        """Its file in the folder of a contest."""
        return _EXACT.format(self.problem)

    @property
    def within_level(self) -> bool:
        """Whether any motion leaves no more than `LEVEL`, at which local minima are looked for."""
        return self.front.stillest().residual <= LEVEL

    @cached_property
    def filled(self) -> NDArray[np.float64]:
        """Residual [m] and energy [J] of the front and of the motions between, shape (n, 2)."""
        return filled(self.front, _FILL)


@dataclass(frozen=True)
class Run(Saved):
    """One method on one problem: from a seed, or what a file of another tool holds.

    Of another tool's run that was not recorded only what it ended with is known: it has no marks
    and no visits.
    """

    kind: ClassVar[str] = "contest-run"
    version: ClassVar[int] = 1

    problem: str
    method: str
    evaluations: CountFromOne | None
    scale: Scale
    front: Front
    population: int | None = None
    marks: tuple[Mark, ...] = ()
    visits: Visits | None = None
    file: str | None = None
    digest: str = ""
    claims: tuple[str, ...] = ()

    @property
    def place(self) -> str:
        """Its file in the folder of a contest."""
        folder, name = ("imports", self.file) if self.file else ("runs", f"seed{self.front.seed}")
        return f"{folder}/{self.problem}/{folder_of(self.method)}/{name}.json"

    @property
    def here(self) -> bool:
        """Whether it was run here, not imported."""
        return self.file is None

    @property
    def words(self) -> str:
        """Which run it is, in words."""
        if self.file:
            return f"{self.file} of {self.method} on {self.problem}"
        return f"{self.method} on {self.problem} from seed {self.front.seed}"


Kept = Yardstick | Run | Landscape
K = TypeVar("K", Yardstick, Run, Landscape)
FOLDERS: dict[str, type[Kept]] = {
    "runs": Run,
    "imports": Run,
    "landscape": Landscape,
    "exact": Yardstick,
}
"""Exact fronts are read last: another part that is at work writes one before the runs on it."""


class Store:
    """What the folder of a contest holds, by place, read once and kept up to date.

    FileFormatError where a file in it is broken, or in the place of another.
    """

    def __init__(self, path: Path) -> None:
        self.path, self.kept = path, dict[str, Kept]()
        for folder, kind in FOLDERS.items():
            for file in sorted(path.glob(f"{folder}/**/*.json")):
                try:
                    one = kind.load(file)
                except FileFormatError as error:
                    raise FileFormatError(f"{error}; remove it to have it made again") from None
                if file != path / one.place:
                    raise FileFormatError(
                        f"{file} holds what belongs to {path / one.place}; put it there, or "
                        "remove it"
                    )
                self.kept[one.place] = one

    def of(self, kind: type[K]) -> list[K]:
        """All of one kind."""
        return [one for one in self.kept.values() if isinstance(one, kind)]

    @property
    def yardsticks(self) -> dict[str, Yardstick]:
        """The yardsticks by their problems."""
        return {one.problem: one for one in self.of(Yardstick)}

    def keep(self, what: Kept) -> None:
        """Write a file, whole or not at all, and know of it; ValueError when it cannot be."""
        path = self.path / what.place
        path.parent.mkdir(parents=True, exist_ok=True)
        what.save(path)
        self.kept[what.place] = what
