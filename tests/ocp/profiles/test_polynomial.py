"""The cycloid of a polynomial: eqs (1)-(7), boundary conditions, derivatives, bad input."""

import math

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from quietarm.ocp import MAX_TERMS, CycloidPolynomial

angles = st.floats(-2 * math.pi, 2 * math.pi)
durations = st.floats(0.1, 10.0)
coefficients = st.lists(st.floats(-0.5, 0.5), max_size=10)
"""The wider of the paper's boxes, eq (17)."""


def _path(a, start=0.0, target=1.0, duration=1.0):
    return CycloidPolynomial(len(a)).path(a, start, target, duration)


def _scale(start, target, duration, order):
    """Size of the order-th derivative: what a tolerance is relative to."""
    return (abs(start) + abs(target)) / duration**order + 1e-300


# -- the plain cycloid in closed form: eqs (1), (4) --


@pytest.mark.parametrize("start", [0.0, -1.2])
@pytest.mark.parametrize("fraction", [0.0, 0.1, 0.25, 0.5, 0.75, 0.93, 1.0])
def test_plain_cycloid_in_closed_form(start, fraction):
    span, duration = 2.5, 0.8
    path = _path([], start, start + span, duration)
    t, x = fraction * duration, 2 * math.pi * fraction
    rate = 2 * math.pi / duration
    # theta = span (x - sin x)/(2 pi), and its derivatives.
    assert path(t) == pytest.approx(start + span * (x - math.sin(x)) / (2 * math.pi), abs=1e-13)
    assert path(t, 1) == pytest.approx(span / duration * (1 - math.cos(x)), abs=1e-12)
    assert path(t, 2) == pytest.approx(span / duration * rate * math.sin(x), abs=1e-11)
    assert path(t, 3) == pytest.approx(span / duration * rate**2 * math.cos(x), abs=1e-10)


def test_plain_cycloid_peaks():
    # From the closed form: speed 2 span/T halfway, acceleration 2 pi span/T^2 at a quarter.
    path = _path([], 0.0, math.pi / 6, 0.8)
    assert path(0.4, 1) == pytest.approx(2 * (math.pi / 6) / 0.8)
    assert path(0.2, 2) == pytest.approx(2 * math.pi * (math.pi / 6) / 0.8**2)
    assert path(0.4) == pytest.approx(math.pi / 12)


# -- eqs (1), (6), (7) typed afresh --


@settings(max_examples=40)
@given(a=coefficients, start=angles, target=angles, duration=durations, fraction=st.floats(0, 1))
def test_angle_is_eq_1_of_eq_6(a, start, target, duration, fraction):
    T = -1 + 2 * fraction  # eq (7)
    U = fraction + (1 - T**2) * sum(a_n * T**n for n, a_n in enumerate(a))  # eq (6)
    theta = (target - start) * (U - math.sin(2 * math.pi * U) / (2 * math.pi)) + start  # eq (1)
    path = _path(a, start, target, duration)
    assert path(fraction * duration) == pytest.approx(theta, rel=1e-12, abs=1e-12)


# -- boundary conditions: eq (5) --


@settings(max_examples=40)
@given(a=coefficients, start=angles, target=angles, duration=durations)
def test_joint_rests_at_start_and_target(a, start, target, duration):
    path, ends = _path(a, start, target, duration), [0.0, duration]
    close = 1e-14 * _scale(start, target, duration, 0)
    assert path(ends) == pytest.approx([start, target], abs=close)
    for order in (1, 2):
        # Coefficients of 0.5 in up to ten terms multiply the derivatives by 1e3 at most.
        close = 1e-11 * _scale(start, target, duration, order)
        assert path(ends, order) == pytest.approx([0.0, 0.0], abs=close)


@settings(max_examples=40)
@given(a=coefficients, order=st.integers(1, 3), outside=st.floats(1e-6, 100.0))
def test_joint_rests_before_and_after_the_move(a, order, outside):
    path = _path(a, -0.3, 1.1, 0.8)
    times = [-outside, 0.8 + outside]
    assert path(times) == pytest.approx([-0.3, 1.1], abs=1e-14)
    assert path(times, order).tolist() == [0.0, 0.0]


# -- derivatives --


@settings(max_examples=25)
@given(a=coefficients, start=angles, target=angles, duration=durations, fraction=st.floats(0, 1))
def test_derivatives_are_those_of_the_angle(a, start, target, duration, fraction):
    # casadi's own derivatives of theta, of order 1 to 3, from the angle alone.
    t = ca.SX.sym("t")
    profile = CycloidPolynomial(len(a))
    expected = [profile.derivatives(a, t / duration, start, target, duration)[0]]
    for _ in range(3):
        expected.append(ca.jacobian(expected[-1], t))
    by_casadi = ca.Function("theta", [t], expected)(fraction * duration)
    path = _path(a, start, target, duration)
    for order in range(4):
        size = np.abs(path(np.linspace(0.0, duration, 101), order)).max()
        assert path(fraction * duration, order) == pytest.approx(
            float(by_casadi[order]), abs=1e-11 * size + 1e-300
        )


@pytest.mark.parametrize("order", [1, 2, 3])
def test_derivatives_are_the_limits_of_differences(order):
    # Independent of casadi: central differences of the order below, N = 6 of the paper's Table 1.
    a = [-1.889e-3, -1.427e-1, -4.247e-2, -1.187e-1, 4.800e-2, -1.890e-1]
    path, t, h = _path(a, 0.0, math.pi / 6, 0.8), np.linspace(0.05, 0.75, 29), 1e-5
    differences = (path(t + h, order - 1) - path(t - h, order - 1)) / (2 * h)
    size = np.abs(path(t, order)).max()
    assert path(t, order) == pytest.approx(differences, abs=1e-7 * size)


# -- symmetries --


@settings(max_examples=25)
@given(a=coefficients, factor=st.floats(0.1, 10.0), fraction=st.floats(0, 1))
def test_a_slower_move_is_the_same_in_stretched_time(a, factor, fraction):
    fast, slow = _path(a, -1.0, 2.0, 1.0), _path(a, -1.0, 2.0, factor)
    for order in range(4):
        stretched = slow(fraction * factor, order) * factor**order
        assert stretched == pytest.approx(float(fast(fraction, order)), rel=1e-9, abs=1e-9)


@settings(max_examples=40)
@given(a=coefficients, fraction=st.floats(0, 1), order=st.integers(0, 3))
def test_the_move_is_proportional_to_its_span(a, fraction, order):
    one, three = _path(a, 0.0, 1.0), _path(a, 0.7, -2.3)
    expected = -3 * one(fraction, order) + (0.7 if order == 0 else 0.0)
    assert three(fraction, order) == pytest.approx(expected, rel=1e-9, abs=1e-9)


@settings(max_examples=40)
@given(a=coefficients, fraction=st.floats(0, 1), order=st.integers(0, 3))
def test_alternating_signs_run_the_move_backwards(a, fraction, order):
    # T -> -T in eq (6): U -> 1 - U when a_n -> (-1)^n a_n, n = 1, 2, ...
    forwards = _path(a, 0.4, 1.9)
    backwards = _path([(-1) ** n * a_n for n, a_n in enumerate(a, start=1)], 1.9, 0.4)
    expected = (-1) ** order * forwards(1.0 - fraction, order)
    assert backwards(fraction, order) == pytest.approx(expected, rel=1e-9, abs=1e-7)


@settings(max_examples=40)
@given(a=coefficients, fraction=st.floats(0, 1), order=st.integers(0, 3))
def test_a_term_of_coefficient_zero_changes_nothing(a, fraction, order):
    assert _path([*a, 0.0])(fraction, order) == _path(a)(fraction, order)


# -- one set of lines for symbols, matrices and numbers --


def test_numbers_symbols_and_matrices_give_the_same():
    rows, columns, terms = 3, 5, 4
    values = np.random.default_rng(3).uniform(-0.5, 0.5, (terms + 1, rows, columns))
    values[0] = np.abs(values[0]) * 2  # the fraction, in [0, 1]
    profile, move = CycloidPolynomial(terms), (-0.5, 1.3, 0.9)

    def derivatives(arguments):
        return list(profile.derivatives(arguments[1:], arguments[0], *move))

    scalars = [ca.SX.sym(f"x{i}") for i in range(terms + 1)]
    of_scalars = ca.Function("scalars", scalars, [ca.vertcat(*derivatives(scalars))])
    matrices = [ca.MX.sym(f"X{i}", rows, columns) for i in range(terms + 1)]
    of_matrices = ca.Function("matrices", matrices, derivatives(matrices))
    by_matrix = [value.full() for value in of_matrices.call([ca.DM(v) for v in values])]
    for row in range(rows):
        for column in range(columns):
            one = values[:, row, column].tolist()
            by_number = np.array([float(value) for value in derivatives(one)])
            assert of_scalars(*one).full().ravel() == pytest.approx(by_number, rel=1e-13)
            here = np.array([matrix[row, column] for matrix in by_matrix])
            assert here == pytest.approx(by_number, rel=1e-13)


def test_motion_is_angle_speed_and_acceleration():
    profile = CycloidPolynomial(2)
    arguments = ([0.1, -0.2], 0.3, 0.0, 1.0, 0.8)
    assert profile.motion(*arguments) == (*profile.derivatives(*arguments), None)


# -- the callable --


@pytest.mark.parametrize("shape", [(), (0,), (1,), (7,), (2, 3), (2, 3, 4)])
@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_path_keeps_the_shape_of_the_times(shape, order):
    t = np.linspace(-0.1, 1.1, math.prod(shape)).reshape(shape)
    result = _path([0.1, -0.1])(t, order)
    assert result.shape == shape
    each = [_path([0.1, -0.1])(one, order).item() for one in t.ravel()]
    assert result.ravel().tolist() == each


# -- terms and coefficients --


@pytest.mark.parametrize("terms", [0, 1, 6, 20, np.int64(3)])
def test_terms_are_the_number_of_coefficients(terms):
    assert CycloidPolynomial(terms).size == terms
    assert type(CycloidPolynomial(terms).terms) is int


# -- families by name --


def test_the_most_terms_still_tell_the_powers_apart():
    # The doc of MAX_TERMS: the condition number of the powers of T on [-1, 1] leaves four digits.
    T = np.cos(np.linspace(0, np.pi, 400))
    condition = np.linalg.cond(np.vander(T, MAX_TERMS))
    assert condition * np.finfo(float).eps < 1e-4
