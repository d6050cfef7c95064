"""One task's program, solved many times: what all fronts by the gradient share."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ocp.answers.provenance import SolveSettings
from ocp.plan.solver import first_steps, start_coefficients
from ocp.profiles.joint_profile import JointProfile
from ocp.profiles.kinds import refuse_other_kinds
from ocp.program.problem import Problem
from ocp.program.solution import LEAST_ENERGY, Solution
from ocp.program.task_program import TaskProgram
from ocp.program.transcription import RESIDUAL
from ocp.robustness.uncertain import uncertain_plant, with_samples
from ocp.task.point_to_point import PointToPoint

Guess = NDArray[np.float64] | Solution
Report = Callable[[int, int], None]
"""Called with the number of points done and asked for."""
SAME = 1e-5
"""Solutions whose energies differ by less than this share count as one motion."""


def no_report(done: int, total: int) -> None:
    """Report nothing."""


def better(one: Solution, other: Solution) -> bool:
    """Whether one solution is cheaper than another by more than the solver's tolerance."""
    if not (one.status.solved and other.status.solved):
        return one.status.solved
    return one.energy < other.energy * (1 - SAME)


@dataclass
class Sweep:
    """A task's program, solved many times with other residual limits or weights.

    Attributes
    ----------
    task : PointToPoint
        The move and its limits.
    profile : JointProfile
        How the joint moves.
    settings : SolveSettings
        Bound, starts, seed, steps.
    """

    task: PointToPoint
    profile: JointProfile
    settings: SolveSettings
    iterations: int = 0
    began: float = field(default_factory=time.perf_counter)

    def __post_init__(self) -> None:
        refuse_other_kinds(self.task, self.profile)
        if self.profile.size == 0:
            raise ValueError("a profile of 0 terms has nothing to choose; give 1 term or more")
        self.steps = first_steps(self.task, self.profile, self.settings)
        self.guesses = start_coefficients(self.profile, self.settings)
        self._program: TaskProgram | None = None

    @property
    def ranges(self) -> list[float]:
        """The largest errors of an uncertain plant."""
        return list(uncertain_plant(self.task.plant).ranges.values())

    @property
    def samples(self) -> list[tuple[float, ...]]:
        """The errors at which its residual counts; the first sample has none."""
        return [(0.0,) * len(self.ranges), *uncertain_plant(self.task.plant).samples]

    def add_samples(self, more: Sequence[Sequence[float]]) -> None:
        """Let the residual of an uncertain plant count at more errors."""
        if more:
            self.take(with_samples(self.task, more))

    def take(self, task: PointToPoint) -> None:
        """Go on with another task."""
        self.task, self._program = task, None

    @property
    def program(self) -> TaskProgram:
        """The program with the residual as a variable."""
        if self._program is None or self._program.steps != self.steps:
            self._program = TaskProgram(self.task, self.profile, self.steps)
        return self._program

    def problem(self, residual_limit: float) -> Problem:
        """What is asked at a residual limit [m]."""
        limits = {**self.task.limits, RESIDUAL: residual_limit}
        return Problem(self.program, limits, self.settings.bound, self.guesses)

    def solve(
        self,
        guess: Guess,
        residual_limit: float = np.inf,
        minimise: Mapping[str, float] = LEAST_ENERGY,
    ) -> Solution:
        """Run the solver from one start.

        Parameters
        ----------
        guess : ndarray, shape (profile.size,), or Solution
            Coefficients, or the solution beside it.
        residual_limit : float
            Largest residual [m].
        minimise : mapping of str to float
            As for `Problem.solve`.

        Returns
        -------
        Solution
            The solution, whatever its status.
        """
        found = self.problem(residual_limit).solve(guess, minimise)
        self.iterations += found.iterations
        return found
