"""Set points by which the load follows a planned path: the drive's linear model, inverted.

The plan says what moves the load, so that the motor's place and effort follow; the servo's law is
then solved for what it has to be asked for. It is an equation of the following error alone, which
is stable, and which dies away within some time constants of the servo after arrival.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from quietarm.models import JointMotion
from quietarm.ocp.simulation.servo import Servo

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

Array = NDArray[np.float64]
FINEST = 1 / 8000
"""Distance of times at which the following error is solved for [s]; a tick of most servos."""
_LONGEST_TAIL = 1.0
"""Seconds after arrival in which set points may still change."""
_SETTLED = 2e-6
"""Share of the way within which set points have arrived."""


@dataclass(frozen=True)
class SetPoints:
    """Set points of a servo: rows of time [s], place [rad], speed and acceleration.

    After the last row the servo holds its place.
    """

    time: Array
    place: Array
    speed: Array
    acceleration: Array

    def at(self, times: Array) -> Array:
        """Place, speed and acceleration at times, shape (3, times); lines between the rows."""
        rows = (self.place, self.speed, self.acceleration)
        after = (self.place[-1], 0.0, 0.0)
        return np.array(
            [np.interp(times, self.time, row, right=end) for row, end in zip(rows, after)]
        )


def invert(
    servo: Servo, target: Servo, path: JointMotion, effort: Array, step: float, every: int
) -> SetPoints:
    """Return the set points by which a load follows a path on its servo.

    Parameters
    ----------
    servo, target : Servo
        The drive about the start and about the target.
    path : JointMotion
        Motion of the load at times `step` apart, from rest to rest.
    effort : ndarray
        Torque that moves load and motor so, without Coulomb friction [N m].
    step : float
        Distance of the times [s].
    every : int
        A row is every so many times.
    """
    moving = len(effort)
    longer = math.ceil(_LONGEST_TAIL / step / every) * every
    ends = float(path.angle[-1]), 0.0, target.holding
    place, acceleration, torque = (
        np.append(row, np.full(longer, end))
        for row, end in zip((path.angle, path.acceleration, effort), ends)
    )
    times = np.linspace(0.0, step * (len(place) - 1), len(place))
    stretch = _spline(times, servo.compliance * (torque - servo.rotor * acceleration))
    given = torque + servo.rotor * stretch(times, 2)
    motor = _spline(times, place + stretch(times))
    dead = servo.drive.dead_time or 0.0
    needed = np.interp(times + dead, times, given) - servo.holding
    error = _spline(times, _following_error(servo, times, motor, needed))
    rows = [motor(times, order) + error(times, order) for order in range(3)]
    end = float(place[-1]) + servo.compliance * target.holding
    away = np.abs(rows[0] - end) > _SETTLED * abs(end - rows[0][0])
    last = max(moving - 1, int(np.flatnonzero(away)[-1]) + 1)
    last = min(math.ceil(last / every) * every, len(times) - 1)
    chosen = np.arange(0, last + 1, every)
    table = np.array([row[chosen] for row in rows])
    table[:, -1] = (end, 0.0, 0.0)
    return SetPoints(times[chosen], *table)


def _spline(times: Array, values: Array) -> BSpline:
    from scipy.interpolate import make_interp_spline  # slow to load

    return make_interp_spline(times, values, k=5)


def _following_error(servo: Servo, times: Array, motor: BSpline, needed: Array) -> Array:
    """Set point less the motor's place, so that the servo gives the effort that is needed."""
    drive = servo.drive
    loop = drive.position_loop or 0.0
    reset = drive.assumed_reset_time
    gain = servo.gain
    if drive.feedforward == "none":
        # the speed that is asked for less that of the motor, and its integral
        integral = _solved(np.array([[-1 / reset]]), needed / gain, times)[:, 0]
        return (needed / gain - integral / reset + motor(times, 1)) / loop
    if drive.feedforward == "speed":
        matrix = np.array([[0.0, 1.0], [-loop / reset, -loop - 1 / reset]])
        return _solved(matrix, needed / gain, times)[:, 1]
    share = gain / servo.inertia
    lacking = needed / servo.inertia - motor(times, 2)
    matrix = np.array(
        [
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [-share * loop / reset, -share * (loop + 1 / reset), -share],
        ]
    )
    return _solved(matrix, lacking, times)[:, 1]


def _solved(matrix: Array, forcing: Array, times: Array) -> Array:
    """States of x' = matrix x, whose last entry is forced, from rest."""
    from scipy.signal import lsim  # slow to load

    unit = np.eye(len(matrix))
    system = (matrix, unit[:, -1:], unit, np.zeros((len(matrix), 1)))
    return np.atleast_2d(lsim(system, forcing, times)[2].T).T.reshape(len(times), -1)
