"""One trade-off of residual and energy: a task on its steps, solved and certified many times."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.front.front import Front, reference_corner
from quietarm.ocp.front.points import FailedPoint, FrontPoint, non_dominated
from quietarm.ocp.limits import Limit
from quietarm.ocp.planning.certify import OF_A_PLAN, Certified, Tolerances, certify
from quietarm.ocp.planning.request import Request
from quietarm.ocp.planning.too_short import refuse_too_short
from quietarm.ocp.record import Setting
from quietarm.ocp.solvers.problem import LEAST_ENERGY, Program, Solution
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.task import PointToPoint

Array = NDArray[np.float64]
Progress = Callable[[int, int], None]
"""Called with the number of points done and of all."""
RESIDUAL_LIMIT = "residual_limit"


def no_report(done: int, total: int) -> None:
    """Report nothing."""


Place = Mapping[str, float]
"""Where a point was to be: a residual limit [m], or weights, by name."""


class Certificate(NamedTuple):
    """A point by the independent integrator, or why there is none; and the iterations it took."""

    point: FrontPoint | FailedPoint
    iterations: int


@dataclass(frozen=True)
class Curve:
    """A task along its profile, whose residual is limited or weighted."""

    program: Program
    request: Request

    @classmethod
    def begin(cls, request: Request) -> Curve:
        """On the steps that are asked for, or that the task takes.

        InfeasibleTaskError where not even a rigid joint is as fast as the task.
        """
        request.profile.refuse_no_choice()
        refuse_too_short(request.task)
        return cls(Program.of(request.task, request.profile, request.steps), request)

    @property
    def task(self) -> PointToPoint:
        """The move."""
        return self.program.task

    @property
    def solver(self) -> Solver:
        """What solves its problems."""
        return self.request.solver

    @property
    def starts(self) -> list[Array]:
        """Coefficients to start from."""
        return self.request.guesses

    @property
    def tolerances(self) -> Tolerances:
        """Of points between the ends: less exact than a plan; steps are doubled once."""
        return Tolerances(energy=1e-4, most_steps=2 * self.program.steps)

    def problem(
        self, residual_limit: float = np.inf, minimise: Mapping[str, float] = LEAST_ENERGY
    ) -> Program:
        """The problem at a residual limit [m]."""
        return self.program.within(residual_limit, self.request.bound, minimise)

    def certify(
        self,
        solutions: Sequence[tuple[Solution, Place]],
        most_residual: float = np.inf,
        *,
        free: bool = False,
    ) -> list[Certificate]:
        """Give solutions, each with its place, the figures of another integrator.

        Their residuals are their limits, unless it is the cheapest of all, whose residual is free.
        What was not solved is a failed point.
        """
        solved = [solution for solution, _ in solutions if solution.status.solved]
        problems = [self.problem(np.inf if free else solution.residual) for solution in solved]
        outcomes = certify(
            problems,
            solved,
            self.solver,
            OF_A_PLAN if free else self.tolerances,
            (Limit.of_residual(most_residual, self.task.plant.tip_unit), *self.task.limits),
        )
        remaining = iter(outcomes)
        certificates: list[Certificate] = []
        for solution, place in solutions:
            outcome = next(remaining) if solution.status.solved else solution.status.text
            if isinstance(outcome, Certified):
                certificates.append(self.point_of(outcome))
            else:
                failed = FailedPoint(place, str(outcome))
                certificates.append(Certificate(failed, solution.iterations))
        return certificates

    def point_of(self, certified: Certified) -> Certificate:
        """A certified solution as a point."""
        solution = certified.solution
        point = FrontPoint(
            self.program.profile.checked(solution.coefficients),
            certified.checked.residual,
            certified.checked.energy,
            solution.shadow_prices,
        )
        return Certificate(point, solution.iterations)

    def to_front(
        self,
        method: str,
        certificates: Iterable[Certificate],
        points: int,
        *,
        iterations: int = 0,
        settings: Mapping[str, Setting] = {},
    ) -> Front:
        """The points as a front, whose record states how many there were to be, and these settings.

        Iterations are those that no certificate counts.
        """
        ended = list(certificates)
        failures = tuple(end.point for end in ended if isinstance(end.point, FailedPoint))
        certified = [end.point for end in ended if isinstance(end.point, FrontPoint)]
        record = self.request.record(
            method,
            iterations + sum(end.iterations for end in ended),
            0.0,
            points=points,
            steps=self.program.steps,
            **settings,
        )
        return Front(
            task=self.task,
            profile=self.program.profile,
            points=non_dominated(certified),
            record=record,
            reference=reference_corner(self.task),
            failed=len(failures),
            failures=failures,
        )


def curve_of(
    front: Front, *, starts: int, steps: int | None = None, solver: Solver = Sqp()
) -> Curve:
    """The curve of a front that is there already, within its bound; it must have a point."""
    front.smallest_residual()
    seed = front.record.seed or 0
    bound = front.record.bound
    return Curve.begin(Request(front.task, front.profile, solver, bound, starts, seed, steps))
