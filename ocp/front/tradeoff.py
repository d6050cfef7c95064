"""A trade-off: a task on its steps, solved within many limits, certified, and made a front."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.checks import instance
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.front.front import Front, reference_corner
from quietarm.ocp.front.points import FailedPoint, FrontPoint, non_dominated, point_of
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.limits import RESIDUAL, Limit
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY, peak_quantities, with_peaks_measured
from quietarm.ocp.planning.certify import OF_A_PLAN, Certified, certify
from quietarm.ocp.planning.request import Request
from quietarm.ocp.planning.too_short import refuse_too_short
from quietarm.ocp.record import Setting
from quietarm.ocp.solvers.choice import stand_in_settings
from quietarm.ocp.solvers.problem import LEAST_ENERGY, MOST_SOLVER_STEPS, Program, Solution
from quietarm.ocp.solvers.solver import Solver
from quietarm.ocp.solvers.sqp import Sqp
from quietarm.ocp.task import PointToPoint

Array = NDArray[np.float64]
RESIDUAL_LIMIT = "residual_limit"
BETWEEN_ENDS = 1e-4
"""Share by which energies of points between the ends may differ: looser than a plan's."""


AskedPlace = Mapping[str, float]
"""Where a point was to be: a residual limit [m], or weights, by name."""


class Certificate(NamedTuple):
    """A point by the independent integrator, or why there is none.

    Beside it stand the iterations that it took, and what solved it, as a record states that.
    """

    point: FrontPoint | FailedPoint
    iterations: int
    solved_by: Mapping[str, Setting] = {}


@dataclass(frozen=True)
class Tradeoff:
    """A task of which motions are asked for at many limits: of the residual, and of peaks.

    Attributes
    ----------
    request : Request
        The move, and how it is solved.
    program : Program
        The task on its steps, with the peaks among the objectives measured.
    objectives : tuple of str
        Names of the objectives.
    """

    request: Request
    program: Program
    objectives: tuple[str, ...] = RESIDUAL_AND_ENERGY

    @classmethod
    def begin(cls, request: Request) -> Tradeoff:
        """Return the trade-off of residual and energy on the requested or the usual steps.

        InfeasibleTaskError where not even a rigid joint is as fast as the task.
        """
        request.profile.refuse_no_choice()
        refuse_too_short(request.task)
        return cls(request, Program.of(request.task, request.profile, request.steps))

    @classmethod
    def measured(
        cls, request: Request, objectives: tuple[str, ...], steps: int | None = None
    ) -> Tradeoff:
        """Return the trade-off of these objectives, on a number of steps."""
        task = with_peaks_measured(request.task, peak_quantities(objectives))
        program = Program.of(task, request.profile, steps or request.steps)
        return cls(request, program, objectives)

    @classmethod
    def of_front(
        cls, front: Front, *, starts: int, steps: int | None = None, solver: Solver = Sqp()
    ) -> Tradeoff:
        """Return the trade-off of a given front, within its bound; it must have a point."""
        front.smallest_residual()
        seed = front.record.seed or 0
        bound = front.record.bound
        instance("task", front.task, PointToPoint)  # a front of a function has none
        request = Request(front.task, front.profile, solver, bound, starts, seed, steps)
        if front.objectives == RESIDUAL_AND_ENERGY:
            return cls.begin(request)
        return cls.measured(request, front.objectives)

    @property
    def task(self) -> PointToPoint:
        """The move."""
        return self.request.task

    @property
    def axes(self) -> tuple[str, ...]:
        """The limited axes: the residual, and the quantities of the peaks."""
        return RESIDUAL, *peak_quantities(self.objectives)

    @property
    def solver(self) -> Solver:
        """The solver of its programs."""
        return self.request.solver

    @property
    def starts(self) -> list[Array]:
        """Coefficients to start from."""
        return self.request.guesses

    @property
    def most_steps(self) -> int:
        """Steps that points between the ends may take: they are doubled once."""
        return 2 * self.program.steps

    def problem(
        self,
        residual_limit: float = np.inf,
        minimise: Mapping[str, float] = LEAST_ENERGY,
        peaks: Mapping[str, float] = {},
    ) -> Program:
        """The program at a limit of the residual [m] and of peaks, within those of the task."""
        limits = {limit.name: limit for limit in self.task.limits}
        for name in self.axes[1:]:
            size = min(peaks.get(name, np.inf), limits[name].size if name in limits else np.inf)
            if size < np.inf:
                limits[name] = self.program.limits_of_task[name].widened_to(size)
        residual = Limit.of_residual(residual_limit, self.task.plant.tip_unit)
        return self.program.asking(
            limits=(residual, *limits.values()),
            bound=self.request.bound,
            minimise=minimise,
            offset=0.0,
        )

    def within(
        self, sizes: Mapping[str, float], minimise: Mapping[str, float] = LEAST_ENERGY
    ) -> Program:
        """The program within limits of these sizes by axis; where there is none it is free."""
        return self.problem(sizes.get(RESIDUAL, np.inf), minimise, sizes)

    def certify(
        self,
        solutions: Sequence[tuple[Solution, AskedPlace]],
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
            (Limit.of_residual(most_residual, self.task.plant.tip_unit), *self.task.limits),
            agreement=OF_A_PLAN if free else BETWEEN_ENDS,
            most_steps=MOST_SOLVER_STEPS if free else self.most_steps,
        )
        remaining = iter(outcomes)
        certificates: list[Certificate] = []
        for solution, place in solutions:
            outcome = next(remaining) if solution.status.solved else solution.status.text
            if isinstance(outcome, Certified):
                certificates.append(self.certificate_of(outcome))
            else:
                failed = FailedPoint(place, str(outcome))
                certificates.append(Certificate(failed, solution.iterations))
        return certificates

    def certify_within(
        self,
        solutions: Sequence[Solution],
        problems: Sequence[Program],
        limits: Sequence[Limit] | None = None,
    ) -> list[Certificate | SolverFailedError]:
        """Solutions of these programs as points, within these limits or those of the task alone."""
        tip_unit = self.task.plant.tip_unit
        outcomes = certify(
            problems,
            solutions,
            self.solver,
            limits or (Limit.of_residual(np.inf, tip_unit), *self.task.limits),
            agreement=BETWEEN_ENDS,
            most_steps=self.most_steps,
        )
        return [
            self.certificate_of(outcome) if isinstance(outcome, Certified) else outcome
            for outcome in outcomes
        ]

    def certificate_of(self, certified: Certified) -> Certificate:
        """A certified solution as a point; its peaks by CVODES where they are objectives."""
        solution = certified.solution
        profile = self.program.profile
        coefficients = profile.checked(solution.coefficients)
        if self.objectives == RESIDUAL_AND_ENERGY:
            figures = certified.figures
            point = FrontPoint(coefficients, figures.residual, figures.energy)
        else:
            motion = JudgedMotion.of_profile(self.task, profile, coefficients)
            point = point_of(motion, self.objectives)
        point = replace(point, shadow_prices=solution.shadow_prices)
        return Certificate(point, solution.iterations, solution.solved_by)

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
            **stand_in_settings(self.solver, [end.solved_by for end in ended]),
        )
        return Front(
            task=self.task,
            profile=self.program.profile,
            points=non_dominated(certified, self.objectives),
            record=record,
            reference=reference_corner(self.task, self.objectives),
            failed=len(failures),
            failures=failures,
            objectives=self.objectives,
        )
