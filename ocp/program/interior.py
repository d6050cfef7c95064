"""IPOPT, an interior-point method, on the rows of a stack, one at a time.

The other answer by the gradient: the same functions of one row, another way through the
inequalities. The objective is rounded off in a first run, as the barrier rounds off the limits; the
second run goes on from there with the objective as it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from quietarm.ocp.base.interrupts import note_interrupts
from quietarm.ocp.program.ipopt import OPTIONS, Point, ipopt_of_functions, run_ipopt
from quietarm.ocp.program.quadratic import Model
from quietarm.ocp.program.sqp import FEASIBLE, End, Rows
from quietarm.ocp.program.stack import Stack

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

    Parameters
    ----------
    stack : Stack
        The programs.
    x : ndarray, shape (rows, unknowns)
        Starts.
    warm : bool
        Whether they are beside minima.

    Returns
    -------
    Rows
        Where they ended; after Ctrl-C those not yet begun are where they started.
    """
    count, equalities = len(x), stack.equalities
    found = Rows(
        x.copy(), np.full(count, np.nan), np.full(count, np.inf),
        np.zeros((count, equalities)), np.zeros(stack.lower.shape),
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
    point, end = Point(found.x[row]), None
    for width in _STAGES[-1:] if warm else _STAGES:
        solver = functions.solver(_LAST if width == 0 else _FIRST)
        free = np.full(len(point.unknowns), np.inf)
        bounds = functions.lower, functions.upper
        stop = run_ipopt(solver, point, (-free, free), bounds, np.array([width]))
        found.iterations[row] += stop.iterations
        point = stop.point
        end = _ENDS.get(stop.return_status)
        if end is End.STOPPED or (end is End.INFEASIBLE and width > 0):
            break
    model = functions.model(point.unknowns, 0.0)
    g = np.concatenate([model.c[0], model.v[0, functions.kept]])
    passed = np.max([functions.lower - g, g - functions.upper], initial=0.0)
    if end is None:  # no step helps any more
        end = End.CREEPING if passed <= FEASIBLE else End.UNFINISHED
    found.ends[row], found.x[row], found.violation[row] = end, point.unknowns, passed
    found.f[row] = model.f[0]
    m = found.of_c.shape[1]
    found.of_c[row], found.of_v[row, functions.kept] = point.multipliers[:m], point.multipliers[m:]


class _RowFunctions:
    """One row of a stack, as functions that IPOPT calls."""

    def __init__(self, stack: Stack, row: int) -> None:
        self.stack, self.row = stack, np.array([row])
        self.m = stack.equalities
        bounded = np.isfinite(stack.lower[row]) | np.isfinite(stack.upper[row])
        self.kept = np.flatnonzero(bounded)
        zeros = np.zeros(self.m)
        self.lower = np.concatenate([zeros, stack.lower[row, self.kept]])
        self.upper = np.concatenate([zeros, stack.upper[row, self.kept]])
        self._last: tuple[bytes, float, Model] | None = None

    def model(self, x: Array, width: float, multipliers: Array | None = None) -> Model:
        """The model at a point; without multipliers the last one is kept for the next call."""
        of_v = np.zeros((1, self.stack.lower.shape[1]))
        if multipliers is None:
            key = x.tobytes(), width
            if self._last is None or self._last[:2] != key:
                of_c = np.zeros((1, self.m))
                found = self.stack.evaluate(self.row, x[None], of_c, of_v, np.array([width]))
                self._last = *key, found
            return self._last[2]
        of_v[0, self.kept] = multipliers[self.m :]
        of_c = multipliers[None, : self.m]
        return self.stack.evaluate(self.row, x[None], of_c, of_v, np.array([width]))

    def solver(self, options: Any) -> ca.Function:
        """A solver whose parameter is the width."""
        n, rows = self.stack.unknowns, len(self.lower)

        def constraints(model: Model) -> Array:
            return np.concatenate([model.c[0], model.v[0, self.kept]])

        def jacobian(model: Model) -> Array:
            return np.concatenate([model.by_c[0], model.by_v[0, self.kept]])

        def hessian(x: Array, width: float, of_f: float, multipliers: Array) -> Array:
            found = self.model(x, width, multipliers).hessian[0]
            if of_f != 1:  # in the restoration of feasibility, where f does not count
                none = np.zeros(rows)
                found = found + (of_f - 1) * self.model(x, width, none).hessian[0]
            return np.triu(found + found.T) / 2

        def at(of: Any) -> Any:
            return lambda x, width: [part(self.model(x, width)) for part in of]

        f, gradient = (lambda model: model.f), (lambda model: model.gradient)
        self._alive = [
            _Call("row_f", [(n, 1), (1, 1)], [(1, 1)], at([f])),
            _Call("row_g", [(n, 1), (1, 1)], [(rows, 1)], at([constraints])),
            _Call("row_df", [(n, 1), (1, 1)], [(1, 1), (1, n)], at([f, gradient])),
            _Call("row_dg", [(n, 1), (1, 1)], [(rows, 1), (rows, n)], at([constraints, jacobian])),
            _Call(
                "row_bends", [(n, 1), (1, 1), (1, 1), (rows, 1)], [ca.Sparsity.upper(n)],
                lambda *arguments: [hessian(*arguments)],
            ),
        ]  # fmt: skip
        f_call, g_call, gradient_call, jacobian_call, hessian_call = self._alive
        return ipopt_of_functions(
            n, f_call, g_call, gradient_call, jacobian_call, hessian_call, options
        )


class _Call(ca.Callback):
    """A function of arrays as casadi calls it."""

    def __init__(self, name: str, inputs: list[Any], outputs: list[Any], function: Any) -> None:
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
        """Dense arguments."""
        return ca.Sparsity.dense(*self._inputs[i])

    def get_sparsity_out(self, i: int) -> ca.Sparsity:
        """Dense results, but for the Hessian's half."""
        shape = self._outputs[i]
        return shape if isinstance(shape, ca.Sparsity) else ca.Sparsity.dense(*shape)

    def eval(self, arg: Sequence[ca.DM]) -> list[ca.DM]:
        """Call it."""
        values = [one.full() for one in arg]
        flat = [
            one.ravel() if one.size > 1 or i in (0, 3) else one.item()
            for i, one in enumerate(values)
        ]
        found = self._function(*flat)
        return [
            ca.DM(self.get_sparsity_out(i), np.asarray(one).T[np.tril_indices(len(one))].tolist())
            if isinstance(self._outputs[i], ca.Sparsity)
            else ca.DM(np.asarray(one).reshape(self._outputs[i]))
            for i, one in enumerate(found)
        ]
