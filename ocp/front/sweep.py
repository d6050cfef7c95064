"""One task's program, solved many times: what all fronts by the gradient share."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.front.answer import Front
from quietarm.ocp.planning.starts import first_steps, start_coefficients
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import SolveSettings
from quietarm.ocp.solvers.program import Program
from quietarm.ocp.solvers.solution import ENERGY, LEAST_ENERGY, RESIDUAL, Scalarization, Solution
from quietarm.ocp.solvers.solving import Row, Solved, solve
from quietarm.ocp.task import PointToPoint

Guess = NDArray[np.float64]
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
        self.profile.refuse_no_choice()
        self.steps = first_steps(self.task, self.profile, self.settings)
        self.guesses = start_coefficients(self.profile, self.settings)
        self._program: Program | None = None

    def add_samples(self, more: Sequence[Sequence[float]]) -> None:
        """Let the residual of an uncertain plant count at more errors."""
        if more:
            self.take(self.task.with_samples([*self.task.scenarios[1:], *more]))

    def take(self, task: PointToPoint) -> None:
        """Go on with another task."""
        self.task, self._program = task, None

    @property
    def program(self) -> Program:
        """The task on its steps."""
        if self._program is None or self._program.steps != self.steps:
            self._program = Program(self.task, self.profile, self.steps)
        return self._program

    def ask(
        self, residual_limit: float = np.inf, minimise: Mapping[str, float] = LEAST_ENERGY
    ) -> Scalarization:
        """What is asked at a residual limit [m]."""
        limits = {**self.task.limits, RESIDUAL: residual_limit}
        return Scalarization(limits, self.settings.bound, minimise)

    def solve(
        self,
        rows: Sequence[tuple[Guess, Scalarization]],
        *,
        warm: bool = False,
        groups: Sequence[int] | None = None,
    ) -> list[Solution]:
        """The solutions from coefficients for what is asked; KeyboardInterrupt after Ctrl-C."""
        found, complete = self.solved(rows, warm=warm, groups=groups)
        if not complete:
            raise KeyboardInterrupt
        return found

    def solved(
        self,
        rows: Sequence[tuple[Guess, Scalarization]],
        *,
        warm: bool,
        groups: Sequence[int] | None,
    ) -> Solved:
        """The same with those of Ctrl-C; `warm` beside minima, one group for starts of one ask."""
        asked = [Row(self.program, ask, start) for start, ask in rows]
        found = solve(asked, self.settings.solver, warm=warm, groups=groups)
        self.iterations += sum(one.iterations for one in found.solutions)
        return found

    def best(self, starts: Sequence[Guess], ask: Scalarization, *, warm: bool = False) -> Solution:
        """The best from several starts."""
        found = self.solve([(start, ask) for start in starts], warm=warm, groups=[0] * len(starts))
        return best_of(found, ask)


def best_of(found: Sequence[Solution], ask: Scalarization) -> Solution:
    """The solution of the least value of what is made least."""

    def value(one: Solution) -> tuple[bool, float]:
        values = {**one.peaks, ENERGY: one.energy}
        least = sum(weight * values[name] for name, weight in ask.minimise.items())
        return not one.status.solved, least

    return min(found, key=value)


def sweep_of(front: Front, **settings: Any) -> Sweep:
    """The task of a front that is there already, within its bound."""
    front.stillest()  # refuses an empty front
    bound: Any = front.settings.get("bound")
    asked = SolveSettings(bound=bound, seed=front.seed or 0, **settings)
    return Sweep(front.task, front.profile, asked)
