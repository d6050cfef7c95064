"""MO-CMA-ES: evolution strategies that learn a covariance each, selected by hypervolume.

Every individual is a (1+1)-CMA-ES with a step length and a covariance of its own. Its offspring and
all parents are ranked by dominance and then by the hypervolume that each alone adds [1]_; an
offspring that survives is a success [2]_. All individuals are updated at once, as arrays.

References
----------
.. [1] Igel, Hansen and Roth, Evolutionary Computation 15, 2007, pp. 1-28.
.. [2] Voss, Hansen and Igel, Genetic and Evolutionary Computation Conference, 2010, pp. 487-494.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import moocore
import numpy as np
from numpy.typing import NDArray

from quietarm.metaheuristics.algorithms.array_algorithm import Array, ArrayAlgorithm
from quietarm.metaheuristics.algorithms.variation import reflected

Rows = NDArray[np.int64]


@dataclass
class Strategies:
    """Strategy parameters of individuals, a row for each, in bounds scaled to 0 to 1."""

    X: Array
    F: Array
    violation: Array
    step: Array
    success: Array
    path: Array
    covariance: Array

    def rows(self, rows: Any) -> Strategies:
        """Some of them, copied."""
        return Strategies(**{name: table[rows].copy() for name, table in vars(self).items()})

    def with_more(self, more: Strategies) -> Strategies:
        """Append the strategies of more individuals."""
        return Strategies(
            **{
                name: np.concatenate([table, getattr(more, name)])
                for name, table in vars(self).items()
            }
        )


class MOCMAES(ArrayAlgorithm):
    """MO-CMA-ES for any number of objectives.

    Parameters
    ----------
    population : int
        Individuals.
    first_step : float
        Step length at first, as a share of the box.
    """

    def __init__(self, population: int = 100, first_step: float = 0.2) -> None:
        super().__init__(population)
        self.first_step = first_step

    def _setup(self, problem: Any, **options: Any) -> None:
        super()._setup(problem, **options)
        self.strategies: Strategies | None = None

    @property
    def survivors(self) -> tuple[Array, Array, Array]:
        """The parents of the next generation."""
        known = self._known
        return self._in_units(known.X), known.F, known.violation

    @property
    def _known(self) -> Strategies:
        assert self.strategies is not None
        return self.strategies

    def _in_units(self, X: Array) -> Array:
        return np.clip(self.lower + X * (self.upper - self.lower), self.lower, self.upper)

    def propose(self) -> Array:
        """An offspring of each individual, normally distributed about it."""
        parents = self._known
        size = parents.X.shape[1]
        draws = self.random_state.standard_normal(parents.X.shape)
        factors = np.linalg.cholesky(parents.covariance)
        steps = np.einsum("ijk,ik->ij", factors, draws)
        offspring = parents.X + parents.step[:, None] * steps
        self.offspring = reflected(offspring, np.zeros(size), np.ones(size))
        return self._in_units(self.offspring)

    def learn(self, X: Array, F: Array, violation: Array) -> None:
        """Update every individual by whether its offspring survives, and select."""
        if self.strategies is None:
            self.strategies = self._first(X, F, violation)
            return
        parents = self._known
        count, size = parents.X.shape
        offspring = parents.rows(slice(None))
        offspring.X = self.offspring
        offspring.F = F.copy()
        offspring.violation = violation.copy()
        merged = parents.with_more(offspring)
        selected = self._selected(merged, count)
        survives = np.isin(np.arange(count, 2 * count), selected)
        moves = (offspring.X - parents.X) / parents.step[:, None]
        _adapt_step(offspring, survives, size)
        _adapt_covariance(offspring, moves, size)
        _adapt_step(parents, survives, size)
        self.strategies = parents.with_more(offspring).rows(selected)

    def _first(self, X: Array, F: Array, violation: Array) -> Strategies:
        count, size = X.shape
        return Strategies(
            (X - self.lower) / (self.upper - self.lower),
            F.copy(),
            violation.copy(),
            np.full(count, self.first_step),
            np.full(count, 1 / 5.5),
            np.zeros((count, size)),
            np.tile(np.eye(size), (count, 1, 1)),
        )

    def _selected(self, strategies: Strategies, count: int) -> Rows:
        """The best of them: by violation, then dominance, then contributed hypervolume."""
        order = list[int]()
        feasible = np.flatnonzero(strategies.violation <= 0)
        ranks = moocore.pareto_rank(strategies.F[feasible]) if len(feasible) else feasible
        for rank in range(int(ranks.max()) + 1 if len(feasible) else 0):
            rows = feasible[ranks == rank]
            missing = count - len(order)
            if len(rows) <= missing:
                order.extend(rows.tolist())
                continue
            order.extend(rows[most_contributing(strategies.F[rows], missing)].tolist())
            break
        if len(order) < count:
            broken = np.flatnonzero(strategies.violation > 0)
            by_violation = broken[np.argsort(strategies.violation[broken], kind="stable")]
            order.extend(by_violation[: count - len(order)].tolist())
        return np.array(order)


def most_contributing(F: Array, count: int) -> Rows:
    """Rows of non-dominated points that are left when the least hypervolume is lost, one by one."""
    rows = np.arange(len(F))
    span = np.ptp(F, axis=0)
    scaled = (F - F.min(axis=0)) / np.where(span > 0, span, 1.0)
    # the ends are never lost: beyond them there is room for all
    corner = np.full(F.shape[1], 1e6)
    while len(rows) > count:
        contributions = moocore.hv_contributions(scaled[rows], ref=corner)
        rows = np.delete(rows, np.argmin(contributions))
    return rows


def _adapt_step(strategies: Strategies, success: NDArray[np.bool_], size: int) -> None:
    target = 1 / 5.5
    rate = target / (2 + target)
    damping = 1 + size / 2
    strategies.success = (1 - rate) * strategies.success + rate * success
    strategies.step *= np.exp((strategies.success - target) / (damping * (1 - target)))
    strategies.step = np.clip(strategies.step, 1e-12, 1.0)


def _adapt_covariance(strategies: Strategies, moves: Array, size: int) -> None:
    few = 0.44  # share of successes above which the path is not followed
    rate = 2 / (size + 2)
    learning = 2 / (size**2 + 6)
    quiet = (strategies.success < few)[:, None]
    path = (1 - rate) * strategies.path + np.where(quiet, np.sqrt(rate * (2 - rate)) * moves, 0.0)
    outer = path[:, :, None] * path[:, None, :]
    old = strategies.covariance
    outer = outer + np.where(quiet[:, :, None], 0.0, rate * (2 - rate)) * old
    strategies.covariance = (1 - learning) * old + learning * outer
    strategies.path = path
