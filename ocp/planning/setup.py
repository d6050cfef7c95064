"""How a move is solved: by which solver, within which box, from which starts, on how many steps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.checks import finite, instance, whole
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import Record, Setting, coefficient_bound, digits, number_of_starts
from quietarm.ocp.simulation.mesh import MOST_STEPS
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp


@dataclass(frozen=True)
class Setup:
    """What is chosen beyond the task and its profile, as `plan_move` takes it.

    Attributes
    ----------
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
    thorough : bool
        Whether, where no start is solved, another solver stands in, and an error says which limit,
        if wider, would do: that takes a solve for each.

    Raises
    ------
    TypeError, ValueError
        When the solver is none; when a number is out of range.
    """

    solver: Solver = Sqp()
    bound: float | None = None
    starts: int = 4
    seed: int = 0
    steps: int | None = None
    guess: tuple[float, ...] | None = None
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

    def start_coefficients(self, profile: JointProfile) -> list[NDArray[np.float64]]:
        """Coefficients to start from: the guess or the plain cycloid, then random ones."""
        first = profile.plain if self.guess is None else np.array(self.guess)
        random = np.random.default_rng(self.seed)
        box = profile.start_box(self.bound)
        count = (self.starts - 1) * profile.random_starts
        return [first, *(random.uniform(*box) for _ in range(count))]

    def record(self, method: str, iterations: int, seconds: float, **also: Setting) -> Record:
        """What found an answer so, with other settings of the method's own."""
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
