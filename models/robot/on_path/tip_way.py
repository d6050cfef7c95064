"""The place in space where the tip of a robot rests along its path."""

from __future__ import annotations

from functools import lru_cache

import casadi as ca
import numpy as np

from quietarm.models.joint_motion import Array
from quietarm.models.robot.dynamics.modes import sag_at
from quietarm.models.robot.dynamics.moving_robot import MovingRobot
from quietarm.models.robot.on_path.path_tables import range_of_tables, tables_of
from quietarm.models.robot.path.geometric_path import GeometricPath

_PLACES = 129
"""Of the path: between them a spline is within 1e-8 m on the robots tried."""


@lru_cache(maxsize=64)
def way_of(robot: MovingRobot, path: GeometricPath, stiffness: float, payload: float) -> TipWay:
    """The way of a robot's tip with multiples of its springs and payload, computed once."""
    return TipWay(robot, path, stiffness, payload)


class TipWay:
    """Place and orientation of a tip that rests on a path.

    Parameters
    ----------
    robot : MovingRobot
        What moves.
    path : GeometricPath
        Where its joints go.
    stiffness, payload : float
        Multiples of the robot's, by which it sags.
    """

    def __init__(
        self, robot: MovingRobot, path: GeometricPath, stiffness: float, payload: float
    ) -> None:
        from scipy.interpolate import CubicSpline  # takes a quarter of a second to load

        dynamics = robot.dynamics_with(stiffness, payload)
        self._directions = list(tables_of(robot, path).directions)
        x = ca.SX.sym("x", dynamics.size)
        rotation, origin = dynamics.place(robot.tip_place, x)
        frame = ca.Function("frame", [x], [ca.densify(ca.horzcat(rotation, origin))])
        places = np.linspace(*range_of_tables(), _PLACES)
        frames = list[Array]()
        sag = None
        for q in path.extended(places):
            sag = sag_at(dynamics, q, sag)
            frames.append(frame(np.concatenate([q, sag])).full())
        self._frames = CubicSpline(places, np.array(frames))

    def deviations(self, places: Array, tips: Array, target: float) -> Array:
        """Return where the tip is, seen from where it rests at a target [m], shape (3, samples).

        The displacements of the tip are those along the axes of its own frame in which it moves.
        """
        frames = self._frames(places)
        rest = self._frames(target)[:, 3]
        displaced = np.einsum("nij,jn->in", frames[:, :, self._directions], tips)
        return frames[:, :, 3].T - rest[:, None] + displaced

    def felt(self, time: Array, places: Array, gravity: Array) -> Array:
        """Accelerations that a sensor at the tip feels where nothing swings [m/s^2].

        Along the axes of the tip's frame in which it moves, shape (samples, axes).

        Parameters
        ----------
        time, places : ndarray, shape (samples,)
            When the tip is where on the path [s], close enough for differences.
        gravity : ndarray, shape (3,)
            As seen from the ground [m/s^2].
        """
        frames = self._frames(places)
        speed = np.gradient(frames[:, :, 3], time, axis=0)
        acceleration = np.gradient(speed, time, axis=0)
        along: Array = np.einsum(
            "nij,ni->nj", frames[:, :, self._directions], acceleration - gravity
        )
        return along
