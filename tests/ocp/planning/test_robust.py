"""Robust plans: the residual limit holds between the samples, whatever the error."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest

import quietarm as qa
from quietarm.ocp import SolverFailedError, perturb_plant
from quietarm.ocp.planning import plan_along

RANGE = 0.1


@pytest.fixture(scope="module")
def task():
    uncertainty = qa.Uncertainty({"frequency": RANGE})
    return qa.PointToPoint(qa.SingleLinkManipulator(), pi / 6, 0.8, uncertainty=uncertainty)


@pytest.fixture(scope="module")
def plan(task):
    return qa.plan_move(task, starts=1)


def residuals(plan, errors):
    """By CVODES, of the motion on plants with these errors."""
    task = plan.task.certain
    return [
        qa.JudgedMotion.of_profile(
            replace(task, plant=perturb_plant(task.plant, {"frequency": error})),
            plan.profile,
            plan.coefficients,
        ).residual
        for error in errors
    ]


def test_the_limit_holds_between_the_samples(plan):
    limit = plan.residual_limit
    assert plan.excess <= 0
    # none of these is a sample, or a point of the grid on which the worst was looked for
    errors = RANGE * np.array([-0.937, -0.613, -0.337, -0.113, 0.113, 0.187, 0.263, 0.613, 0.937])
    assert max(residuals(plan, errors)) <= plan.worst.residual * (1 + 1e-4) <= limit * (1 + 1e-4)


def test_residual_and_energy_are_those_of_samples_and_assumed_plant(plan):
    samples = [error for (error,) in plan.task.scenarios]
    assert plan.residual == pytest.approx(max(residuals(plan, samples)), rel=1e-6)
    alone = qa.evaluate_coefficients(plan.task.certain, plan.coefficients)
    assert plan.energy == pytest.approx(alone.energy, rel=1e-8)


@pytest.mark.slow
def test_ipopt_finds_the_same(task, plan):
    other = qa.plan_move(task, starts=1, solver=qa.Ipopt())
    assert other.record.method == "ipopt"
    assert other.excess <= plan_along.EXCESS
    assert other.energy == pytest.approx(plan.energy, rel=1e-2)


@pytest.mark.slow
@pytest.mark.parametrize("error", [1e-4, 0.05, 0.1])
def test_by_default_it_leaves_no_more_than_the_plain_plan_in_the_worst_case(task, error):
    task = replace(task, uncertainty=qa.Uncertainty({"frequency": error}))
    plain, plan = qa.plan_move(task.certain), qa.plan_move(task)
    errors = error * np.linspace(-1, 1, 21)
    leaves = [max(residuals(one, errors)) for one in (plain, plan)]
    assert leaves[1] <= max(leaves[0], 1e-6) * (1 + 1e-3)
    # the answer says which limit that was, at most 5 % of how far the plain cycloid bends the tip
    bent = qa.evaluate_coefficients(task.certain, []).motion.peak_deflection
    assert leaves[1] <= plan.residual_limit * (1 + 1e-3) <= 0.05 * bent * (1 + 2e-3)


@pytest.mark.slow
def test_where_the_default_is_out_of_reach_the_limit_is_near_the_least_worst_case(task):
    one_term = qa.plan_move(task, qa.CycloidPolynomial(1), bound=0.2)
    limit = one_term.residual_limit
    assert one_term.worst.residual <= limit * (1 + 1e-3)
    with pytest.raises(qa.InfeasibleTaskError):
        qa.plan_move(task, qa.CycloidPolynomial(1), bound=0.2, residual_limit=0.9 * limit)


@pytest.mark.slow
def test_a_limit_that_does_not_hold_is_refused_with_what_is_left(task, monkeypatch):
    # without rounds and tightening nothing holds between the scenarios
    monkeypatch.setattr(plan_along, "_ROUNDS", 0)
    monkeypatch.setattr(plan_along, "_TIGHTENINGS", 0)
    task = replace(task, uncertainty=qa.Uncertainty({"frequency": 0.2}))
    with pytest.raises(SolverFailedError, match=r"above its limit of 0\.002 m"):
        qa.plan_move(task, qa.CycloidPolynomial(18), residual_limit=2e-3)
    with pytest.raises(SolverFailedError, match=r"smaller errors than frequency \+-20 % or a "):
        qa.plan_move(task, residual_limit=2e-3)
