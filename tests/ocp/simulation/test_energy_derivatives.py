"""One step's share of the energy: its gradient, and the curvature that moving zeros cause."""

import math

import casadi as ca
import numpy as np
import pytest
from hypothesis import strategies as st
from numpy.polynomial import Polynomial
from quietarm.ocp.simulation.collocation import GAUSS_NODES, GAUSS_WEIGHTS, NODES, mesh
from quietarm.ocp.simulation.objective import (
    energy_derivatives,
    resolved_energy,
    two_samples,
)

NODE = np.array(GAUSS_NODES)
X = Polynomial([0.0, 1.0])
# The quadratic through the nodes' values is the sum of these times the values.
BASIS = [
    math.prod((X - other) / (node - other) for other in NODE if other != node) for node in NODE
]
LEAST = 1e-3
"""Slopes above this count as they are."""

QUADRATICS = {
    "constant": Polynomial([3.0]),
    "negative": Polynomial([-3.0]),
    "complex zeros": Polynomial([1.0, -1.0, 1.0]),
    "zeros outside": (X + 1) * (X - 2),
    "ramp through zero": 2 * X - 1,
    "falling ramp": 1 - 3 * X,
    "one zero": X**2 - 1 / 4,
    "two zeros": (X - 1 / 4) * (X - 3 / 4),
    "two zeros, near the ends": -5 * (X - 0.02) * (X - 0.99),
}


@pytest.mark.parametrize("name", QUADRATICS)
def test_two_samples_of_a_quadratic_are_those_of_gausss_two_nodes(name):
    quadratic = QUADRATICS[name]
    nodes, weights = np.polynomial.legendre.leggauss(2)  # on [-1, 1]
    samples = two_samples() @ quadratic(NODE)
    assert samples == pytest.approx(quadratic((nodes + 1) / 2), abs=1e-12)
    assert samples @ weights / 2 == pytest.approx(quadratic.integ()(1.0), abs=1e-12)


def _zeros(quadratic):
    roots = quadratic.trim(1e-12).roots()
    return [r.real for r in roots if abs(r.imag) < 1e-9 and 0 < r.real < 1]


def _energy(power):
    return float(resolved_energy([ca.DM(p) for p in power], 1.0))


def _derivatives(power, least=LEAST):
    """Gradient [3], second derivatives [3, 3]."""
    gradient, bends = energy_derivatives()(power, least)
    return gradient.full().ravel(), bends.full()


def _with_sign(quadratic, function):
    """Integral over the step of the function times the sign of the quadratic."""
    breaks = [0.0, *sorted(_zeros(quadratic)), 1.0]
    primitive, middles = function.integ(), np.add(breaks[:-1], breaks[1:]) / 2
    return np.sign(quadratic(middles)) @ np.diff(primitive(np.array(breaks)))


# -- closed forms --


@pytest.mark.parametrize("name", QUADRATICS)
def test_the_gradient_is_the_integral_of_the_sign(name):
    # d/dp of the integral of |p| is the integral of sign(p): the zeros' own move adds nothing.
    quadratic = QUADRATICS[name]
    gradient, _ = _derivatives(quadratic(NODE))
    expected = [_with_sign(quadratic, function) for function in BASIS]
    assert _energy(quadratic(NODE)) == pytest.approx(_with_sign(quadratic, quadratic), abs=1e-14)
    assert gradient == pytest.approx(np.array(expected), abs=1e-13)


@pytest.mark.parametrize("name", QUADRATICS)
def test_the_curvature_is_two_over_the_slope_at_each_zero(name):
    # The derivative of the integral of sign(p) q: q jumps by twice itself where the zero moves.
    quadratic = QUADRATICS[name]
    bends, expected = _derivatives(quadratic(NODE))[1], np.zeros((NODES, NODES))
    for zero in _zeros(quadratic):
        at_zero = np.array([function(zero) for function in BASIS])
        expected += 2 * np.outer(at_zero, at_zero) / abs(quadratic.deriv()(zero))
    assert bends == pytest.approx(expected, rel=1e-10, abs=1e-13)


def test_where_the_power_touches_zero_the_gradient_is_that_of_one_sign():
    # 4 (x - 1/2)^2 has a double zero on the middle node, whose curvature has no bound.
    power = 4 * (NODE - 0.5) ** 2
    gradient, bends = _derivatives(power)
    assert _energy(power) == pytest.approx(1 / 3, rel=1e-12)
    assert gradient == pytest.approx(np.array(GAUSS_WEIGHTS), abs=1e-6)
    assert np.linalg.norm(bends) <= 2 * 2 / LEAST  # two zeros, each 2 g g' / slope with |g| = 1


@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9, 1e-12, 0.0, -1e-12, -1e-9, -1e-6, -1e-3])
def test_the_gradient_goes_over_without_a_jump_where_zeros_meet(gap):
    # Zeros at 0.3 +- sqrt(gap): between them the sign is the other way, 2 sqrt(gap) long.
    gradient, bends = _derivatives((NODE - 0.3) ** 2 - gap)
    apart = 2 * math.sqrt(max(gap, 0.0))
    at_zero = np.array([function(0.3) for function in BASIS])
    expected = np.array(GAUSS_WEIGHTS) - 2 * apart * at_zero
    assert gradient == pytest.approx(expected, abs=2 * apart**2 + 1e-6)
    assert np.isfinite(bends).all()


# -- any quadratic --


outside = st.floats(1.05, 3.0) | st.floats(-2.0, -0.05)


@pytest.mark.parametrize("least", [0.5, 1.0, 4.0])
def test_a_slope_below_the_least_counts_as_the_least(least):
    # x - 1/2 has slope 1, and the middle node alone is not zero there.
    bends = _derivatives(NODE - 0.5, least=least)[1]
    assert bends[1, 1] == pytest.approx(2 / max(1.0, least), rel=1e-12)
    assert np.abs(np.delete(bends.ravel(), 4)).max() < 1e-12


# -- from one step to the next --

STEPS = 4
BEGIN, LENGTH = (x.full() for x in mesh(ca.DM(np.arange(STEPS)).T, STEPS))
