"""The named problems that a contest is held on, and the exact front of each as a yardstick."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from quietarm.metaheuristics import PROBLEMS, NamedProblem, problem_of
from quietarm.metaheuristics.budget.record import Scale
from quietarm.ocp import CycloidPolynomial, Front
from quietarm.ocp.answers.saved import Saved
from quietarm.ocp.base.ranges import Positive
from quietarm.studies.comparison.staircase import filled
from quietarm.studies.paper.printed import CONDITIONS

_FILL = 10_000
"""Points of an exact front with the motions between them: its hypervolume is right to 1e-4."""


def problems_of(names: Sequence[str]) -> tuple[NamedProblem, ...]:
    """Problems by their names; the paper's six conditions where none is given."""
    if not names:
        wanted = [(case.task, CycloidPolynomial(), case.bound) for case in CONDITIONS]
        every = [problem for problem in PROBLEMS.values() if not problem.peak]
        return tuple(one for one in every if (one.task, one.profile, one.bound) in wanted)
    problems = tuple(map(problem_of, dict.fromkeys(names)))
    for problem in problems:
        if problem.peak:
            raise ValueError(
                f"{problem.name} has a third objective, and a contest compares residual and "
                "energy alone; leave it out"
            )
    return problems


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
        volume = scale.hypervolume(filled(front, _FILL))
        return cls(problem.name, problem.bound, front, scale, volume)

    @property
    def place(self) -> str:
        """Its file in the folder of a contest."""
        return f"exact/{self.problem}.json"

    @cached_property
    def filled(self) -> NDArray[np.float64]:
        """Residual [m] and energy [J] of the front and of the motions between, shape (n, 2)."""
        return filled(self.front, _FILL)
