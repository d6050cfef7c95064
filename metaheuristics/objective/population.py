"""The objectives of a whole population: the values of the gradient's batch, a row a candidate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.ocp import JointProfile, PointToPoint
from quietarm.ocp.checks import takes, whole
from quietarm.ocp.front.points import table_of
from quietarm.ocp.interrupts import keep_interrupts, one_at_a_time
from quietarm.ocp.profiles.check_profile import check_profile
from quietarm.ocp.simulation.free_vibration import after_arrival
from quietarm.ocp.simulation.grid import default_steps
from quietarm.ocp.solvers.batch import Batch, batch

CANDIDATE_STEPS, _STEPS_A_TERM, _WITH_LIMITS = 24, 4, 64
"""Steps of every search: the least, those for each coefficient, and the least with limits."""
ACCURACY = 5e-4
"""Residuals and energies of random candidates in the boxes of all named problems are within this
share of those of much finer steps; docs/measures.md has what was measured."""
UNUSABLE = 1e30
"""A figure from here up counts as not finite. This value replaces it, because algorithms can sort
it: it comes last."""


def search_steps(task: PointToPoint, profile: JointProfile) -> int:
    """Steps at which every search sees a move, whether it runs here or in another library."""
    least = max(_WITH_LIMITS if task.limits else CANDIDATE_STEPS, _STEPS_A_TERM * profile.size)
    return default_steps(task, least=least)


@dataclass(frozen=True)
class PopulationValues:
    """Objectives and constraint violations of a population; rows are candidates.

    Attributes
    ----------
    residual : ndarray, shape (candidates,)
        F1 [m].
    energy : ndarray, shape (candidates,)
        F2 [J].
    violations : ndarray, shape (candidates, limits)
        Each limited peak over its limit, less 1: positive if the limit is violated.
    """

    residual: NDArray[np.float64]
    energy: NDArray[np.float64]
    violations: NDArray[np.float64]


class PopulationObjective:
    """F1, F2 and the violations of a task's limits for many candidates at once.

    Start, target, duration, initial state, limits and the residual matrix are parameters
    of the compiled function: an objective for another task with the same plant, profile and limited
    quantities is not compiled again.

    Parameters
    ----------
    task : PointToPoint
        The move.
    profile : JointProfile
        How the joint moves.
    steps : int, optional
        Number of steps; those of `search_steps` by default.
    threads : int
        Blocks of candidates that are evaluated at the same time.

    Raises
    ------
    ValueError
        When `threads` is below 1.
    """

    @one_at_a_time
    @keep_interrupts()  # casadi loses a Ctrl-C
    @takes(task=PointToPoint, profile=JointProfile)
    def __init__(
        self,
        task: PointToPoint,
        profile: JointProfile,
        *,
        steps: int | None = None,
        threads: int = 1,
    ) -> None:
        check_profile(profile)
        self.task, self.profile, self.threads = task, profile, whole("threads", threads, 1)
        self.steps = search_steps(task, profile) if steps is None else whole("steps", steps, 1)
        self._scenarios = np.array(task.scenarios)
        self._tip_rows = [vibration.rows for vibration in after_arrival(task)]

    @property
    def _batch(self) -> Batch:
        """Kept by whoever asks for it, since casadi's functions can be neither copied nor sent."""
        task = self.task
        limited, names = tuple(limit.quantity for limit in task.limits), task.error_names
        return batch(task.plant, self.profile, self.steps, limited, names, task.energy)

    @keep_interrupts()
    def __call__(self, coefficients: ArrayLike) -> PopulationValues:
        """Evaluate a population.

        Parameters
        ----------
        coefficients : array_like, shape (candidates, profile.size)
            One candidate a row.

        Returns
        -------
        PopulationValues
            One row a candidate, in the same order; NaN where a candidate is not finite.

        Raises
        ------
        ValueError
            When they are no plain numbers, or their shape does not fit the profile.
        """
        population = table_of(coefficients, self.profile.size)
        count, scenarios = len(population), len(self._scenarios)
        # scenario by scenario: the first rows are the candidates on the nominal plant
        rows = np.tile(population, (scenarios, 1))
        move = np.tile(self.task.row, (len(rows), 1))
        errors = np.repeat(self._scenarios, count, axis=0)
        found = self._batch.values(rows, move, errors, self.threads)
        missed = self.task.missed(found.arrival)
        missed = missed.reshape(scenarios, count, len(self.task.final_state))
        each = zip(missed, self._tip_rows)
        residual = np.max([np.abs(z @ tips.T).max(axis=1) for z, tips in each], axis=0)
        violations = np.empty((count, len(self.task.limits)))
        for i, limit in enumerate(self.task.limits):
            values = found.limited[:, self._batch.places[limit.name]]
            peak = limit.peak(values.min(axis=1), values.max(axis=1)).reshape(scenarios, count)
            largest = peak.max(axis=0) if limit.quantity.in_scenarios else peak[0]
            violations[:, i] = largest / limit.size - 1
        return PopulationValues(residual, found.energy[:count], violations)


def replace_failures(table: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Fill the rows of a table that are not finite with `UNUSABLE`; tells which these are."""
    usable = np.all(np.abs(table) < UNUSABLE, axis=1)  # NaN is not less, either
    failed = np.asarray(~usable, dtype=bool)
    table[failed] = UNUSABLE
    return failed
