"""Functions of candidates, which every search, bench and recorder asks, whatever is behind them.

A move that quietarm simulates is one kind, a user's own function another.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.ocp import Front
from quietarm.ocp.front.points import Entries, FrontPoint
from quietarm.ocp.record import Record

Array = NDArray[np.float64]
Rows = tuple[tuple[float, ...], ...]


class ProblemFunction(ABC):
    """Objectives and violations of many candidates at once; all objectives are minimised.

    Attributes
    ----------
    task : PointToPoint or SearchedFunction
        The move; of a user's own function its names and its box.
    profile : JointProfile or SearchedFunction
        What the coefficients are of.
    bound : float or None
        Largest absolute coefficient, where the box has one for all.
    lower, upper : ndarray, shape (variables,)
        The box of the coefficients.
    variables, objectives, units, constraints : tuple of str
        Names, in the order of the columns, and the units of the objectives.
    reference : tuple of float or None
        The corner that hypervolumes are measured from; None where it follows from what is found.
    """

    task: Any
    profile: Any
    bound: float | None
    lower: Array
    upper: Array
    variables: tuple[str, ...]
    objectives: tuple[str, ...]
    units: tuple[str, ...]
    constraints: tuple[str, ...]
    reference: tuple[float, ...] | None = None

    @property
    def of_model(self) -> bool:
        """Return whether a plant's model stands behind it: it has a gradient, and no surprises."""
        return True

    @property
    def kept_free(self) -> float:
        """Return by how much a method that ends on constraints keeps violations below zero.

        It is 0 unless violations are shares of a limit. A user's own violations have units of their
        own; there such a method keeps its tolerance free.
        """
        return 0.0

    @property
    def corner(self) -> tuple[float, ...] | None:
        """Return the corner that hypervolumes are measured from; None as of `reference`."""
        return self.reference

    @abstractmethod
    def __call__(self, candidates: ArrayLike) -> tuple[Array, Array]:
        """Evaluate candidates, one a row.

        Objectives of shape (candidates, objectives), and violations of shape (candidates,
        constraints): positive where a constraint is broken.
        """

    def fill(self, candidates: Array, values: Array) -> None:
        """Write objectives and violations side by side into a table, a row for each candidate.

        A function that evaluates one candidate after another writes each row as soon as it has it,
        so that what is stopped in between leaves those before.
        """
        values[:] = np.hstack(self(candidates))

    @abstractmethod
    def points_of(
        self, coefficients: Array, values: Array, bound: float | None
    ) -> tuple[FrontPoint, ...]:
        """Return the points of a front, of candidates and what they were worth to the search."""

    @abstractmethod
    def entries_of(
        self, candidates: tuple[int, ...], coefficients: Rows, objectives: Rows, believed: Rows
    ) -> Entries:
        """Return the entries of a front, of a row for each objective; others as of `Entries`."""

    @abstractmethod
    def front_with(self, points: tuple[FrontPoint, ...], record: Record, **entries: Any) -> Front:
        """Return a front of these points, with further entries as of a `Front`."""
