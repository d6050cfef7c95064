"""The time-optimal motion of a rigid joint: constant jerk, acceleration or speed, piece by piece.

What bends is left out, so that no flexible joint can be faster within limits of speed, acceleration
and jerk; other limits are turned into such by the plant's equations where nothing swings.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from quietarm.models import JointMotion, Plant
from quietarm.ocp.limits import TORQUE_SPEED, Limit, TorqueSpeedLine
from quietarm.ocp.simulation.free_vibration import FreeVibration
from quietarm.ocp.task import PointToPoint

_ANGLES = 9
"""Of the joint, at which a plant is asked what an acceleration takes."""
_HALVINGS = 200
"""Of the largest speed; each settles another bit."""


class RigidBounds(NamedTuple):
    """What a rigid joint may do in the direction of a move, all positive and infinite if unlimited.

    Speed [rad/s], acceleration when it speeds up and when it brakes [rad/s^2], and the rates at
    which the acceleration may rise and fall [rad/s^3].
    """

    speed: float = math.inf
    speeding_up: float = math.inf
    braking: float = math.inf
    rising: float = math.inf
    falling: float = math.inf


@dataclass(frozen=True)
class RigidMotion:
    """The time-optimal motion of a rigid joint.

    Attributes
    ----------
    duration : float
        How long it takes [s].
    switches : tuple of float
        When its acceleration or jerk jumps [s], from 0 to the duration.
    """

    duration: float
    switches: tuple[float, ...]


def rigid_motion(span: float, bounds: RigidBounds) -> RigidMotion:
    """The time-optimal motion over a distance `span` [rad] > 0; ValueError where nothing limits it.

    It speeds up, cruises where the speed is limited, and brakes.
    """

    def ramps(speed: float) -> tuple[_Ramp, _Ramp]:
        return (
            _Ramp.to(speed, bounds.speeding_up, bounds.rising, bounds.falling),
            # backwards in time, where its acceleration rises and falls as when it speeds up
            _Ramp.to(speed, bounds.braking, bounds.rising, bounds.falling),
        )

    def remaining(speed: float) -> float:
        return span - sum(ramp.distance for ramp in ramps(speed))

    cruising_speed = bounds.speed
    if remaining(cruising_speed) < 0:
        cruising_speed = _largest_speed(remaining, bounds.speed)
    if math.isinf(cruising_speed):
        raise ValueError("nothing limits the rigid joint; give a limit of speed or acceleration")
    speeding_up, braking = ramps(cruising_speed)
    cruise = max(0.0, remaining(cruising_speed)) / cruising_speed
    begin_of_braking = speeding_up.duration + cruise
    duration = begin_of_braking + braking.duration
    switches = [
        *speeding_up.switches,
        *(duration - switch for switch in braking.switches),
    ]
    return RigidMotion(duration, tuple(sorted(set(switches))))


def _largest_speed(remaining: Callable[[float], float], most: float) -> float:
    """The speed at which both ramps take all of the way."""
    high = most if math.isfinite(most) else 1.0
    while remaining(high) > 0:
        high *= 2
    low = 0.0
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        if not low < middle < high:
            break
        low, high = (middle, high) if remaining(middle) > 0 else (low, middle)
    return high


class _Ramp(NamedTuple):
    """From rest to a speed: the time at which each of its pieces ends [s], and how far it gets."""

    switches: tuple[float, ...]
    distance: float

    @property
    def duration(self) -> float:
        return self.switches[-1]

    @classmethod
    def to(cls, speed: float, acceleration: float, rising: float, falling: float) -> _Ramp:
        """As fast as acceleration and jerk allow; with neither at once."""
        if math.isinf(speed):
            return cls((math.inf,), math.inf)
        slowness = 1 / rising + 1 / falling
        # so that rising and falling alone reach the speed
        peak = min(acceleration, math.sqrt(2 * speed / slowness) if slowness > 0 else math.inf)
        if math.isinf(peak):
            return cls((0.0, 0.0), 0.0)
        rise = peak / rising
        fall = peak / falling
        hold = max(0.0, speed / peak - (rise + fall) / 2)
        speed_after_rise = peak * rise / 2
        speed_after_hold = speed_after_rise + peak * hold
        distance = (
            peak * rise**2 / 6
            + (speed_after_rise + speed_after_hold) / 2 * hold
            + speed_after_hold * fall
            + peak * fall**2 / 3
        )
        return cls((0.0, rise, rise + hold, rise + hold + fall), distance)


def declared_bounds(task: PointToPoint) -> RigidBounds:
    """The task's own limits of speed, acceleration and jerk in its direction."""
    by_name = {limit.name: limit for limit in task.limits}

    def sides(name: str) -> tuple[float, float]:
        """The bound in the direction of the move, and against it."""
        limit = by_name.get(name)
        if limit is None:
            return math.inf, math.inf
        if task.span > 0:
            return limit.upper, -limit.lower
        return -limit.lower, limit.upper

    line = by_name.get(TORQUE_SPEED)
    no_torque_beyond = math.inf
    if line is not None and isinstance(line.quantity.values, TorqueSpeedLine):
        no_torque_beyond = line.quantity.values.largest_speed
    return RigidBounds(
        min(sides("speed")[0], no_torque_beyond), *sides("acceleration"), *sides("jerk")
    )


def assumed_bounds(task: PointToPoint) -> RigidBounds:
    """The same, and what limits of torque and deflection come to where nothing swings."""
    declared = declared_bounds(task)
    needed = _Needed.along(task)
    torques = list(_torque_limits(task.limits))
    accelerations = [torque / needed.torque for torque in torques]
    speeds = [torque / needed.friction for torque in torques if needed.friction > 0]
    deflection = next((one.size for one in task.limits if one.name == "deflection"), math.inf)
    if needed.deflection > 0:
        accelerations.append(deflection / needed.deflection)
    largest = min(accelerations, default=math.inf)
    return declared._replace(
        speed=min(declared.speed, *speeds, math.inf),
        speeding_up=min(declared.speeding_up, largest),
        braking=min(declared.braking, largest),
    )


def largest_deflection(task: PointToPoint) -> float:
    """The largest static displacement of a tip [m] by 1 rad/s^2 along the way."""
    return _Needed.along(task).deflection


def _torque_limits(limits: Iterable[Limit]) -> Iterable[float]:
    for limit in limits:
        if limit.name == "torque":
            yield min(-limit.lower, limit.upper)
        if isinstance(limit.quantity.values, TorqueSpeedLine):
            yield limit.quantity.values.points[0][0]


class _Needed(NamedTuple):
    """What a unit acceleration takes where nothing swings: torque and static deflection.

    And the torque by friction of a unit speed.
    """

    torque: float
    deflection: float
    friction: float

    @classmethod
    def along(cls, task: PointToPoint) -> _Needed:
        """The largest of each along the way."""
        angles = np.linspace(task.start, task.target, _ANGLES).tolist()
        needed = np.abs([cls._at(task.plant, angle) for angle in angles])
        torque, deflection, friction = needed.max(axis=0).tolist()
        return cls(torque, deflection, friction)

    @staticmethod
    def _at(plant: Plant, angle: float) -> tuple[float, float, float]:
        still = [0.0] * plant.modes
        accelerating = JointMotion(angle, 0.0, 1.0)
        turning = JointMotion(angle, 1.0, 0.0)
        bent = static_deflections(plant, angle)
        tips = plant.tips_at(accelerating, bent.tolist())
        return (
            float(plant.torque(accelerating, bent.tolist(), still, still)),
            max(abs(float(tip)) for tip in tips),
            float(plant.torque(turning, still, still, still)),
        )


def static_deflections(plant: Plant, angle: float) -> np.ndarray:
    """Modal amplitudes [m] that a constant acceleration of 1 rad/s^2 would hold: shape (modes,)."""
    still = [0.0] * plant.modes
    pushed = plant.modal_accelerations(JointMotion(angle, 0.0, 1.0), still, still)
    at_rest = FreeVibration(plant, angle)
    stiffness = -at_rest.matrix[plant.modes :, : plant.modes]
    return np.linalg.solve(stiffness, np.array([float(push) for push in pushed]))
