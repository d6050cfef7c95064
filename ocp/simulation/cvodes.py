"""CVODES with its options, a plant's equations for it, and what happens after arrival.

Nothing here knows how the joint moves: `resimulation` drives it along a profile or a free motion.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray
from quietarm.models import Expression, JointMotion, Plant
from quietarm.models.joint_motion import Modes
from quietarm.ocp.energy import power_of
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.interrupts import keep_interrupts, silent_errors
from quietarm.ocp.simulation.residual import fastest_along
from quietarm.ocp.task import PointToPoint
from quietarm.ocp.uncertainty import perturb_plant

CVODES = {
    "linear_multistep_method": "adams",  # order up to 12: a fifth of the steps of BDF's 5
    "reltol": 1e-11,
    "abstol": 1e-13,
}
"""Options of every run, but for its steps: see `options_for`."""
Errors = tuple[tuple[str, float], ...]
"""Relative errors of a plant by name, as `perturb_plant` takes them."""
_MOST_STEPS, _LEAST_A_SAMPLE = 3_000_000, 1_000
"""Steps in a run: it takes some seconds, in which CVODES hears no signal. Coefficients of 1000,
five hundred times those of any plan, take 700 from one of 3500 samples to the next."""
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
    jerk : ndarray, shape (samples,)
        Rate of change of the joint's acceleration [rad/s^3]; between jumps of the acceleration.
    """

    time: NDArray[np.float64]
    joint: NDArray[np.float64]
    modes: NDArray[np.float64]
    tips: NDArray[np.float64]
    torque: NDArray[np.float64]
    power: NDArray[np.float64]
    jerk: NDArray[np.float64]

    def __post_init__(self) -> None:
        for array in vars(self).values():
            array.setflags(write=False)

    @classmethod
    def from_outputs(
        cls, plant: Plant, time: NDArray[np.float64], outputs: NDArray[np.float64]
    ) -> Trajectory:
        """Name the rows of `outputs_of`, whose columns are samples at these times [s]."""
        rows, m = outputs.T.copy(), 4 + plant.modes
        return cls(
            time=time.copy(),
            joint=rows[:, :3],
            modes=rows[:, 4:m],
            tips=rows[:, m:-1],
            torque=rows[:, -1],
            power=power_of(rows[:, -1], rows[:, 1]),
            jerk=rows[:, 3],
        )

    @property
    def motion(self) -> JointMotion:
        """Angle, speed, acceleration and jerk of the joint, each of shape (samples,)."""
        angle, speed, acceleration = self.joint.T
        return JointMotion(angle, speed, acceleration, self.jerk)


def outputs_of(plant: Plant, joint: JointMotion, states: Expression) -> Expression:
    """Rows angle, speed, acceleration, jerk, W, tips, torque of a trajectory; a column a sample.

    The states, (2 * modes, samples), are W [m] and then W' [m/s].
    """
    W, dW, ddW = _modes(plant, joint, states)
    rows = (*joint, *W, *plant.tip_displacements(W), plant.torque(joint, W, dW, ddW))
    return ca.vertcat(*(ca.DM.zeros(1, states.shape[1]) + row for row in rows))


def rates_of(plant: Plant, joint: JointMotion, states: Expression) -> Expression:
    """Time derivative of the states of `outputs_of`."""
    _, dW, ddW = _modes(plant, joint, states)
    return ca.vertcat(*dW, *ddW)


def _modes(plant: Plant, joint: JointMotion, states: Expression) -> tuple[Modes, Modes, Modes]:
    rows = ca.vertsplit(states)
    W, dW = rows[: plant.modes], rows[plant.modes :]
    return W, dW, plant.modal_accelerations(joint, W, dW)


@contextmanager
def cvodes_for(motion: str) -> Iterator[None]:
    """Let CVODES be called in this block; name the motion that it cannot follow."""
    try:
        with silent_errors():  # the error below is enough
            yield
    except RuntimeError as error:
        raise SolverFailedError(f"CVODES could not follow this motion{motion}") from error


def options_for(times: ArrayLike) -> dict[str, str | float | int]:
    """Options of a run that ends within some seconds, also where it cannot follow the motion.

    CVODES counts its steps from one sample to the next.
    """
    gaps = np.diff(np.asarray(times, dtype=float), prepend=0.0)
    share = float(gaps.max() / gaps.sum())
    return {**CVODES, "max_num_steps": max(_LEAST_A_SAMPLE, round(_MOST_STEPS * share))}


def after_arrival(
    plant: Plant, target: float, times: NDArray[np.float64], names: Sequence[str] = ()
) -> ca.Function:
    """CVODES from `x0`, W [m] and then W' [m/s] at arrival, with errors `p` of these names.

    Its `xf` has a column for each of the times since arrival [s], which increase from beyond 0.
    """
    state, errors = ca.SX.sym("x", 2 * plant.modes), ca.SX.sym("e", len(names))
    wrong = perturb_plant(plant, dict(zip(names, ca.vertsplit(errors), strict=True)))
    rates = rates_of(wrong, JointMotion(target, 0.0, 0.0), state)
    problem, options = {"x": state, "p": errors, "ode": rates}, options_for(times)
    return ca.integrator("rest", "cvodes", problem, 0.0, times.tolist(), options)


@dataclass(frozen=True, eq=False)
class _Rest:
    """Constant matrices from the state at arrival to the states in the residual window.

    The time of a sample is the sum of a long and a short time, so that s samples take about 2
    sqrt(s) matrices: with many modes, one for every sample would fill the memory.
    """

    short: NDArray[np.float64]  # (short times, 2 * modes, 2 * modes)
    long: NDArray[np.float64]  # (long times, 2 * modes, 2 * modes)
    tips: NDArray[np.float64]  # (tips * short times, 2 * modes)


def _rest(task: PointToPoint, errors: Errors = ()) -> _Rest:
    faster = 1 + max((abs(error) for _, error in errors), default=0.0)
    faster = math.ceil(10 * faster) / 10  # so that like errors share what is compiled
    radians = task.residual_window * fastest_along(task.plant, task.target, task.target) * faster
    samples = max(1, math.ceil(radians / _RADIANS_A_SAMPLE))
    with cvodes_for("'s residual vibration"):
        return _from_unit_states(task.plant, task.target, task.residual_window, samples, errors)


@lru_cache(maxsize=256)
@keep_interrupts()  # casadi loses a Ctrl-C, and what it left unfinished would be kept here
def _from_unit_states(
    plant: Plant, target: float, window: float, samples: int, errors: Errors
) -> _Rest:
    size, short = 2 * plant.modes, math.ceil(math.sqrt(samples))
    long = math.ceil(samples / short)
    run = _after_arrival(plant, target, window, (short, long), tuple(name for name, _ in errors))
    values = ca.DM([error for _, error in errors])
    later = run(x0=ca.DM.eye(size), p=values)["xf"].full().reshape(size, size, -1)
    matrices = np.concatenate([np.eye(size)[None], later.transpose(2, 0, 1)])
    into = matrices[: short + 1]
    W = [ca.DM(into[:, mode].reshape(1, -1)) for mode in range(plant.modes)]
    wrong = perturb_plant(plant, dict(errors))
    tips = ca.horzcat(*wrong.tip_displacements(W)).full().reshape(-1, size)
    return _Rest(into, matrices[[0, *range(short, short + long - 1)]], tips)


@lru_cache(maxsize=32)
def _after_arrival(
    plant: Plant, target: float, window: float, counts: tuple[int, int], names: tuple[str, ...]
) -> ca.Function:
    short, long = counts
    at = np.append(np.arange(1, short + 1), short * np.arange(2, long + 1))
    return after_arrival(plant, target, window * at / (short * long), names)


def residual_of(task: PointToPoint, arrival: NDArray[np.float64], errors: Errors = ()) -> float:
    """Largest tip displacement [m] of what is missed on arrival, on a plant with errors."""
    rest = _rest(task, errors)
    return float(np.abs(rest.tips @ (rest.long @ task.missed(arrival)).T).max())


@keep_interrupts()
def rest_of(task: PointToPoint, arrival: ArrayLike) -> Trajectory:
    """What happens in the residual window, from W (m) and then W' (m/s) at arrival, by CVODES."""
    rest = _rest(task)
    states = (rest.short @ (rest.long @ np.asarray(arrival)).T).transpose(1, 2, 0)
    # The last short time is the first of the next long one, except in the end.
    joined = np.hstack([states[:, :, :-1].reshape(len(states), -1), states[:, -1:, -1]])
    times = task.duration + np.linspace(0.0, task.residual_window, joined.shape[1])
    return Trajectory.from_outputs(task.plant, times, outputs_at_rest(task, ca.DM(joined)))


def outputs_at_rest(task: PointToPoint, states: ca.DM) -> NDArray[np.float64]:
    """`outputs_of` the joint at rest at the target."""
    return outputs_of(task.plant, JointMotion(task.target, 0.0, 0.0, 0.0), states).full()
