"""IPOPT, an interior-point method, on the rows of a stack, one at a time.

The other answer by the gradient: the same functions of one row, another way through the
inequalities. The objective is rounded off in a first run, as the barrier rounds off the limits; the
second run goes on from there with the objective as it is.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.interrupts import note_interrupts
from quietarm.ocp.solvers.ipopt import OPTIONS, compiled, run_ipopt
from quietarm.ocp.solvers.quadratic import Model
from quietarm.ocp.solvers.sqp import FEASIBLE, End, Rows
from quietarm.ocp.solvers.stack import Stack

Array = NDArray[np.float64]
_STAGES = (0.5, 0.15, 0.05, 0.015, 0.0)
"""Widths over which the objective is rounded off, run by run."""
_FIRST = {
    **OPTIONS,
    "nlp_scaling_method": "none",
    "tol": 1e-4,
    "mu_init": 1e-2,
    "mu_strategy": "monotone",
}
_LAST = {
    **OPTIONS, "nlp_scaling_method": "none", "tol": 1e-8, "mu_strategy": "monotone",
    "mu_init": 1e-8, "warm_start_init_point": "yes", "max_iter": 100,
    **{f"warm_start_{name}": 1e-9 for name in
       ("bound_push", "bound_frac", "slack_bound_push", "slack_bound_frac", "mult_bound_push")},
    # Else a step may raise the objective for the sake of 1e-6 in the slacks, and it goes to and fro
    # across a kink until the iterations run out: at 6 of 125 points of fronts, now at 1.
    "delta": 1e-6,
    # Where zeros of the power meet, second derivatives no longer help: it ends when the objective
    # has hardly changed three times.
    "acceptable_tol": 1e3, "acceptable_dual_inf_tol": 1e10, "acceptable_constr_viol_tol": 1e-9,
    "acceptable_compl_inf_tol": 1e-5, "acceptable_obj_change_tol": 1e-10, "acceptable_iter": 3,
}  # fmt: skip
_ENDS = {
    "Solve_Succeeded": End.SOLVED,
    "Solved_To_Acceptable_Level": End.CREEPING,
    "Feasible_Point_Found": End.CREEPING,
    "Infeasible_Problem_Detected": End.INFEASIBLE,
    "Not_Enough_Degrees_Of_Freedom": End.INFEASIBLE,
    "Maximum_Iterations_Exceeded": End.UNFINISHED,
    "User_Requested_Stop": End.STOPPED,
}


def interior_point(stack: Stack, x: Array, *, warm: bool = False) -> Rows:
    """Minimise the rows of a stack from their starts, as `sqp.minimise` does.

    Warm starts are beside minima. After Ctrl-C rows not yet begun are where they started.
    """
    count = len(x)
    found = Rows(
        x.copy(), np.full(count, np.nan), np.full(count, np.inf),
        np.zeros((count, stack.equalities)), np.zeros(stack.lower.shape),
        [End.STOPPED] * count, np.zeros(count, dtype=int),
    )  # fmt: skip
    with note_interrupts() as came:
        for row in range(count):
            if came:
                break
            _one(_RowFunctions(stack, row), found, row, warm)
            if came and found.ends[row] is not End.SOLVED:
                found.ends[row] = End.STOPPED
    return replace(found, stopped=bool(came))


def _one(functions: _RowFunctions, found: Rows, row: int, warm: bool) -> None:
    """Run after run, from where the one before ended."""
    x, multipliers, end = found.x[row], None, None
    free = np.full(len(x), np.inf)
    bounds = functions.lower, functions.upper
    for width in _STAGES[-1:] if warm else _STAGES:
        solver = functions.solver(_FIRST if width else _LAST)
        x, multipliers, status, iterations = run_ipopt(
            solver, x, (-free, free), bounds, np.array([width]), multipliers
        )
        found.iterations[row] += iterations
        end = _ENDS.get(status)
        if end is End.STOPPED or (end is End.INFEASIBLE and width > 0):
            break
    model = functions.model(x, np.zeros(1))
    g = functions.constraints(model)
    passed = np.max([functions.lower - g, g - functions.upper], initial=0.0)
    if end is None:  # no step helps any more
        end = End.CREEPING if passed <= FEASIBLE else End.UNFINISHED
    found.ends[row], found.x[row], found.violation[row] = end, x, passed
    found.f[row] = model.f[0]
    assert multipliers is not None
    of_c, of_v = np.split(multipliers, [functions.equalities])
    found.of_c[row], found.of_v[row, functions.kept] = of_c, of_v


class _RowFunctions:
    """One row of a stack, as functions that IPOPT calls."""

    def __init__(self, stack: Stack, row: int) -> None:
        self._stack, self._row, self.equalities = stack, np.array([row]), stack.equalities
        bounded = np.isfinite(stack.lower[row]) | np.isfinite(stack.upper[row])
        self.kept = np.flatnonzero(bounded)
        none = np.zeros(self.equalities)
        self.lower, self.upper = (
            np.concatenate([none, of[row, self.kept]]) for of in (stack.lower, stack.upper)
        )
        self._last: tuple[bytes, Model] | None = None

    def model(self, x: Array, width: Array) -> Model:
        """The model at a point without curvature, kept for the next call."""
        key = x.tobytes() + width.tobytes()
        if self._last is None or self._last[0] != key:
            self._last = key, self._weighted(x, width, np.zeros(len(self.lower)))
        return self._last[1]

    def _weighted(self, x: Array, width: Array, multipliers: Array) -> Model:
        of_c, of_v = multipliers[None, : self.equalities], np.zeros((1, self._stack.lower.shape[1]))
        of_v[0, self.kept] = multipliers[self.equalities :]
        return self._stack.evaluate(self._row, x[None], of_c, of_v, width)

    def constraints(self, model: Model) -> Array:
        """Equalities, then what is bounded."""
        return np.concatenate([model.c[0], model.v[0, self.kept]])

    def _slopes(self, model: Model) -> Array:
        return np.concatenate([model.by_c[0], model.by_v[0, self.kept]])

    def _hessian(self, x: Array, width: Array, of_f: Array, multipliers: Array) -> list[ca.DM]:
        """Upper half of the Lagrangian's."""
        hessian = self._weighted(x, width, multipliers).hessian[0]
        if of_f != 1:  # in the restoration of feasibility, where f does not count
            alone = self._weighted(x, width, np.zeros(len(self.lower)))
            hessian = hessian + (of_f - 1) * alone.hessian[0]
        return [ca.triu(ca.DM((hessian + hessian.T) / 2))]

    def solver(self, options: Any) -> ca.Function:
        """A solver whose parameter is the width."""
        n, rows = self._stack.unknowns, len(self.lower)
        x, width = ca.MX.sym("x", n), ca.MX.sym("width")

        def call(name: str, shapes: list[tuple[int, int]], *of: Callable[[Model], Any]) -> _Call:
            def values(x: Array, width: Array) -> list[Any]:
                return [part(self.model(x, width)) for part in of]

            return _Call(name, [n, 1], [ca.Sparsity.dense(*shape) for shape in shapes], values)

        f = call("row_f", [(1, 1)], lambda model: model.f)
        g = call("row_g", [(rows, 1)], self.constraints)
        slopes = {
            "grad_f": call("row_df", [(1, 1), (1, n)], lambda m: m.f, lambda m: m.gradient),
            "jac_g": call("row_dg", [(rows, 1), (rows, n)], self.constraints, self._slopes),
            "hess_lag": _Call("row_bends", [n, 1, 1, rows], [ca.Sparsity.upper(n)], self._hessian),
        }
        self._alive = f, g, slopes  # casadi does not keep them
        return compiled({"x": x, "p": width, "f": f(x, width), "g": g(x, width)}, options, slopes)


class _Call(ca.Callback):
    """A function of arrays as casadi calls it."""

    def __init__(
        self, name: str, inputs: list[int], outputs: list[ca.Sparsity], function: Callable[..., Any]
    ) -> None:
        ca.Callback.__init__(self)
        self._inputs, self._outputs, self._function = inputs, outputs, function
        self.construct(name, {})

    def get_n_in(self) -> int:
        """How many arguments."""
        return len(self._inputs)

    def get_n_out(self) -> int:
        """How many results."""
        return len(self._outputs)

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        """Columns."""
        return ca.Sparsity.dense(self._inputs[i], 1)

    def get_sparsity_out(self, i: int) -> ca.Sparsity:
        """As given."""
        return self._outputs[i]

    def eval(self, arg: Sequence[ca.DM]) -> list[ca.DM]:
        """Call it."""
        return [ca.DM(value) for value in self._function(*(one.full().ravel() for one in arg))]
