"""A search by a surrogate: Gaussian processes of all objectives and violations, for few candidates.

Each objective and each violation has a Gaussian process with a Matern kernel [2]_. Among
random candidates near the archive, between its members and over the box, the next one is that whose
optimistic values (mean less one standard deviation) add the most hypervolume, times how likely it
keeps the limits. Of more than two objectives a random weighted Chebyshev norm stands in place of
the hypervolume [1]_.

A model knows the evaluated candidates nearest to the front, at most `training` of them. Beside the
others its values are optimistic guesses, however bad those candidates were. A search of more than
`ALONE` candidates would spend most of them there, so it chooses only among random candidates whose
nearest evaluated one is known.

References
----------
.. [1] Knowles, IEEE Transactions on Evolutionary Computation 10, 2006, pp. 50-66.
.. [2] Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, chapters 2, 4 and 5.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import ceil, sqrt
from typing import Any

import moocore
import numpy as np
from numpy.linalg import LinAlgError
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve, solve_triangular
from scipy.optimize import minimize
from scipy.spatial import KDTree
from scipy.spatial.distance import cdist
from scipy.stats import norm, qmc
from threadpoolctl import threadpool_limits

from quietarm.metaheuristics.evaluation.population import UNUSABLE

Rows = NDArray[np.intp]
Array = NDArray[np.float64]
ALONE = 250
"""Largest budget with which a model chooses one candidate, anywhere within the bounds.

With a larger one it chooses several, and none beside a candidate that it does not know.
"""


class GaussianProcess:
    """A Gaussian process in the unit cube, with a Matern kernel of smoothness 5/2 and noise.

    Parameters
    ----------
    U : ndarray, shape (n, size)
        Where values are known.
    values : ndarray, shape (n,)
        The values, of mean 0 and standard deviation 1 or so.
    logarithms : ndarray, optional
        Logarithms of the variance, of a length for each coefficient, and of the noise's variance;
        they are the likeliest ones, found from these or from a usual start.
    fit : bool
        Whether the likeliest are to be found, or those that are given stay.
    """

    def __init__(
        self, U: Array, values: Array, logarithms: Array | None = None, fit: bool = True
    ) -> None:
        size = U.shape[1]
        usual = np.concatenate([[0.0], np.full(size, np.log(0.5)), [np.log(1e-4)]])
        bounds = np.log([(1e-2, 1e3), *[(0.05, 20.0)] * size, (1e-7, 1.0)])
        self.U = U
        self._values = values
        self.logarithms = usual if logarithms is None else logarithms
        if fit:
            squares = (U[:, None] - U) ** 2
            result = minimize(
                self._misfit, self.logarithms, args=(squares,), jac=True, method="L-BFGS-B",
                bounds=bounds, options={"maxiter": 50},
            )  # fmt: skip
            self.logarithms = np.clip(result.x, *bounds.T)
        covariance = self._kernel(U) + np.exp(self.logarithms[-1]) * np.eye(len(U))
        self._factor = cho_factor(covariance, lower=True)
        self._weights = cho_solve(self._factor, values)

    def predict(self, rows: Array) -> tuple[Array, Array]:
        """Mean and standard deviation at rows of the unit cube, without the noise."""
        across = self._kernel(rows)
        explained = solve_triangular(self._factor[0], across.T, lower=True)
        variance = np.exp(self.logarithms[0]) - (explained**2).sum(axis=0)
        return across @ self._weights, np.sqrt(np.maximum(variance, 1e-12))

    def _kernel(self, rows: Array) -> Array:
        lengths = np.exp(self.logarithms[1:-1])
        root = sqrt(5) * cdist(rows / lengths, self.U / lengths)
        return np.exp(self.logarithms[0] - root) * (1 + root + root**2 / 3)

    def _misfit(self, logarithms: Array, squares: Array) -> tuple[float, Array]:
        """Negative logarithm of the likelihood, less a constant, and its gradient."""
        variance, *inverse, noise = np.exp(logarithms * ([1] + [-2] * squares.shape[2] + [1]))
        scaled = squares * inverse
        root = np.sqrt(5 * scaled.sum(axis=2))
        decay = variance * np.exp(-root)
        kernel = decay * (1 + root + root**2 / 3)
        try:
            factor = cho_factor(kernel + noise * np.eye(len(kernel)), lower=True)
        except LinAlgError:
            return 1e10, np.zeros_like(logarithms)
        weights = cho_solve(factor, self._values)
        misfit = self._values @ weights / 2 + np.log(np.diag(factor[0])).sum()
        outer = np.outer(weights, weights) - cho_solve(factor, np.eye(len(kernel)))
        by_length = (outer * decay * (1 + root) * 5 / 3)[..., None] * scaled
        slopes = [(outer * kernel).sum(), *by_length.sum(axis=(0, 1)), noise * np.trace(outer)]
        return float(misfit), -np.array(slopes) / 2


@dataclass
class Surrogate:
    """Gaussian processes of some columns of values, whose lengths are found anew at times.

    Parameters
    ----------
    refit : int
        Times that the models are used before their lengths are found anew.
    """

    refit: int = 10
    logarithms: dict[int, Array] = field(default_factory=dict)
    used: int = 0

    def predict(self, U: Array, values: Array, rows: Array) -> tuple[Array, Array]:
        """Mean and standard deviation of each column of values at rows of the unit cube."""
        pairs = [self._of(column, U, values[:, column], rows) for column in range(values.shape[1])]
        self.used += 1
        means, deviations = zip(*pairs)
        return np.column_stack(means), np.column_stack(deviations)

    def _of(self, column: int, U: Array, values: Array, rows: Array) -> tuple[Array, Array]:
        farthest = 5.0  # standard deviations: what is beyond is bad, however bad
        middle = float(values.mean())
        scale = float(values.std()) or 1.0
        scaled = np.clip((values - middle) / scale, -farthest, farthest)
        anew = self.used % self.refit == 0
        model = GaussianProcess(U, scaled, self.logarithms.get(column), fit=anew)
        self.logarithms[column] = model.logarithms
        means, deviations = model.predict(rows)
        return means * scale + middle, deviations * scale


def gaussian_process(
    function: Any, seed: int, budget: int, training: int = 150, pool: int = 1000
) -> None:
    """Ask a problem's recorded function for candidates until its budget is spent.

    Parameters
    ----------
    function, seed, budget
        As of `SearchMethod.run`; with a budget of more than `ALONE` a model chooses several
        candidates at once, beside those that it knows.
    training : int
        Most candidates that a model knows: those nearest to the front.
    pool : int
        Random candidates among which the next one is chosen.
    """
    random = np.random.default_rng(seed)
    lower, upper = function.lower, function.upper
    size = len(lower)
    together = ceil(budget / ALONE)
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
    """The next candidates, in the unit cube."""
    usable = table[:, 0] < UNUSABLE
    if usable.sum() < 3:
        return random.random((together, U.shape[1]))
    U = U[usable]
    table = table[usable]
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
    if together > 1:
        rows = _beside(rows, U, known)
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
    ends_every = 5  # times: an end of the front adds little area, and is what many look for
    for turn in range(surrogate.used, surrogate.used + together):
        gain = _gain(front, corner, optimistic, random) * keeps
        if turn % ends_every == 0:
            end = optimistic[:, turn // ends_every % objectives]
            gain = (end.max() - end) * keeps
        gain[chosen] = -np.inf
        chosen.append(int(np.argmax(gain)))
        front = np.vstack([front, optimistic[chosen[-1]]])
        front = front[moocore.is_nondominated(front)]
    return rows[chosen]


def _nearest_to(F: Array, violation: Array, best: Rows, most: int) -> Rows:
    """Rows that a model is made of: all, or those nearest to the front."""
    if len(F) <= most:
        return np.arange(len(F))
    front = F[best]
    extent = np.ptp(front, axis=0)
    extent = np.where(extent > 0, extent, 1.0)
    excess = np.maximum((F[:, None] - front) / extent, 0.0).sum(axis=2).min(axis=1)
    return np.argsort(excess + violation, kind="stable")[:most]


def _pool(U: Array, best: Array, count: int, random: np.random.Generator) -> Array:
    """Random rows of the unit cube: half near the archive, others between its members and all."""
    size = U.shape[1]
    step = 10 ** random.uniform(-2.5, -0.5, (count // 2, 1))
    near = best[random.integers(len(best), size=count // 2)]
    near = near + step * random.standard_normal(near.shape)
    one, other = best[random.integers(len(best), size=(2, count // 4))]
    share = random.uniform(-0.5, 1.5, (count // 4, 1))
    between = one * share + other * (1 - share)
    between = between + 0.02 * random.standard_normal(between.shape)
    return np.clip(np.vstack([near, random.random((count // 4, size)), between]), 0.0, 1.0)


def _beside(rows: Array, U: Array, known: Rows) -> Array:
    """Rows whose nearest evaluated candidate a model knows; all rows if there are none."""
    nearest = KDTree(U).query(rows)[1]
    beside = np.isin(nearest, known)
    return rows[beside] if beside.any() else rows


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
