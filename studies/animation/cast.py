"""Where every structure of an animation is at every frame."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from quietarm.models import Body, Plant
from quietarm.ocp import Floor, Plan, Trajectory
from quietarm.ocp.base.checks import positive
from quietarm.studies.animation.clock import Clock
from quietarm.studies.figures import Line

Array = NDArray[np.float64]
Bodies = list[Body]

_SCALES = (1.0, 2.0, 3.0, 5.0, 10.0, 20.0, 30.0, 50.0, 100.0)
_BENT = 0.2
"""Share of a structure's size up to which deflections are drawn larger than they are."""


@dataclass(frozen=True, eq=False)
class Actor:
    """One motion of an animation."""

    line: Line
    trajectory: Trajectory
    scale: float
    tips: Array
    bodies: list[Bodies]
    unbent: list[Bodies]

    @cached_property
    def paths(self) -> Array:
        """Where the tips are drawn, shape (tips, frames, 2) [m]."""
        drawn = [[body.points[-1] for body in bodies if body.tip] for bodies in self.bodies]
        return np.array(drawn).reshape(len(drawn), -1, 2).transpose(1, 0, 2)

    @property
    def extent(self) -> Array:
        """Least and largest coordinates of all that is drawn [m], shape (2, 2)."""
        every = points_of(body for bodies in (*self.bodies, *self.unbent) for body in bodies)
        return np.array([every.min(axis=0), every.max(axis=0)])


def cast_of(lines: Sequence[Line], clock: Clock, scale: float | None = None) -> list[Actor]:
    """Where the structures are at every frame."""
    given = None if scale is None else positive("deflection scale", scale)
    samples = [_until(line.plan, clock.end) for line in lines]
    angles = [np.interp(clock.times, one.time, one.joint[:, 0]) for one in samples]
    tips = [_at(clock.times, one.time, one.tips) for one in samples]
    unbent = [
        _structures(line.plan.task.plant, at, np.zeros_like(of))
        for line, at, of in zip(lines, angles, tips, strict=True)
    ]
    names = [line.plan.task.plant.name for line in lines]
    shares = [np.abs(of).max() / _size(bodies[0]) for of, bodies in zip(tips, unbent, strict=True)]
    actors: list[Actor] = []
    for i, line in enumerate(lines):
        largest = max(s for s, name in zip(shares, names, strict=True) if name == names[i])
        one = given or _fitting(largest)
        bodies = _structures(line.plan.task.plant, angles[i], one * tips[i])
        actors.append(Actor(line, samples[i], one, tips[i], bodies, unbent[i]))
    return actors


def points_of(bodies: Iterable[Body]) -> Array:
    """All points of bodies, shape (points, 2) [m]."""
    return np.vstack([body.points for body in bodies])


def _until(motion: Plan | Floor, end: float) -> Trajectory:
    """A motion from its start to the end of the clock."""
    window = end - motion.task.duration
    if window == motion.task.residual_window:
        return motion.trajectory
    return replace(motion, task=replace(motion.task, residual_window=window)).trajectory


def _at(times: Array, of: Array, columns: Array) -> Array:
    return np.column_stack([np.interp(times, of, column) for column in columns.T])


def _structures(plant: Plant, angles: Array, tips: Array) -> list[Bodies]:
    return [
        list(plant.structure(float(angle), row.tolist()))
        for angle, row in zip(angles, tips, strict=True)
    ]


def _size(bodies: Bodies) -> float:
    """The larger side of what is drawn [m]; 1 m of a single point."""
    return float(np.ptp(points_of(bodies), axis=0).max()) or 1.0


def _fitting(share: float) -> float:
    """The scale for deflections that are this share of the structure's size."""
    return max([s for s in _SCALES if s * share <= _BENT], default=1.0)
