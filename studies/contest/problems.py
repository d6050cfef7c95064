"""The problems of a contest, by name, and the exact front that each is measured against."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees
from typing import ClassVar

from metaheuristics.budget.record import Scale
from ocp import CycloidPolynomial, Front, JointProfile, PointToPoint, epsilon_front
from ocp.answers.saved import Saved
from ocp.base.names import nearest
from ocp.base.ranges import Positive
from studies.comparison.staircase import filled
from studies.paper.case import Case
from studies.paper.printed import CONDITIONS
from studies.registry.methods import LEVELS

_POINTS = 50
_FILL = 10_000
"""Points of an exact front with the motions between them: its hypervolume is right to 1e-4."""


@dataclass(frozen=True)
class Problem:
    """A move, a profile and a box, by name.

    Attributes
    ----------
    name : str
        What it is called on the command line and in names of files.
    task : PointToPoint
        The move.
    bound : float
        Largest absolute coefficient.
    profile : JointProfile
        How the joint moves.
    """

    name: str
    task: PointToPoint
    bound: float
    profile: JointProfile


def _named(case: Case) -> Problem:
    task = case.task
    name = f"{task.plant.name}-{degrees(task.span):.6g}deg-{task.duration:g}s"
    assert case.bound is not None  # a case has one
    return Problem(name, task, case.bound, CycloidPolynomial())


PROBLEMS = {problem.name: problem for problem in map(_named, CONDITIONS)}
"""The six conditions of the paper."""


def problems_of(names: Sequence[str]) -> tuple[Problem, ...]:
    """Problems by their names; all where none is given.

    Parameters
    ----------
    names : sequence of str
        Names of `PROBLEMS`.

    Returns
    -------
    tuple of Problem
        Each once.

    Raises
    ------
    ValueError
        When a name is unknown; the nearest one is suggested.
    """
    for name in names:
        if name not in PROBLEMS:
            raise ValueError(
                f"unknown problem {name!r}; {nearest(name, PROBLEMS)}(known: {', '.join(PROBLEMS)})"
            )
    return tuple(PROBLEMS[name] for name in dict.fromkeys(names or PROBLEMS))


@dataclass(frozen=True)
class Yardstick(Saved):
    """What the methods are measured against on a problem.

    Attributes
    ----------
    problem : str
        Its name.
    bound : float
        Largest absolute coefficient.
    front : Front
        The exact front.
    scale : Scale
        Its extent.
    hypervolume : float
        What it dominates, with the motions between its points, in this extent.
    """

    kind: ClassVar[str] = "yardstick"
    version: ClassVar[int] = 1

    problem: str
    bound: Positive
    front: Front
    scale: Scale
    hypervolume: Positive

    @classmethod
    def of(cls, problem: Problem, front: Front) -> Yardstick:
        """The yardstick that an exact front is; ValueError where it is a single motion."""
        scale = Scale.of(front)
        volume = scale.hypervolume(filled(front, _FILL))
        return cls(problem.name, problem.bound, front, scale, volume)


def exact_front(problem: Problem) -> Front:
    """The front of a problem by the gradient, with points at `LEVELS`."""
    return epsilon_front(
        problem.task, problem.profile, bound=problem.bound, points=_POINTS, at=LEVELS
    )
