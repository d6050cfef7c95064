"""The judge of a plan on its drive: servo, belt or gear and dry friction, without the plan's steps.

Steps of Runge and Kutta, with dry friction held over a step: it is the force that stops its body by
the end of the step, or the largest that it can be where that is not enough. So bodies stick and
slide without a smooth stand-in.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.models.compiled import Compiled
from quietarm.models.joint_motion import LINEAR, JointMotion
from quietarm.ocp.errors import SolverFailedError
from quietarm.ocp.simulation.servo import (
    Moving,
    Servo,
    SetPoint,
    grows,
    servo_law,
    state_rates,
    state_size,
)
from quietarm.ocp.simulation.set_points import SetPoints

Array = NDArray[np.float64]
_RATE = 8000
"""Least number of steps in a second; half as many change what is left by less than 1 %."""
_RADIANS = 0.4
"""Most radians of the fastest part in a step."""
MOST_STEPS = 1_000_000


class DriveFigures(NamedTuple):
    """Figures of a plan on its drive: servo, transmission and dry friction.

    Attributes
    ----------
    following_error : float
        Largest difference of set point and motor [rad].
    off_path : float
        Largest difference of the load from the planned path [rad].
    residual : float
        Largest distance of a tip from its target after arrival [m]; where the joint turns, of the
        tip from the joint.
    peak_torque : float
        Largest torque of the motor, with friction [N m].
    heat : float or None
        Copper loss [J]; None where the motor constant is unknown.
    """

    following_error: float
    off_path: float
    residual: float
    peak_torque: float
    heat: float | None


@dataclass(frozen=True)
class DriveRun:
    """Motion of motor, load and tips on a drive: an entry of each array a step.

    Attributes
    ----------
    time : ndarray, shape (steps,)
        Time since the command began [s], at the end of each step.
    asked : ndarray
        Place that the servo is given [rad].
    motor, load, load_speed : ndarray
        Places of motor and load [rad], and the load's speed [rad/s].
    tips : ndarray, shape (tips, steps)
        Displacements of the tips from the load [m].
    effort : ndarray
        Torque of the motor [N m].
    motor_speed : ndarray
        Speed of the motor [rad/s].
    """

    time: Array
    asked: Array
    motor: Array
    load: Array
    load_speed: Array
    tips: Array
    effort: Array
    motor_speed: Array


_GROWS = (
    "the servo does not hold the plant: its motion grows without bound; give the loops as the "
    "drive has them, a shorter dead time or a stiffer belt"
)


def steps_a_second(servo: Servo, fastest: float, least: float = _RATE) -> float:
    """Steps that a drive needs, whose structure has modes up to a frequency [rad/s]."""
    return max(least, max(servo.fastest, fastest) / _RADIANS)


def run_on_drive(
    servo: Servo,
    set_points: SetPoints,
    rest: float,
    fastest: float,
    initial: tuple[float, ...] = (),
    least: float = _RATE,
) -> DriveRun:
    """Follow set points by the servo, and go on after the last one.

    Parameters
    ----------
    servo : Servo
        Plant and drive.
    set_points : SetPoints
        What the servo is given.
    rest : float
        Seconds after the last row.
    fastest : float
        Largest angular frequency of the structure [rad/s].
    initial : tuple of float
        W [m] and then W' [m/s] at the start; at rest by default.
    least : float
        Least number of steps in a second.

    Raises
    ------
    SolverFailedError
        When the motion grows without bound, or takes too many steps.
    """
    if grows(servo):
        raise SolverFailedError(_GROWS)
    rate = steps_a_second(servo, fastest, least)
    count = math.ceil((set_points.time[-1] + rest) * rate)
    if count > MOST_STEPS:
        raise SolverFailedError(
            f"the motion on the drive takes {count} steps, of at most {MOST_STEPS}; give a shorter "
            "move or residual window, or a softer belt"
        )
    step = _Step(servo, 1 / rate)
    rows = set_points.at(np.arange(count) / rate)
    start = step.start(float(rows[0, 0]), initial)
    outputs = step.march(start, rows)
    if not np.isfinite(outputs).all():
        raise SolverFailedError(_GROWS)
    motor, speed, load, load_speed, effort, *tips = outputs
    return DriveRun(
        (np.arange(count) + 1) / rate,
        rows[0],
        motor,
        load,
        load_speed,
        np.array(tips),
        effort,
        speed,
    )


class _Step:
    """One step of a plant on its drive, and many of them in turn."""

    def __init__(self, servo: Servo, length: float) -> None:
        self.servo = servo
        self.length = length
        # the effort is held over a step, which delays it by half of one
        delay = max(0.0, (servo.drive.dead_time or 0.0) / length - 0.5)
        self.whole = int(delay)
        self.share = delay - self.whole

    def start(self, place: float, initial: tuple[float, ...]) -> Array:
        """State of a joint at rest at a set point, whose motor gives what holds it."""
        servo = self.servo
        holding = servo.holding
        modes = initial or (0.0,) * (2 * servo.plant.modes)
        bodies = [place, 0.0]
        if servo.is_compliant:
            bodies += [place - servo.compliance * holding, 0.0]
        return np.array([*bodies, *modes, holding / servo.gain, *[holding] * (self.whole + 1)])

    def march(self, start: Array, rows: Array) -> Array:
        """Rows of motor, its speed, load, its speed, effort and tips, a column a step."""
        marched = _marching(self.servo, self.length, self.whole, self.share, rows.shape[1])
        return marched(start, rows)[0]


@lru_cache(maxsize=4)
def _marching(servo: Servo, length: float, whole: int, share: float, count: int) -> Compiled:
    """(start, rows of set points) -> outputs of every step."""

    def build() -> ca.Function:
        one = _one_step(servo, length, whole, share)
        many = one.mapaccum("drive", count)
        start = ca.MX.sym("start", one.numel_in(0))
        rows = ca.MX.sym("rows", 3, count)
        _, outputs = many(start, rows)
        return ca.Function("marched", [start, rows], [outputs])

    return Compiled(build)


def _one_step(servo: Servo, length: float, whole: int, share: float) -> ca.Function:
    """(state, set point) -> next state, outputs."""
    size = state_size(servo)
    full = ca.SX.sym("full", size + 1 + whole + 1)
    row = ca.SX.sym("row", 3)
    state, integral, sent = ca.vertsplit(full, [0, size, size + 1, full.numel()])
    now = Moving.of(state, servo)
    asked = SetPoint(*ca.vertsplit(row))
    effort, integrating = servo_law(servo, now.motor, now.motor_speed, integral, asked)
    sent = ca.vertcat(effort, sent)  # the latest first
    given = (1 - share) * sent[whole] + share * sent[whole + 1]
    free = _advanced(servo, state, given, ca.SX(2, 1), length)
    rubbing = _rubbing(servo, Moving.of(free, servo), length)
    after = _advanced(servo, state, given, rubbing, length)
    there = Moving.of(after, servo)
    path = JointMotion(there.load, there.load_speed, 0.0)
    tips = servo.plant.tips_at(path, ca.vertsplit(there.W))
    following = ca.vertcat(after, integral + length * integrating, sent[: whole + 1])
    outputs = ca.vertcat(
        there.motor, there.motor_speed, there.load, there.load_speed, given, *map(ca.SX, tips)
    )
    return ca.Function("step", [full, row], [following, ca.densify(outputs)], {"cse": True})


def _advanced(servo: Servo, state: ca.SX, effort: ca.SX, rubbing: ca.SX, length: float) -> ca.SX:
    """The state a step later, by Runge and Kutta, of forces that are constant over it."""

    def rates(at: ca.SX) -> ca.SX:
        return state_rates(servo, at, effort, rubbing)

    first = rates(state)
    second = rates(state + length / 2 * first)
    third = rates(state + length / 2 * second)
    fourth = rates(state + length * third)
    return state + length / 6 * (first + 2 * second + 2 * third + fourth)


def _rubbing(servo: Servo, free: Moving, length: float) -> ca.SX:
    """Friction on motor and load that stops them by the end of a step, or the largest."""
    drive = servo.drive
    sizes = drive.friction_motor or 0.0, drive.friction_load or 0.0
    if not servo.is_compliant:
        whole = _clipped(-free.load_speed * servo.load_inertia / length, sum(sizes))
        return ca.vertcat(whole, 0)
    return ca.vertcat(
        _clipped(-free.motor_speed * servo.rotor / length, sizes[0]),
        _clipped(-free.load_speed * servo.load_inertia / length, sizes[1]),
    )


def _clipped(force: ca.SX, most: float) -> ca.SX:
    return ca.fmin(ca.fmax(force, -most), most)


def figures_of(
    servo: Servo, run: DriveRun, planned: Array, duration: float, target: float
) -> DriveFigures:
    """Return the figures of a run, beside the planned places of the load at its times."""
    after = run.time >= duration
    constant = servo.drive.motor_constant
    heat = None
    if constant is not None:
        heat = float((run.effort**2).sum() * run.time[0] / constant**2)
    return DriveFigures(
        float(np.abs(run.asked - run.motor).max()),
        float(np.abs(run.load - planned).max()),
        float(np.abs(tip_places(servo, run, target)[:, after]).max()),
        float(np.abs(run.effort).max()),
        heat,
    )


def tip_places(servo: Servo, run: DriveRun, target: float) -> Array:
    """Places of the tips about the target [m], shape (tips, steps).

    Where the joint slides and the tips' displacements are ways along it, the load's place counts as
    well; else they are displacements from the joint.
    """
    if servo.plant.joint == LINEAR and servo.plant.tip_unit == "m":
        return run.tips + (run.load - target)
    return run.tips
