"""One trade-off of residual and energy: a task on its steps, solved and certified many times."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.front.front import Front, reference_corner
from quietarm.ocp.front.points import FailedPoint, FrontPoint, non_dominated
from quietarm.ocp.limits import Limit
from quietarm.ocp.planning.certify import OF_A_PLAN, Certified, Tolerances, certify
from quietarm.ocp.planning.setup import Setup
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.record import Setting
from quietarm.ocp.solvers.problem import LEAST_ENERGY, Problem, Solution, Transcription
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.task import PointToPoint

Array = NDArray[np.float64]
Report = Callable[[int, int], None]
"""Called with the number of points done and asked for."""
RESIDUAL_LIMIT = "residual_limit"


def no_report(done: int, total: int) -> None:
    """Report nothing."""


Asked = Mapping[str, float]
"""A residual limit [m], or weights, by name."""


class Certificate(NamedTuple):
    """A point by the independent integrator, or why there is none; and the iterations it took."""

    point: FrontPoint | FailedPoint
    iterations: int


@dataclass(frozen=True)
class Curve:
    """A task along its profile, whose residual is limited or weighted."""

    transcription: Transcription
    setup: Setup

    @classmethod
    def begin(cls, task: PointToPoint, profile: JointProfile, setup: Setup) -> Curve:
        """On the steps that the setup or the task asks for."""
        profile.refuse_no_choice()
        return cls(Transcription.of(task, profile, setup.steps), setup)

    @property
    def task(self) -> PointToPoint:
        """The move."""
        return self.transcription.task

    @property
    def solver(self) -> Solver:
        """What solves its problems."""
        return self.setup.solver

    @cached_property
    def starts(self) -> list[Array]:
        """Coefficients to start from."""
        return self.setup.start_coefficients(self.transcription.profile)

    @property
    def tolerances(self) -> Tolerances:
        """Of points between the ends: less exact than a plan; steps are doubled once."""
        return Tolerances(energy=1e-4, most_steps=2 * self.transcription.steps)

    def problem(
        self, residual_limit: float = np.inf, minimise: Mapping[str, float] = LEAST_ENERGY
    ) -> Problem:
        """The problem at a residual limit [m]."""
        return Problem.of(self.transcription, residual_limit, self.setup.bound, minimise)

    def certify(
        self,
        found: Sequence[tuple[Solution, Asked]],
        most_residual: float = np.inf,
        *,
        free: bool = False,
    ) -> list[Certificate]:
        """Give solutions, each with what was asked for, the figures of another integrator.

        Their residuals are their limits, unless it is the cheapest of all, whose residual is free.
        What was not solved is a failed point.
        """
        solved = [solution for solution, _ in found if solution.status.solved]
        problems = [self.problem(np.inf if free else one.residual) for one in solved]
        tolerances = OF_A_PLAN if free else self.tolerances
        limits = (Limit.of_residual(most_residual, self.task.plant.tip_unit), *self.task.limits)
        outcomes = iter(certify(problems, solved, self.solver, tolerances, limits))
        ended = [next(outcomes) if one.status.solved else one.status.text for one, _ in found]
        return [
            self.point_of(outcome)
            if isinstance(outcome, Certified)
            else Certificate(FailedPoint(asked, str(outcome)), solution.iterations)
            for (solution, asked), outcome in zip(found, ended)
        ]

    def point_of(self, found: Certified) -> Certificate:
        """A certified solution as a point."""
        coefficients = self.transcription.profile.checked(found.solution.coefficients)
        solution, checked = found.solution, found.checked
        prices = solution.shadow_prices
        point = FrontPoint(coefficients, checked.residual, checked.energy, prices)
        return Certificate(point, solution.iterations)

    def to_front(
        self,
        method: str,
        certificates: Iterable[Certificate],
        points: int,
        seconds: float,
        *,
        iterations: int = 0,
        gaps: Iterable[tuple[float, float]] = (),
        also: Mapping[str, Setting] = {},
    ) -> Front:
        """The points as a front; iterations are those that no certificate counts."""
        found = list(certificates)
        failures = tuple(one.point for one in found if isinstance(one.point, FailedPoint))
        return Front(
            task=self.task,
            profile=self.transcription.profile,
            points=non_dominated(one.point for one in found if isinstance(one.point, FrontPoint)),
            record=self.setup.record(
                method,
                iterations + sum(one.iterations for one in found),
                seconds,
                points=points,
                steps=self.transcription.steps,
                **also,
            ),
            reference=reference_corner(self.task),
            failed=len(failures),
            failures=failures,
            gaps=tuple(gaps),
        )


def curve_of(
    front: Front, *, starts: int, steps: int | None = None, solver: Solver = Sqp()
) -> Curve:
    """The curve of a front that is there already, within its bound; it must have a point."""
    front.smallest_residual()
    bound, seed = front.record.bound, front.record.seed or 0
    setup = Setup(solver, bound, starts, seed, steps)
    return Curve.begin(front.task, front.profile, setup)
