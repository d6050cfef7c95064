"""Derivatives of what `symbolic_rollout` gives: finite, and equal to differences."""

from functools import cache

import casadi as ca
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import quietarm as qa
from quietarm.ocp import CycloidGaussians, CycloidNetwork, PositivePower, symbolic_rollout

PLANTS = {
    "link": qa.SingleLinkManipulator(),
    "arm": qa.ArmOnFlexibleLink(),
    "two links": qa.DualLinkManipulator(),
    "two modes": qa.FlexibleBeam(mode_count=2.0),
}
PROFILES = {
    "polynomial": qa.CycloidPolynomial(6),
    "gaussians": CycloidGaussians(3),
    "network": CycloidNetwork(3),
    "spline": qa.CycloidSpline(6),
}
ENERGIES = {
    "absolute": qa.AbsolutePower(),
    "positive": PositivePower(),
    "copper": qa.CopperLoss(0.12),
}
MOST = max(profile.size for profile in PROFILES.values())
WIDTH = 1e-6
CASES = [
    *(("link", profile, "absolute") for profile in PROFILES),
    *((plant, "polynomial", "absolute") for plant in PLANTS if plant != "link"),
    *(("link", "polynomial", energy) for energy in ENERGIES if energy != "absolute"),
    *(
        (plant, profile, "absolute")
        for plant in PLANTS
        if plant != "link"
        for profile in PROFILES
        if profile != "polynomial"
    ),
]
"""Every profile, every plant and every energy once, then all others."""


@cache
def derivatives(plant, profile, energy):
    """(coefficients) -> values, their Jacobian, the energy's gradient and its Hessian."""
    shape, move = PROFILES[profile], (0.1, 1.0, 0.9)
    a = ca.MX.sym("a", shape.size)
    found = symbolic_rollout(
        PLANTS[plant], shape, ca.vertsplit(a), move, 12,
        jerk=True, breaks=shape.breaks(move[2]), energy=ENERGIES[energy],
    )  # fmt: skip
    values = [found.energy, found.arrival.T]
    for node in found.samples:
        values += map(ca.vec, (node.path.speed, node.path.jerk, *node.torques))
    values = ca.vertcat(*values)
    hessian, gradient = ca.hessian(found.energy, a)
    return ca.Function("derivatives", [a], [values, ca.jacobian(values, a), gradient, hessian])


def by_differences(function, output, a):
    """The Jacobian of an output by central differences."""
    ends = [[function(a + side * row)[output].full().ravel() for side in (WIDTH, -WIDTH)]
            for row in np.eye(len(a))]  # fmt: skip
    return np.transpose([(up - down) / (2 * WIDTH) for up, down in ends])


@pytest.mark.slow_after(5)
@pytest.mark.parametrize("case", CASES, ids=" ".join)
@given(numbers=st.lists(st.floats(-1, 1), min_size=MOST, max_size=MOST))
@example(numbers=[0.0] * MOST)  # the plain cycloid
@settings(max_examples=8)
def test_derivatives_are_finite_and_those_of_differences(case, numbers):
    function = derivatives(*case)
    a = np.array(numbers[: function.size1_in(0)])
    values, jacobian, gradient, hessian = (x.full() for x in function(a))
    for found in (values, jacobian, gradient, hessian):
        assert np.isfinite(found).all()
    rows = np.abs(jacobian).max(axis=1, keepdims=True) + 1e-6
    assert np.abs((by_differences(function, 0, a) - jacobian) / rows).max() < 1e-4
    assert gradient.ravel() == pytest.approx(jacobian[0], rel=1e-9, abs=1e-9)


@pytest.mark.slow_after(7)
@pytest.mark.parametrize("case", CASES, ids=" ".join)
def test_second_derivatives_are_those_of_differences(case):
    """Where no two zeros of the power meet, at which the curvature has no bound."""
    function, random = derivatives(*case), np.random.default_rng(5)
    for a in random.uniform(-0.2, 0.2, (3, function.size1_in(0))):
        hessian = function(a)[3].full()
        differences = by_differences(function, 2, a)
        assert np.abs(differences - hessian).max() < 1e-3 * np.abs(hessian).max()
