"""The quadratic programs of sequential quadratic programming, a row each, by DAQP.

DAQP is a dual active-set method (Arnstrom, Bemporad and Axehill, IEEE Trans. Automatic Control 67,
2022). Where the linearised constraints cannot be met, the step makes their violation least.
"""

from __future__ import annotations

from typing import NamedTuple

import daqp
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.intp]

_EXACT = {"primal_tol": 1e-11, "dual_tol": 1e-11, "iter_limit": 300}
_LOOSER = {"primal_tol": 1e-9, "dual_tol": 1e-9}
_STIFFER = 1e-6
"""Settings of the quadratic programs, and where these fail."""
_EQUALITY = 5
_OPTIMUM = 1
_EMPTY = -1
"""DAQP's mark of one; its words for a solution, and for constraints that cannot be met."""


class Multipliers(NamedTuple):
    """Multipliers of m equalities and k bounded values, shapes (rows, m) and (rows, k).

    Positive where the objective falls if a value may grow.
    """

    equality: Array
    bounded: Array

    def take(self, rows: Index) -> Multipliers:
        """Some rows."""
        return Multipliers(self.equality[rows], self.bounded[rows])

    def put(self, rows: Index, other: Multipliers) -> None:
        """Replace rows."""
        self.equality[rows], self.bounded[rows] = other


class Model(NamedTuple):
    """Rows of programs at their points: values, derivatives, Hessian of the Lagrangian.

    Shapes are (rows,), (rows, n); (rows, m) and (rows, m, n) of the equalities, which are to be 0;
    (rows, k) and (rows, k, n) of what is bounded; (rows, n, n).
    """

    objective: Array
    gradient: Array
    equality: Array
    equality_jacobian: Array
    bounded: Array
    bounded_jacobian: Array
    hessian: Array

    def put(self, rows: Index, other: Model) -> None:
        """Replace rows."""
        for part, new in zip(self, other):
            part[rows] = new

    def take(self, rows: Index | NDArray[np.bool_]) -> Model:
        """Some rows."""
        return Model(*(part[rows] for part in self))


class Steps(NamedTuple):
    """Steps d, shape (rows, n), with multipliers; whether the linearised constraints are met."""

    d: Array
    multipliers: Multipliers
    met: NDArray[np.bool_]


def least_steps(model: Model, lower: Array, upper: Array, radius: Array, linear: int) -> Steps:
    """Steps that minimise quadratic models within linearised constraints and in a box.

    The Hessians are convex, `radius` is half the sides of the boxes. Where the constraints cannot
    be met, the step makes their violation least; the last `linear` of what is bounded are kept all
    the same.
    """
    rows, n = model.gradient.shape
    m = model.equality.shape[1]
    k = model.bounded.shape[1]
    above = upper - model.bounded
    below = lower - model.bounded
    reach = np.abs(model.bounded_jacobian).sum(axis=2) * radius[:, None]
    near = (above <= reach) | (-below <= reach)
    found = Steps(
        np.zeros((rows, n)),
        Multipliers(np.zeros((rows, m)), np.zeros((rows, k))),
        np.zeros(rows, dtype=bool),
    )
    for i in range(rows):
        own = np.flatnonzero(near[i])
        box = np.full(n, radius[i])
        table = np.concatenate([model.equality_jacobian[i], model.bounded_jacobian[i, own]])
        most = np.concatenate([box, -model.equality[i], above[i, own]])
        least = np.concatenate([-box, -model.equality[i], below[i, own]])
        marks = np.zeros(len(most), dtype=np.int32)
        marks[n : n + m] = _EQUALITY
        one = model.hessian[i], model.gradient[i], table, most, least
        d, _, flag, info = daqp.solve(*one, marks, **_EXACT)
        if flag not in (_OPTIMUM, _EMPTY):  # it cycles: with a little more curvature it ends
            stiffer = one[0] + _STIFFER * np.trace(one[0]) * np.eye(n)
            d, _, flag, info = daqp.solve(stiffer, *one[1:], marks, **_LOOSER)
        if flag == _OPTIMUM:
            found.met[i], multipliers = True, info["lam"][n:]
            found.multipliers.equality[i] = multipliers[:m]
            found.multipliers.bounded[i, own] = multipliers[m:]
        else:
            d = _least_violation(table, most[n:], least[n:], radius[i], m, own >= k - linear)
        found.d[i] = d
    return found


def _least_violation(
    table: Array, most: Array, least: Array, radius: float, m: int, hard: NDArray[np.bool_]
) -> Array:
    """The step in a box that makes the largest violation of linearised constraints least.

    The violation t is one more unknown; hard constraints, the last ones, are kept.
    """
    n = table.shape[1]
    give = np.concatenate([np.ones(m), (~hard).astype(float)])
    above = np.isfinite(most)
    below = np.isfinite(least)
    rows = np.block([
        [table[above], -give[above, None]],
        [table[below], give[below, None]],
    ])  # fmt: skip
    free = np.inf
    upper = np.concatenate([np.full(n, radius), [free], most[above], np.full(below.sum(), free)])
    lower = np.concatenate([np.full(n, -radius), [0.0], np.full(above.sum(), -free), least[below]])
    # Curvature that settles which of the steps of least violation is taken: a short one.
    tie = 1e-3
    hessian = np.diag([*[tie] * n, tie])
    cost = np.append(np.zeros(n), 1.0)
    marks = np.zeros(len(upper), dtype=np.int32)
    d, *_ = daqp.solve(hessian, cost, rows, upper, lower, marks, **_EXACT)
    return np.asarray(d)[:n]


def convexify(model: Model) -> Array:
    """Hessians with negative curvature along the linearised equalities counted as positive.

    Across them the equalities settle the step, so that any curvature will do that keeps the whole
    positive.
    """
    hessian = (model.hessian + model.hessian.transpose(0, 2, 1)) / 2
    m, n = model.equality_jacobian.shape[1:]
    if m >= n:
        return np.repeat(np.eye(n)[None], len(hessian), axis=0)
    basis = np.linalg.svd(model.equality_jacobian)[2].transpose(0, 2, 1) if m else np.eye(n)
    hessian = basis.swapaxes(-1, -2) @ hessian @ basis
    values, vectors = np.linalg.eigh(hessian[:, m:, m:])
    values = np.abs(values)
    values = np.maximum(values, 1e-8 * values.max(axis=1, keepdims=True) + 1e-12)
    turned = vectors.swapaxes(-1, -2)
    hessian[:, m:, m:] = (vectors * values[:, None, :]) @ turned
    if m:
        mixed = hessian[:, m:, :m]
        inverse = (vectors / values[:, None, :]) @ turned
        own = values.mean(axis=1)[:, None, None] * np.eye(m)
        hessian[:, :m, :m] = mixed.swapaxes(-1, -2) @ inverse @ mixed + own
    return np.ascontiguousarray(basis @ hessian @ basis.swapaxes(-1, -2))
