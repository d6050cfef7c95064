"""MOEA/D with differential evolution, whose objectives are scaled to what was found.

Each individual minimises the largest weighted and scaled objective, for weights of its own, and is
bred from, and replaces, those of neighbouring weights [1]_. Both objectives of a move have units
and sizes of their own; so they are scaled to the best values until now and to the largest of the
non-dominated individuals.

MOEA/D goes from one individual to the next. Here the offspring of all are bred first and evaluated
in one call, then they replace in turn: a call for many candidates costs little more than one.

References
----------
.. [1] Li and Zhang, IEEE Transactions on Evolutionary Computation 13, 2009, pp. 284-302.
"""

from __future__ import annotations

from typing import Any

import moocore
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from quietarm.metaheuristics.algorithms.array_algorithm import Array, ArrayAlgorithm
from quietarm.metaheuristics.algorithms.variation import mutated, reflected

Rows = NDArray[np.int64]


class ScaledMOEAD(ArrayAlgorithm):
    """MOEA/D-DE for any number of objectives.

    Of two candidates the one of smaller violation is better, then the one of smaller scaled
    objective.

    Parameters
    ----------
    ref_dirs : ndarray, shape (population, objectives)
        Weights of the individuals, of sum 1.
    n_neighbors : int
        Individuals of the nearest weights, from which the parents come.
    prob_neighbor_mating : float
        Share of the offspring whose parents are neighbours; the others' are any.
    replaced : int
        Most individuals that one offspring replaces.
    CR, F : float
        Share of the coefficients that cross, and factor of the difference.
    mutation_eta : float
        How small a mutation is; of each coefficient at a rate of 1 / their number.
    """

    def __init__(
        self,
        ref_dirs: Array,
        n_neighbors: int = 20,
        prob_neighbor_mating: float = 0.9,
        replaced: int = 2,
        CR: float = 1.0,
        F: float = 0.5,
        mutation_eta: float = 20.0,
    ) -> None:
        super().__init__(len(ref_dirs))
        self.weights = np.maximum(ref_dirs, 1e-6)  # what has no weight would not be minimised
        self.n_neighbors = n_neighbors
        self.near = prob_neighbor_mating
        self.replaced = replaced
        self.crossover = CR
        self.factor = F
        self.mutation_eta = mutation_eta

    def _setup(self, problem: Any, **options: Any) -> None:
        super()._setup(problem, **options)
        distances = cdist(self.weights, self.weights)
        self.neighbours = np.argsort(distances, axis=1, kind="stable")[:, : self.n_neighbors]
        self.ideal = np.full(problem.n_obj, np.inf)
        self.X = np.empty((0, problem.n_var))

    @property
    def survivors(self) -> tuple[Array, Array, Array]:
        """One individual for each of the weights."""
        return self.X, self.objectives, self.violation

    def propose(self) -> Array:
        """An offspring of each individual, by the difference of two others."""
        random = self.random_state
        count = len(self.X)
        self.among_neighbours = random.random(count) < self.near
        first = self._drawn()
        second = self._drawn()
        crossing = random.random(self.X.shape) < self.crossover
        crossing[np.arange(count), random.integers(self.X.shape[1], size=count)] = True
        moved = self.X + self.factor * (self.X[first] - self.X[second])
        offspring = np.where(crossing, moved, self.X)
        offspring = reflected(offspring, self.lower, self.upper)
        return mutated(offspring, self.lower, self.upper, self.mutation_eta, random)

    def _drawn(self) -> Rows:
        """An individual for each, from its neighbours or from all."""
        random = self.random_state
        count = len(self.X)
        columns = random.integers(self.neighbours.shape[1], size=count)
        near = self.neighbours[np.arange(count), columns]
        return np.where(self.among_neighbours, near, random.integers(count, size=count))

    def learn(self, X: Array, F: Array, violation: Array) -> None:
        """Let the offspring replace individuals, in random order."""
        feasible = violation <= 0
        if feasible.any():
            self.ideal = np.minimum(self.ideal, F[feasible].min(axis=0))
        if not len(self.X):
            self.X = X.copy()
            self.objectives = F.copy()
            self.violation = violation.copy()
            return
        extent = self._extent(F, violation)
        merit = self._merit(self.objectives, extent)
        scaled = (F - self.ideal) / extent
        everybody = np.arange(len(self.X))
        replaced_by = np.full(len(self.X), -1)
        known = self.violation.copy()
        for row in self.random_state.permutation(len(X)):
            places = self.neighbours[row] if self.among_neighbours[row] else everybody
            value = (self.weights[places] * scaled[row]).max(axis=1)
            better = (violation[row] < known[places]) | (
                (violation[row] == known[places]) & (value < merit[places])
            )
            chosen = np.flatnonzero(better)
            if len(chosen) > self.replaced:
                chosen = self.random_state.choice(chosen, self.replaced, replace=False)
            merit[places[chosen]] = value[chosen]
            known[places[chosen]] = violation[row]
            replaced_by[places[chosen]] = row
        changed = replaced_by >= 0
        self.X[changed] = X[replaced_by[changed]]
        self.objectives[changed] = F[replaced_by[changed]]
        self.violation = known

    def _merit(self, F: Array, extent: Array) -> Array:
        """The largest weighted and scaled objective of each individual, for its weights."""
        return (self.weights * ((F - self.ideal) / extent)).max(axis=1)

    def _extent(self, F: Array, violation: Array) -> Array:
        """Return the extent of the non-dominated, feasible individuals in each objective."""
        table = np.vstack([self.objectives, F])
        table = table[np.append(self.violation, violation) <= 0]
        if not len(table):
            return np.ones(F.shape[1])
        extent = table[moocore.is_nondominated(table)].max(axis=0) - self.ideal
        return np.where(extent > 0, extent, 1.0)
