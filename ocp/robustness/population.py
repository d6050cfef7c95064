"""What one joint motion leaves and costs on many plants with errors, in one casadi call.

The same symbolic rollout as that of searches, with a plant in each row in the place of a candidate.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.models import Expression, JointMotion, Plant
from quietarm.ocp.energy import Energy
from quietarm.ocp.interrupts import keep_interrupts
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.simulation.buffered import BufferedFunction
from quietarm.ocp.simulation.collocation import NODES, step
from quietarm.ocp.simulation.errors import with_errors
from quietarm.ocp.simulation.residual import residual_samples
from quietarm.ocp.simulation.rollout import ROLLOUT_STEPS, default_steps, node_times, rollout_along
from quietarm.ocp.task import PointToPoint

_BLOCK = 50
"""Plants a call: their intermediate values fit the processor's cache."""

_DOUBLINGS = 4
_STRIDE = 2**_DOUBLINGS
"""The residual is sampled at a multiple of so many times."""

_STEPS_OF_CSE = 2 * ROLLOUT_STEPS
"""Common terms are looked for up to these steps: that takes a third off a call, but a time that
grows with the square of the steps."""


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
        self.names = tuple(ranges)
        self._task = task
        faster = 1 + max(ranges.values())  # any of the parameters may be a frequency
        resolved = default_steps(task, least=1)
        steps = max(ROLLOUT_STEPS, int(np.ceil(faster * resolved)))
        self._samples = _STRIDE * int(np.ceil(faster * residual_samples(task) / _STRIDE))
        breaks = profile.breaks(task.duration)
        times, length = node_times(steps, breaks=breaks)
        joint = _joint_at(times, task, profile, coefficients)
        between = task.residual_window / (self._samples - 1)
        self._function = BufferedFunction(
            _compiled(task.plant, length.shape[1], self.names, not breaks, task.energy)
        )
        times = *task.move[1:], between
        self._along = joint.T.full(), length.T.full(), *times, task.initial_state

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
        count = len(block)
        errors = np.zeros((block.shape[1], _BLOCK))
        errors[:, :count] = block.T
        arrival, transition, tips, energy, torque = self._function(errors, *self._along)
        size = len(arrival)
        tip_of_state = np.zeros((_BLOCK, len(tips) // (size // 2), size))
        tip_of_state[:, :, : size // 2] = tips.T.reshape(_BLOCK, -1, size // 2)
        of_window = _at_samples(
            tip_of_state, transition.T.reshape(_BLOCK, size, size),
            self._task.missed(arrival.T)[:, :, None], self._samples,
        )  # fmt: skip
        residual = np.abs(of_window).max(axis=(1, 2))
        return np.column_stack([residual, energy[0], np.abs(torque).max(axis=0)])[:count]


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


def _joint_at(
    times: Sequence[ca.DM], task: PointToPoint, profile: JointProfile, coefficients: ArrayLike
) -> ca.DM:
    """Angle, speed and acceleration at every node of a step, shape (3 * NODES, steps)."""
    checked = profile.checked(coefficients, task.duration)
    return ca.vertcat(*(row for at in times for row in profile.motion(checked, at, *task.move)[:3]))


@lru_cache(maxsize=16)
def _compiled(
    plant: Plant, steps: int, names: tuple[str, ...], unbroken: bool, energy: Energy
) -> ca.Function:
    """(errors, joint, length of steps, target, duration, time between samples, state) -> figures.

    A row a plant: state on arrival; the transition of the state between two samples at rest and the
    tips of the modes, both row by row; energy; torque at the nodes.
    """
    errors, joint = ca.MX.sym("e", _BLOCK, len(names)), ca.MX.sym("joint", 3 * NODES, steps)
    length = ca.MX.sym("length", 1, steps)
    target, duration, between = (ca.MX.sym(name) for name in ("target", "duration", "dt"))
    initial = ca.MX.sym("initial", 2 * plant.modes)
    columns = dict(zip(names, ca.horzsplit(errors, 1), strict=True))
    moving = with_errors(plant, {n: ca.repmat(e, 1, steps) for n, e in columns.items()})
    resting, modes = with_errors(plant, columns), range(plant.modes)
    rows = [ca.repmat(row, _BLOCK, 1) for row in ca.vertsplit(joint)]
    joints = [JointMotion(*rows[3 * node : 3 * node + 3]) for node in range(NODES)]
    rollout = rollout_along(
        moving, joints, duration * ca.repmat(length, _BLOCK, 1), energy, unbroken=unbroken,
        initial=ca.vertsplit(initial),
    )  # fmt: skip
    by_column = step(resting, [JointMotion(target, 0.0, 0.0)] * NODES, between).transition()[1]
    transition = [column[row] for row in range(2 * plant.modes) for column in by_column]
    of_mode = [resting.tip_displacements([float(i == j) for i in modes]) for j in modes]
    tips = [column[tip] for tip in range(plant.tips) for column in of_mode]
    outputs = [
        rollout.arrival, _rows(transition), _rows(tips), rollout.energy,
        ca.horzcat(*rollout.torque),
    ]  # fmt: skip
    inputs = [errors, joint, length, target, duration, between, initial]
    return ca.Function("errors", inputs, outputs, {"cse": steps <= _STEPS_OF_CSE})


def _rows(columns: list[Expression]) -> Expression:
    """Columns side by side, one row for each plant; some may not depend on the errors."""
    return ca.horzcat(*(ca.DM.zeros(_BLOCK, 1) + column for column in columns))
