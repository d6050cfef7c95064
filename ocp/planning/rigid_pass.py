"""The least time in which a machine that does not swing can follow a path within its limits.

A bound from below that needs no solver: from rest, the largest speed at every place of the path is
that of a pass forwards, as fast as the limits let it speed up, and of one backwards, as fast as
they let it brake. Modes follow the motion as they would hold still under its acceleration: where
the equations are linear, a motion from rest to rest takes no less torque than that, and bends no
less, however it swings in between.

Where the tip may swing after arrival, the structure can lend its momentum to the joint: then only
the inertia that the joint has to move at once counts, and nothing has to brake.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.models import JointMotion, Plant
from quietarm.models.compiled import Compiled
from quietarm.ocp.limits import OF_THIRD_ORDER, TORQUE_SPEED, Limit
from quietarm.ocp.sample import sample_plant
from quietarm.ocp.simulation.free_vibration import FreeVibration
from quietarm.ocp.task import PointToPoint

Array = NDArray[np.float64]
_PLACES = 401
"""Of the path, the ends included."""
_BY_THE_STRUCTURE = ("torque", TORQUE_SPEED, "deflection")
"""Limits, beside those of the joint, that bound how soon a structure can follow. Not so its tip's
acceleration, which is as small as one likes while the structure bends slowly, however fast the
joint, nor quantities of one's own, of which nothing is known."""
_NEARLY = 0.02
"""Share by which a limited value may differ from a sum, as that of a robot whose sag turns with it:
what is refused is shorter than the bound by a larger share."""
_FASTEST = 1e100
_SLOWEST = 1e-100
"""Speeds that count as unlimited, and as none."""


class LimitedRows(NamedTuple):
    """Limited values at the places of a path: a row each, a column for each place.

    They are `slope` times the acceleration along the path, `bend` times the squared speed, `drag`
    times the speed, and what they are at rest; within `lower` and `upper`.
    """

    slope: Array
    bend: Array
    drag: Array
    at_rest: Array
    lower: Array
    upper: Array

    def backwards(self) -> LimitedRows:
        """Return these rows from the last place to the first, where braking is speeding up."""
        turned = LimitedRows(*(part[:, ::-1] for part in self))
        return turned._replace(slope=-turned.slope)

    def and_(self, more: LimitedRows) -> LimitedRows:
        """Return these rows and others."""
        return LimitedRows(*map(np.concatenate, zip(self, more)))


def least_duration(task: PointToPoint, arrives_at_rest: bool) -> float:
    """A duration [s] below which no motion keeps the limits of a task; 0 where none is known."""
    kinematic = [limit for limit in task.limits if limit.quantity.derivative is not None]
    dynamic = [limit for limit in task.limits if limit.name in _BY_THE_STRUCTURE]
    by_joints = limited_rows(task, kinematic)
    forwards = by_joints.and_(limited_rows(task, dynamic, swings=not arrives_at_rest))
    braking = forwards if arrives_at_rest else by_joints
    speeding_up, first_square = _squared_speeds(task, forwards)
    slowing_down, last_square = _squared_speeds(task, braking.backwards())
    squares = np.minimum(speeding_up, slowing_down[::-1])
    if not np.all(squares[1:-1] > 0):  # stuck: a swing may help it over
        return 0.0
    speeds = np.sqrt(squares)
    step = abs(task.span) / (_PLACES - 1)
    durations = 2 * step / (speeds[1:] + speeds[:-1])
    # at the ends it may be as fast as a limit lets it before the step is over
    durations[0] = step / speeds[1] * (1 + squares[1] / first_square)
    durations[-1] = step / speeds[-2] * (1 + squares[-2] / last_square)
    return float(durations.sum())


def values_at_rest(task: PointToPoint, limit: Limit) -> Array:
    """Return a limited quantity's values at rest, at start and target, shape (rows, 2)."""
    return _Values(task, [limit], False, places=2).at(0.0, 0.0)


def limited_rows(task: PointToPoint, limits: Sequence[Limit], swings: bool = False) -> LimitedRows:
    """The rows of limits, in the direction of a move.

    Without those of quantities that are no such sums, and of the jerk.
    """
    limits = [limit for limit in limits if limit.quantity.derivative != OF_THIRD_ORDER]
    values = _Values(task, limits, swings)
    at_rest = values.at(0.0, 0.0)
    slope = values.at(0.0, 1.0) - at_rest
    forwards = values.at(1.0, 0.0)
    backwards = values.at(-1.0, 0.0)
    bend = (forwards + backwards) / 2 - at_rest
    drag = (forwards - backwards) / 2
    # what a move of this duration reaches at least, twice
    speed = 2 * abs(task.span) / task.duration
    acceleration = 8 * abs(task.span) / task.duration**2
    modelled = acceleration * slope + speed**2 * bend + speed * drag + at_rest
    scale = np.abs(modelled).max(axis=1, initial=0.0)
    differs = np.abs(values.at(speed, acceleration) - modelled).max(axis=1, initial=0.0)
    counts = [limit.quantity.rows(task.plant) for limit in limits]
    sides = np.repeat([(limit.lower, limit.upper) for limit in limits], counts, axis=0)
    lower, upper = (np.repeat(side[:, None], _PLACES, axis=1) for side in sides.reshape(-1, 2).T)
    is_sum = differs <= _NEARLY * scale
    return LimitedRows(
        *(part[is_sum] for part in (slope, bend, drag, at_rest, lower, upper)),
    )


class _Values:
    """Limited values of a plant along a task's path, with modes that follow its motion."""

    def __init__(
        self, task: PointToPoint, limits: Sequence[Limit], swings: bool, places: int = _PLACES
    ) -> None:
        plant = task.plant
        self._places = np.linspace(task.start, task.target, places)
        self._forwards = math.copysign(1.0, task.span)
        self._swings = swings
        self._modes = plant.modes
        self._pushes, self._outputs = Compiled.guard(lambda: _functions(plant, limits))
        matrix = FreeVibration(plant, self._places).matrix
        self._stiffness = -matrix[:, plant.modes :, : plant.modes]

    def at(self, speed: float, acceleration: float) -> Array:
        """The values at every place, shape (rows, places)."""
        path = np.stack([
            self._places,
            np.full(len(self._places), self._forwards * speed),
            np.full(len(self._places), self._forwards * acceleration),
        ])  # fmt: skip
        pushes = self._call(self._pushes, path)
        still = np.zeros((self._modes, len(self._places)))
        if self._swings:
            return self._call(self._outputs, np.concatenate([path, still, pushes]))
        bent: Any = np.linalg.solve(self._stiffness, pushes.T[:, :, None])[:, :, 0].T
        return self._call(self._outputs, np.concatenate([path, bent, still]))

    @staticmethod
    def _call(function: ca.Function, columns: Array) -> Array:
        return Compiled.guard(lambda: function(columns).full())


def _functions(plant: Plant, limits: Sequence[Limit]) -> tuple[ca.Function, ca.Function]:
    """Build the modes' pushes by place, speed, acceleration, and values by these, W and W''."""
    x = ca.SX.sym("x", 3 + 2 * plant.modes)
    path = JointMotion(*ca.vertsplit(x[:3]))
    W, ddW = (ca.vertsplit(part) for part in ca.vertsplit(x[3:], plant.modes))
    still = [0.0] * plant.modes
    sample = sample_plant(plant, path, W, still, ddW)
    values = [value for limit in limits for value in limit.quantity.values(sample)]
    pushes = plant.modal_accelerations(path, still, still)
    return (
        ca.Function("pushes", [x[:3]], [ca.densify(ca.vertcat(*pushes))]),
        ca.Function("values", [x], [ca.densify(ca.vertcat(*values, ca.SX(0, 1)))]),
    )


def _squared_speeds(task: PointToPoint, rows: LimitedRows) -> tuple[Array, float]:
    """The largest squared speed at every place, from rest at the first.

    And that at the second if nothing limited the speed.
    """
    step = abs(task.span) / (_PLACES - 1)
    largest = np.abs(rows.slope).max(axis=1, keepdims=True, initial=0.0)
    pushes = np.abs(rows.slope) > 1e-6 * largest
    # what bounds the acceleration from above: the upper side where it grows with it, else the lower
    side = np.where(rows.slope > 0, rows.upper, rows.lower)
    squares: Array = np.zeros(_PLACES)
    limit = _speed_limit(rows)
    first_square = 0.0
    for place in range(_PLACES - 1):
        counted = pushes[:, place]
        slope = rows.slope[counted, place]
        room = side[counted, place] - rows.at_rest[counted, place]
        room -= rows.bend[counted, place] * squares[place]
        # the speed after the step by each row, with the drag at that speed
        drag = step * rows.drag[counted, place] / slope
        gained = np.maximum(squares[place] + 2 * step * room / slope, 0.0)
        root = np.sqrt(drag**2 + gained)
        speeds = np.where(drag > 0, gained / np.maximum(drag + root, _SLOWEST), root - drag)
        square = speeds.min(initial=_FASTEST) ** 2
        first_square = first_square or square
        squares[place + 1] = min(square, limit[place + 1])
    return squares, first_square


def _speed_limit(rows: LimitedRows) -> Array:
    """The largest squared speed by rows that follow from the speed alone."""
    alone = ~(rows.slope.any(axis=1) | rows.bend.any(axis=1) | rows.at_rest.any(axis=1))
    drag = rows.drag[alone]
    side = np.where(drag > 0, rows.upper[alone], -rows.lower[alone])
    moves = drag != 0
    speeds = np.divide(side, np.abs(drag), out=np.full(drag.shape, np.inf), where=moves)
    return np.minimum(speeds.min(axis=0, initial=_FASTEST), _FASTEST) ** 2
