"""The objectives of a whole population in one casadi call.

The equations and definitions are those of the gradient answer: the same symbolic rollout, with one
row a candidate. casadi's virtual machine runs over the rows, so no compiler is needed, and sines
and cosines of every candidate and time point are taken in a few long operations.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from models import Expression, Plant
from ocp import JointProfile, PointToPoint, residual_matrix, symbolic_rollout
from ocp.checks import whole
from ocp.interrupts import keep_interrupts
from ocp.residual import residual_samples
from ocp.rollout import SymbolicRollout, default_steps

LEAST_STEPS = 40
"""Steps that keep nine in ten random candidates of the paper's boxes within 1e-4 in energy."""
BLOCK = 200
"""Candidates a call: their intermediate values fit the processor's cache."""


@dataclass(frozen=True)
class PopulationValues:
    """What a population costs; rows are candidates.

    Attributes
    ----------
    residual : ndarray, shape (candidates,)
        F1 [m].
    energy : ndarray, shape (candidates,)
        F2 [J].
    violations : ndarray, shape (candidates, limits)
        Each limited peak over its limit, less 1: positive where the limit is broken.
    """

    residual: NDArray[np.float64]
    energy: NDArray[np.float64]
    violations: NDArray[np.float64]


class PopulationObjective:
    """F1, F2 and the violations of a task's limits for many candidates at once.

    Start, target, duration, limits and the residual matrix are parameters of the compiled function:
    an objective for another task of the same plant, profile and limited quantities costs no build.

    Parameters
    ----------
    task : PointToPoint
        The move.
    profile : JointProfile
        How the joint moves.
    steps : int, optional
        Number of steps; by default `LEAST_STEPS`, or more where the plant's modes need them.
    threads : int
        Blocks of candidates that are evaluated at the same time.

    Raises
    ------
    ValueError
        When `threads` is below 1.
    """

    def __init__(
        self,
        task: PointToPoint,
        profile: JointProfile,
        *,
        steps: int | None = None,
        threads: int = 1,
    ) -> None:
        self.task, self.profile, self.threads = task, profile, whole("threads", threads, 1)
        default = default_steps(task, least=LEAST_STEPS)
        self.steps = default if steps is None else whole("steps", steps, 1)
        samples = 1 << (residual_samples(task) - 1).bit_length()
        self._tip_of_state = ca.DM(residual_matrix(task, samples).T)
        self._limits = ca.DM(list(task.limits.values()))
        self._function = _compiled(task.plant, profile, self.steps, tuple(task.limits), samples)

    @keep_interrupts()  # casadi loses a Ctrl-C
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
            When the shape does not fit the profile.
        """
        population = np.asarray(coefficients, dtype=float)
        if population.ndim != 2 or population.shape[1] != self.profile.size:
            raise ValueError(
                f"the population has shape {population.shape}; give (candidates, "
                f"{self.profile.size})"
            )
        count = len(population)
        blocks = list(_blocks(population))
        if self.threads > 1 and len(blocks) > 1:
            with ThreadPoolExecutor(self.threads) as pool:
                rows = list(pool.map(self._evaluate, blocks))
        else:
            rows = [self._evaluate(block) for block in blocks]
        table = np.vstack(rows)[:count] if rows else np.empty((0, 2 + self._limits.numel()))
        return PopulationValues(table[:, 0], table[:, 1], table[:, 2:])

    def _evaluate(self, block: NDArray[np.float64]) -> NDArray[np.float64]:
        values = self._function(
            ca.DM(block), ca.DM(self.task.move), self._tip_of_state, self._limits
        )
        return values.full()


def _blocks(population: NDArray[np.float64]) -> Iterator[NDArray[np.float64]]:
    """Blocks of equal size; the last is filled up with plain cycloids."""
    for first in range(0, len(population), BLOCK):
        block = population[first : first + BLOCK]
        missing = BLOCK - len(block)
        yield np.vstack([block, np.zeros((missing, block.shape[1]))]) if missing else block


@lru_cache(maxsize=16)
def _compiled(
    plant: Plant, profile: JointProfile, steps: int, limited: tuple[str, ...], samples: int
) -> ca.Function:
    population = ca.MX.sym("a", BLOCK, profile.size)
    move, limits = ca.MX.sym("move", 3), ca.MX.sym("limits", len(limited))
    tip_of_state = ca.MX.sym("L", 2 * plant.modes, samples * plant.tips)
    columns = [ca.repmat(column, 1, steps) for column in ca.horzsplit(population, 1)]
    rollout = symbolic_rollout(plant, profile, columns, ca.vertsplit(move), steps, candidates=BLOCK)
    residual = _row_peak([rollout.arrival @ tip_of_state])
    peaks = _peaks(plant, rollout)
    violations = [_row_peak(peaks[name]) / limits[i] - 1 for i, name in enumerate(limited)]
    table = ca.horzcat(residual, rollout.energy, *violations)
    inputs = [population, move, tip_of_state, limits]
    return ca.Function("population", inputs, [table], {"cse": True})


def _peaks(plant: Plant, rollout: SymbolicRollout) -> dict[str, list[Expression]]:
    """The quantities that a task may limit, at the nodes."""
    tips = [tip for state in rollout.states for tip in plant.tip_displacements(state.W)]
    return {
        "torque": rollout.torque,
        "speed": [joint.speed for joint in rollout.joints],
        "acceleration": [joint.acceleration for joint in rollout.joints],
        "deflection": tips,
    }


def _row_peak(values: Sequence[Expression]) -> Expression:
    """Largest absolute entry of each row: the columns are folded onto each other by halves."""
    folded = ca.horzcat(*(ca.fabs(value) for value in values))
    while folded.shape[1] > 1:
        columns = folded.shape[1]
        half = (columns + 1) // 2
        upper = folded[:, columns - half :]  # overlaps the lower half where the count is odd
        folded = ca.fmax(folded[:, :half], upper)
    return folded
