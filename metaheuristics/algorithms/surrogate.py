"""A search by a surrogate: Gaussian processes of all objectives and violations, for few candidates.

Each objective and each violation has a Gaussian process with a Matern kernel (scikit-learn). Among
random candidates near the archive, between its members and over the box, the next one is that whose
optimistic values (mean less one standard deviation) add the most hypervolume, times how likely it
keeps the limits. Of more than two objectives a random weighted Chebyshev norm stands in place of
the hypervolume [1]_.

References
----------
.. [1] Knowles, IEEE Transactions on Evolutionary Computation 10, 2006, pp. 50-66.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from math import ceil
from typing import Any

import moocore
import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm, qmc
from threadpoolctl import threadpool_limits

Array = NDArray[np.float64]
_FAILED = 1e30
"""Values from here up are those of candidates that failed."""


@dataclass
class Surrogate:
    """Gaussian processes of some columns; how long their lengths are is found anew at times.

    Parameters
    ----------
    refit : int
        Times that the models are used before their lengths are found anew.
    """

    refit: int = 10
    kernels: dict[int, Any] = field(default_factory=dict)
    used: int = 0

    def predict(self, U: Array, values: Array, rows: Array) -> tuple[Array, Array]:
        """Mean and standard deviation of each column of values at rows of the unit box."""
        found = [self._of(column, U, values[:, column], rows) for column in range(values.shape[1])]
        self.used += 1
        means, deviations = (np.column_stack(several) for several in zip(*found))
        return means, deviations

    def _of(self, column: int, U: Array, values: Array, rows: Array) -> tuple[Array, Array]:
        # not at the top: scikit-learn is an extra
        from sklearn.gaussian_process import GaussianProcessRegressor
        from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel

        middle = float(values.mean())
        scale = float(values.std()) or 1.0
        scaled = np.clip((values - middle) / scale, -5.0, 5.0)
        kernel = self.kernels.get(column)
        if kernel is None:
            lengths = Matern(np.full(U.shape[1], 0.5), (0.05, 20.0), nu=2.5)
            kernel = ConstantKernel(1.0, (1e-2, 1e3)) * lengths + WhiteKernel(1e-4, (1e-7, 1.0))
        anew = column not in self.kernels or self.used % self.refit == 0
        options: Any = {"optimizer": "fmin_l_bfgs_b" if anew else None, "random_state": 0}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # a length at its bound
            model = GaussianProcessRegressor(kernel, **options).fit(U, scaled)
            self.kernels[column] = model.kernel_
            means, deviations = model.predict(rows, return_std=True)
        return means * scale + middle, deviations * scale


def gaussian_process(
    function: Any, seed: int, budget: int, training: int = 150, pool: int = 1000
) -> None:
    """Ask a problem's recorded function for candidates until its budget is spent.

    Parameters
    ----------
    function : callable
        A problem's recorded function.
    seed : int
        Seed of the random numbers.
    budget : int
        Candidates that count: of more than 250 several are chosen by one model.
    training : int
        Most candidates that a model knows: those nearest to the front.
    pool : int
        Random candidates among which the next one is chosen.
    """
    random = np.random.default_rng(seed)
    lower, upper = function.lower, function.upper
    size = len(lower)
    together = ceil(budget / 250)
    surrogate = Surrogate()
    U = qmc.LatinHypercube(size, rng=random).random(2 * size + 4)
    table, objectives = _values(function, lower + U * (upper - lower))
    while True:
        with threadpool_limits(1):
            chosen = _next(U, table, objectives, surrogate, training, pool, together, random)
        more, _ = _values(function, lower + chosen * (upper - lower))
        U = np.vstack([U, chosen])
        table = np.vstack([table, more])


def _values(function: Any, candidates: Array) -> tuple[Array, int]:
    """Objectives and violations side by side, and how many of these are objectives."""
    F, violations = function(candidates)
    return np.hstack([F, violations]), F.shape[1]


def _next(
    U: Array,
    table: Array,
    objectives: int,
    surrogate: Surrogate,
    training: int,
    pool: int,
    together: int,
    random: np.random.Generator,
) -> Array:
    """The next candidates, in the unit box."""
    usable = table[:, 0] < _FAILED
    if usable.sum() < 3:
        return random.random((together, U.shape[1]))
    U, table = U[usable], table[usable]
    F = table[:, :objectives]
    violation = np.maximum(table[:, objectives:], 0.0).sum(axis=1)
    feasible = violation <= 0
    best = np.flatnonzero(feasible)
    if len(best):
        best = best[moocore.is_nondominated(F[best])]
    else:
        best = np.argsort(violation, kind="stable")[:5]
    known = _nearest_to(F, violation, best, training)
    rows = _pool(U, U[best], pool, random)
    means, deviations = surrogate.predict(U[known], table[known], rows)
    keeps = np.ones(len(rows))
    for column in range(objectives, table.shape[1]):
        spread = np.maximum(deviations[:, column], 1e-12)
        keeps *= norm.cdf(-means[:, column] / spread)
    optimistic = means[:, :objectives] - deviations[:, :objectives]
    if not feasible.any():
        nearly = np.maximum(means[:, objectives:] - deviations[:, objectives:], 0.0).sum(axis=1)
        order = np.lexsort([nearly, -keeps])
        return rows[order[:together]]
    chosen = list[int]()
    front = F[best]
    corner = _corner(F[feasible], front)
    for _ in range(together):
        gain = _gain(front, corner, optimistic, random) * keeps
        gain[chosen] = -np.inf
        chosen.append(int(np.argmax(gain)))
        front = np.vstack([front, optimistic[chosen[-1]]])
        front = front[moocore.is_nondominated(front)]
    return rows[chosen]


def _nearest_to(F: Array, violation: Array, best: Array, most: int) -> Array:
    """Rows that a model is made of: all, or those nearest to the front."""
    if len(F) <= most:
        return np.arange(len(F))
    front = F[best]
    extent = np.ptp(front, axis=0)
    extent = np.where(extent > 0, extent, 1.0)
    excess = np.maximum((F[:, None] - front) / extent, 0.0).sum(axis=2).min(axis=1)
    return np.argsort(excess + violation, kind="stable")[:most]


def _pool(U: Array, best: Array, count: int, random: np.random.Generator) -> Array:
    """Random rows of the unit box: half near the archive, others between its members and all."""
    size = U.shape[1]
    step = 10 ** random.uniform(-2.5, -0.5, (count // 2, 1))
    near = best[random.integers(len(best), size=count // 2)]
    near = near + step * random.standard_normal(near.shape)
    one, other = best[random.integers(len(best), size=(2, count // 4))]
    share = random.uniform(-0.5, 1.5, (count // 4, 1))
    between = one * share + other * (1 - share)
    between = between + 0.02 * random.standard_normal(between.shape)
    return np.clip(np.vstack([near, random.random((count // 4, size)), between]), 0.0, 1.0)


def _corner(F: Array, front: Array) -> Array:
    """The corner up to which hypervolume counts: beyond the front, far beyond while it is small."""
    extent = np.ptp(front, axis=0)
    most = front.max(axis=0)
    corner = most + 0.1 * np.where(extent > 0, extent, np.abs(most) + 1e-9)
    return np.maximum(corner, np.quantile(F, 0.9, axis=0)) if len(front) < 3 else corner


def _gain(front: Array, corner: Array, rows: Array, random: np.random.Generator) -> Array:
    """Return the gain that each row of objectives is to a front."""
    if rows.shape[1] == 2:
        return hypervolume_gain(front, corner, rows)
    ideal = front.min(axis=0)
    weights = random.dirichlet(np.ones(rows.shape[1]))
    scaled = weights * (rows - ideal) / (corner - ideal)
    norms = scaled.max(axis=1) + 0.05 * scaled.sum(axis=1)
    return norms.max() - norms


def hypervolume_gain(front: Array, corner: Array, rows: Array) -> Array:
    """Area that each row adds alone to what a front of two objectives dominates."""
    within = front[(front < corner).all(axis=1)]
    within = within[np.argsort(within[:, 0])]
    edges = np.concatenate([[-np.inf], within[:, 0], [corner[0]]])
    heights = np.concatenate([[corner[1]], within[:, 1]])
    widths = np.maximum(edges[None, 1:] - np.maximum(edges[None, :-1], rows[:, :1]), 0.0)
    return (widths * np.maximum(heights[None] - rows[:, 1:], 0.0)).sum(axis=1)
