"""The time-optimal motion of a rigid joint: constant jerk, acceleration or speed, piece by piece.

What bends is left out, so that no flexible joint can be faster within limits of speed, acceleration
and jerk; other limits are turned into such by the plant's equations where nothing swings.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from quietarm.models import JointMotion, Plant
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.limits import TORQUE_SPEED, Limit, Shares, TorqueSpeedLine
from quietarm.ocp.profiles.cycloid import CycloidPolynomial
from quietarm.ocp.profiles.free_motion import FreeMotion
from quietarm.ocp.simulation.free_vibration import FreeVibration, fastest_along
from quietarm.ocp.solvers.problem import MOST_SOLVER_STEPS
from quietarm.ocp.task import PointToPoint

_ANGLES = 9
"""Of the joint, at which a plant is asked what an acceleration takes."""
_OF_A_RIGID_JOINT = ("speed", "acceleration", "jerk", "torque", TORQUE_SPEED, "deflection")
"""Limits that say how a joint may move where nothing swings."""


class RigidBounds(NamedTuple):
    """Bounds of a rigid joint in the direction of a move, all positive and infinite if unlimited.

    Speed [rad/s], acceleration when it speeds up and when it brakes [rad/s^2], and the rates at
    which the acceleration may rise and fall [rad/s^3].
    """

    speed: float = math.inf
    speeding_up: float = math.inf
    braking: float = math.inf
    rising: float = math.inf
    falling: float = math.inf


class RigidPiece(NamedTuple):
    """A part of a rigid motion: its length [s], its first acceleration and its constant jerk."""

    length: float
    acceleration: float
    jerk: float


@dataclass(frozen=True)
class RigidMotion:
    """The time-optimal motion of a rigid joint.

    Attributes
    ----------
    duration : float
        How long it takes [s].
    switches : tuple of float
        When its acceleration or jerk jumps [s], from 0 to the duration.
    pieces : tuple of RigidPiece
        What it does between them; none of a motion that is known by its switches alone.
    """

    duration: float
    switches: tuple[float, ...]
    pieces: tuple[RigidPiece, ...] = ()

    @property
    def free_motion(self) -> FreeMotion:
        """Return this motion in pieces, forwards; instants without length are left out."""
        shortest = 1e-9  # [s]: what is shorter comes from rounding
        lasting = [piece for piece in self.pieces if piece.length > shortest]
        lengths, accelerations, jerks = zip(*lasting)
        times = np.append(0.0, np.cumsum(lengths))
        return FreeMotion(times, np.array(accelerations), np.array(jerks))


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
    pieces = (*speeding_up.pieces, RigidPiece(cruise, 0.0, 0.0), *braking.backwards)
    return RigidMotion(duration, tuple(sorted(set(switches))), pieces)


def _largest_speed(remaining: Callable[[float], float], most: float, halvings: int = 200) -> float:
    """The speed at which both ramps take all of the way; each halving settles another bit."""
    high = most if math.isfinite(most) else 1.0
    while remaining(high) > 0:
        high *= 2
    low = 0.0
    for _ in range(halvings):
        middle = (low + high) / 2
        if not low < middle < high:
            break
        if remaining(middle) > 0:
            low = middle
        else:
            high = middle
    return high


class _Ramp(NamedTuple):
    """Ramp from rest to a speed: the time at which each of its pieces ends [s], and its way."""

    switches: tuple[float, ...]
    distance: float
    pieces: tuple[RigidPiece, ...] = ()

    @property
    def duration(self) -> float:
        return self.switches[-1]

    @property
    def backwards(self) -> list[RigidPiece]:
        """The pieces in reversed time, which brakes to rest."""
        return [
            RigidPiece(length, -(acceleration + jerk * length), jerk)
            for length, acceleration, jerk in reversed(self.pieces)
        ]

    @classmethod
    def to(cls, speed: float, acceleration: float, rising: float, falling: float) -> _Ramp:
        """Make the ramp that is as fast as acceleration and jerk allow; with neither at once."""
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
        pieces = (
            RigidPiece(rise, 0.0, rising if rise else 0.0),
            RigidPiece(hold, peak, 0.0),
            RigidPiece(fall, peak, -falling if fall else 0.0),
        )
        return cls((0.0, rise, rise + hold, rise + hold + fall), distance, pieces)


def rigid_duration(task: PointToPoint) -> float:
    """Return the least time of rigid joints within the limits of speed, acceleration and jerk [s].

    No motion within the limits is shorter; it is 0 if nothing limits a joint.
    """
    return max(rigid_durations(task))


def rigid_durations(task: PointToPoint) -> list[float]:
    """Return the least time of each rigid joint by itself, from its first angle to its last [s].

    It is 0 if nothing limits the joint.
    """
    durations = list[float]()
    for distance, bounds in zip(_distances(task), _bounds_of_joints(task)):
        try:
            durations.append(rigid_motion(distance, bounds).duration)
        except ValueError:  # nothing limits this joint
            durations.append(0.0)
    return durations


def declared_bounds(task: PointToPoint) -> RigidBounds:
    """The task's own limits of speed, acceleration and jerk in its direction, along the path."""
    of_joints = _bounds_of_joints(task)
    if len(of_joints) == 1:
        return of_joints[0]
    scaled = np.array(of_joints) / _slopes(task)[:, None]
    return RigidBounds(*scaled.min(axis=0).tolist())


def _bounds_of_joints(task: PointToPoint) -> list[RigidBounds]:
    """Return the bounds of every joint."""
    by_name = {limit.name: limit for limit in task.limits}
    line = by_name.get(TORQUE_SPEED)
    no_torque_beyond = math.inf
    if line is not None and isinstance(line.quantity.values, TorqueSpeedLine):
        no_torque_beyond = line.quantity.values.largest_speed

    def bounds(joint: int, forward: bool) -> RigidBounds:
        def sides(name: str) -> tuple[float, float]:
            """The bound in the direction of the move, and against it."""
            lower, upper = _sides(by_name.get(name), joint)
            return (upper, -lower) if forward else (-lower, upper)

        return RigidBounds(
            min(sides("speed")[0], no_torque_beyond), *sides("acceleration"), *sides("jerk")
        )

    return [bounds(joint, way > 0) for joint, way in enumerate(_ways(task))]


def _sides(limit: Limit | None, joint: int) -> tuple[float, float]:
    """Least and largest value that a limit leaves a joint."""
    if limit is None:
        return -math.inf, math.inf
    shares = limit.quantity.values
    if not isinstance(shares, Shares):
        return limit.lower, limit.upper
    for bound in shares.bounds:
        if bound.place == joint:
            return bound.lower, bound.upper
    return -math.inf, math.inf


def _ways(task: PointToPoint) -> list[float]:
    """Return the way of every joint, from its first angle to its last."""
    begin, end = (
        task.plant.joints(JointMotion(place, 0.0, 0.0)) for place in (task.start, task.target)
    )
    return [float(last.angle) - float(first.angle) for first, last in zip(begin, end)]


def _distances(task: PointToPoint) -> list[float]:
    return [abs(way) for way in _ways(task)]


def _slopes(task: PointToPoint, least: float = 1e-9) -> np.ndarray:
    """Return how far every joint goes for each unit of the path, at most along the way.

    Not less than `least`, where a joint stands still while the path goes on: nothing is divided by
    0.
    """
    places = np.linspace(task.start, task.target, _ANGLES).tolist()
    slopes = [
        [abs(float(joint.speed)) for joint in task.plant.joints(JointMotion(place, 1.0, 0.0))]
        for place in places
    ]
    return np.maximum(np.max(slopes, axis=0), least)


def assumed_bounds(task: PointToPoint) -> RigidBounds:
    """Return the declared bounds, narrowed to what the other limits come to.

    Limits of torque and deflection count as where nothing swings. All else, such as a user's own
    quantities, counts as what the fastest plain cycloid within them reaches. So a limit that is
    nowhere in the way changes nothing. ValueError where no cycloid is so slow that it keeps them,
    and nothing else limits the joint.
    """
    declared = declared_bounds(task)
    needed = _Needed.along(task)
    accelerations: list[float] = []
    speeds: list[float] = []
    for joint, torques in enumerate(_torque_limits(task.limits, len(needed.torques))):
        inertia = needed.torques[joint]
        friction = needed.frictions[joint]
        if inertia > 0:
            accelerations += (torque / inertia for torque in torques)
        if friction > 0:
            speeds += (torque / friction for torque in torques)
    sizes = {limit.name: limit.size for limit in task.limits}
    if "deflection" in sizes and needed.deflection > 0:
        accelerations.append(sizes["deflection"] / needed.deflection)
    largest = min(accelerations, default=math.inf)
    bounds = declared._replace(
        speed=min(declared.speed, *speeds, math.inf),
        speeding_up=min(declared.speeding_up, largest),
        braking=min(declared.braking, largest),
    )
    is_limited = math.isfinite(min(bounds.speed, *bounds[1:3], bounds.rising))
    others = [limit for limit in task.limits if limit.name not in _OF_A_RIGID_JOINT]
    if is_limited and not others:
        return bounds
    least = _least_cycloid(task, others or task.limits)
    if math.isinf(least) and not is_limited:
        limits = ", ".join(map(str, others or task.limits))
        raise ValueError(
            f"the plain cycloid breaks its limits ({limits}) in every duration that the solver "
            "resolves; give wider ones"
        )
    largest = 2 * math.pi * abs(task.span) / least**2
    return bounds._replace(
        speeding_up=min(bounds.speeding_up, largest), braking=min(bounds.braking, largest)
    )


def _least_cycloid(task: PointToPoint, limits: Sequence[Limit]) -> float:
    """Return the duration of the fastest plain cycloid that keeps limits [s], within some per cent.

    Infinite where none does.
    """

    def keeps(duration: float) -> bool:
        cycloid = CycloidPolynomial(0)
        try:
            motion = JudgedMotion.of_profile(replace(task.certain, duration=duration), cycloid, [])
            return not motion.figures.exceeded(limits)
        except SolverFailedError:
            return False

    fastest = fastest_along(task.plant, task.start, task.target)
    longest = MOST_SOLVER_STEPS / 2 / fastest if fastest > 0 else math.inf
    shortest = 2.0**-12
    duration = min(1.0, longest)
    if keeps(duration):
        while duration > shortest and keeps(duration / 2):
            duration /= 2
    else:
        while not keeps(duration):
            if duration >= min(longest, 1 / shortest):
                return math.inf
            duration = min(2 * duration, longest)
    low = duration / 2
    for _ in range(4):
        middle = math.sqrt(low * duration)
        if keeps(middle):
            duration = middle
        else:
            low = middle
    return duration


def largest_deflection(task: PointToPoint) -> float:
    """The largest static displacement of a tip [m] by 1 rad/s^2 along the way."""
    return _Needed.along(task).deflection


def _torque_limits(limits: Iterable[Limit], joints: int) -> list[list[float]]:
    """Return what limits the torque of every joint."""
    torques: list[list[float]] = [[] for _ in range(joints)]
    for limit in limits:
        for joint in range(joints):
            if limit.name == "torque":
                lower, upper = _sides(limit, joint)
                torques[joint].append(min(-lower, upper))
            if isinstance(limit.quantity.values, TorqueSpeedLine):
                torques[joint].append(limit.quantity.values.points[0][0])
    return torques


class _Needed(NamedTuple):
    """Torque by joint and static deflection that a unit acceleration takes if nothing swings.

    And the torque by friction of a unit speed, by joint; without what holds the joints at rest.
    """

    torques: list[float]
    deflection: float
    frictions: list[float]

    @classmethod
    def along(cls, task: PointToPoint) -> _Needed:
        """The largest of each along the way."""
        places = np.linspace(task.start, task.target, _ANGLES).tolist()
        torques, deflections, frictions = zip(*(cls._at(task.plant, place) for place in places))
        return cls(
            np.max(torques, axis=0).tolist(),
            max(deflections),
            np.max(frictions, axis=0).tolist(),
        )

    @staticmethod
    def _at(plant: Plant, place: float) -> tuple[list[float], float, list[float]]:
        still = [0.0] * plant.modes
        accelerating = JointMotion(place, 0.0, 1.0)
        bent = static_deflections(plant, place).tolist()
        tips = plant.tips_at(accelerating, bent)
        holding = plant.torques(JointMotion(place, 0.0, 0.0), still, still, still)

        def torques(path: JointMotion, W: list[float]) -> list[float]:
            moving = plant.torques(path, W, still, still)
            return [abs(float(torque) - float(rest)) for torque, rest in zip(moving, holding)]

        return (
            torques(accelerating, bent),
            max(abs(float(tip)) for tip in tips),
            torques(JointMotion(place, 1.0, 0.0), still),
        )


def static_deflections(plant: Plant, angle: float) -> np.ndarray:
    """Modal amplitudes [m] that a constant acceleration of 1 rad/s^2 would hold: shape (modes,)."""
    still = [0.0] * plant.modes
    pushed = plant.modal_accelerations(JointMotion(angle, 0.0, 1.0), still, still)
    at_rest = FreeVibration(plant, angle)
    stiffness = -at_rest.matrix[plant.modes :, : plant.modes]
    return np.linalg.solve(stiffness, np.array([float(push) for push in pushed]))
