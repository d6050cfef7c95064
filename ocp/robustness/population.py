"""What one joint motion leaves and costs on many plants with errors: a plant in each row."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.models import Expression, JointMotion, Plant
from quietarm.ocp.interrupts import keep_interrupts
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.buffered import BufferedFunction
from quietarm.ocp.simulation.collocation import NODES, step
from quietarm.ocp.simulation.residual import residual_samples
from quietarm.ocp.simulation.rollout import ROLLOUT_STEPS, default_steps
from quietarm.ocp.solvers.batch import batch
from quietarm.ocp.task import PointToPoint
from quietarm.ocp.uncertainty import perturb_plant

_BLOCK = 100
"""Plants a call."""

_DOUBLINGS = 4
_STRIDE = 2**_DOUBLINGS
"""The residual is sampled at a multiple of so many times."""


@dataclass(frozen=True, eq=False)
class Figures:
    """What a motion leaves and costs: one entry for each plant, arrays are read-only.

    Attributes
    ----------
    residual : ndarray
        F1 [m].
    energy : ndarray
        F2 [J].
    peak_torque : ndarray
        Largest absolute torque during the move [N m], over the nodes of the steps.
    """

    residual: NDArray[np.float64]
    energy: NDArray[np.float64]
    peak_torque: NDArray[np.float64]

    def __post_init__(self) -> None:
        for array in vars(self).values():
            array.setflags(write=False)

    def part(self, first: int, count: int) -> Figures:
        """So many entries from the first on."""
        return Figures(*(array[first : first + count].copy() for array in vars(self).values()))


class ErrorPopulation:
    """Residual, energy and peak torque of one motion on plants with errors.

    The joint follows its planned path whatever the plant; energy and torque are what that takes.
    """

    @keep_interrupts()  # casadi loses a Ctrl-C
    def __init__(
        self,
        task: PointToPoint,
        profile: JointProfile,
        coefficients: ArrayLike,
        ranges: dict[str, float],
    ) -> None:
        names, faster = tuple(ranges), 1 + max(ranges.values())  # any of them may be a frequency
        steps = max(ROLLOUT_STEPS, int(np.ceil(faster * default_steps(task, least=1))))
        self._task = task
        self._coefficients = profile.checked(coefficients, task.duration)
        self._samples = _STRIDE * int(np.ceil(faster * residual_samples(task) / _STRIDE))
        breaks = profile.breaks(task.duration)
        self._batch = batch(task.plant, profile, steps, ("torque",), names, task.energy, breaks)
        self._at_rest = BufferedFunction(_at_rest(task.plant, names))

    @keep_interrupts()
    def __call__(
        self, errors: ArrayLike, report: Callable[[int, int], object] | None = None
    ) -> Figures:
        """Evaluate plants by their errors, shape (plants, names), in the order of the ranges."""
        plants = np.asarray(errors, dtype=float)
        rows = [np.empty((0, 3))]
        for first in range(0, len(plants), _BLOCK):
            block = plants[first : first + _BLOCK]
            rows.append(self._evaluate(block))
            if report is not None:
                report(first + len(block), len(plants))
        return Figures(*np.vstack(rows).T.copy())

    def _evaluate(self, block: NDArray[np.float64]) -> NDArray[np.float64]:
        count, task = len(block), self._task
        motion, row = (np.tile(one, (count, 1)) for one in (self._coefficients, task.row))
        found = self._batch.values(motion, row, block)
        between = task.residual_window / (self._samples - 1)
        filled = np.resize(block, (_BLOCK, block.shape[1]))
        transition, tips = (
            rows.T[:count] for rows in self._at_rest(filled.T, task.target, between)
        )
        size = found.arrival.shape[1]
        tip_of_state = np.zeros((count, tips.shape[1] // (size // 2), size))
        tip_of_state[:, :, : size // 2] = tips.reshape(count, -1, size // 2)
        of_window = _at_samples(
            tip_of_state, transition.reshape(count, size, size),
            task.missed(found.arrival)[:, :, None], self._samples,
        )  # fmt: skip
        residual = np.abs(of_window).max(axis=(1, 2))
        return np.column_stack([residual, found.energy, np.abs(found.limited).max(axis=1)])


def _at_samples(
    tips: NDArray[np.float64],
    transition: NDArray[np.float64],
    state: NDArray[np.float64],
    samples: int,
) -> NDArray[np.float64]:
    """Tips at rest at every sample of the window, by powers of the transition between two.

    Tips (plants, tips, states) are taken over `_STRIDE` samples, states (plants, states, 1) over
    strides; each product of the two is a sample.
    """
    for _ in range(_DOUBLINGS):
        tips = np.concatenate([tips, tips @ transition], axis=1)
        transition = transition @ transition
    strides = samples // _STRIDE
    while state.shape[2] < strides:
        state = np.concatenate([state, transition @ state], axis=2)
        transition = transition @ transition
    return tips @ state[:, :, :strides]


@lru_cache(maxsize=16)
def _at_rest(plant: Plant, names: tuple[str, ...]) -> ca.Function:
    """(errors, target, time between samples) -> transition between two samples, tips of the modes.

    A row a plant; each matrix is laid out row by row.
    """
    errors, target, between = ca.MX.sym("e", _BLOCK, len(names)), ca.MX.sym("a"), ca.MX.sym("dt")
    resting = perturb_plant(plant, dict(zip(names, ca.horzsplit(errors, 1), strict=True)))
    modes = range(plant.modes)
    by_column = step(resting, [JointMotion(target, 0.0, 0.0)] * NODES, between).transition()[1]
    transition = [column[row] for row in range(2 * plant.modes) for column in by_column]
    of_mode = [resting.tip_displacements([float(i == j) for i in modes]) for j in modes]
    tips = [column[tip] for tip in range(plant.tips) for column in of_mode]
    return ca.Function("at_rest", [errors, target, between], [_rows(transition), _rows(tips)])


def _rows(columns: list[Expression]) -> Expression:
    """Columns side by side, one row for each plant; some may not depend on the errors."""
    return ca.horzcat(*(ca.DM.zeros(_BLOCK, 1) + column for column in columns))
