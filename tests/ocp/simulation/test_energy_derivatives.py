"""One step's share of the energy: its gradient, and the curvature that moving zeros cause."""

import math

import casadi as ca
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

from ocp.simulation.collocation import GAUSS_NODES, GAUSS_WEIGHTS, NODES
from ocp.simulation.objective import energy_derivatives, resolved_energy

NODE = np.array(GAUSS_NODES)
X = Polynomial([0.0, 1.0])
# The quadratic through the nodes' values is the sum of these times the values.
BASIS = [
    math.prod((X - other) / (node - other) for other in NODE if other != node) for node in NODE
]
VANISHING = math.prod(X - node for node in NODE)
BY_FIVE = [*BASIS, VANISHING, VANISHING * (X - 0.5)]
"""How the power on the step changes with its values at the nodes, the cubic and the quartic."""
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


def _zeros(quadratic):
    roots = quadratic.trim(1e-12).roots()
    return [r.real for r in roots if abs(r.imag) < 1e-9 and 0 < r.real < 1]


def _derivatives(power, cubic=0.0, quartic=0.0, least=LEAST):
    """Energy, gradient [5], second derivatives [3, 3]."""
    energy, gradient, bends = energy_derivatives()(power, cubic, quartic, least)
    return float(energy), gradient.full().ravel(), bends.full()


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
    energy, gradient, _ = _derivatives(quadratic(NODE))
    expected = [_with_sign(quadratic, function) for function in BY_FIVE]
    assert energy == pytest.approx(_with_sign(quadratic, quadratic), abs=1e-14)
    assert gradient == pytest.approx(np.array(expected), abs=1e-13)


@pytest.mark.parametrize("name", QUADRATICS)
def test_the_curvature_is_two_over_the_slope_at_each_zero(name):
    # The derivative of the integral of sign(p) q: q jumps by twice itself where the zero moves.
    quadratic = QUADRATICS[name]
    bends, expected = _derivatives(quadratic(NODE))[2], np.zeros((NODES, NODES))
    for zero in _zeros(quadratic):
        at_zero = np.array([function(zero) for function in BASIS])
        expected += 2 * np.outer(at_zero, at_zero) / abs(quadratic.deriv()(zero))
    assert bends == pytest.approx(expected, rel=1e-10, abs=1e-13)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_power_of_one_sign_costs_its_mean(sign):
    energy, gradient, bends = _derivatives(sign * np.array([1.0, 2.0, 4.0]), 3.0, -5.0)
    assert energy == pytest.approx(np.dot(GAUSS_WEIGHTS, [1.0, 2.0, 4.0]), rel=1e-14)
    assert gradient == pytest.approx(sign * np.append(GAUSS_WEIGHTS, [0.0, 0.0]), abs=1e-14)
    assert not bends.any()


def test_where_the_power_touches_zero_the_gradient_is_that_of_one_sign():
    # 4 (x - 1/2)^2 has a double zero on the middle node, whose curvature has no bound.
    energy, gradient, bends = _derivatives(4 * (NODE - 0.5) ** 2)
    assert energy == pytest.approx(1 / 3, rel=1e-12)
    assert gradient[:NODES] == pytest.approx(np.array(GAUSS_WEIGHTS), abs=1e-6)
    assert np.linalg.norm(bends) <= 2 * 2 / LEAST  # two zeros, each 2 g g' / slope with |g| = 1


@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9, 1e-12, 0.0, -1e-12, -1e-9, -1e-6, -1e-3])
def test_the_gradient_goes_over_without_a_jump_where_zeros_meet(gap):
    # Zeros at 0.3 +- sqrt(gap): between them the sign is the other way, 2 sqrt(gap) long.
    _, gradient, bends = _derivatives((NODE - 0.3) ** 2 - gap)
    apart = 2 * math.sqrt(max(gap, 0.0))
    at_zero = np.array([function(0.3) for function in BASIS])
    expected = np.array(GAUSS_WEIGHTS) - 2 * apart * at_zero
    assert gradient[:NODES] == pytest.approx(expected, abs=2 * apart**2 + 1e-6)
    assert np.isfinite(bends).all()


def test_no_power_has_an_energy_and_a_gradient_all_the_same():
    energy, gradient, bends = _derivatives(np.zeros(NODES))
    assert energy == 0.0
    assert np.abs(gradient).max() <= 1.0
    assert np.isfinite(bends).all()


# -- any quadratic --


def _power(first, second, height):
    return height * (NODE - first) * (NODE - second)


inside = st.floats(0.05, 0.95)
outside = st.floats(1.05, 3.0) | st.floats(-2.0, -0.05)
heights = st.floats(0.5, 5.0) | st.floats(-5.0, -0.5)
beyond = st.floats(-1.0, 1.0)


@given(first=inside, second=inside | outside, height=heights, cubic=beyond, quartic=beyond)
def test_the_gradient_is_the_limit_of_differences(first, second, height, cubic, quartic):
    assume(abs(first - second) > 0.05)
    at, h = np.append(_power(first, second, height), [cubic, quartic]), 1e-6
    _, gradient, _ = _derivatives(at[:NODES], *at[NODES:])
    for i in range(NODES + 2):
        there, back = at.copy(), at.copy()
        there[i], back[i] = at[i] + h, at[i] - h
        energies = [_derivatives(p[:NODES], *p[NODES:])[0] for p in (there, back)]
        assert gradient[i] == pytest.approx((energies[0] - energies[1]) / (2 * h), abs=1e-7)


@given(first=inside, second=inside | outside, height=heights)
def test_the_curvature_is_that_of_the_gradient_without_terms_beyond(first, second, height):
    assume(abs(first - second) > 0.05)
    power, h = _power(first, second, height), 1e-6
    bends = _derivatives(power)[2]
    for i, unit in enumerate(np.eye(NODES)):
        there, back = (_derivatives(power + s * h * unit)[1][:NODES] for s in (1, -1))
        assert bends[i] == pytest.approx((there - back) / (2 * h), rel=1e-4, abs=1e-4)


numbers = st.floats(-10.0, 10.0)


@given(power=st.tuples(numbers, numbers, numbers), cubic=numbers, quartic=numbers)
def test_the_energy_is_that_of_the_rollout_and_convex(power, cubic, quartic):
    energy, _, bends = _derivatives(power, cubic, quartic)
    expected = float(resolved_energy([ca.DM(p) for p in power], 1.0, cubic, quartic))
    assert energy == pytest.approx(expected, rel=1e-12, abs=1e-12)
    assert np.array_equal(bends, bends.T)
    assert np.linalg.eigvalsh(bends).min() >= -1e-12 * (1 + np.abs(bends).max())


@pytest.mark.parametrize("least", [0.5, 1.0, 4.0])
def test_a_slope_below_the_least_counts_as_the_least(least):
    # x - 1/2 has slope 1, and the middle node alone is not zero there.
    bends = _derivatives(NODE - 0.5, least=least)[2]
    assert bends[1, 1] == pytest.approx(2 / max(1.0, least), rel=1e-12)
    assert np.abs(np.delete(bends.ravel(), 4)).max() < 1e-12
