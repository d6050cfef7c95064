"""A grid of moves: axes over the move and over parameters of its plant."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from quietarm.ocp import PointToPoint

OF_MOVES = {"start": "rad", "target": "rad", "duration": "s"}
"""Axes over the move, with their units; all others are parameters of the plant."""
_WHOLE_STEPS = 1e-6


@dataclass(frozen=True)
class Axis:
    """Values of one quantity."""

    name: str
    values: tuple[float, ...]
    unit: str


def axis_values(text: str, parse: Callable[[str], float]) -> tuple[float, ...]:
    """Read values: one, several as ``0.6,0.8,1.2``, or from, to, step as ``10deg:90deg:5deg``."""
    if ":" in text:
        ends = text.split(":")
        if len(ends) != 3:
            raise ValueError(f"{text!r} is no axis; give from:to:step, as 10deg:90deg:5deg")
        first, last, step = map(parse, ends)
        steps = (last - first) / step if step else math.inf
        if not (steps > 0 and math.isfinite(steps)):
            raise ValueError(
                f"{text!r}: steps of {ends[2]} do not lead from {ends[0]} to {ends[1]}"
            )
        if abs(steps - round(steps)) > _WHOLE_STEPS * steps:
            raise ValueError(
                f"{text!r}: steps of {ends[2]} from {ends[0]} do not reach {ends[1]}; give a step "
                "that does"
            )
        return tuple(np.linspace(first, last, round(steps) + 1).round(12).tolist())
    values = tuple(parse(one) for one in text.split(","))
    if len(set(values)) < len(values):
        raise ValueError(f"{text!r} has a value twice; give each once")
    return tuple(sorted(values))


@dataclass(frozen=True)
class Grid:
    """The cells of several axes, in the order of their last axis first; some at once are a chunk.

    Parameters of the plant come before the quantities of the move: chunks then have few plants.
    """

    task: PointToPoint
    axes: tuple[Axis, ...]
    at_once: int = 256

    def __post_init__(self) -> None:
        known = {axis.name: axis.values for axis in self.axes}
        starts = known.get("start", (self.task.start,))
        for same in sorted({*starts} & {*known.get("target", (self.task.target,))}):
            raise ValueError(
                f"start and target are both {same:g} rad in some cells: there is no move; leave "
                "that value out of one axis"
            )

    @property
    def shape(self) -> tuple[int, ...]:
        """Values of every axis."""
        return tuple(len(axis.values) for axis in self.axes)

    @property
    def cells(self) -> int:
        """How many moves there are."""
        return math.prod(self.shape)

    @cached_property
    def chunk(self) -> tuple[int, ...]:
        """Cells of a chunk along each axis; along one that is cut, chunks are alike."""
        sizes, room = list[int](), self.at_once
        for length in reversed(self.shape):
            parts = -(-length // max(1, room))
            sizes.append(-(-length // parts))
            room //= sizes[-1]
        return tuple(reversed(sizes))

    @cached_property
    def chunks(self) -> list[tuple[slice, ...]]:
        """The cells of every chunk."""
        counts = [-(-n // size) for n, size in zip(self.shape, self.chunk, strict=True)]
        return [
            tuple(
                slice(k * size, min((k + 1) * size, n))
                for k, size, n in zip(place, self.chunk, self.shape, strict=True)
            )
            for place in np.ndindex(*counts)
        ]

    def tasks(self, chunk: Sequence[slice]) -> list[PointToPoint]:
        """The moves of a chunk, in C order."""
        parts = [axis.values[cut] for axis, cut in zip(self.axes, chunk, strict=True)]
        return [self._task([part[i] for part, i in zip(parts, place, strict=True)])
                for place in np.ndindex(*map(len, parts))]  # fmt: skip

    def _task(self, values: Sequence[float]) -> PointToPoint:
        given = {axis.name: value for axis, value in zip(self.axes, values, strict=True)}
        move = {name: given.pop(name) for name in OF_MOVES if name in given}
        plant: Any = self.task.plant
        return replace(self.task, plant=replace(plant, **given), **move)
