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
"""From coefficients in a box. What remains of the sampled program's error is much less than its own
distance to the truth."""
UNBOXED = {**SAMPLED, "mu_strategy": "monotone", "mu_init": 1e-3}
"""Without a box the adaptive barrier loses its way with ten terms or more; with one it takes a
fifth less iterations."""
PEAK = OPTIONS
"""The least peak, from coefficients alone."""
_BARRIER = 2e-9
RESOLVED = {
    **OPTIONS,
    "tol": 1e-7,
    # IPOPT keeps the barrier above an eleventh of this; what the barrier is times the rows of a
    # residual limit is energy that is not saved.
    "compl_inf_tol": 10 * _BARRIER,
    "mu_strategy": "monotone",
    "mu_init": _BARRIER,
    "warm_start_init_point": "yes",
    **{
        f"warm_start_{name}": _BARRIER
        for name in ("bound_push", "bound_frac", "slack_bound_push", "slack_bound_frac",
                     "mult_bound_push")
    },
    "max_iter": 30,
    # Else a constraint that is kept a little better pays for more energy.
    "delta": 1e-12,
    "acceptable_tol": 1e3,
    "acceptable_dual_inf_tol": 1e10,
    "acceptable_constr_viol_tol": 1e-8,
    "acceptable_compl_inf_tol": 1e-5,
    "acceptable_obj_change_tol": 1e-9,
    "acceptable_iter": 3,
}  # fmt: skip
"""From the minimum beside it, with its multipliers. Where zeros of the power meet, second
derivatives are of no more use: the iterations end when the energy has hardly changed three times.
"""
