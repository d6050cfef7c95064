"""Where structures are at the frames of a film."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from quietarm.models import Body
from quietarm.ocp import Candidate, Floor, Plan, Trajectory
from quietarm.studies.figures.motion import Line

Array = NDArray[np.float64]

_SCALES = (1.0, 2.0, 3.0, 5.0, 10.0, 20.0, 30.0, 50.0, 100.0)
_BENT = 0.2
"""Share of a structure's size up to which deflections are drawn larger than they are."""
_SAMPLES = 1500


@dataclass(frozen=True)
class Structure:
    """A structure that moves as one motion has it."""

    line: Line
    trajectory: Trajectory
    times: Array
    scale: float = 1.0

    @cached_property
    def tips(self) -> Array:
        """Displacements of the tips at the frames [m]."""
        return self._at_frames(self.trajectory.tips)

    @cached_property
    def bodies(self) -> list[list[Body]]:
        """What is drawn at every frame."""
        return self._structures(self.scale * self.tips)

    @cached_property
    def unbent(self) -> list[list[Body]]:
        """The same without bending."""
        return self._structures(0 * self.tips)

    @property
    def paths(self) -> Array:
        """Where the tips are drawn, shape (tips, frames, 2) [m]."""
        ends = [[body.points[-1] for body in bodies if body.tip] for bodies in self.bodies]
        return np.array(ends).reshape(len(ends), -1, 2).transpose(1, 0, 2)

    @property
    def corners(self) -> Array:
        """Least and largest coordinates of all that is drawn [m], shape (2, 2)."""
        return _corners([body for bodies in (*self.bodies, *self.unbent) for body in bodies])

    @property
    def largest_share(self) -> float:
        """The largest displacement of a tip as a share of the structure's size."""
        size = np.ptp(_corners(self.unbent[0]), axis=0).max() or 1.0  # 1 m of a single point
        return float(np.abs(self.tips).max() / size)

    def _at_frames(self, columns: Array) -> Array:
        sampled = [np.interp(self.times, self.trajectory.time, column) for column in columns.T]
        return np.column_stack(sampled)

    def _structures(self, tips: Array) -> list[list[Body]]:
        plant = self.line.plan.task.plant
        angles = self._at_frames(self.trajectory.joint[:, :1])[:, 0]
        return [
            list(plant.structure(float(angle), row.tolist()))
            for angle, row in zip(angles, tips, strict=True)
        ]


def structures_of(
    lines: Sequence[Line], times: Array, end: float, scale: float | None = None
) -> list[Structure]:
    """The motions of lines at the times of frames; those of one plant have one scale."""
    structures = [Structure(line, _until(line.plan, end), times) for line in lines]

    def fitting(plant: str) -> float:
        share = max(a.largest_share for a in structures if a.line.plan.task.plant.name == plant)
        return max([s for s in _SCALES if s * share <= _BENT], default=1.0)

    return [replace(a, scale=scale or fitting(a.line.plan.task.plant.name)) for a in structures]


def _until(motion: Plan | Floor, end: float) -> Trajectory:
    """A motion from its start to the end of the animation."""
    task = motion.task
    if task.duration + task.residual_window == end:
        return motion.trajectory
    if isinstance(motion, Plan):
        return motion.sampled(np.union1d(np.linspace(0.0, end, _SAMPLES), [task.duration]))
    task = replace(task, residual_window=end - task.duration)
    return Candidate.of_free_motion(task, motion.free).trajectory


def _corners(bodies: Sequence[Body]) -> Array:
    points = np.vstack([body.points for body in bodies])
    return np.array([points.min(axis=0), points.max(axis=0)])
