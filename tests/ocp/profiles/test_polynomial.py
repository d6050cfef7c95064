"""The cycloid of a polynomial: eqs (1)-(7), boundary conditions, derivatives, bad input."""

import math

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import quietarm as qa
from quietarm.ocp import CycloidPolynomial, CycloidSpline

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
@pytest.mark.parametrize("fraction", [0.1, 0.93])
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
    before_and_after = [-0.5 * duration, 1.5 * duration]
    assert path(before_and_after, 3).tolist() == [0.0, 0.0]


@settings(max_examples=25)
@given(a=coefficients, start=angles, target=angles, duration=durations, fraction=st.floats(0, 1))
def test_derivatives_are_those_of_the_angle(a, start, target, duration, fraction):
    # casadi's own derivatives of theta, of order 1 to 3, from the angle alone.
    t = ca.SX.sym("t")
    profile = CycloidPolynomial(len(a))
    expected = [start + (target - start) * profile.angle(a, t / duration)]
    for _ in range(3):
        expected.append(ca.jacobian(expected[-1], t))
    by_casadi = ca.Function("theta", [t], expected)(fraction * duration)
    path = _path(a, start, target, duration)
    for order in range(4):
        size = np.abs(path(np.linspace(0.0, duration, 101), order)).max()
        assert path(fraction * duration, order) == pytest.approx(
            float(by_casadi[order]), abs=1e-11 * size + 1e-300
        )


def test_a_profile_without_coefficients_has_nothing_to_choose():
    with pytest.raises(ValueError, match="of 0 terms has one motion for a move"):
        CycloidPolynomial(0).refuse_no_choice()
    CycloidPolynomial(1).refuse_no_choice()
    assert [CycloidPolynomial(n).amount for n in (1, 2)] == ["1 term", "2 terms"]


def test_there_are_at_most_32_terms_and_28_of_a_polynomial():
    assert (CycloidSpline(32).size, CycloidPolynomial(28).size) == (32, 28)
    for family, terms in ((CycloidSpline, 33), (CycloidPolynomial, 29)):
        with pytest.raises(ValueError, match=f"terms is {terms}; give at most {terms - 1}"):
            family(terms)


# -- what is wrong with coefficients --


@pytest.mark.parametrize(
    ("size", "given", "told"),
    [
        (1, "x", "give 1 number$"),
        (2, "x", "give 2 numbers$"),
        (3, [0.1, 0.2], "got 2 coefficients for a profile of 3; give 3 numbers$"),
        (2, [0.1, math.nan], "coefficient 2 is nan"),
    ],
)
def test_coefficients_that_do_not_fit_are_told(size, given, told):
    with pytest.raises(ValueError, match=told):
        CycloidPolynomial(size).checked(given)


def test_a_duration_may_be_as_short_as_the_profile_allows():
    task = qa.PointToPoint(qa.SingleLinkManipulator(), math.pi / 6, 0.8)
    shaped = qa.shaped_cycloid(task, "zv")
    assert shaped.checked([], shaped.least_duration) == ()
    with pytest.raises(ValueError, match="too short for the "):
        shaped.checked([], 0.99 * shaped.least_duration)


def test_derivatives_go_up_to_the_third():
    path = qa.CycloidPolynomial(0).path([], 0.0, 1.0, 0.8)
    with pytest.raises(ValueError, match="derivative order is 4; give 0, 1, 2 or 3"):
        path(0.1, 4)
    with pytest.raises(ValueError, match="derivative order is -1; give a whole number from 0 up"):
        path(0.1, -1)


def test_a_motion_has_its_jerk_where_it_is_asked_for():
    move = [], 0.3, 0.0, 1.0, 0.8
    assert qa.CycloidPolynomial(0).motion(*move).jerk is None
    # eq (1) of the plain cycloid, differentiated three times: 4 pi^2 cos(2 pi t/TE) / TE^3
    expected = 4 * math.pi**2 * math.cos(0.6 * math.pi) / 0.8**3
    assert float(qa.CycloidPolynomial(0).motion(*move, jerk=True).jerk) == pytest.approx(expected)


def test_a_spline_has_a_control_point_less_than_its_degree_at_least():
    assert qa.CycloidSpline(4).size == 4  # docs/profiles.md: 4 to 32
    with pytest.raises(ValueError, match="terms is 3; give a whole number from 4 up"):
        qa.CycloidSpline(3)
