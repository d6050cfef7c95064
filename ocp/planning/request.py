"""What a plan is asked for: a move along a profile within a limit, and how it is solved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.ocp.planning.residual_limit import ResidualLimit
from quietarm.ocp.planning.setup import Setup
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.solvers.problem import LEAST_ENERGY, Program
from quietarm.ocp.task import PointToPoint


@dataclass(frozen=True, eq=False)
class PlanRequest:
    """All that a plan depends on; it goes as one value from `plan_move` to the solver.

    Attributes
    ----------
    task : PointToPoint
        The move.
    profile : JointProfile
        How the joint moves.
    setup : Setup
        How it is solved.
    residual_limit : ResidualLimit
        Largest residual [m].
    quick : bool
        Whether a failure need not say what would be feasible.
    has_stand_in : bool
        Whether another solver is tried where this one solves no start.
    """

    task: PointToPoint
    profile: JointProfile
    setup: Setup
    residual_limit: ResidualLimit
    quick: bool = False
    has_stand_in: bool = True

    @cached_property
    def starts(self) -> list[NDArray[np.float64]]:
        """Coefficients to start from."""
        return self.setup.start_coefficients(self.profile)

    def problem(self, minimise: Mapping[str, float] = LEAST_ENERGY) -> Program:
        """The nonlinear program, of the least energy or another sum."""
        program = Program.of(self.task, self.profile, self.setup.steps)
        return program.within(self.residual_limit.size, self.setup.bound, minimise)

    def on(self, task: PointToPoint) -> PlanRequest:
        """The same of another task."""
        return replace(self, task=task)

    def within(self, size: float) -> PlanRequest:
        """The same within a residual limit [m] that does not adapt."""
        return replace(self, residual_limit=ResidualLimit(size))

    def from_guess(self, guess: ArrayLike) -> PlanRequest:
        """The same from these coefficients first; ValueError where they do not fit the profile."""
        setup = replace(self.setup, guess=self.profile.checked(guess))
        return replace(self, setup=setup)

    def along(self, profile: JointProfile, guess: ArrayLike | None = None) -> PlanRequest:
        """The same along another profile from one start: the guess, or the plain motion."""
        setup = replace(self.setup, starts=1, guess=None)
        request = replace(self, profile=profile, setup=setup)
        return request if guess is None else request.from_guess(guess)
