"""Contents of a library of moves, such as a sweep's dataset, for the page."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

from numpy.typing import NDArray

from quietarm.ocp import PointToPoint


class LibraryAxis(Protocol):
    """One quantity of a grid."""

    @property
    def name(self) -> str:
        """A quantity of the move, or a parameter of its plant."""
        ...

    @property
    def values(self) -> Sequence[float]:
        """The values in SI units, which rise."""
        ...

    @property
    def unit(self) -> str:
        """The SI unit."""
        ...


class LibraryGrid(Protocol):
    """The axes of a library."""

    @property
    def axes(self) -> Sequence[LibraryAxis]:
        """One for each quantity that differs between the moves."""
        ...

    @property
    def names(self) -> Sequence[str]:
        """The names of the axes."""
        ...


class Library(Protocol):
    """Coefficients of every move within a grid."""

    @property
    def grid(self) -> LibraryGrid:
        """The grid."""
        ...

    def task(self, **at: float) -> PointToPoint:
        """Make the move of some values of the axes."""
        ...

    def coefficients(self, **at: float) -> NDArray[Any]:
        """Interpolate the coefficients of a move; ValueError where there are none."""
        ...
