"""The joint's angle as a spline."""

from math import pi

import numpy as np
import pytest
from scipy.interpolate import BSpline

from quietarm.ocp import CycloidPolynomial, JointSpline

KNOTS = (0.05, 0.1, 0.3, 0.5, 0.77, 0.9)
PROFILE = JointSpline(KNOTS)


def test_it_is_scipys_spline():
    a = np.random.default_rng(0).uniform(-0.3, 0.3, PROFILE.size)
    plain = PROFILE.places - np.sin(2 * pi * PROFILE.places) / (2 * pi)
    points = np.concatenate([np.zeros(3), plain + a, np.ones(3)])
    knots = np.concatenate([np.zeros(6), KNOTS, np.ones(6)])
    times = np.linspace(0.0, 1.3, 301)[1:-1]
    path = PROFILE.path(a, -0.2, 0.7, 1.3)
    for order in range(4):
        expected = (
            BSpline(knots, points, 5).derivative(order) if order else BSpline(knots, points, 5)
        )
        values = 0.9 * expected(times / 1.3) / 1.3**order + (-0.2 if order == 0 else 0.0)
        assert path(times, order) == pytest.approx(values, rel=1e-9, abs=1e-9)


def test_its_table_has_what_every_coefficient_adds():
    a = np.random.default_rng(1).uniform(-0.3, 0.3, PROFILE.size)
    fractions = np.linspace(0.0, 1.0, 101)[1:-1]
    path = PROFILE.path(a, 0.0, 1.0, 1.0)
    plain, *by_each = PROFILE.table(fractions)
    for order, values in enumerate(plain + np.tensordot(a, by_each, axes=1)):
        assert values == pytest.approx(path(fractions, order), rel=1e-9, abs=1e-9)


def test_both_ends_are_at_rest_without_acceleration():
    path = PROFILE.path(np.full(PROFILE.size, 0.1), 0.0, 1.0, 2.0)
    for order, ends in ((0, [0.0, 1.0]), (1, [0.0, 0.0]), (2, [0.0, 0.0])):
        assert path([0.0, 2.0], order) == pytest.approx(ends, abs=1e-9)


def test_without_coefficients_it_is_near_the_plain_cycloid():
    many = JointSpline(tuple(np.linspace(0, 1, 22)[1:-1]))
    times = np.linspace(0, 1, 101)
    cycloid = CycloidPolynomial(0).path([], 0.0, 1.0, 1.0)(times)
    assert many.path(many.plain, 0.0, 1.0, 1.0)(times) == pytest.approx(cycloid, abs=5e-3)


@pytest.mark.parametrize(
    ("knots", "message"),
    [
        ((), "got 0 knots; give 1 to 64"),
        ((0.5, 0.4), "knots are -0.1 of the move apart"),
        ((0.5, 1.0), "knots are 0 of the move apart"),
        ((float("nan"),), "knot is nan"),
    ],
)
def test_knots_that_do_not_rise_are_refused(knots, message):
    with pytest.raises(ValueError, match=message):
        JointSpline(knots)
