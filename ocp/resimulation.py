"""The independent integrator: CVODES, and a quadrature that finds the power's sign changes.

Every figure that a plan reports comes from here, not from the optimiser's own fixed steps.
"""

from __future__ import annotations

import io
import math
from contextlib import redirect_stderr
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from models import Expression, JointMotion
from ocp.errors import SolverFailedError
from ocp.interrupts import keep_interrupts
from ocp.objective import Motion
from ocp.profile import CycloidPolynomial, JointProfile
from ocp.residual import fastest_mode, residual_samples
from ocp.task import PointToPoint

RELATIVE_TOLERANCE = 1e-11
ABSOLUTE_TOLERANCE = 1e-13
_SAMPLES = 1000
_RADIANS_A_SAMPLE = 0.003
"""Phase of the fastest mode between samples of the residual: misses 1.2e-6 of a peak at most."""


@dataclass(frozen=True)
class Trajectory:
    """A motion sampled in time; rows are samples, arrays are read-only.

    Attributes
    ----------
    time : ndarray, shape (samples,)
        Times [s]; arrival is at the task's duration.
    joint : ndarray, shape (samples, 3)
        Angle, speed and acceleration of the joint [rad, rad/s, rad/s^2].
    modes : ndarray, shape (samples, modes)
        Modal amplitudes W [m].
    tips : ndarray, shape (samples, tips)
        Tip displacements [m].
    torque : ndarray, shape (samples,)
        Joint torque [N m]; after arrival, what holds the joint against the vibration.
    power : ndarray, shape (samples,)
        torque * speed [W].
    """

    time: NDArray[np.float64]
    joint: NDArray[np.float64]
    modes: NDArray[np.float64]
    tips: NDArray[np.float64]
    torque: NDArray[np.float64]
    power: NDArray[np.float64]

    def __post_init__(self) -> None:
        for array in vars(self).values():
            array.setflags(write=False)


class _Resimulation:
    """CVODES and the plant's outputs for one task along one member of a profile."""

    def __init__(
        self, task: PointToPoint, profile: JointProfile, coefficients: tuple[float, ...]
    ) -> None:
        self.task, self.profile, self.coefficients = task, profile, coefficients
        self.modes = task.plant.modes
        self.time = ca.SX.sym("t")
        self.state = ca.SX.sym("x", 2 * self.modes + 1)  # W, W', work

    def _equations(self, moving: bool) -> tuple[JointMotion, Expression, Expression]:
        """Joint, state derivative and outputs [angle, speed, acceleration, W, tips, torque]."""
        plant, m = self.task.plant, self.modes
        if moving:
            fraction = self.time / self.task.duration
            joint = self.profile.motion(self.coefficients, fraction, *self.task.move)
        else:
            joint = JointMotion(self.task.target, 0.0, 0.0)
        W, dW = ca.vertsplit(self.state[:m]), ca.vertsplit(self.state[m : 2 * m])
        ddW = plant.modal_accelerations(joint, W, dW)
        torque = plant.torque(joint, W, dW, ddW)
        derivative = ca.vertcat(*dW, *ddW, torque * joint.speed)
        outputs = ca.vertcat(*joint, *W, *plant.tip_displacements(W), torque)
        return joint, derivative, outputs

    def run(
        self, times: NDArray[np.float64], initial: NDArray[np.float64], moving: bool
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """States and outputs (samples in rows) at increasing times; `initial` is at the first."""
        _, derivative, outputs = self._equations(moving)
        if len(times) > 1:
            integrate = ca.integrator(
                "resimulation",
                "cvodes",
                {"t": self.time, "x": self.state, "ode": derivative},
                float(times[0]),
                times[1:].tolist(),
                {"reltol": RELATIVE_TOLERANCE, "abstol": ABSOLUTE_TOLERANCE,
                 "max_num_steps": 200_000},
            )  # fmt: skip
            try:
                with redirect_stderr(io.StringIO()):  # the error below says it for people
                    later = integrate(x0=ca.DM(initial))["xf"].full().T
            except RuntimeError as error:
                raise SolverFailedError(
                    "CVODES could not follow this motion; are the coefficients far out of scale? "
                    f"(largest is {max(map(abs, self.coefficients), default=0.0):g})"
                ) from error
            states = np.vstack([initial, later])
        else:
            states = initial[None, :]
        observe = ca.Function("observe", [self.time, self.state], [outputs])
        return states, observe(ca.DM(times).T, ca.DM(states.T)).full().T

    def trajectory(self, times: NDArray[np.float64], rows: NDArray[np.float64]) -> Trajectory:
        """Outputs, a row a time, by their names."""
        m = self.modes
        joint, torque = rows[:, :3].copy(), rows[:, -1].copy()
        return Trajectory(
            time=times.copy(),
            joint=joint,
            modes=rows[:, 3 : 3 + m].copy(),
            tips=rows[:, 3 + m : -1].copy(),
            torque=torque,
            power=torque * joint[:, 1],
        )

    @property
    def at_rest(self) -> NDArray[np.float64]:
        return np.zeros(2 * self.modes + 1)


@keep_interrupts()  # casadi loses a Ctrl-C
def sample_trajectory(
    task: PointToPoint, profile: JointProfile, coefficients: ArrayLike, times: ArrayLike
) -> Trajectory:
    """Simulate a motion with CVODES and sample it.

    Parameters
    ----------
    task : PointToPoint
        The move.
    profile : JointProfile
        How the joint moves.
    coefficients : array_like, shape (profile.size,)
        The profile's coefficients.
    times : array_like, shape (samples,)
        Increasing times from 0 on [s]; those after the duration show the residual vibration.

    Returns
    -------
    Trajectory
        The samples.

    Raises
    ------
    ValueError
        When the times do not increase from 0 or later, or the coefficients do not fit.
    SolverFailedError
        When CVODES cannot follow the motion.
    """
    grid = np.atleast_1d(np.asarray(times, dtype=float))
    ordered = grid.ndim == 1 and grid.size and grid[0] >= 0 and np.all(np.diff(grid) > 0)
    if not (ordered and np.all(np.isfinite(grid))):
        raise ValueError("sample times must be finite and increase from 0 or later")
    flow = _Resimulation(task, profile, profile.checked(coefficients))
    before = grid[grid <= task.duration]
    after = grid[grid > task.duration]
    move_times = np.union1d(before, [0.0, task.duration])
    states, outputs = flow.run(move_times, flow.at_rest, moving=True)
    rows = outputs[np.isin(move_times, before)]
    if after.size:
        rest_times = np.concatenate([[task.duration], after])
        rows = np.vstack([rows, flow.run(rest_times, states[-1], moving=False)[1][1:]])
    return flow.trajectory(grid, rows)


def resimulate(task: PointToPoint, profile: JointProfile, coefficients: ArrayLike) -> Motion:
    """Residual, energy and diagnostics of a motion by CVODES.

    Arguments and errors as for `resimulated`, whose figures it returns.
    """
    return resimulated(task, profile, coefficients)[0]


@keep_interrupts()
def resimulated(
    task: PointToPoint, profile: JointProfile, coefficients: ArrayLike
) -> tuple[Motion, NDArray[np.float64]]:
    """Residual, energy and diagnostics of a motion by CVODES, and its state on arrival.

    The signed work is integrated along with the modes; the energy is the sum of its absolute
    changes between the power's sign changes, which are located on a fine grid first.

    Parameters
    ----------
    task : PointToPoint
        The move.
    profile : JointProfile
        How the joint moves.
    coefficients : array_like, shape (profile.size,)
        The profile's coefficients.

    Returns
    -------
    Motion
        The figures.
    ndarray, shape (2 * modes,)
        W (m) and then W' (m/s) on arrival.

    Raises
    ------
    ValueError
        When the coefficients do not fit the profile.
    SolverFailedError
        When CVODES cannot follow the motion.
    """
    residual_samples(task)  # refuses a window beyond reason
    flow = _Resimulation(task, profile, profile.checked(coefficients))
    samples = max(_SAMPLES, math.ceil(20 * fastest_mode(task) * task.duration))
    times = np.linspace(0.0, task.duration, samples + 1)
    states, outputs = flow.run(times, flow.at_rest, moving=True)
    power = outputs[:, -1] * outputs[:, 1]
    energy = _energy(flow, times, power)

    tip_columns = slice(3 + flow.modes, -1)
    motion = Motion.from_samples(
        task,
        outputs[:, :3],
        outputs[:, tip_columns],
        outputs[:, -1],
        residual=float(np.abs(rest_of(task, states[-1, :-1]).tips).max()),
        energy=energy,
        net_work=float(states[-1, -1]),
    )
    return motion, states[-1, :-1]


@keep_interrupts()
def rest_of(task: PointToPoint, arrival: ArrayLike) -> Trajectory:
    """What happens in the residual window, from W (m) and then W' (m/s) at arrival, by CVODES."""
    flow = _Resimulation(task, CycloidPolynomial(0), ())
    window = math.ceil(task.residual_window * fastest_mode(task) / _RADIANS_A_SAMPLE) + 1
    times = task.duration + np.linspace(0.0, task.residual_window, window)
    _, outputs = flow.run(times, np.append(arrival, 0.0), moving=False)
    return flow.trajectory(times, outputs)


def _energy(flow: _Resimulation, times: NDArray[np.float64], power: NDArray[np.float64]) -> float:
    """Integral of |power|, from the signed work at its sign changes."""
    change = np.flatnonzero(power[:-1] * power[1:] < 0)
    share = power[change] / (power[change] - power[change + 1])
    zeros = times[change] + share * (times[change + 1] - times[change])
    # The ends, and samples where the power is exactly 0, as halfway through a symmetric motion.
    breaks = np.union1d(zeros, np.concatenate([times[[0, -1]], times[power == 0]]))
    work = flow.run(breaks, flow.at_rest, moving=True)[0][:, -1]
    return float(np.abs(np.diff(work)).sum())
