"""Options of IPOPT."""

from __future__ import annotations

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
SAMPLED = {**OPTIONS, "tol": 1e-5}
"""What remains of the sampled program's error is much less than its own distance to the truth."""


def _warm_options(barrier: float) -> dict[str, str | int | float]:
    pushes = ("bound_push", "bound_frac", "slack_bound_push", "slack_bound_frac", "mult_bound_push")
    return {
        "warm_start_init_point": "yes",
        "mu_init": barrier,
        **{f"warm_start_{name}": barrier for name in pushes},
    }


BESIDE = _warm_options(1e-6)
"""From the solution beside it a point of a front takes a third of the iterations with these."""
RESOLVED = {**OPTIONS, "tol": 1e-8}
FINISH = {
    **_warm_options(1e-8),
    "mu_strategy": "monotone",
    "max_iter": 15,
    "acceptable_tol": 1e3,
    "acceptable_dual_inf_tol": 1e10,
    "acceptable_constr_viol_tol": 1e-8,
    "acceptable_compl_inf_tol": 1e-5,
    "acceptable_obj_change_tol": 1e-9,
    "acceptable_iter": 3,
}
"""From the sampled minimum. Where zeros of the power meet, second derivatives are of no more use:
the iterations end when the energy has hardly changed three times."""
