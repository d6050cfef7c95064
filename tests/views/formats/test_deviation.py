"""The proven bound of an interpolation's error, beside what is sampled."""

import casadi as ca
import numpy as np
import pytest
from robots import straight, ur5_with_bar

import quietarm as qa
from quietarm.models import LinearAxis, SingleLinkManipulator
from quietarm.ocp import (
    CycloidNetwork,
    CycloidPolynomial,
    PointToPoint,
    evaluate_coefficients,
    shaped_cycloid,
)
from quietarm.ocp.profiles.joint_spline import JointSpline
from quietarm.views.formats.between_rows import note_of_points
from quietarm.views.formats.deviation import (
    CUBIC,
    LINEAR,
    QUINTIC,
    SPLINE,
    deviation_of,
    deviation_words,
    motion_at,
    pieces_through,
)
from quietarm.views.formats.enclosure import Interval, NoEnclosureError, enclose
from quietarm.views.formats.exact_path import path_function

LINK = PointToPoint(SingleLinkManipulator(), np.pi / 6, 0.8, start=-0.2)
AXIS = PointToPoint(LinearAxis(), 0.3, 0.5)
MOVES = {
    "polynomial": (LINK, CycloidPolynomial(6)),
    "zvd": (LINK, shaped_cycloid(LINK, "zvd")),
    "axis": (AXIS, CycloidPolynomial(3)),
    "spline": (LINK, JointSpline((0.2, 0.5, 0.8))),
    "network": (LINK, CycloidNetwork(5)),
}


def plan_along(task, profile):
    rng = np.random.default_rng(5)
    coefficients = profile.plain + 0.1 * rng.uniform(-1, 1, profile.size)
    return evaluate_coefficients(task, coefficients, profile=profile)


def ticks(plan, rate):
    """Set points up to the first at or after arrival, which may be after it."""
    return np.arange(int(np.ceil(plan.task.duration * rate - 1e-9)) + 1) / rate


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("move", MOVES.values(), ids=MOVES)
def test_the_bound_is_above_the_error_and_close_to_it(move):
    plan = plan_along(*move)
    rng = np.random.default_rng(2)
    for rate in (10.0, 70.0):
        times = ticks(plan, rate)
        points = motion_at(plan, times)
        for interpolation in (LINEAR, SPLINE, CUBIC, QUINTIC):
            pieces = pieces_through(times, points, interpolation)
            deviation = deviation_of(plan, pieces)
            anywhere = rng.uniform(0, times[-1], 5_000)
            error = abs(pieces(anywhere) - motion_at(plan, anywhere)[0]).max(axis=0)
            size = abs(plan.task.target)
            assert (deviation.proven >= error).all()
            assert (deviation.proven >= deviation.sampled).all()
            # a fifth more, or what nobody asks for more closely
            assert (deviation.proven <= 1.2 * error + 2e-9 * size).all()


def test_the_bound_is_that_of_the_textbook():
    """Linear interpolation of the plain cycloid: an eighth of h^2 times its peak acceleration."""
    plan = evaluate_coefficients(LINK, [])
    times = ticks(plan, 1000.0)
    deviation = deviation_of(plan, pieces_through(times, motion_at(plan, times), LINEAR))
    # the cycloid's peak acceleration is 2 pi span / T^2
    peak = 2 * np.pi * (np.pi / 6 + 0.2) / 0.8**2
    assert 1 <= deviation.proven[0] / (1e-6 / 8 * peak) < 1.1


def test_motions_are_those_of_the_plan():
    plan = plan_along(LINK, CycloidPolynomial(6))
    times = np.linspace(0, 0.79, 30)
    sample = plan.sampled(times).sample.joints[0]
    for order, values in enumerate(motion_at(plan, times)):
        assert values[:, 0] == pytest.approx(sample[order], abs=1e-9)
    after = [values[0, 0] for values in motion_at(plan, np.array([0.9]))]
    assert after == pytest.approx([np.pi / 6, 0, 0], abs=1e-15)


@pytest.mark.parametrize(
    "make",
    [
        (lambda x: (x - 2) * (3 - x * x) / (x**2 + 1) - 1 / (x + 7)),
        (lambda x: ca.sin(3 * x) * ca.cos(x - 1) + ca.tanh(x) - ca.exp(-x * x)),
        (lambda x: x**3 - x**5 / 7 + ca.sqrt(x * x + 1) + ca.fabs(x - 0.3)),
        (lambda x: ca.if_else(x < 0.5, x, 1 - x) + ca.fmin(x, 0.2) + ca.fmax(x, -0.4)),
        (lambda x: ca.if_else(ca.logic_or(x < -1, ca.logic_and(x >= 0, x != 2)), x, -x)),
        (lambda x: 0 * x + 2),
    ],
)
def test_values_lie_within_their_enclosures(make):
    x, a = ca.SX.sym("x"), ca.SX.sym("a")
    function = ca.Function("f", [x, a], [make(x) + a])
    rng = np.random.default_rng(3)
    low = rng.uniform(-4, 4, 500)
    width = 10.0 ** rng.uniform(-9, 0.5, 500)
    (found,) = enclose(function, Interval(low, low + width), [[0.25]])
    for share in (0.0, 0.3, 0.7, 1.0):
        values = np.array([float(function(place, 0.25)) for place in low + share * width])
        assert (found.low <= values).all()
        assert (values <= found.high).all()
    # of the narrowest intervals all but those where a case changes are narrow as well
    narrow = width < 1e-6
    assert np.median((found.high - found.low)[narrow]) < 1e-4


def test_an_operation_without_an_enclosure_is_said():
    x = ca.SX.sym("x")
    with pytest.raises(NoEnclosureError, match="no enclosure of operation"):
        enclose(ca.Function("f", [x], [ca.erf(x)]), Interval(np.zeros(1), np.ones(1)), [])


def test_an_export_says_what_is_sampled_and_what_is_proven(cycloid):
    told = note_of_points(cycloid, 100.0)
    assert told.startswith("between the points, by quintics of angle, speed and acceleration, at")
    assert "rad (proven; sampled " in told
    assert note_of_points(cycloid, 100.0, ("time", "torque")) == ""


@pytest.mark.slow
def test_joints_of_a_robot_each_have_a_bound():
    task = qa.PointToPoint(ur5_with_bar().along(straight()), target=1.0, duration=1.0)
    plan = qa.evaluate_coefficients(task, [0.01, -0.12, -0.04, 0.12])
    times = ticks(plan, 125.0)
    deviation = deviation_of(plan, pieces_through(times, motion_at(plan, times), CUBIC))
    assert deviation.proven.shape == (6,)
    assert (deviation.proven >= deviation.sampled).all()
    assert (deviation.proven <= 1.2 * deviation.sampled + 1e-8).all()
    assert deviation_words(plan, deviation).count("rad (proven") == 1


def test_the_path_functions_accelerations_are_derivatives_of_its_positions():
    """On which the bound stands."""
    plan = plan_along(LINK, CycloidPolynomial(6))
    function = path_function(plan.profile, plan.task.plant)
    assert function.numel_out(0) == 3
    h = 1e-4
    times = np.linspace(0.1, 0.7, 20)
    before, here, after = (motion_at(plan, times + step)[0] for step in (-h, 0, h))
    second = (before - 2 * here + after) / h**2
    assert second == pytest.approx(motion_at(plan, times)[2], rel=1e-3, abs=1e-3)
