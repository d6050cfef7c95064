"""What one joint motion leaves and costs on many plants with errors: a plant in each row."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.ocp.interrupts import keep_interrupts
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.free_vibration import FreeVibration
from quietarm.ocp.simulation.grid import ROLLOUT_STEPS, default_steps
from quietarm.ocp.solvers.batch import batch
from quietarm.ocp.task import PointToPoint
from quietarm.ocp.uncertainty import perturb_plant

_BLOCK = 1000
"""Plants a call."""


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
        self._task, self._names = task, names
        self._coefficients = profile.checked(coefficients, task.duration)
        breaks = profile.breaks(task.duration)
        self._batch = batch(task.plant, profile, steps, ("torque",), names, task.energy, breaks)

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
        errors = {name: ca.DM(column) for name, column in zip(self._names, block.T, strict=True)}
        plants, targets = perturb_plant(task.plant, errors), np.full(count, task.target)
        vibrations = FreeVibration(plants, targets, task.residual_window)
        residual = vibrations.peak(task.missed(found.arrival))
        return np.column_stack([residual, found.energy, np.abs(found.limited).max(axis=1)])
