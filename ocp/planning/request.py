"""The request for a plan: a move along a profile within a residual limit, and how it is solved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.ocp.checks import finite, instance, whole
from quietarm.ocp.planning.residual_limit import checked_residual_limit
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import Record, Setting, coefficient_bound, digits, number_of_starts
from quietarm.ocp.simulation.mesh import MOST_STEPS
from quietarm.ocp.solvers.problem import LEAST_ENERGY, Program
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.task import PointToPoint


@dataclass(frozen=True, eq=False)
class Request:
    """A request, all that a plan or a front depends on, which goes from `plan_move` to the solver.

    Attributes
    ----------
    task : PointToPoint
        The move.
    profile : JointProfile
        How the joint moves.
    solver : Solver
        What solves.
    bound : float or None
        Largest absolute coefficient.
    starts, seed : int
        How many starts, the random ones of a seed.
    steps : int or None
        Of the discretisation; None where the task chooses them.
    guess : tuple of float or None
        Coefficients of the first start, in place of the plain cycloid.
    residual_limit : float
        Largest residual [m] of a plan.
    adapts : bool
        Whether that limit may be lowered or raised: of an uncertain task the default without
        a band is only where the search for a limit begins.
    quick : bool
        Whether a failure need not say what would be feasible.
    has_stand_in : bool
        Whether another solver is tried where this one solves no start.
    thorough : bool
        Whether an error says which limit, if wider, would do; that takes a solve for each. Then
        another solver also stands in where no start is solved.

    Raises
    ------
    TypeError, ValueError
        When the solver is none; when a number is out of range.
    """

    task: PointToPoint
    profile: JointProfile
    solver: Solver = Sqp()
    bound: float | None = None
    starts: int = 4
    seed: int = 0
    steps: int | None = None
    guess: tuple[float, ...] | None = None
    residual_limit: float = 0.0
    adapts: bool = False
    quick: bool = False
    has_stand_in: bool = True
    thorough: bool = True

    def __post_init__(self) -> None:
        instance("solver", self.solver, Solver)
        checked: dict[str, Any] = {
            "starts": number_of_starts(self.starts),
            "seed": whole("seed", self.seed, 0),
        }
        if self.bound is not None:
            checked["bound"] = coefficient_bound(self.bound)
        if self.steps is not None:
            finer = "finer ones differ by rounding alone"
            checked["steps"] = whole("steps", self.steps, 2, MOST_STEPS, finer)
        if self.guess is not None:
            checked["guess"] = tuple(finite("guess", value) for value in self.guess)
        for name, value in checked.items():
            object.__setattr__(self, name, value)

    @property
    def is_held(self) -> bool:
        """Return whether an uncertain plant has to keep a band or a stated residual limit."""
        return self.task.uncertainty is not None and not self.adapts

    @cached_property
    def guesses(self) -> list[NDArray[np.float64]]:
        """Coefficients to start from: the guess or the plain cycloid, then random ones."""
        first = self.profile.plain if self.guess is None else np.array(self.guess)
        random = np.random.default_rng(self.seed)
        box = self.profile.start_box(self.bound)
        count = (self.starts - 1) * self.profile.random_starts
        return [first, *(random.uniform(*box) for _ in range(count))]

    def problem(self, minimise: Mapping[str, float] = LEAST_ENERGY) -> Program:
        """The program, of the least energy or another sum."""
        program = Program.of(self.task, self.profile, self.steps)
        return program.within(self.residual_limit, self.bound, minimise)

    def record(self, method: str, iterations: int, seconds: float, **also: Setting) -> Record:
        """Return the record of how an answer was found, with other settings of the method's own."""
        settings: dict[str, Setting] = {"starts": self.starts, "steps": self.steps}
        settings |= self.solver.stated | also
        if self.guess is not None:
            settings["guess"] = ", ".join(map(digits, self.guess))
        return Record(
            method,
            settings,
            self.bound,
            self.seed,
            iterations=iterations,
            seconds=seconds,
        )

    def on(self, task: PointToPoint) -> Request:
        """Return this request for another task."""
        return replace(self, task=task)

    def stating(self, residual_limit: float | None) -> Request:
        """Return this request within a residual limit [m] that is stated, or the task's default.

        ValueError where it is negative, or that of an uncertain task is 0.
        """
        size = checked_residual_limit(self.task, residual_limit)
        free = residual_limit is None and self.task.band is None
        adapts = free and self.task.uncertainty is not None
        return replace(self, residual_limit=size, adapts=adapts)

    def within(self, size: float) -> Request:
        """Return this request within a residual limit [m] that does not adapt."""
        return replace(self, residual_limit=size, adapts=False)

    def from_guess(self, guess: ArrayLike) -> Request:
        """Return this request from these coefficients first; ValueError if they do not fit."""
        return replace(self, guess=self.profile.checked(guess))

    def along(self, profile: JointProfile, guess: ArrayLike | None = None) -> Request:
        """Return this request along another profile, from the guess or the plain motion alone."""
        request = replace(self, profile=profile, starts=1, guess=None)
        return request if guess is None else request.from_guess(guess)
