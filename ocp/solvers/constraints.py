"""What is bounded in a batch of problems, one class a kind of constraint.

Each gives its values and their Jacobian from the motions' derivatives, both scaled, and adds its
multipliers to those of the motions. The first axis is the problem, or of one evaluation the row.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.limits import Limit
from quietarm.ocp.solvers.batch import Derivatives, Multipliers

Array = NDArray[np.float64]
Index = NDArray[np.intp]


class Constraint(ABC):
    """Values within bounds.

    Attributes
    ----------
    lower, upper : ndarray, shape (problems, values)
        Their bounds.
    """

    lower: Array
    upper: Array

    @property
    def count(self) -> int:
        """How many values."""
        return self.upper.shape[1]

    @abstractmethod
    def evaluate(self, rows: Index, motions: Derivatives, x: Array) -> tuple[Array, Array]:
        """Values (rows, count) and Jacobian (rows, count, n) at the unknowns x (rows, n).

        Derivatives of the motions are by scenario and along the unknowns.
        """

    @abstractmethod
    def pull_back(self, rows: Index, multipliers: Array, onto: Multipliers) -> None:
        """Add multipliers of the values (rows, count) to those of the motions, by scenario."""


class ResidualLimit(Constraint):
    """The tip displacements after arrival in every scenario, at the times that can be largest."""

    def __init__(self, tips: Array, limit: Array) -> None:
        """Tips have shape (problems, scenarios, times, 2 * modes), scaled; limits (problems,)."""
        self._tips = tips
        self.upper = np.repeat(limit[:, None], tips.shape[1] * tips.shape[2], axis=1)
        self.lower = -self.upper

    def evaluate(self, rows: Index, motions: Derivatives, x: Array) -> tuple[Array, Array]:
        """As of `Constraint`."""
        tips, count, n = self._tips[rows], len(rows), x.shape[1]
        values = np.einsum("rstk,rsk->rst", tips, motions.arrival).reshape(count, self.count)
        return values, (tips @ motions.arrival_jacobian).reshape(count, self.count, n)

    def pull_back(self, rows: Index, multipliers: Array, onto: Multipliers) -> None:
        """As of `Constraint`."""
        tips = self._tips[rows]
        onto.arrival[:] += np.einsum("rst,rstk->rsk", multipliers.reshape(tips.shape[:3]), tips)


class QuantityLimit(Constraint):
    """A quantity at the nodes of the steps, of the nominal plant or in all scenarios."""

    def __init__(self, place: slice, scenarios: int, bounds: Array, scale: Array) -> None:
        """Where it stands among the limited; bounds (problems, 2) and scales (problems,)."""
        self._scenarios, self._place, self._scale = slice(0, scenarios), place, scale[:, None]
        values = scenarios * (place.stop - place.start)
        self.lower, self.upper = (
            np.repeat(side[:, None], values, axis=1) for side in (bounds / self._scale).T
        )

    def evaluate(self, rows: Index, motions: Derivatives, x: Array) -> tuple[Array, Array]:
        """As of `Constraint`."""
        del x
        count, scale = len(rows), self._scale[rows]
        values = motions.limited[:, self._scenarios, self._place].reshape(count, self.count) / scale
        jacobian = motions.limited_jacobian[:, self._scenarios, self._place]
        return values, jacobian.reshape(*values.shape, jacobian.shape[-1]) / scale[:, :, None]

    def pull_back(self, rows: Index, multipliers: Array, onto: Multipliers) -> None:
        """As of `Constraint`."""
        part = onto.limited[:, self._scenarios, self._place]
        part += (multipliers / self._scale[rows]).reshape(part.shape)


class Peak(Constraint):
    """A constraint whose peak p is the last unknown: v - p <= 0 <= v + p, as of `Limit.peak`."""

    def __init__(self, of: Constraint, limit: Limit) -> None:
        self._of, self._limit = of, limit
        zero, free = np.zeros(of.upper.shape), np.full(of.upper.shape, np.inf)
        self.upper, self.lower = np.hstack([zero, free]), np.hstack([-free, zero])

    def evaluate(self, rows: Index, motions: Derivatives, x: Array) -> tuple[Array, Array]:
        """As of `Constraint`."""
        values, jacobian = self._of.evaluate(rows, motions, x)
        one, peak, (below, above) = np.ones((*values.shape, 1)), x[:, -1:], self._limit.sides
        by_peak = [
            np.concatenate([jacobian[:, :, :-1], -side * one], axis=2) for side in (above, below)
        ]
        bounded = np.hstack([values - above * peak, values - below * peak])
        return bounded, np.concatenate(by_peak, axis=1)

    def pull_back(self, rows: Index, multipliers: Array, onto: Multipliers) -> None:
        """As of `Constraint`."""
        below, above = np.split(multipliers, 2, axis=1)
        self._of.pull_back(rows, below + above, onto)

    def largest(self, rows: Index, motions: Derivatives, x: Array) -> Array:
        """The peaks, shape (rows,)."""
        values = self._of.evaluate(rows, motions, x)[0]
        return self._limit.peak(values.min(axis=1), values.max(axis=1))


class Box(Constraint):
    """The coefficients that have bounds of their own, linear in the unknowns."""

    def __init__(self, lower: Array, upper: Array, axes: Array) -> None:
        """Bounds have shape (problems, profile.size); coefficients are axes @ unknowns."""
        bounded = np.isfinite(np.stack([lower, upper])).any(axis=(0, 1))
        self.lower, self.upper, self._axes = lower[:, bounded], upper[:, bounded], axes[bounded]

    def evaluate(self, rows: Index, motions: Derivatives, x: Array) -> tuple[Array, Array]:
        """As of `Constraint`."""
        jacobian = np.repeat(self._axes[None], len(rows), axis=0)
        return x @ self._axes.T, jacobian

    def pull_back(self, rows: Index, multipliers: Array, onto: Multipliers) -> None:
        """As of `Constraint`: it is linear."""
