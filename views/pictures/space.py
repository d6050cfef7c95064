"""Structures in space: the room in which they move, and how a viewer sees it in perspective.

The scripts of the page have the same camera and the same capsules (`views/page/space.js`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import acos, ceil, cos, floor, log10, pi, sin

import numpy as np
from numpy.typing import NDArray

from quietarm.views.pictures.grammar import FAINT
from quietarm.views.pictures.structure import DrawnPart, Structure

Array = NDArray[np.float64]
ELEVATION = float(np.radians(18.0))
"""From which a structure is seen at first."""
_AWAY = 4.0
"""Distance of the viewer from the middle of the room, as a multiple of its size."""
_ROUND = 9
"""Points of each end of a capsule."""


@dataclass(frozen=True, eq=False)
class Room:
    """The upright cylinder in which structures move, on a floor.

    Attributes
    ----------
    middle : ndarray, shape (3,)
        Its middle [m].
    reach, half : float
        Its radius and half of its height [m].
    seen_from : float
        Direction of the ground from which it is seen at first [rad].
    """

    middle: Array
    reach: float
    half: float
    seen_from: float

    @classmethod
    def of(cls, structures: Sequence[Structure]) -> Room:
        """Return the room of structures of one plant at all of their frames."""
        parts = [part for structure in structures for part in structure.bent]
        low = np.min([part.points.min(axis=(0, 1)) - part.radius for part in parts], axis=0)
        high = np.max([part.points.max(axis=(0, 1)) + part.radius for part in parts], axis=0)
        feet = [part.points[..., 0, 2].min() for part in parts if part.colour == FAINT]
        low[2] = min(feet, default=low[2])
        middle = (low + high) / 2
        across = [
            np.linalg.norm(part.points[..., :2] - middle[:2], axis=-1).max() + part.radius
            for part in parts
        ]
        plant = structures[0].line.plan.task.plant
        return cls(middle, float(max(across)) or 1.0, float(high[2] - low[2]) / 2, plant.seen_from)

    @property
    def floor(self) -> float:
        """Height of the floor [m]."""
        return float(self.middle[2]) - self.half

    @property
    def away(self) -> float:
        """Distance of the viewer from the middle [m]."""
        return _AWAY * float(np.hypot(self.reach, self.half))

    @property
    def square(self) -> float:
        """Side of the squares of the floor [m]: 1, 2 or 5 times a power of ten."""
        power = 10.0 ** floor(log10(self.reach / 4))
        return power * next(digit for digit in (1, 2, 5, 10) if digit * power >= self.reach / 4)

    @property
    def square_words(self) -> str:
        """Say how large the squares of the floor are."""
        cm = 100 * self.square
        return f"squares of {self.square:g} m" if cm >= 100 else f"squares of {cm:g} cm"


@dataclass(frozen=True, eq=False)
class Camera:
    """A viewer of a room, by the direction in which the viewer stands [rad]."""

    room: Room
    azimuth: float
    elevation: float = ELEVATION

    def seen(self, points: Array) -> Array:
        """Return places in the picture, and a scale: shape (..., 3) of points (..., 3) [m].

        x is to the right and y upwards from the middle of the room; the nearer, the larger the
        scale, by which lengths at a point are drawn.
        """
        right = np.array([-sin(self.azimuth), cos(self.azimuth), 0.0])
        ground = np.array([cos(self.azimuth), sin(self.azimuth), 0.0])
        up = np.array([0.0, 0.0, 1.0])
        above = cos(self.elevation) * up - sin(self.elevation) * ground
        near = sin(self.elevation) * up + cos(self.elevation) * ground
        away = self.room.away
        off = points - self.room.middle
        scale = away / (away - off @ near)
        return np.stack([scale * (off @ right), scale * (off @ above), scale], axis=-1)

    def floor(self) -> tuple[Array, list[Array]]:
        """The edge of a round floor in the picture, and the lines of its squares."""
        turns = np.linspace(0.0, 2 * pi, 73)
        edge = self._on_floor(self.room.reach * np.column_stack([np.cos(turns), np.sin(turns)]))
        count = ceil(self.room.reach / self.room.square)
        lines = list[Array]()
        for k in range(-count, count + 1):
            at = k * self.room.square
            if abs(at) < self.room.reach:
                half = float(np.sqrt(self.room.reach**2 - at**2))
                lines.append(self._on_floor(np.array([[at, -half], [at, half]])))
                lines.append(self._on_floor(np.array([[-half, at], [half, at]])))
        return edge, lines

    def shadow(self, points: Array) -> Array:
        """Return points of a structure as they fall on the floor, in the picture."""
        return self.seen(np.column_stack([points[:, :2], np.full(len(points), self.room.floor)]))

    def _on_floor(self, places: Array) -> Array:
        x, y, _ = self.room.middle
        points = np.column_stack([places + np.array([x, y]), np.full(len(places), self.room.floor)])
        return self.seen(points)[:, :2]


def capsules(seen: Array, radius: float, wider: float = 0.0, shift: float = 0.0) -> list[Array]:
    """Outlines of the pieces of a line of a radius [m], as a camera has seen its points.

    Parameters
    ----------
    seen : ndarray, shape (points, 3)
        Places in the picture and scales; a single point is a ball.
    radius : float
        Of the line.
    wider : float
        By which it is wider in the picture.
    shift : float
        By which it is shifted up and to the left, as a share of the radius.
    """
    radii = radius * seen[:, 2]
    places = seen[:, :2] + np.outer(radii, [-shift, shift])
    radii = radii + wider
    if len(seen) == 1:
        return [_hull(places[0], radii[0], places[0], radii[0])]
    pieces = zip(places, radii, places[1:], radii[1:])
    return [_hull(*piece) for piece in pieces]


def _hull(first: Array, one: float, second: Array, other: float) -> Array:
    """Points around two discs."""
    across = second - first
    distance = float(np.hypot(*across))
    if distance <= abs(one - other):
        middle, radius = (first, one) if one >= other else (second, other)
        turns = np.linspace(0.0, 2 * pi, 2 * _ROUND)
        return middle + radius * np.column_stack([np.cos(turns), np.sin(turns)])
    towards = float(np.arctan2(across[1], across[0]))
    apart = acos((one - other) / distance)
    behind = np.linspace(towards + apart, towards + 2 * pi - apart, _ROUND)
    before = np.linspace(towards - apart, towards + apart, _ROUND)
    return np.vstack([
        first + one * np.column_stack([np.cos(behind), np.sin(behind)]),
        second + other * np.column_stack([np.cos(before), np.sin(before)]),
    ])  # fmt: skip


def by_depth(parts: Sequence[DrawnPart], frame: int, camera: Camera) -> list[tuple[int, Array]]:
    """Return the numbers of parts at a frame as they are seen, the farthest first."""
    seen = [camera.seen(part.points[frame]) for part in parts]
    return sorted(enumerate(seen), key=lambda part: float(part[1][:, 2].mean()))
