"""The objectives of a whole population in one casadi call.

The equations and definitions are those of the gradient answer: the same symbolic rollout, with one
row per candidate. casadi's virtual machine runs over the rows, so no compiler is needed, and sines
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
from ocp import JointProfile, PointToPoint, symbolic_rollout
from ocp.base.checks import real_array, whole
from ocp.base.interrupts import keep_interrupts
from ocp.base.threads import one_at_a_time
from ocp.simulation.buffered import BufferedFunction
from ocp.simulation.residual import residual_rows
from ocp.simulation.rollout import SymbolicRollout, default_steps
from ocp.task.quantities import QUANTITIES, ask_for_jerk

CANDIDATE_STEPS = 24
"""Steps that keep the energy of nine in ten random candidates of the paper's boxes within 1e-4, and
W at arrival within 1e-6 m."""
BLOCK = 100
"""Candidates a call: their intermediate values fit the processor's cache."""
UNUSABLE = 1e30
"""A figure from here up counts as not finite. This value replaces it, because algorithms can sort
it: it comes last."""


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
        Number of steps; by default `CANDIDATE_STEPS`, or more where the plant's modes need them.
    threads : int
        Blocks of candidates that are evaluated at the same time.
    often : bool
        Whether it is called often. If not, the function is built several times faster, and a call
        takes up to twice as long; the figures are the same.

    Raises
    ------
    ValueError
        When `threads` is below 1.
    """

    @one_at_a_time
    @keep_interrupts()  # casadi loses a Ctrl-C
    def __init__(
        self,
        task: PointToPoint,
        profile: JointProfile,
        *,
        steps: int | None = None,
        threads: int = 1,
        often: bool = True,
    ) -> None:
        self.task, self.profile, self.threads = task, profile, whole("threads", threads, 1)
        default = default_steps(task, least=CANDIDATE_STEPS)
        self.steps = default if steps is None else whole("steps", steps, 1)
        self._tip_of_state = residual_rows(task).T
        self._limits = np.array(list(task.limits.values()))
        self._idle: list[BufferedFunction] = []
        self._function = _compiled(task.plant, profile, self.steps, tuple(task.limits), often)

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
            When they are no real numbers, or their shape does not fit the profile.
        """
        population = real_array("coefficients", coefficients, "rows of numbers")
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
        table = np.vstack(rows)[:count] if rows else np.empty((0, 2 + self._limits.size))
        return PopulationValues(table[:, 0], table[:, 1], table[:, 2:])

    def _evaluate(self, block: NDArray[np.float64]) -> NDArray[np.float64]:
        try:
            buffered = self._idle.pop()
        except IndexError:  # all are in use by other threads, or none is made yet
            buffered = BufferedFunction(self._function)
        arrival, table = buffered(block.T, self.task.move, self._limits)
        residual = np.abs(arrival.T @ self._tip_of_state).max(axis=1)
        rows = np.column_stack([residual, table.T])
        self._idle.append(buffered)
        return rows

    def __getstate__(self) -> dict[str, object]:
        return {**self.__dict__, "_idle": []}  # casadi's buffers can be neither copied nor pickled


def replace_failures(table: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Fill the rows of a table that are not finite with `UNUSABLE`; tells which these are."""
    usable = np.all(np.abs(table) < UNUSABLE, axis=1)  # NaN is not less, either
    failed = np.asarray(~usable, dtype=bool)
    table[failed] = UNUSABLE
    return failed


def _blocks(population: NDArray[np.float64]) -> Iterator[NDArray[np.float64]]:
    """Blocks of equal size; the last is filled up with plain cycloids."""
    for first in range(0, len(population), BLOCK):
        block = population[first : first + BLOCK]
        missing = BLOCK - len(block)
        yield np.vstack([block, np.zeros((missing, block.shape[1]))]) if missing else block


@lru_cache(maxsize=32)
def _compiled(
    plant: Plant, profile: JointProfile, steps: int, limited: tuple[str, ...], often: bool
) -> ca.Function:
    population = ca.MX.sym("a", BLOCK, profile.size)
    move, limits = ca.MX.sym("move", 3), ca.MX.sym("limits", len(limited))
    columns = [ca.repmat(column, 1, steps) for column in ca.horzsplit(population, 1)]
    rollout = symbolic_rollout(
        plant, profile, columns, ca.vertsplit(move), steps, BLOCK, ask_for_jerk(limited)
    )
    at_nodes = [_at_nodes(plant, rollout, name) for name in limited]
    violations = [_row_peak(values) / limits[i] - 1 for i, values in enumerate(at_nodes)]
    outputs = [rollout.arrival, ca.horzcat(rollout.energy, *violations)]
    return ca.Function("population", [population, move, limits], outputs, {"cse": often})


def _at_nodes(plant: Plant, rollout: SymbolicRollout, name: str) -> list[Expression]:
    """A quantity that a task may limit, at the nodes."""
    nodes = zip(rollout.joints, rollout.states, rollout.torque, strict=True)
    return [
        value
        for joint, state, torque in nodes
        for value in QUANTITIES[name].of(joint, plant.tip_displacements(state.W), torque)
    ]


def _row_peak(values: Sequence[Expression]) -> Expression:
    """Largest absolute entry of each row: the columns are folded onto each other by halves."""
    folded = ca.horzcat(*(ca.fabs(value) for value in values))
    while folded.shape[1] > 1:
        columns = folded.shape[1]
        half = (columns + 1) // 2
        upper = folded[:, columns - half :]  # overlaps the lower half where the count is odd
        folded = ca.fmax(folded[:, :half], upper)
    return folded
