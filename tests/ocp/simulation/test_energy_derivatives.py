"""One step's share of the energy: its gradient, and the curvature that moving zeros cause."""

import math

import casadi as ca
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.polynomial import Polynomial
from quietarm.ocp.simulation.collocation import GAUSS_NODES, GAUSS_WEIGHTS, NODES, mesh
from quietarm.ocp.simulation.objective import (
    beyond_quadratic,
    energy_derivatives,
    resolved_energy,
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


@pytest.mark.parametrize("sign", [1, -1])
def test_a_power_of_one_sign_costs_its_mean(sign):
    power = sign * np.array([1.0, 2.0, 4.0])
    gradient, bends = _derivatives(power)
    assert _energy(power) == pytest.approx(np.dot(GAUSS_WEIGHTS, [1.0, 2.0, 4.0]), rel=1e-14)
    assert gradient == pytest.approx(sign * np.array(GAUSS_WEIGHTS), abs=1e-14)
    assert not bends.any()


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


def test_no_power_has_an_energy_and_a_gradient_all_the_same():
    gradient, bends = _derivatives(np.zeros(NODES))
    assert _energy(np.zeros(NODES)) == 0.0
    assert np.abs(gradient).max() <= 1.0
    assert np.isfinite(bends).all()


# -- any quadratic --


def _power(first, second, height):
    return height * (NODE - first) * (NODE - second)


inside = st.floats(0.05, 0.95)
outside = st.floats(1.05, 3.0) | st.floats(-2.0, -0.05)
heights = st.floats(0.5, 5.0) | st.floats(-5.0, -0.5)


@settings(max_examples=30)
@given(first=inside, second=inside | outside, height=heights)
def test_the_gradient_is_the_limit_of_differences(first, second, height):
    assume(abs(first - second) > 0.05)
    power, h = _power(first, second, height), 1e-6
    gradient, _ = _derivatives(power)
    for i, unit in enumerate(np.eye(NODES)):
        there, back = (_energy(power + s * h * unit) for s in (1, -1))
        assert gradient[i] == pytest.approx((there - back) / (2 * h), abs=1e-7)


@given(first=inside, second=inside | outside, height=heights)
def test_the_curvature_is_that_of_the_gradient(first, second, height):
    assume(abs(first - second) > 0.05)
    power, h = _power(first, second, height), 1e-6
    bends = _derivatives(power)[1]
    for i, unit in enumerate(np.eye(NODES)):
        there, back = (_derivatives(power + s * h * unit)[0] for s in (1, -1))
        assert bends[i] == pytest.approx((there - back) / (2 * h), rel=1e-4, abs=1e-4)


numbers = st.floats(-10.0, 10.0)


@given(power=st.tuples(numbers, numbers, numbers), other=st.tuples(numbers, numbers, numbers))
def test_the_energy_is_convex_and_its_gradient_a_support_of_it(power, other):
    gradient, bends = _derivatives(power)
    assert gradient @ power == pytest.approx(_energy(power), rel=1e-9, abs=1e-9)  # homogeneous
    assert _energy(other) >= gradient @ other - 1e-6 * (1 + np.abs(other).max())
    assert np.array_equal(bends, bends.T)
    assert np.linalg.eigvalsh(bends).min() >= -1e-12 * (1 + np.abs(bends).max())


@pytest.mark.parametrize("least", [0.5, 1.0, 4.0])
def test_a_slope_below_the_least_counts_as_the_least(least):
    # x - 1/2 has slope 1, and the middle node alone is not zero there.
    bends = _derivatives(NODE - 0.5, least=least)[1]
    assert bends[1, 1] == pytest.approx(2 / max(1.0, least), rel=1e-12)
    assert np.abs(np.delete(bends.ravel(), 4)).max() < 1e-12


# -- from one step to the next --

STEPS = 4
BEGIN, LENGTH = (x.full() for x in mesh(ca.DM(np.arange(STEPS)).T, STEPS))
TIMES = BEGIN.T + LENGTH.T * NODE


def _moved(zero):
    """A power of one zero at the nodes of every step (STEPS, NODES), and its change with that."""
    return (np.exp(2 * TIMES) - np.exp(2 * zero)), -2 * np.exp(2 * zero) * np.ones_like(TIMES)


def _change(zero):
    """How the energy changes with the zero, by the gradient."""
    steps = zip(LENGTH.ravel(), *_moved(zero), strict=True)
    return sum(length * _derivatives(power)[0] @ by_zero for length, power, by_zero in steps)


def _change_with_terms_beyond(zero, h=1e-8):
    """The same of the energy with what neighbouring steps tell, by differences."""

    def energy(place):
        power = [ca.DM(column).T for column in _moved(place)[0].T]
        terms = (ca.horzcat(*power) @ weights for weights in beyond_quadratic(STEPS))
        return float(resolved_energy(power, ca.DM(LENGTH), *terms))

    return (energy(zero + h) - energy(zero - h)) / (2 * h)


def _largest_jump(change, step, count):
    """Largest difference of the gradient from place to place about where a step begins."""
    places = BEGIN[0, step] + np.linspace(-5e-3, 5e-3, count)
    return np.abs(np.diff([change(zero) for zero in places])).max()


@pytest.mark.parametrize("step", range(1, STEPS))
def test_the_gradient_does_not_jump_where_a_zero_passes_into_the_next_step(step):
    # From place to place it changes by the curvature times their distance, and no more.
    coarse, fine = (_largest_jump(_change, step, count) for count in (101, 401))
    assert fine == pytest.approx(coarse / 4, rel=0.05)


@pytest.mark.parametrize("step", range(1, STEPS))
def test_with_terms_beyond_the_quadratic_it_would_jump(step):
    # Why the solver's energy leaves them out: the cubic is not zero where a step ends.
    coarse, fine = (_largest_jump(_change_with_terms_beyond, step, count) for count in (26, 101))
    assert fine > 0.6 * coarse


@pytest.mark.parametrize(("cubic", "jump"), [(0.0, 0.0), (3.0, 0.3), (5.0, 0.5)])
def test_the_jump_of_a_zero_that_leaves_a_step_by_hand(cubic, jump):
    # Of x - z the energy is z^2 - z + 1/2 up to z = 1 and z - 1/2 from there: slope 1 on both
    # sides. The cubic's work up to z is counted twice, and its power at the end of the step is
    # (1 - node 1)(1 - node 2)(1 - node 3) = 1/20.
    h = 1e-6

    def energy(zero):
        return float(resolved_energy([ca.DM(x - zero) for x in GAUSS_NODES], 1.0, cubic))

    inside, outside = ((energy(1 + s * h) - energy(1)) / (s * h) for s in (-1, 1))
    assert outside == pytest.approx(1.0, abs=1e-5)
    assert outside - inside == pytest.approx(jump, abs=1e-5)
