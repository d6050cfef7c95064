"""A grid of moves: axes over the move and over parameters of its plant."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import groupby, product
from typing import Any

import numpy as np

from quietarm.models import Plant
from quietarm.models.dimensions import WAY
from quietarm.ocp import PointToPoint
from quietarm.ocp.checks import IF_STATED, finite, has_no, quoted
from quietarm.ocp.task import OF_MOVES
from quietarm.ocp.window import DefaultWindow, default_window
from quietarm.studies.sweep.learned_arrivals import LearnedArrivals

MOST_VALUES = 100_000
"""Of an axis."""
MOST_CELLS = 5_000_000
"""Of a grid; so many take some 7 hours on a core, and as dataset 1.5 GB."""


@dataclass(frozen=True)
class Axis:
    """Values of one quantity, which are made to rise."""

    name: str
    values: tuple[float, ...]
    unit: str

    def __post_init__(self) -> None:
        values = tuple(sorted(finite(f"a value of {self.name}", value) for value in self.values))
        if not 0 < len(values) <= MOST_VALUES or len(set(values)) < len(values):
            raise ValueError(
                f"the axis {self.name} has {len(values)} values, {len(set(values))} different; "
                f"give 1 to {MOST_VALUES}, each once"
            )
        object.__setattr__(self, "values", values)


@dataclass(frozen=True)
class MoveGrid:
    """The moves of several axes, in C order.

    Parameters of the plant come before the quantities of the move: chunks then have few plants.
    All moves have one residual window, the task's; where nobody gave it, the longest of their own.
    Of a grid that was learned from recordings each arrives in a state of its own.
    """

    task: PointToPoint
    axes: tuple[Axis, ...]
    arrivals: LearnedArrivals | None = field(default=None, metadata=IF_STATED)

    def __post_init__(self) -> None:
        units = self.task.plant.units()
        units |= {name: unit.of(self.task.plant.joint) for name, unit in OF_MOVES.items()}
        for axis in self.axes:
            if axis.name not in units:
                raise ValueError(
                    has_no(
                        self.task.plant.name,
                        "axis",
                        axis.name,
                        units,
                    )
                )
            if self.names.count(axis.name) > 1:
                raise ValueError(f"the axis {axis.name} is given twice; give it once")
            if axis.unit != units[axis.name]:
                raise ValueError(
                    f"the axis {axis.name} is in {quoted(axis.unit)}; give it in "
                    f"{quoted(units[axis.name])}"
                )
        if self.cells > MOST_CELLS:
            raise ValueError(
                f"the grid has {self.cells} cells, some {self.hours:.0f} hours on a core, and "
                f"{MOST_CELLS} are the most of one dataset; give wider steps, or a part of it"
            )
        known = {axis.name: axis.values for axis in self.axes}
        starts = known.get("start", (self.task.start,))
        for same in sorted({*starts} & {*known.get("target", (self.task.target,))}):
            raise ValueError(
                f"start and target are both {same:g} {WAY.of(self.task.plant.joint)} in "
                "some cells: there is no move; leave that value out of one axis"
            )
        if self.axes and isinstance(self.task.residual_window, DefaultWindow):
            window = float(default_window(self._plants_and_targets()))
            object.__setattr__(
                self,
                "task",
                replace(self.task, residual_window=window),
            )

    @property
    def names(self) -> list[str]:
        """Names of the axes."""
        return [axis.name for axis in self.axes]

    @property
    def shape(self) -> tuple[int, ...]:
        """Values of every axis."""
        return tuple(len(axis.values) for axis in self.axes)

    @property
    def cells(self) -> int:
        """Number of moves."""
        return math.prod(self.shape)

    @property
    def hours(self) -> float:
        """Hours that a core takes to plan the moves, roughly."""
        # of six terms, without ranges of errors
        seconds_of_cell = 0.005
        return seconds_of_cell * self.cells / 3600

    def tasks(self, chunk: tuple[slice, ...]) -> list[PointToPoint]:
        """The moves of some cells."""
        parts = (axis.values[cut] for axis, cut in zip(self.axes, chunk))
        return [self.task_at(dict(zip(self.names, values))) for values in product(*parts)]

    def task_at(self, at: Mapping[str, float]) -> PointToPoint:
        """The move of a value of every axis."""
        move = {name: at[name] for name in OF_MOVES if name in at}
        task = replace(self.task, plant=self._plant_at(at), **move)
        if self.arrivals is None:
            return task
        final = self.arrivals.final(task.plant, (task.start, task.target, task.duration))
        return replace(task, final=final)

    def _plant_at(self, at: Mapping[str, float]) -> Plant:
        """The plant of a value of every axis; those over the move do not count."""
        plant: Any = self.task.plant
        return replace(plant, **{name: at[name] for name in at if name not in OF_MOVES})

    def _plants_and_targets(self) -> Iterator[tuple[Plant, float]]:
        """Yield plants and targets of moves, by what decides how slowly the plant swings there."""
        axes = [axis for axis in self.axes if axis.name not in ("start", "duration")]
        most = 41 if len(axes) <= 2 else 7  # values of an axis, the ends among them
        for values in product(*(_thinned(axis.values, most) for axis in axes)):
            at = dict(zip([axis.name for axis in axes], values))
            yield self._plant_at(at), at.get("target", self.task.target)


def _thinned(values: tuple[float, ...], most: int) -> tuple[float, ...]:
    """Return at most so many of the values, spread evenly with both ends."""
    places = np.unique(
        np.linspace(
            0,
            len(values) - 1,
            min(most, len(values)),
        )
        .round()
        .astype(int)
    )
    return tuple(values[place] for place in places)


def by_plant(tasks: Iterable[PointToPoint]) -> Iterator[list[PointToPoint]]:
    """Moves of one plant after another, together."""
    return (list(group) for _, group in groupby(tasks, key=lambda task: task.plant))
