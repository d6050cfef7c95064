"""Gaussians, network and spline in the place of the polynomial: formulas, ends, plans."""

import numpy as np
import pytest
from scipy.interpolate import BSpline

import quietarm as qa
from quietarm.ocp import CycloidGaussians, CycloidNetwork

UNITS = {"gaussians": CycloidGaussians, "network": CycloidNetwork}
FAMILIES = {**UNITS, "spline": qa.CycloidSpline}


@pytest.fixture(params=UNITS)
def of_units(request):
    return UNITS[request.param]


def _input(name, terms, a, x):
    """U at the fractions x of the move, typed afresh from the docstrings of the families."""
    if name == "spline":  # clamped and quintic, on even knots
        knots = np.concatenate([np.zeros(5), np.linspace(0, 1, terms - 2), np.ones(5)])
        return x + BSpline(knots, np.array([0.0, *a, 0.0]), 5)(x)
    T, (weights, places, sharp) = 2 * x - 1, np.split(a[1:], 3)
    z = sharp[:, None] * (T - places[:, None])
    units = (
        np.exp(-(z**2)) if name == "gaussians" else np.tanh(places[:, None] + np.outer(sharp, T))
    )
    return x + (1 - T**2) * (a[0] + weights @ units)


@pytest.mark.parametrize(("name", "terms"), [*((name, 5) for name in FAMILIES), ("spline", 20)])
def test_the_angle_is_that_of_the_formula_and_each_derivative_that_of_the_one_before(name, terms):
    profile = FAMILIES[name](terms)
    a = np.random.default_rng(1).uniform(*profile.box(0.5))
    path, x = profile.path(a, -0.4, 1.1, 0.7), np.linspace(0.073, 0.93, 17)
    U = _input(name, terms, a, x)
    angle = -0.4 + 1.5 * (U - np.sin(2 * np.pi * U) / (2 * np.pi))  # eq (1)
    assert path(0.7 * x) == pytest.approx(angle, abs=1e-12)
    for order in range(3):
        slope = (path(0.7 * x + 1e-6, order) - path(0.7 * x - 1e-6, order)) / 2e-6
        size = np.abs(path(0.7 * x, order + 1)).max()
        assert path(0.7 * x, order + 1) == pytest.approx(slope, abs=1e-7 * size)


@pytest.mark.parametrize("name", FAMILIES)
def test_the_joint_is_at_rest_at_both_ends_whatever_the_coefficients(name):
    # Eq (5).
    profile = FAMILIES[name](5)
    a = np.random.default_rng(2).uniform(-30, 30, profile.size)
    path, ends = profile.path(a, -0.3, 1.1, 0.8), np.array([0.0, 0.8])
    assert path(ends) == pytest.approx([-0.3, 1.1], abs=1e-12)
    for order in (1, 2):
        size = np.abs(path(np.linspace(0.0, 0.8, 201), order)).max()
        assert path(ends, order) == pytest.approx([0.0, 0.0], abs=1e-11 * (1 + size))


def test_a_bound_is_for_the_weights_of_units(of_units):
    default, given = of_units(3).box(None), of_units(3).box(0.1)
    assert default[1][:4] == pytest.approx(0.5)
    assert (*given[0][:4], *given[1][:4]) == pytest.approx([-0.1] * 4 + [0.1] * 4)
    assert np.array_equal(np.array(default)[:, 4:], np.array(given)[:, 4:])


@pytest.mark.slow_after(2)
@pytest.mark.parametrize(
    ("name", "profile"),
    [
        ("single link", CycloidGaussians(3)),
        ("arm", CycloidNetwork(3)),
        ("two links", qa.CycloidSpline()),
    ],
)
def test_the_gradient_plans_with_it(solved, name, profile, tasks, tmp_path):
    task = tasks[name]
    plan = qa.plan_move(task, profile, starts=1)
    assert plan.residual < 1e-7 * qa.evaluate_coefficients(task, []).residual + 1e-8
    assert plan.motion == qa.JudgedMotion.of_profile(task, profile, plan.coefficients).motion
    assert plan.energy < 1.001 * solved(task, 4).energy
    plan.save(tmp_path / "plan.json")
    assert qa.Plan.load(tmp_path / "plan.json") == plan
