"""A place on a robot's path, and what was computed there, so that it is computed once."""

from __future__ import annotations

from collections.abc import Callable
from threading import local
from typing import Any

import numpy as np

from quietarm.models.joint_motion import Array, Expression
from quietarm.models.robot.path.piecewise import Place

OfGroup = dict[str, Array]


class Here:
    """A place on the path of one plant.

    Parameters
    ----------
    parts : tuple
        What the plant is made of, and the place last. Arrays are compared by their numbers, since
        whoever gave one may write others into it; all else by what it is, so that symbols can be
        among them.
    knots : ndarray
        Of the plant's tables.
    """

    def __init__(self, parts: tuple[Any, ...], knots: Array) -> None:
        self._parts = tuple(np.copy(part) if _is_array(part) else part for part in parts)
        self._knots = knots
        self._bases = dict[int, Place]()
        self._groups = dict[str, OfGroup]()

    def is_of(self, parts: tuple[Any, ...]) -> bool:
        """Return whether this is the place of that plant: the same numbers, the very objects."""
        return all(map(_is_same, self._parts, parts))

    def basis(self, terms: int) -> Place:
        """The basis of so many terms."""
        if terms not in self._bases:
            angle: Expression = self._parts[-1]
            self._bases[terms] = Place(self._knots, angle, terms)
        return self._bases[terms]

    def once(self, group: str, compute: Callable[[Here, str], OfGroup]) -> OfGroup:
        """Return the coefficients of a group, computed when they are first asked for."""
        if group not in self._groups:
            self._groups[group] = compute(self, group)
        return self._groups[group]


def _is_array(part: object) -> bool:
    return isinstance(part, np.ndarray)


def _is_same(mine: Any, other: Any) -> bool:
    """Return whether a part is the one that was kept, of an array whether its numbers are."""
    if _is_array(mine) and _is_array(other):
        return np.array_equal(mine, other)
    return mine is other


class Latest(local):
    """The latest place of a thread of Python."""

    here: Here | None = None
