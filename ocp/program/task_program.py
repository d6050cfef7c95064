"""One task's numbers in the nonlinear program: scales, residual rows, axes."""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from ocp.base.interrupts import keep_interrupts
from ocp.profiles.joint_profile import JointProfile
from ocp.program.condensed import condensed
from ocp.program.solution import ENERGY
from ocp.program.step_model import by_group
from ocp.program.transcription import RESIDUAL
from ocp.simulation.residual import residual_rows
from ocp.task.point_to_point import PointToPoint

_ROWS_AT_ONCE = 32
"""Residual rows are padded to a multiple of this, so that similar tasks share a program."""


class TaskProgram:
    """One task's numbers for the program of a number of steps.

    Everything is measured against the profile with all coefficients zero, so that the solver sees
    numbers of order one for any plant.

    Parameters
    ----------
    task : PointToPoint
        The move.
    profile : JointProfile
        How the joint moves.
    steps : int
        Number of steps.

    Attributes
    ----------
    of_cycloid : float
        Residual of the plain cycloid [m].
    """

    @keep_interrupts()  # building, too, loses a Ctrl-C
    def __init__(self, task: PointToPoint, profile: JointProfile, steps: int) -> None:
        self.task, self.profile, self.steps = task, profile, steps
        self.motion = motion = condensed(task.plant, profile, steps, tuple(task.limits))
        self.even_axes = motion.even_axes(task.move)
        self.scale = np.ones(motion.scales)
        states, outputs, _ = self.figures(np.zeros(profile.size))
        peaks = [np.abs(rows).max() for rows in self.by_group(outputs).values()]
        self.scale = np.array([*np.abs(states).max(axis=1), *peaks])
        self.scale[self.scale == 0] = 1.0
        names = [group.name for group in motion.groups[1:]]
        self.reference = dict(zip(names, self.scale[motion.states :].tolist(), strict=True))
        self.reference[ENERGY] = self.reference["power"] * task.duration
        matrix = _filled_up(residual_rows(task)) * self.scale[: motion.states]
        self.of_cycloid = float(
            np.abs(matrix @ (states[:, -1] / self.scale[: motion.states])).max()
        )
        self.reference[RESIDUAL] = float(np.abs(matrix).max())
        self.matrix = matrix / self.reference[RESIDUAL]

    def figures(
        self, coefficients: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
        """Scaled states after every step, outputs of every step, energy."""
        inputs = (coefficients, self.task.move, self.scale)
        values = self.motion.figures(*(ca.DM(value) for value in inputs))
        states, outputs, energy = (value.full() for value in values)
        return states, outputs, energy.item()

    def by_group(self, outputs: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        """Outputs by the quantity's name."""
        return by_group(self.motion.groups[1:], outputs)

    def peaks(self, arrival: NDArray[np.float64], outputs: NDArray[np.float64]) -> dict[str, float]:
        """The residual of a scaled state on arrival, and the peaks of scaled outputs."""
        values = {RESIDUAL: self.matrix @ arrival, **self.by_group(outputs)}
        return {
            name: float(np.abs(value).max()) for name, value in values.items() if name != "power"
        }


def _filled_up(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.pad(rows, ((0, -len(rows) % _ROWS_AT_ONCE), (0, 0)), mode="edge")
