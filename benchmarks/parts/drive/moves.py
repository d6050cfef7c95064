"""The moves of the machines, and their set points: quietarm's plans, and shapers over ruckig."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from ruckig import InputParameter, Ruckig, Trajectory

from quietarm import PointToPoint, Uncertainty, plan_move
from quietarm.models import LinearAxis
from quietarm.ocp.profiles.free_motion import FreeMotion
from quietarm.ocp.profiles.shaped_cycloid import SHAPERS
from quietarm.studies.compare.baselines import ruckig_motion, shaped

from .machines import GANTRY, PICKER, Machine
from .simulate import SetPoints

RATE = 1000
"""Set points in a second."""


@dataclass(frozen=True)
class Move:
    """A move of a machine, and what its user weighs and allows.

    Parameters
    ----------
    machine
        The machine that moves.
    target
        How far it moves [m].
    load
        What swings, by scales [kg].
    friction
        Viscous friction in the model [N s/m].
    limits
        Limits of the task, by name.
    sooner
        Duration of the robust plan that is to act earlier than ZVD [s].
    jog
        Speed of the recording at constant speed [m/s].
    noise
        Standard deviation of the laser that watches the tool [m].
    """

    machine: Machine
    target: float
    load: float
    friction: float
    limits: Mapping[str, float] = field(hash=False)
    sooner: float
    jog: float
    noise: float

    def task(
        self, frequency: float, damping: float, duration: float, error: float = 0.0
    ) -> PointToPoint:
        """The move as a user asks for it, with an identified frequency [Hz] and damping."""
        axis = LinearAxis(
            omega1=2 * np.pi * frequency,
            zeta1=damping,
            mass=self.machine.commissioned_mass,
            load=self.load,
            friction=self.friction,
        )
        uncertainty = Uncertainty({"frequency": error}) if error else None
        return PointToPoint(axis, self.target, duration, uncertainty=uncertainty, **self.limits)

    def shortest(self, shaper: str, frequency: float, damping: float) -> float:
        """Least duration of a shaper over ruckig [s], rounded up to a whole row."""
        least = self.ruckig_duration + SHAPERS[shaper](2 * np.pi * frequency, damping).times[-1]
        return float(np.ceil(least * RATE - 1e-9) / RATE)

    @property
    def ruckig_duration(self) -> float:
        """Duration of the fastest move within the limits [s], by ruckig."""
        request = InputParameter(1)
        request.current_position = [0.0]
        request.target_position = [self.target]
        request.max_velocity = [self.limits["speed_limit"]]
        request.max_acceleration = [self.limits["acceleration_limit"]]
        request.max_jerk = [self.limits["jerk_limit"]]
        trajectory = Trajectory(1)
        Ruckig(1).calculate(request, trajectory)
        return trajectory.duration


MOVES = {
    move.machine.name: move
    for move in (
        Move(
            GANTRY,
            target=0.8,
            load=15.0,
            friction=50.0,
            limits={
                "speed_limit": 1.5,
                "acceleration_limit": 7.0,
                "jerk_limit": 150.0,
                "torque_limit": 780.0,
            },
            sooner=0.906,
            jog=0.1,
            noise=2e-5,
        ),
        Move(
            PICKER,
            target=0.25,
            load=1.17,
            friction=6.0,
            limits={
                "speed_limit": 2.0,
                "acceleration_limit": 22.0,
                "jerk_limit": 1500.0,
                "torque_limit": 156.0,
            },
            sooner=0.290,
            jog=0.1,
            noise=1e-5,
        ),
    )
}


def plan(task: PointToPoint, residual_limit: float | None = None) -> SetPoints:
    """Plan a task with quietarm; a task with errors takes a residual limit [m]."""
    candidate = plan_move(task, residual_limit=residual_limit).candidate
    time = _rows(task.duration)
    motion = candidate.sample(np.minimum(time, task.duration)).motion
    return SetPoints(time, *(np.array(each) for each in motion[:3]))


def shaper_over_ruckig(task: PointToPoint, shaper: str = "") -> SetPoints:
    """Shape the move of ruckig to last as long as the task; without a shaper it stays as it is."""
    if not shaper:
        return _of_free_motion(ruckig_motion(task))
    impulses = SHAPERS[shaper](task.plant.omega1, task.plant.zeta1)
    remaining = replace(task, duration=task.duration - impulses.times[-1])
    return _of_free_motion(shaped(ruckig_motion(remaining), impulses))


def _rows(duration: float) -> np.ndarray:
    return np.arange(int(np.ceil(duration * RATE - 1e-6)) + 1) / RATE


def _of_free_motion(free: FreeMotion) -> SetPoints:
    """Rows of a motion of constant jerk in pieces."""
    lengths = np.diff(free.times)
    jerk = free.jerk
    acceleration = free.acceleration
    gains = acceleration * lengths + jerk * lengths**2 / 2
    speed = np.append(0.0, np.cumsum(gains))
    ways = speed[:-1] * lengths + acceleration * lengths**2 / 2 + jerk * lengths**3 / 6
    place = np.append(0.0, np.cumsum(ways))
    time = _rows(free.times[-1])
    at = np.minimum(time, free.times[-1])
    piece = np.clip(np.searchsorted(free.times, at, side="right") - 1, 0, len(lengths) - 1)
    since = at - free.times[piece]
    a, j = acceleration[piece], jerk[piece]
    return SetPoints(
        time,
        place[piece] + speed[piece] * since + a * since**2 / 2 + j * since**3 / 6,
        speed[piece] + a * since + j * since**2 / 2,
        a + j * since,
    )
