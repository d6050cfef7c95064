"""A move as a plain function of arrays, for any optimisation library."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.interrupts import interruptible
from quietarm.metaheuristics.evaluation.population import (
    measured_figures,
    replace_failures,
    search_evaluator,
)
from quietarm.metaheuristics.problems.problem_function import ProblemFunction, Rows
from quietarm.ocp import Front, JointProfile, PointToPoint, reference_corner
from quietarm.ocp.checks import takes
from quietarm.ocp.front.points import Entries, FrontPoint, evaluated
from quietarm.ocp.objectives import (
    RESIDUAL_AND_ENERGY,
    checked_objectives,
    objectives_on,
    peak_quantities,
    with_peaks_measured,
)
from quietarm.ocp.planning.choose_profile import choose_profile
from quietarm.ocp.record import Record, coefficient_bound
from quietarm.ocp.simulation.evaluator import Evaluation

Array = NDArray[np.float64]
KEPT_FREE = 0.005
"""Share of every limit: the verification sees peaks between the steps of a search."""


class MoveFunction(ProblemFunction):
    """The objectives and the violations of a move, for many candidates at once.

    All objectives are minimised; a candidate is feasible if no violation is positive.

    Parameters
    ----------
    task : PointToPoint
        The move; its limits become constraints.
    profile : JointProfile, optional
        How the joint moves; by default the polynomial that `plan_move` takes for the task.
    bound : float, optional
        Largest absolute coefficient; required, unless the profile has a `default_bound`.
    objectives : sequence of str
        Names of the objectives: residual, energy, and peaks during the move, as
        ``"peak_torque"``.
    steps : int, optional
        Steps of the simulation; those of every search by default, as of `search_steps`.
    threads : int
        Blocks of candidates that are evaluated at the same time.

    Attributes
    ----------
    lower, upper : ndarray, shape (variables,)
        The box of the coefficients; they have no unit.
    variables, objectives, constraints : tuple of str
        Names, in the order of the columns; residual and energy are the first objectives.
    units : tuple of str
        SI units of the objectives. Violations are shares of the limit, without a unit.

    Raises
    ------
    ValueError
        When there is no bound, an objective is not known, or a number is out of range.
    """

    @takes(task=PointToPoint, profile=JointProfile)
    def __init__(
        self,
        task: PointToPoint,
        profile: JointProfile | None = None,
        *,
        bound: float | None = None,
        objectives: Sequence[str] = RESIDUAL_AND_ENERGY,
        steps: int | None = None,
        threads: int = 1,
    ) -> None:
        profile = choose_profile(task) if profile is None else profile
        bound = profile.default_bound if bound is None else bound
        if bound is None:
            raise ValueError("give a bound on the coefficients, within which to search")
        bound = coefficient_bound(bound)
        profile.refuse_no_choice()
        self.task = task
        self.profile = profile
        self.bound = bound
        self.objectives = checked_objectives(objectives)
        self.peaks = peak_quantities(self.objectives)
        self.lower, self.upper = (np.array(side, dtype=float) for side in profile.box(bound))
        self.variables = tuple(f"a_{i + 1}" for i in range(profile.size))
        self.units = tuple(entry.unit for entry in objectives_on(task.plant, self.objectives))
        self.constraints = tuple(limit.quantity.limit for limit in task.limits)
        measured = with_peaks_measured(task, self.peaks)
        self._evaluator = search_evaluator(measured, profile, steps, threads)
        self._limited = [limit.name for limit in task.limits]

    @property
    def kept_free(self) -> float:
        """Return the share of a limit that a method which ends on limits keeps free."""
        return KEPT_FREE

    @interruptible
    def __call__(self, candidates: ArrayLike) -> tuple[Array, Array]:
        """Evaluate candidates.

        Parameters
        ----------
        candidates : array_like, shape (candidates, variables)
            Coefficients, one candidate a row.

        Returns
        -------
        objectives : ndarray, shape (candidates, objectives)
            Residual [m], energy [J], then the peaks, each in its SI unit. A candidate whose motion
            overflows has 1e30 everywhere, so that it comes last.
        violations : ndarray, shape (candidates, constraints)
            Each limited peak over its limit, less 1: positive where the limit is broken.

        Raises
        ------
        ValueError
            When they are no plain numbers, or the shape is another.
        """
        with np.errstate(all="ignore"):  # coefficients of any size
            objectives, violations = self._figures(self._evaluator(candidates))
        table = np.column_stack([objectives, violations])
        replace_failures(table)
        count = len(self.objectives)
        return table[:, :count], table[:, count:]

    def _figures(self, evaluation: Evaluation) -> tuple[Array, Array]:
        """Objectives and violations of what was simulated."""
        return measured_figures(evaluation, self.peaks, self._limited)

    @property
    def corner(self) -> tuple[float, ...]:
        """Return the corner of the task."""
        return reference_corner(self.task, self.objectives)

    def points_of(
        self, coefficients: Array, values: Array, bound: float | None
    ) -> tuple[FrontPoint, ...]:
        """The points of a front by CVODES, whatever the steps of the search gave."""
        del values
        return evaluated(
            self.task, self.profile, coefficients, bound, objectives=self.objectives
        ).points

    def entries_of(
        self, candidates: tuple[int, ...], coefficients: Rows, objectives: Rows, believed: Rows
    ) -> Entries:
        """Return the entries of a front of the move."""
        residuals, energies, *others = objectives
        peaks = dict(zip(self.peaks, others))
        return Entries(candidates, coefficients, residuals, energies, peaks, believed)

    def front_with(self, points: tuple[FrontPoint, ...], record: Record, **entries: Any) -> Front:
        """The front of the move."""
        return Front(self.task, self.profile, points, record, objectives=self.objectives, **entries)
