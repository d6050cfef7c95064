"""Places of structures at the frames of a film, and how their parts look."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from quietarm.models import Body
from quietarm.ocp import Floor, JudgedMotion, Plan, Trajectory
from quietarm.views.pictures.grammar import FAINT, INK
from quietarm.views.pictures.motion import Line

Array = NDArray[np.float64]
_SCALES = (1.0, 2.0, 3.0, 5.0, 10.0, 20.0, 30.0, 50.0, 100.0)
_BENT = 0.2
"""Share of a structure's size up to which deflections are drawn larger than they are."""
_DOT = np.array([[0.0, 0.0], [1e-6, 0.0]])
"""A line of hardly any length [m], which with round ends shows as a disc."""


class DrawnPart(NamedTuple):
    """A line of a structure: its points, shape (frames, points, 2 or 3) [m], and its look."""

    points: Array
    colour: str
    width: float
    radius: float = 0.0
    """In space [m]."""
    tip: bool = False
    """Whether its last point is a tip."""


@dataclass(frozen=True)
class Structure:
    """A structure that moves as one motion has it, deflections drawn `scale` times larger."""

    line: Line
    trajectory: Trajectory
    times: Array
    scale: float = 1.0

    @cached_property
    def tips(self) -> Array:
        """Displacements of the tips at the frames [m], shape (frames, tips)."""
        return self._at_frames(self.trajectory.tips)

    @cached_property
    def bent(self) -> list[DrawnPart]:
        """Parts that are drawn: discs, links and tips."""
        return self._parts(self._bent_bodies)

    @cached_property
    def unbent(self) -> list[DrawnPart]:
        """Parts that are drawn, without deflection."""
        return self._parts(self._bodies(0 * self.tips))

    @property
    def paths(self) -> list[Array]:
        """Path on which each tip is drawn, shape (frames, 2 or 3) [m]."""
        first = self._bent_bodies[0]
        return [part.points[:, -1] for part, body in zip(self.bent, first) if body.tip]

    @property
    def trail_begins(self) -> float:
        """Time from which paths of tips are drawn [s]: in space from the start, else on arrival."""
        task = self.line.plan.task
        return 0.0 if task.plant.in_space else task.duration

    @property
    def corners(self) -> Array:
        """Least and largest coordinates of all that is drawn [m], shape (2, 2 or 3)."""
        parts = [*self.bent, *self.unbent]
        points = np.vstack([part.points.reshape(-1, part.points.shape[-1]) for part in parts])
        return np.array([points.min(axis=0), points.max(axis=0)])

    @property
    def scale_words(self) -> str:
        """Words on how much larger deflections are drawn."""
        return "to scale" if self.scale == 1 else f"deflection x {self.scale:g}"

    @property
    def on_support(self) -> bool:
        """Return whether a support is seen under the structure, down to the floor."""
        posts = [part for part in self.bent if part.colour == FAINT]
        return any(np.ptp(part.points, axis=1).max() > 2 * part.radius for part in posts)

    @property
    def largest_share(self) -> float:
        """The largest displacement of a tip as a share of the structure's size."""
        still = replace(self, times=self.times[:1])
        first = np.vstack([part.points[0] for part in still.unbent])
        size = np.ptp(first, axis=0).max() or 1.0  # 1 m of a single point
        return float(np.abs(self.tips).max() / size)

    def _at_frames(self, columns: Array) -> Array:
        sampled = [np.interp(self.times, self.trajectory.time, column) for column in columns.T]
        return np.column_stack(sampled)

    @cached_property
    def _bent_bodies(self) -> list[list[Body]]:
        return self._bodies(self.scale * self.tips)

    def _bodies(self, tips: Array) -> list[list[Body]]:
        """The bodies at every frame."""
        plant = self.line.plan.task.plant
        angles = self._at_frames(np.column_stack([self.trajectory.sample.path.angle]))[:, 0]
        return [
            list(plant.structure(float(angle), row.tolist())) for angle, row in zip(angles, tips)
        ]

    def _parts(self, bodies_of_frames: list[list[Body]]) -> list[DrawnPart]:
        plant = self.line.plan.task.plant
        parts = list[DrawnPart]()
        for bodies in zip(*bodies_of_frames):
            points = np.array([bent.points for bent in bodies])
            body = bodies[0]
            if body.ground:
                parts.append(DrawnPart(points, FAINT, 1.5, body.radius))
                continue
            if points.shape[1] == 1 and not plant.in_space:
                parts.append(DrawnPart(points + _DOT, INK, 16.0))
                continue
            colour = INK if body.rigid and not body.tip else self.line.colour
            parts.append(
                DrawnPart(points, colour, 9.0 if body.rigid else 5.0, body.radius, body.tip)
            )
        return parts


def structures_of(
    lines: Sequence[Line], times: Array, end: float, scale: float | None = None
) -> list[Structure]:
    """The motions of lines at the times of frames; those of one plant have one scale."""
    structures = [Structure(line, _until(line.plan, end), times) for line in lines]
    shares = dict[str, float]()
    for structure in structures:
        plant = structure.line.plan.task.plant.name
        shares[plant] = max(shares.get(plant, 0.0), structure.largest_share)

    def fitting(plant: str) -> float:
        return max([s for s in _SCALES if s * shares[plant] <= _BENT], default=1.0)

    return [replace(a, scale=scale or fitting(a.line.plan.task.plant.name)) for a in structures]


def _until(motion: Plan | Floor, end: float) -> Trajectory:
    """A motion from its start to the end of the film."""
    samples = 1500
    task = motion.task
    if task.duration + task.residual_window == end:
        return motion.trajectory
    if isinstance(motion, Plan):
        return motion.sampled(np.union1d(np.linspace(0.0, end, samples), [task.duration]))
    task = replace(task, residual_window=end - task.duration)
    return JudgedMotion.of_free_motion(task, motion.free).trajectory
