"""A place on a robot's path, and what was computed there, so that it is computed once."""

from __future__ import annotations

from collections.abc import Callable
from threading import local
from typing import Any

from quietarm.models.joint_motion import Array, Expression
from quietarm.models.robot.path.piecewise import Place

OfGroup = dict[str, Array]


class Here:
    """A place on the path of one plant.

    Parameters
    ----------
    parts : tuple
        What the plant is made of, and the place last. They are compared by what they are, not by
        what they say, so that symbols can be among them.
    knots : ndarray
        Of the plant's tables.
    """

    def __init__(self, parts: tuple[Any, ...], knots: Array) -> None:
        self._parts = parts
        self._knots = knots
        self._bases = dict[int, Place]()
        self._groups = dict[str, OfGroup]()

    def is_of(self, parts: tuple[Any, ...]) -> bool:
        """Return whether this is the place of that plant, the very same objects."""
        return all(mine is other for mine, other in zip(self._parts, parts))

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


class Latest(local):
    """The latest place of a thread of Python."""

    here: Here | None = None
