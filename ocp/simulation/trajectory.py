"""A motion sampled in time, and the equations that give what is sampled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.models import Expression, JointMotion, Plant
from quietarm.models.joint_motion import Modes
from quietarm.ocp.sample import Sample, sample_plant, symbolic_sample


@dataclass(frozen=True)
class Trajectory:
    """A motion sampled in time; rows are samples, arrays are read-only.

    Attributes
    ----------
    time : ndarray, shape (samples,)
        Times [s]; arrival is at the task's duration.
    sample : Sample
        Joints, modes, tips and torques, every value of shape (samples,); jerks between jumps of
        the acceleration; torques after arrival hold the joints against the vibration.
    """

    time: NDArray[np.float64]
    sample: Sample

    @classmethod
    def from_outputs(
        cls, plant: Plant, time: NDArray[np.float64], outputs: NDArray[np.float64]
    ) -> Trajectory:
        """Name the rows of `outputs_of`, whose columns are samples at these times [s]."""
        own_time = time.copy()
        rows = np.ascontiguousarray(outputs).copy()
        for array in (own_time, rows):
            array.setflags(write=False)
        return cls(own_time, symbolic_sample(plant).with_values(rows))

    @property
    def motion(self) -> JointMotion:
        """Angle, speed, acceleration and jerk along the path, each of shape (samples,)."""
        return self.sample.path

    @cached_property
    def joint(self) -> NDArray[np.float64]:
        """Angle, speed and acceleration of the first joint, shape (samples, 3)."""
        return _columns(self.sample.joints[0][:3])

    @property
    def jerk(self) -> NDArray[np.float64]:
        """Rate of change of the first joint's acceleration [rad/s^3]."""
        return self.sample.joints[0].jerk

    @cached_property
    def modes(self) -> NDArray[np.float64]:
        """Modal amplitudes W [m], shape (samples, modes)."""
        return _columns(self.sample.W)

    @cached_property
    def tips(self) -> NDArray[np.float64]:
        """Tip displacements [m], shape (samples, tips)."""
        return _columns(self.sample.tips)

    @property
    def torque(self) -> NDArray[np.float64]:
        """Torque of the first joint [N m]."""
        return self.sample.torques[0]

    @cached_property
    def power(self) -> NDArray[np.float64]:
        """Sum of torque * speed over the joints [W]."""
        power = self.sample.power
        power.setflags(write=False)
        return power


def _columns(values: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Values side by side, read-only."""
    columns = np.column_stack(values)
    columns.setflags(write=False)
    return columns


def outputs_of(plant: Plant, joint: JointMotion, states: Expression) -> Expression:
    """Rows of a trajectory, the values of its `Sample`; a column a sample.

    The motion along the path has its jerk; the states, (2 * modes, samples), are W [m] and then
    W' [m/s].
    """
    rows = sample_plant(plant, joint, *_modes(plant, joint, states)).values
    return ca.vertcat(*(ca.DM.zeros(1, states.shape[1]) + row for row in rows))


def rates_of(plant: Plant, joint: JointMotion, states: Expression) -> Expression:
    """Time derivative of the states of `outputs_of`."""
    _, dW, ddW = _modes(plant, joint, states)
    return ca.vertcat(*dW, *ddW)


def _modes(plant: Plant, joint: JointMotion, states: Expression) -> tuple[Modes, Modes, Modes]:
    rows = ca.vertsplit(states)
    W = rows[: plant.modes]
    dW = rows[plant.modes :]
    return W, dW, plant.modal_accelerations(joint, W, dW)


_POINTS = 7
"""Samples of the polynomial through an extreme and its neighbours."""


def extremes(times: NDArray[np.float64], rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Least and largest value of each row, by a polynomial around its extreme samples.

    Where a row jumps or bends sharply, it is the sample itself. Rows may be pieces of these times.
    """
    signed = np.concatenate([-rows, rows])
    at = np.argmax(signed, axis=1)
    largest = np.take_along_axis(signed, at[:, None], axis=1)[:, 0]
    if len(times) >= _POINTS:
        between = np.fmax(largest, _between(times, signed, at))
        largest = np.where(np.isfinite(between), between, largest)
    low, high = np.split(largest, 2)
    return np.column_stack([-low, high])


def _between(
    times: NDArray[np.float64], rows: NDArray[np.float64], at: NDArray[np.intp]
) -> NDArray[np.float64]:
    """The largest value beside a sample of each row; minus infinity where it is not smooth."""
    piece, at = np.divmod(at, len(times))
    first = np.clip(at - _POINTS // 2, 0, len(times) - _POINTS)
    near = first[:, None] + np.arange(_POINTS)
    centre = times[at][:, None]
    width = (times[near[:, -1]] - times[near[:, 0]])[:, None]
    values = np.take_along_axis(
        rows,
        piece[:, None] * len(times) + near,
        axis=1,
    )
    x = (times[near] - centre) / width
    by_power = np.linalg.solve(_powers(x, _POINTS), values[:, :, None])[:, :, 0]
    below = ((times[np.maximum(at - 1, 0)])[:, None] - centre) / width
    above = ((times[np.minimum(at + 1, len(times) - 1)])[:, None] - centre) / width
    slope = by_power[:, 1:] * np.arange(1, _POINTS)
    bend = slope[:, 1:] * np.arange(1, _POINTS - 1)
    root = np.zeros_like(centre)
    for _ in range(3):  # Newton's method
        powers = _powers(root, _POINTS - 1)
        second = (powers[:, :, :-1] @ bend[:, :, None])[:, 0]
        step = np.zeros_like(root)
        np.divide(
            (powers @ slope[:, :, None])[:, 0],
            second,
            where=second < 0,
            out=step,
        )
        root = np.minimum(np.maximum(root - step, below), above)
    peak = (_powers(root, _POINTS) @ by_power[:, :, None])[:, 0, 0]
    finest = np.abs(by_power[:, -2:]) @ 0.5 ** np.arange(_POINTS - 2, _POINTS)
    # Where the polynomial's two highest terms are larger, the function jumps or bends sharply.
    smooth = finest <= 0.02 * np.ptp(values, axis=1)
    return np.where(smooth, peak, -np.inf)


def _powers(values: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Powers 0 to count - 1 of values of any shape, along one more axis."""
    factors = np.empty((*values.shape, count))
    factors[..., 0] = 1.0
    factors[..., 1:] = values[..., None]
    return np.multiply.accumulate(factors, axis=-1)
