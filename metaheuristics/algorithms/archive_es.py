"""A (1+1) evolution strategy with an archive: one candidate after another, for small budgets.

The parent is a candidate of the archive, the less crowded of two, as in [1]_. Its child takes a
normal step, in all coefficients or in about half of them, whose length is drawn about a common one;
that grows with every child that enters the archive, and shrinks with others so that a fifth do. At
times a share of the difference of two other candidates is added. Where no candidate is feasible
yet, those of least violation are the archive.

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
    size : ndarray
        Lengths of the box.
    """

    def __init__(self, X: Array, F: Array, violation: Array, size: Array) -> None:
        self.size = size
        self.step = 0.2  # of the box
        self._keep(X, F, violation)

    @property
    def feasible(self) -> bool:
        """Return whether a candidate was found that violates nothing."""
        return bool(self.violation[0] <= 0)

    def take(self, X: Array, F: Array, violation: Array) -> None:
        """Let a child enter that nothing in the archive dominates, and learn the length of steps.

        All are tables of one row.
        """
        growth = 1.25  # of the step where a child enters; a fourth of it is lost where none does
        shortest = 2e-3
        longest = 0.5
        if self.feasible:
            enters = violation[0] <= 0 and not (F[0] >= self.F).all(axis=1).any()
        else:
            enters = violation[0] < self.violation[0]
        if not enters:
            self.step = max(shortest, self.step * growth**-0.25)
        else:
            self.step = min(longest, self.step * growth)
        if enters or not self.feasible:
            self._keep(
                np.vstack([self.X, X]),
                np.vstack([self.F, F]),
                np.append(self.violation, violation),
            )

    def _keep(self, X: Array, F: Array, violation: Array) -> None:
        few = 3  # candidates that are kept while none is feasible
        rows = np.flatnonzero(violation <= 0)
        if len(rows):
            rows = rows[moocore.is_nondominated(F[rows])]
        else:
            rows = np.argsort(violation, kind="stable")[:few]
        self.X = X[rows]
        self.F = F[rows]
        self.violation = violation[rows]
        extent = np.ptp(self.F, axis=0)
        scaled = (self.F - self.F.min(axis=0)) / np.where(extent > 0, extent, 1.0)
        distance = np.abs(scaled[:, None] - scaled).sum(axis=2)
        # the nearest is the candidate itself
        self._room = np.sort(distance, axis=1)[:, 1:3].sum(axis=1)

    def child(self, differences: float, random: np.random.Generator) -> Array:
        """A child in units of the bounds, which may lie beyond them."""
        spread = 0.2  # standard deviation of the logarithm to base 10 of the lengths of steps
        count = len(self.X)
        parent, rival = random.integers(count, size=2)
        if self.feasible and count > 3 and self._room[rival] > self._room[parent]:
            parent = rival
        moved = random.random(len(self.size)) < 0.5
        if random.random() < 0.5:
            moved[:] = True
        step = self.step * 10 ** random.normal(0.0, spread)
        normal = random.standard_normal(len(self.size))
        child = self.X[parent] + np.where(moved, step * self.size * normal, 0.0)
        if count > 2 and random.random() < differences:
            one, other = random.integers(count, size=2)
            child = child + random.uniform(-1, 1) * (self.X[one] - self.X[other])
        return child


def archive_es(
    function: Any, seed: int, budget: int, first: int = 5, differences: float = 0.3
) -> None:
    """Ask a problem's recorded function for candidates until its budget is spent.

    Parameters
    ----------
    function, seed, budget
        As of `SearchMethod.run`.
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
    archive = ArchiveStrategy(X, F, np.maximum(violations, 0.0).sum(axis=1), upper - lower)
    while True:
        child = archive.child(differences, random)
        child = np.where(child < lower, 2 * lower - child, child)
        child = np.where(child > upper, 2 * upper - child, child)
        child = np.clip(child, lower, upper)[None]
        F, violations = function(child)
        archive.take(child, F, np.maximum(violations, 0.0).sum(axis=1))
