"""The joint's path of a candidate in numbers, to send to another simulator or to a machine."""

from __future__ import annotations

import math
from typing import NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.models import JointMotion
from quietarm.ocp.checks import not_negative, positive, takes
from quietarm.ocp.profiles.joint_profile import JointProfile
from quietarm.ocp.task import PointToPoint

Array = NDArray[np.float64]


class SentMotion(NamedTuple):
    """A joint's motion at even times, from the start of a move; after arrival the joint stands.

    Attributes
    ----------
    time : ndarray, shape (samples,)
        Times [s].
    angle, speed, acceleration : ndarray
        Of the joint [rad, rad/s, rad/s^2], of a linear one in metres, shape (samples,); of a robot
        of all joints, shape (samples, joints).
    """

    time: Array
    angle: Array
    speed: Array
    acceleration: Array


@takes(task=PointToPoint, profile=JointProfile)
def motion_of(
    task: PointToPoint,
    profile: JointProfile,
    coefficients: ArrayLike,
    *,
    step: float = 1e-3,
    after: float = 0.0,
) -> SentMotion:
    """The path of a candidate and its rates: what a simulator's or a machine's servo is given.

    No plant is simulated for it: it is the profile's path alone.

    Parameters
    ----------
    task : PointToPoint
        The move: its plant's joints, start, target and duration.
    profile : JointProfile
        How the joint moves.
    coefficients : array_like, shape (profile.size,)
        The candidate.
    step : float
        Time between samples [s].
    after : float
        How long the joint stands at its target behind the move [s], while the residual is measured.
        The last sample is at this time or the next one behind it, so that the target is reached.

    Returns
    -------
    SentMotion
        Times, angles, speeds and accelerations, as arrays.

    Raises
    ------
    ValueError
        When a number is out of range, or there are not as many coefficients as the profile has.
    """
    most = 10_000_000
    duration = task.duration + not_negative("after", after, "s")
    interval = positive("step", step, "s")
    intervals = math.ceil(duration / interval - 1e-9)
    if interval > duration or intervals > most:
        raise ValueError(
            f"step is {interval:g} s, and the motion takes {duration:g} s; give from "
            f"{duration / most:.2g} to {duration:g} s"
        )
    samples = intervals + 1
    time: Array = np.arange(samples, dtype=float) * np.float64(interval)
    path = profile.path(coefficients, *task.move)
    along = [path(time, order) for order in range(3)]
    if len(task.plant.joint_names) == 1:
        return SentMotion(time, *along)
    symbols = [ca.MX.sym(name) for name in ("angle", "speed", "acceleration")]
    joints = task.plant.joints(JointMotion(*symbols))
    outputs = [value for joint in joints for value in joint[:3]]
    function = ca.Function("joints", symbols, [ca.vertcat(*outputs)])
    rows = function(*(ca.DM(column).T for column in along)).full()
    return SentMotion(time, *(rows[k::3].T.copy() for k in range(3)))
