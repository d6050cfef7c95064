"""The gradient answer: optimality, determinism, limits, other moves, a user's own plant."""

import math
from dataclasses import replace

import numpy as np
import pytest
from fixed_steps import rollout

import quietarm as qa

pi = math.pi


@pytest.mark.parametrize("name", ["single link", "arm"])
def test_no_neighbour_that_arrives_at_rest_costs_less(tasks, solved, name):
    # Random steps, brought back to rest on arrival by Newton's method on rollout's W and W', whose
    # derivative hardly changes on the way.
    task, plan, random = tasks[name], solved(tasks[name]), np.random.default_rng(1)
    steps = plan.verification.steps

    def simulate(a):
        return rollout(task, plan.profile, a, steps=steps)

    best, at = simulate(plan.coefficients), np.array(plan.coefficients)
    columns = [np.subtract(simulate(at + e).arrival, best.arrival) for e in 1e-6 * np.eye(6)]
    back = np.linalg.pinv(np.column_stack(columns) / 1e-6)
    for _ in range(15):
        away = random.normal(size=6)
        a = at + 0.02 * away / np.linalg.norm(away)
        for _ in range(5):
            a -= back @ simulate(a).arrival
        there = simulate(a).motion
        assert there.residual < 1e-9
        assert np.linalg.norm(a - plan.coefficients) > 1e-3
        assert there.energy > best.motion.energy * (1 + 1e-5)


def test_all_limits_at_once_are_kept(tasks, solved):
    task, free = tasks["arm"], solved(tasks["arm"]).motion
    limits = {
        "torque_limit": 0.95 * free.peak_torque,
        "speed_limit": 0.97 * free.peak_speed,
        "acceleration_limit": 0.95 * free.peak_acceleration,
        "jerk_limit": 0.8 * free.peak_jerk,
        "deflection_limit": 0.98 * free.peak_deflection,
    }
    plan = solved(replace(task, **limits), starts=1)
    for limit, value in limits.items():
        assert plan.motion.peak(limit.removesuffix("_limit")) <= value * (1 + 1e-6)
    assert plan.residual < 1e-7
    assert plan.energy > free.energy


def test_eight_steps_are_doubled_until_the_energy_is_cvodes(tasks):
    # Eight miss 5e-5 of it; plans have it within 1e-5 (OF_A_PLAN), which is less than is verified.
    settings = {"starts": 1, "residual_limit": 0.02}
    plan = qa.plan_move(tasks["single link"], qa.CycloidPolynomial(2), steps=8, **settings)
    assert plan.verification.steps in [16, 32, 64]
    assert plan.verification.fixed_step_energy == pytest.approx(plan.energy, rel=1e-5)


@pytest.mark.slow
def test_too_few_steps_are_doubled_until_the_integrators_agree(tasks, solved):
    settings = {"starts": 2, "residual_limit": 1e-6}
    plan = qa.plan_move(tasks["single link"], qa.CycloidPolynomial(4), steps=3, **settings)
    assert plan.verification.steps in [3 * 2**k for k in range(1, 8)]
    assert plan.residual <= 1e-6 * (1 + 1e-6)
    assert plan.verification.fixed_step_energy == pytest.approx(plan.energy, rel=1e-3)
    usual = solved(tasks["single link"], 4, **settings)
    assert plan.energy == pytest.approx(usual.energy, rel=1e-5)


@pytest.mark.slow
def test_a_verification_takes_more_steps_before_it_says_that_two_integrators_differ():
    # A crane of two modes, 24 terms: coefficients of thousands, whose powers of T cancel.
    plant = qa.LinearAxis(omega1=2.68, omega2=6.47, share1=0.3, share2=0.7, mode_count=2)
    profile = qa.CycloidPolynomial(24)
    plan = qa.plan_move(qa.PointToPoint(plant, 2.0, 4.0), profile, starts=1)
    longer = qa.evaluate_coefficients(
        qa.PointToPoint(plant, 20.0, 4.0), plan.coefficients, profile=profile
    )
    assert longer.verification.agrees
    assert longer.verification.steps > longer.steps
