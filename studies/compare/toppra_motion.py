"""The motion of toppra on the path of a task: time-optimal within limits that know no jerk.

toppra is given the path and what its limits come to on it, place by place: speeds, accelerations
and torques of all joints, the last with everything that bends at rest. Its motion has a constant
acceleration of the place between the points of a grid.
"""

from __future__ import annotations

import logging
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from quietarm.models import JointMotion
from quietarm.ocp import PointToPoint
from quietarm.ocp.checks import install
from quietarm.ocp.limits import Limit, Shares
from quietarm.ocp.profiles.free_motion import FreeMotion

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

Array = NDArray[np.float64]
_FORCED = ("acceleration", "torque")
"""Quantities of which toppra needs a limit: without one of them a motion takes no time."""
_UNLIMITED = 1e8
"""In the place of no limit of a joint: toppra's programs ask for numbers."""
_POINTS = 201
"""Of the grid: with 401 the least time of the UR5's move with its bar is the same within 1e-4."""


def toppra_motion(
    task: PointToPoint, *, fastest: bool = False, slowness: float = 1.0
) -> FreeMotion:
    """The motion that toppra finds within a task's limits, stretched to its duration.

    Or the fastest one, stretched by its slowness. Stretched, all speeds and accelerations are less
    by the same share.

    ValueError where toppra is not installed, the task limits neither acceleration nor torque, or
    time is too short.
    """
    try:
        with _quiet():
            from toppra.algorithm import TOPPRA
    except ImportError:
        raise ValueError(f"toppra is not installed; {install('toppra')}") from None
    limits = [limit for limit in task.limits if limit.name in ("speed", *_FORCED)]
    if not any(limit.name in _FORCED for limit in limits):
        raise ValueError(
            "toppra moves within a limit of acceleration or torque, and the move has neither; plan "
            "it with one, such as --acceleration-limit 40"
        )
    grid = np.linspace(0.0, 1.0, _POINTS)
    with _quiet():
        program: Any = TOPPRA(_constraints(task, limits), _way_of(task), gridpoints=grid)
        _, speed, _ = program.compute_parameterization(0.0, 0.0)
    if speed is None:
        raise ValueError("toppra finds no motion; give wider limits")
    lengths = 2 * np.diff(grid) / (speed[1:] + speed[:-1])
    least = float(lengths.sum())
    if not fastest and least > task.duration * (1 + 1e-6):
        raise ValueError(
            f"within the limits it takes {least:.4g} s, more than the {task.duration:.4g} s that "
            "it has; give a longer duration or wider limits"
        )
    stretch = slowness if fastest else task.duration / least
    accelerations = task.span * np.diff(speed) / lengths / stretch**2
    times = np.append(0.0, np.cumsum(stretch * lengths))
    return FreeMotion(times, accelerations, np.zeros(len(accelerations)))


@contextmanager
def _quiet() -> Iterator[None]:
    """Silence toppra's own log, which repeats what is raised here."""
    log = logging.getLogger("toppra")
    level = log.level
    log.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        log.setLevel(level)


def _way_of(task: PointToPoint) -> Any:
    """The task's path for toppra: positions of the joints by the share of the way."""
    from toppra.interpolator import AbstractGeometricPath

    class Way(AbstractGeometricPath):
        """Way from the start, 0, to the target, 1."""

        @property
        def path_interval(self) -> Array:
            return np.array([0.0, 1.0])

        @property
        def dof(self) -> int:
            return len(task.plant.joint_names)

        def __call__(self, path_positions: Any, order: int = 0) -> Array:
            rows = _along(task, path_positions)[order]
            return rows if np.ndim(path_positions) else rows[0]

    return Way()


def _along(task: PointToPoint, shares: Any) -> tuple[Array, Array, Array]:
    """Positions of all joints and their first two slopes by the share, (shares, joints) each."""
    places = task.start + task.span * np.atleast_1d(np.asarray(shares, float))
    joints = task.plant.joints(JointMotion(places, task.span, 0.0))

    def column(values: Sequence[Any]) -> Array:
        return np.column_stack([np.broadcast_to(value, places.shape) for value in values])

    return (
        column([joint.angle for joint in joints]),
        column([joint.speed for joint in joints]),
        column([joint.acceleration for joint in joints]),
    )


def _constraints(task: PointToPoint, limits: Sequence[Limit]) -> list[Any]:
    """Return what toppra takes in the place of limits."""
    from toppra.constraint import (
        DiscretizationType,
        JointAccelerationConstraint,
        JointVelocityConstraint,
        LinearConstraint,
    )

    class TorqueConstraint(LinearConstraint):
        """Torques that the path takes with everything that bends at rest: a s'' + b s'^2 + g."""

        def __init__(self, bounds: Array) -> None:
            super().__init__()
            self.bounds = bounds
            self.dof = len(bounds)
            self.identical = True
            self.set_discretization_type(DiscretizationType.Collocation)

        def compute_constraint_params(self, path: Any, gridpoints: Array) -> tuple[Any, ...]:
            del path
            unit = np.eye(self.dof)
            held = _torques(task, gridpoints, 0.0, 0.0)
            pushed = _torques(task, gridpoints, 0.0, task.span) - held
            # half of both ways: without viscous friction, which is linear in the speed
            swept = (
                _torques(task, gridpoints, task.span, 0.0)
                + _torques(task, gridpoints, -task.span, 0.0)
            ) / 2 - held
            held = held + _coulomb(task, gridpoints)  # it never moves backwards
            sides = np.concatenate([self.bounds[:, 1], -self.bounds[:, 0]])
            return pushed, swept, held, np.vstack([unit, -unit]), sides, None, None

    kinds = {
        "speed": JointVelocityConstraint,
        "acceleration": JointAccelerationConstraint,
        "torque": TorqueConstraint,
    }
    return [kinds[limit.name](_bounds(limit, len(task.plant.joint_names))) for limit in limits]


def _bounds(limit: Limit, joints: int) -> Array:
    """Least and largest value of every joint, shape (joints, 2)."""
    values = limit.quantity.values
    if not isinstance(values, Shares):
        return np.tile([limit.lower, limit.upper], (joints, 1))
    bounds = np.tile([-_UNLIMITED, _UNLIMITED], (joints, 1))
    for bound in values.bounds:
        bounds[bound.place] = (bound.lower, bound.upper)
    return bounds


def _coulomb(task: PointToPoint, shares: Array) -> Array:
    """Coulomb friction of all joints on the way, shape (shares, joints).

    Half of the difference of both ways is viscous friction, linear in the speed, and this.
    """

    def of_both_ways(speed: float) -> Array:
        ways = (_torques(task, shares, way, 0.0) for way in (speed, -speed))
        return np.subtract(*ways) / 2

    return 2 * of_both_ways(task.span) - of_both_ways(2 * task.span)


def _torques(task: PointToPoint, shares: Array, speed: float, acceleration: float) -> Array:
    """Torques of all joints while nothing swings, shape (shares, joints)."""
    plant = task.plant
    still = [0.0] * plant.modes
    rows = list[list[float]]()
    for share in shares:
        motion = JointMotion(task.start + task.span * float(share), speed, acceleration)
        torques = plant.driving_torques(motion, still, still, still)
        rows.append([float(torque) for torque in torques])
    return np.array(rows)
