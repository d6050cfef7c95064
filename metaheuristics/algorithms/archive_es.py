"""A (1+1) evolution strategy with an archive: one candidate after another, for small budgets.

The parent is a candidate of the archive, the less crowded of two. Its child takes a normal step
whose length is drawn anew each time, from a thousandth to a third of the box, and at times a share
of the difference of two others as well. Where no candidate is feasible yet, those of least
violation are the archive. After Knowles and Corne, whose archive chooses in the same way [1]_.

References
----------
.. [1] Knowles and Corne, Evolutionary Computation 8, 2000, pp. 149-172.
"""

from __future__ import annotations

from typing import Any

import moocore
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class ArchiveStrategy:
    """The archive of a (1+1) evolution strategy, and how a child is made of it.

    Parameters
    ----------
    X, F, violation : ndarray
        Candidates, their objectives, and the sum of what they violate.
    most_infeasible : int
        Candidates that are kept while none is feasible.
    """

    def __init__(self, X: Array, F: Array, violation: Array, most_infeasible: int = 10) -> None:
        self.most_infeasible = most_infeasible
        self._keep(X, F, violation)

    def take(self, X: Array, F: Array, violation: Array) -> None:
        """Let candidates enter that nothing in the archive dominates."""
        if (self.violation[0] <= 0) and (violation > 0).all():
            return
        everything = (
            np.vstack([self.X, X]),
            np.vstack([self.F, F]),
            np.append(self.violation, violation),
        )
        self._keep(*everything)

    def _keep(self, X: Array, F: Array, violation: Array) -> None:
        rows = np.flatnonzero(violation <= 0)
        if len(rows):
            rows = rows[moocore.is_nondominated(F[rows])]
        else:
            rows = np.argsort(violation, kind="stable")[: self.most_infeasible]
        self.X = X[rows]
        self.F = F[rows]
        self.violation = violation[rows]
        extent = np.ptp(self.F, axis=0)
        scaled = (self.F - self.F.min(axis=0)) / np.where(extent > 0, extent, 1.0)
        distance = np.abs(scaled[:, None] - scaled).sum(axis=2)
        # the nearest is the candidate itself
        self._room = np.sort(distance, axis=1)[:, 1:3].sum(axis=1)

    def child(self, size: Array, differences: float, random: np.random.Generator) -> Array:
        """A child in the box's units, which may lie beyond the box."""
        shortest = -3.0  # powers of ten, as shares of the box
        longest = -0.5
        count = len(self.X)
        parent, rival = random.integers(count, size=2)
        if count > 3 and self._room[rival] > self._room[parent]:
            parent = rival
        child = self.X[parent].copy()
        step = 10 ** random.uniform(shortest, longest)
        moved = random.random(len(child)) < 0.5
        child += np.where(moved, step * size * random.standard_normal(len(child)), 0.0)
        if count > 2 and random.random() < differences:
            one, other = random.integers(count, size=2)
            child += random.uniform(-1, 1) * (self.X[one] - self.X[other])
        return child


def archive_es(
    function: Any, seed: int, budget: int, first: int = 10, differences: float = 0.5
) -> None:
    """Ask a problem's recorded function for candidates until its budget is spent.

    Parameters
    ----------
    function : callable
        A problem's recorded function.
    seed : int
        Seed of the random numbers.
    budget : int
        Candidates that count; the function itself ends the search.
    first : int
        Candidates that are drawn uniformly before.
    differences : float
        Share of the children that take a difference of two others as well.
    """
    del budget
    random = np.random.default_rng(seed)
    lower, upper = function.lower, function.upper
    X = random.uniform(lower, upper, (first, len(lower)))
    F, violations = function(X)
    archive = ArchiveStrategy(X, F, np.maximum(violations, 0.0).sum(axis=1))
    while True:
        child = archive.child(upper - lower, differences, random)
        child = np.where(child < lower, 2 * lower - child, child)
        child = np.where(child > upper, 2 * upper - child, child)
        child = np.clip(child, lower, upper)[None]
        F, violations = function(child)
        archive.take(child, F, np.maximum(violations, 0.0).sum(axis=1))
