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


class Multipliers(NamedTuple):
    """Multipliers of m equalities and k bounded values, shapes (rows, m) and (rows, k).

    Positive where the objective falls if a value may grow.
    """

    equality: Array
    bounded: Array

    def take(self, rows: Index) -> Multipliers:
        """Some rows."""
        return Multipliers(self.equality[rows], self.bounded[rows])

    def put(self, rows: Index, following: Multipliers) -> None:
        """Replace rows."""
        self.equality[rows] = following.equality
        self.bounded[rows] = following.bounded


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

    def put(self, rows: Index, following: Model) -> None:
        """Replace rows."""
        for part, new in zip(self, following):
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
    """Steps that minimise quadratic models within linearised constraints and bounds.

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
    steps = Steps(
        np.zeros((rows, n)),
        Multipliers(np.zeros((rows, m)), np.zeros((rows, k))),
        np.zeros(rows, dtype=bool),
    )
    for i in range(rows):
        chosen = np.flatnonzero(near[i])
        box = np.full(n, radius[i])
        table = np.concatenate([model.equality_jacobian[i], model.bounded_jacobian[i, chosen]])
        most = np.concatenate([box, -model.equality[i], above[i, chosen]])
        least = np.concatenate([-box, -model.equality[i], below[i, chosen]])
        solution = _solve(
            model.hessian[i],
            model.gradient[i],
            table,
            most,
            least,
            m,
        )
        if solution is not None:
            steps.met[i] = True
            steps.d[i], multipliers = solution
            steps.multipliers.equality[i] = multipliers[:m]
            steps.multipliers.bounded[i, chosen] = multipliers[m:]
        else:
            hard = chosen >= k - linear
            steps.d[i] = _least_violation(table, most[n:], least[n:], radius[i], m, hard)
    return steps


def _solve(
    hessian: Array, gradient: Array, table: Array, most: Array, least: Array, m: int
) -> tuple[Array, Array] | None:
    """The step of one program and its multipliers; None where the constraints cannot be met.

    Bounds are of the step, and then of the table times the step, whose first m rows are equalities.
    """
    n = len(gradient)
    optimum = 1
    empty = -1
    equality = 5
    marks = np.zeros(len(most), dtype=np.int32)
    marks[n : n + m] = equality
    program = gradient, table, most, least, marks
    d, _, flag, info = daqp.solve(hessian, *program, **_EXACT)
    if flag not in (optimum, empty):  # it cycles: with a little more curvature it ends
        stiffer = hessian + 1e-6 * np.trace(hessian) * np.eye(n)
        d, _, flag, info = daqp.solve(
            stiffer,
            *program,
            primal_tol=1e-9,
            dual_tol=1e-9,
        )
    return (d, info["lam"][n:]) if flag == optimum else None


def _least_violation(
    table: Array, most: Array, least: Array, radius: float, m: int, hard: NDArray[np.bool_]
) -> Array:
    """The step within bounds that makes the largest violation of linearised constraints least.

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
        curvature = values.mean(axis=1)[:, None, None] * np.eye(m)
        hessian[:, :m, :m] = mixed.swapaxes(-1, -2) @ inverse @ mixed + curvature
    return np.ascontiguousarray(basis @ hessian @ basis.swapaxes(-1, -2))
