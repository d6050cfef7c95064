"""A joint motion of free acceleration: a polynomial on every interval of a grid, and its figures.

The figures come from CVODES, started anew at every point of the grid, where the acceleration (or,
of a smooth motion, the jerk) jumps; torque and power are one-sided there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from models import Expression, JointMotion, Plant
from ocp.base.interrupts import keep_interrupts
from ocp.simulation.collocation import GAUSS_NODES
from ocp.simulation.cvodes import CVODES, Trajectory, cvodes_for, outputs_of, rates_of, rest_of
from ocp.simulation.objective import Motion, resolved_energy
from ocp.task.point_to_point import PointToPoint

_PARTS = 8
"""Parts of an interval between whose ends the power is a quadratic to the quadrature."""


def joint_after(derivatives: Sequence[Expression], t: Expression) -> JointMotion:
    """The joint a time `t` [s] after these values, by a constant last derivative.

    Parameters
    ----------
    derivatives : sequence of Expression
        Angle [rad], speed, acceleration and, where the acceleration is not constant, jerk.
    t : Expression
        The time [s].

    Returns
    -------
    JointMotion
        The joint.
    """
    angle, speed, acceleration, *rest = derivatives
    jerk = rest[0] if rest else 0.0
    return JointMotion(
        angle + t * (speed + t * (acceleration / 2 + t * (jerk / 6))),
        speed + t * (acceleration + t * (jerk / 2)),
        acceleration + t * jerk,
        jerk,
    )


@dataclass(frozen=True, eq=False)
class FreeMotion:
    """A joint motion from rest, a polynomial on every interval of a grid; arrays are read-only.

    Attributes
    ----------
    times : ndarray, shape (steps + 1,)
        The grid, from 0 to the duration [s].
    acceleration : ndarray, shape (steps,)
        Joint acceleration at the beginning of every interval [rad/s^2].
    jerk : ndarray, shape (steps,)
        Its rate of change on the interval [rad/s^3]: 0 where the acceleration is constant on
        every interval.
    """

    times: NDArray[np.float64]
    acceleration: NDArray[np.float64]
    jerk: NDArray[np.float64]

    def __post_init__(self) -> None:
        for name, values in vars(self).items():
            array = np.array(values, dtype=float)
            if array.ndim != 1 or not np.all(np.isfinite(array)):
                raise ValueError(f"{name} is no list of finite numbers")
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if not len(self.acceleration) == len(self.jerk) == len(self.times) - 1 > 0:
            raise ValueError(
                f"{len(self.times)} times do not fit {len(self.acceleration)} accelerations and "
                f"{len(self.jerk)} jerks; give one of each an interval"
            )
        if self.times[0] != 0 or np.any(np.diff(self.times) <= 0):
            raise ValueError("the times do not increase from 0")

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, FreeMotion):
            return NotImplemented
        return all(np.array_equal(a, vars(other)[name]) for name, a in vars(self).items())

    def __hash__(self) -> int:
        return hash(tuple(array.tobytes() for array in vars(self).values()))

    @property
    def steps(self) -> int:
        """How many intervals the grid has."""
        return len(self.acceleration)

    @property
    def smooth(self) -> bool:
        """Whether the motion has a jerk; else its acceleration is constant on every interval."""
        return bool(np.any(self.jerk))

    @property
    def lengths(self) -> NDArray[np.float64]:
        """Lengths of the intervals [s]."""
        return np.diff(self.times)

    def boundaries(self, start: float) -> NDArray[np.float64]:
        """Angle [rad] and speed [rad/s] at the grid, shape (2, steps + 1), from rest at `start`."""
        h = self.lengths
        speed = np.append(0.0, np.cumsum(h * (self.acceleration + h * self.jerk / 2)))
        moved = h * (speed[:-1] + h * (self.acceleration / 2 + h * self.jerk / 6))
        return np.vstack([start + np.append(0.0, np.cumsum(moved)), speed])

    def split(self, parts: NDArray[np.int_]) -> FreeMotion:
        """The same motion on a finer grid: interval k in `parts[k]` equal parts."""
        old = np.repeat(np.arange(self.steps), parts)
        part = np.concatenate([np.arange(count) for count in parts]) / parts[old]
        into = part * self.lengths[old]
        return FreeMotion(
            np.append(self.times[old] + into, self.times[-1]),
            self.acceleration[old] + self.jerk[old] * into,
            self.jerk[old],
        )


@dataclass(frozen=True)
class FreeSimulation:
    """What CVODES makes of a free motion: its figures and its samples.

    Attributes
    ----------
    motion : Motion
        Residual, energy and diagnostics.
    trajectory : Trajectory
        The move and the residual window after it. Times stand twice where torque or acceleration
        jump: with the values before and after.
    """

    motion: Motion
    trajectory: Trajectory


@lru_cache(maxsize=16)
def _interval(plant: Plant) -> tuple[ca.Function, ca.Function]:
    """CVODES over one interval, and the plant's outputs at a time in it."""
    state, given = ca.SX.sym("x", 2 * plant.modes + 1), ca.SX.sym("p", 5)  # W, W', work
    fraction = ca.SX.sym("t")
    *initial, h = ca.vertsplit(given)
    joint = joint_after(initial, fraction * h)
    outputs = outputs_of(plant, joint, state[:-1])
    power = outputs[-1] * joint.speed
    rates = h * ca.vertcat(rates_of(plant, joint, state[:-1]), power)
    problem = {"t": fraction, "x": state, "p": given, "ode": rates}
    ends_of_parts = [(i + 1) / _PARTS for i in range(_PARTS)]
    integrate = ca.integrator("interval", "cvodes", problem, 0.0, ends_of_parts, CVODES)
    x, p = ca.MX.sym("x", state.numel()), ca.MX.sym("p", given.numel())
    inside = integrate(x0=x, p=p)["xf"]
    march = ca.Function("march", [x, p], [inside[:, -1], inside])
    return march, ca.Function("observe", [fraction, state, given], [outputs])


@keep_interrupts()
def simulate(task: PointToPoint, free: FreeMotion) -> FreeSimulation:
    """Simulate a free motion with CVODES, interval by interval.

    Parameters
    ----------
    task : PointToPoint
        The move; its plant, start and residual window count.
    free : FreeMotion
        How the joint moves.

    Returns
    -------
    FreeSimulation
        Figures and samples.

    Raises
    ------
    SolverFailedError
        When CVODES cannot follow the motion.
    """
    plant, steps = task.plant, free.steps
    given = np.vstack(
        [free.boundaries(task.start)[:, :-1], free.acceleration, free.jerk, free.lengths]
    )
    with cvodes_for(
        f", whose largest acceleration is {np.abs(free.acceleration).max():g} rad/s^2; "
        "set an acceleration limit"
    ):
        march, observe = _interval(plant)
        ends, inside = march.mapaccum(steps)(ca.DM.zeros(2 * plant.modes + 1), given)
    size, ends = 2 * plant.modes + 1, ends.full()
    begins = np.hstack([np.zeros((size, 1)), ends[:, :-1]])
    states = np.concatenate(
        [begins.T[:, None, :], inside.full().T.reshape(steps, _PARTS, size)], axis=1
    )
    fractions = np.tile(np.arange(_PARTS + 1) / _PARTS, steps)
    outputs = observe(
        ca.DM(fractions).T, ca.DM(states.reshape(-1, size)).T, np.repeat(given, _PARTS + 1, axis=1)
    )
    times = np.repeat(free.times[:-1], _PARTS + 1) + fractions * np.repeat(free.lengths, _PARTS + 1)
    moving = Trajectory.from_outputs(plant, times, outputs.full())
    resting = rest_of(task, ends[:-1, -1])
    motion = Motion.from_samples(
        task,
        moving.motion if free.smooth else moving.motion._replace(jerk=None),
        moving.tips,
        moving.torque,
        residual=float(np.abs(resting.tips).max()),
        energy=_energy(moving.power.reshape(steps, -1), states[:, :, -1], free.lengths),
        net_work=float(ends[-1, -1]),
    )
    return FreeSimulation(
        motion,
        Trajectory(
            **{
                name: np.concatenate([values, vars(resting)[name]])
                for name, values in vars(moving).items()
            }
        ),
    )


def _energy(
    power: NDArray[np.float64], work: NDArray[np.float64], lengths: NDArray[np.float64]
) -> float:
    """Integral of |power|, from power and work at the ends of every part of every interval.

    Between them the power is the quadratic that has these values and does this work.
    """
    before, after = power[:, :-1].ravel(), power[:, 1:].ravel()
    h = np.repeat(lengths / _PARTS, _PARTS)
    mean = np.diff(work, axis=1).ravel() / h
    bend = 3 * (before + after) - 6 * mean
    rise = after - before - bend
    at_nodes = [ca.DM(before + x * (rise + x * bend)).T for x in GAUSS_NODES]
    return float(resolved_energy(at_nodes, ca.DM(h).T))
