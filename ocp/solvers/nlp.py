"""IPOPT for a nonlinear program: its options, compiling, and a run."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.models.compiled import Compiled
from quietarm.ocp.cost import COST

Options = Mapping[str, str | int | float]
OPTIONS: dict[str, str | int | float] = {
    "print_level": 0,
    "sb": "yes",
    "tol": 1e-9,
    "constr_viol_tol": 1e-10,
    "mu_strategy": "adaptive",
    "max_iter": 500,
    # Without these an infeasible task takes a hundred times as long: MUMPS's permutation fills in
    # the restoration phase's system, and IPOPT turns to that phase late. Feasible ones take the
    # same iterations either way.
    "mumps_permuting_scaling": 0,
    # Approximate minimum fill copes best with the dense columns of the coefficients: at 400 steps
    # and 20 terms a fifth of the default ordering's time.
    "mumps_pivot_order": 2,
    "expect_infeasible_problem": "yes",
}


class Stop(NamedTuple):
    """The end of a run of IPOPT: unknowns, multipliers, its own status, iterations."""

    unknowns: NDArray[np.float64]
    multipliers: NDArray[np.float64]
    return_status: str
    iterations: int


def compile_nlp(problem: Mapping[str, ca.MX], options: Options) -> ca.Function:
    """IPOPT for a nonlinear program, with casadi's derivatives."""
    chosen = {"calc_lam_p": False, "no_nlp_grad": True, "print_time": False}
    with _on_one_thread():
        return ca.nlpsol(
            "program",
            "ipopt",
            dict(problem),
            {**chosen, "ipopt": dict(options)},
        )


@contextmanager
def _on_one_thread() -> Iterator[None]:
    """Let casadi load IPOPT with one thread for its linear algebra, as `on_one_thread` has it.

    OpenBLAS reads the variable once, when it is loaded with the first solver.
    """
    name = "OPENBLAS_NUM_THREADS"
    chosen = os.environ.get(name)
    os.environ[name] = "1"
    try:
        yield
    finally:
        del os.environ[name]
        if chosen is not None:
            os.environ[name] = chosen


Sides = tuple[NDArray[np.float64], NDArray[np.float64]]


def run_ipopt(
    solver: Compiled,
    start: NDArray[np.float64],
    bounds: Sides,
    constraint_bounds: Sides,
    parameters: NDArray[np.float64],
) -> Stop:
    """Run IPOPT from a point, within lower and upper bounds of unknowns and of constraints."""
    result, stats = solver.solve(
        x0=start,
        lbx=bounds[0],
        ubx=bounds[1],
        lbg=constraint_bounds[0],
        ubg=constraint_bounds[1],
        p=parameters,
    )
    COST.candidates += int(stats.get("n_call_nlp_f", 0))
    COST.gradients += int(stats.get("n_call_nlp_grad_f", 0))
    COST.hessians += int(stats.get("n_call_nlp_hess_l", 0))
    return Stop(
        result["x"],
        result["lam_g"],
        str(stats["return_status"]),
        int(stats["iter_count"]),
    )
