"""Gaussians, network and spline in the place of the polynomial: ends, derivatives, fits, plans."""

import math

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from quietarm.ocp import (
    CycloidGaussians,
    CycloidNetwork,
    CycloidPolynomial,
    CycloidSpline,
    Front,
    Plan,
    PointToPoint,
    epsilon_front,
    evaluate_coefficients,
    plan_move,
    resimulate,
    rollout,
)
from quietarm.ocp.answers.provenance import SolveSettings
from quietarm.ocp.plan.starts import start_coefficients
from quietarm.ocp.profiles.spline import DEGREE, b_splines
from quietarm.ocp.profiles.units import SHARPEST
from scipy.interpolate import BSpline
from scipy.optimize import least_squares

UNITS = {"gaussians": CycloidGaussians, "network": CycloidNetwork}
FAMILIES = {**UNITS, "spline": CycloidSpline}
PLANNED = [
    ("single link", CycloidGaussians(3)),
    ("arm", CycloidNetwork(3)),
    ("two links", CycloidSpline()),
]
"""The plant that each is planned with, beside the arm with a limit."""


@pytest.fixture(params=FAMILIES)
def family(request):
    return FAMILIES[request.param]


@pytest.fixture(params=UNITS)
def of_units(request):
    return UNITS[request.param]


# -- sizes --


@pytest.mark.parametrize("terms", [1, 2, 7, 32])
def test_any_size(of_units, terms):
    profile = of_units(terms)
    assert profile.size == 1 + 3 * terms
    assert of_units.of_size(profile.size) == profile


def test_a_quintic_spline_has_four_control_points_to_move_at_least():
    assert CycloidSpline(4).size == 4
    with pytest.raises(ValueError, match="terms is 3; give a whole number from 4 up"):
        CycloidSpline(3)


# -- the joint's motion --

_NUMBERS = st.floats(-30.0, 30.0, allow_nan=False)


@settings(deadline=None, max_examples=10)
@given(data=st.data(), terms=st.integers(4, 7))
@pytest.mark.parametrize("kind", FAMILIES)
def test_the_joint_is_at_rest_at_both_ends_whatever_the_coefficients(kind, data, terms):
    # Eq (5).
    profile = FAMILIES[kind](terms)
    coefficients = data.draw(st.lists(_NUMBERS, min_size=profile.size, max_size=profile.size))
    path = profile.path(coefficients, -0.3, 1.1, 0.8)
    ends = np.array([0.0, 0.8])
    assert path(ends) == pytest.approx([-0.3, 1.1], abs=1e-12)
    size = [1.0, *(np.abs(path(np.linspace(0.0, 0.8, 201), order)).max() for order in (1, 2))]
    for order in (1, 2):
        assert path(ends, order) == pytest.approx([0.0, 0.0], abs=1e-11 * (1 + size[order]))


def test_each_derivative_is_that_of_the_one_before(family):
    profile = family()
    random = np.random.default_rng(1)
    path = profile.path(random.uniform(*profile.box(0.5)), -0.4, 1.1, 0.7)
    times = np.linspace(0.051, 0.651, 17)
    for order in range(3):
        slope = (path(times + 1e-6, order) - path(times - 1e-6, order)) / 2e-6
        size = np.abs(path(times, order + 1)).max()
        assert path(times, order + 1) == pytest.approx(slope, abs=1e-7 * size)


@pytest.mark.parametrize("terms", [4, 5, 6, 20])
def test_the_splines_are_scipys(terms):
    profile = CycloidSpline(terms)
    at, random = np.linspace(0.0, 1.0, 41), np.random.default_rng(0)
    own = random.normal(size=terms)
    reference = BSpline(np.array(profile.knots), np.array([0.0, *own, 0.0]), DEGREE)
    found = profile.input(list(own), ca.DM(at))
    line = [at, 1.0, 0.0]
    for order in range(3):
        wanted = reference(at, order) + line[order]
        size = np.abs(wanted).max()
        assert found[order].full().ravel() == pytest.approx(wanted, abs=1e-12 * size)


@settings(deadline=None)
@given(at=st.floats(0.0, 1.0))
def test_the_splines_sum_to_one(at):
    values = b_splines(CycloidSpline(6).knots, DEGREE, at)
    assert sum(float(value) for value in values) == pytest.approx(1.0)


def test_a_spline_is_linear_in_its_coefficients_and_units_are_not():
    random, times = np.random.default_rng(1), ca.DM(np.linspace(0.0, 1.0, 9))
    linear = set()
    for name, family in FAMILIES.items():
        profile = family()
        a, b = profile.plain + random.uniform(-0.2, 0.2, (2, profile.size))
        ends, middle = (
            [profile.input(list(one), times)[0].full() for one in of]
            for of in ((a, b), [a / 2 + b / 2])
        )
        if middle[0] == pytest.approx((ends[0] + ends[1]) / 2, abs=1e-12):
            linear.add(name)
    assert linear == {"spline"}


@pytest.mark.parametrize("terms", [1, 2, 5, 9])
def test_the_first_start_is_the_plain_cycloid_within_the_box(family, terms):
    profile = family(max(terms, family.least_terms))
    times = np.linspace(0.0, 0.8, 33)
    plain = CycloidPolynomial(0).path([], 0.0, 1.0, 0.8)(times)
    assert profile.path(profile.plain, 0.0, 1.0, 0.8)(times) == pytest.approx(plain, abs=1e-14)
    lower, upper = profile.box(None)
    starts = start_coefficients(profile, SolveSettings(starts=30, seed=2))
    assert all(np.all((lower <= start) & (start <= upper)) for start in starts)
    assert len({tuple(start) for start in starts}) == len(starts) >= 30


def test_a_bound_is_for_the_weights_of_units(of_units):
    profile = of_units(3)
    default, given_one = profile.box(None), profile.box(0.1)
    assert default[1][:4] == pytest.approx(0.5)
    assert given_one[1][:4] == pytest.approx(0.1)
    assert given_one[0][:4] == pytest.approx(-0.1)
    for a, b in zip(default, given_one, strict=True):
        assert a[4:] == pytest.approx(b[4:])


# -- what they can say --

PRINTED = (-1.889e-3, -1.427e-1, -4.247e-2, -1.187e-1, 4.800e-2, -1.890e-1)  # Table 1, N = 6


def test_units_reproduce_a_polynomial_that_they_are_fitted_to(of_units, tasks):
    # To the paper's six terms: angle, and with it the energy by the rollout.
    profile, task = of_units(), tasks["single link"]
    fractions = ca.DM(np.linspace(0.0, 1.0, 101))
    polynomial = CycloidPolynomial(6)
    wanted = polynomial.input(list(PRINTED), fractions)[0].full().ravel()
    a = ca.SX.sym("a", profile.size)
    off = profile.input(ca.vertsplit(a), fractions)[0] - ca.DM(wanted)
    distance = ca.Function("off", [a], [off, ca.jacobian(off, a)])
    room = np.concatenate([np.full(1 + 5, 100.0), np.full(10, 2.0)])
    fit = least_squares(
        lambda a: distance(a)[0].full().ravel(), profile.plain,
        jac=lambda a: distance(a)[1].full(), bounds=(profile.plain - room, profile.plain + room),
        xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=900,
    )  # fmt: skip
    assert np.abs(fit.fun).max() < 2e-5
    found, printed = (
        rollout(task, one, coefficients).motion
        for one, coefficients in ((profile, fit.x), (polynomial, PRINTED))
    )
    assert found.energy == pytest.approx(printed.energy, rel=2e-5)
    assert found.residual == pytest.approx(printed.residual, abs=1e-6)


def test_a_spline_follows_a_polynomial_better_with_more_control_points():
    fractions = ca.DM(np.linspace(0.0, 1.0, 201))
    wanted = CycloidPolynomial(6).input(list(PRINTED), fractions)[0].full().ravel()
    off = []
    for terms in (6, 14, 25):
        a = ca.SX.sym("a", terms)
        angle = CycloidSpline(terms).input(ca.vertsplit(a), fractions)[0]
        both = ca.Function("both", [a], [ca.jacobian(angle, a), angle])
        matrix, line = both(0)[0].full(), both(0)[1].full().ravel()
        fit = np.linalg.lstsq(matrix, wanted - line)[0]
        off.append(np.abs(matrix @ fit - (wanted - line)).max())
    # A quintic's error falls with the sixth power of the knots' distance (de Boor 1978, ch. XII),
    # once there are many pieces: 3 pieces, then 11, then 22, with a factor of two to spare.
    assert off[1] < off[0] / 20
    assert off[2] < off[1] / 2**6 * 2


# -- answers --


@pytest.mark.parametrize(("name", "profile"), PLANNED)
def test_the_gradient_plans_with_it(solved, name, profile, tasks, tmp_path):
    task = tasks[name]
    plan = plan_move(task, profile, starts=1)
    assert plan.residual < 1e-7 * evaluate_coefficients(task, []).residual + 1e-8
    assert plan.motion == resimulate(task, profile, plan.coefficients)
    assert plan.energy < 1.001 * solved(task, 4).energy
    plan.save(tmp_path / "plan.json")
    assert Plan.load(tmp_path / "plan.json") == plan


@pytest.mark.parametrize("profile", [CycloidGaussians(2), CycloidNetwork(2), CycloidSpline(6)])
def test_limits_hold(profile, tasks):
    arm = tasks["arm"]
    free = plan_move(arm, profile)  # from one start the Gaussians end 12 % above their best
    limit = 0.9 * free.motion.peak_acceleration
    task = PointToPoint(arm.plant, arm.target, arm.duration, acceleration_limit=limit)
    plan = plan_move(task, profile, starts=1)
    assert plan.motion.peak_acceleration <= limit * 1.001
    assert plan.energy >= free.energy * (1 - 1e-4)


def test_a_front_of_it_is_kept(of_units, tasks, tmp_path):
    front = epsilon_front(tasks["single link"], of_units(2), points=3, starts=1)
    energies = [point.energy for point in front.points]
    assert len(energies) >= 3
    assert energies == sorted(energies, reverse=True)
    front.save(tmp_path / "front.json")
    assert Front.load(tmp_path / "front.json") == front


def test_a_wide_gaussian_is_a_constant():
    # Inverse width 0: whatever stands there, the motion is that of the constant alone.
    profile, times = CycloidGaussians(1), np.linspace(0.0, 0.8, 9)
    found = profile.path([0.1, 0.2, 0.4, 0.0], 0.0, 1.0, 0.8)(times)
    wanted = CycloidPolynomial(1).path([0.1 + 0.2], 0.0, 1.0, 0.8)(times)
    assert found == pytest.approx(wanted, abs=1e-14)
    assert math.isfinite(found.sum())


@pytest.mark.parametrize("share", [1.0, -1.0])
def test_the_sharpest_unit_is_still_seen(of_units, share, tasks):
    profile, gain = of_units(1), share * SHARPEST
    at = 0.137 if of_units is CycloidGaussians else -0.137 * gain
    sharp = [0.0, 0.01, at, gain]
    found = resimulate(tasks["single link"], profile, sharp)
    fine = rollout(tasks["single link"], profile, sharp, steps=1000).motion
    assert found.energy == pytest.approx(fine.energy, rel=1e-3)
    assert found.residual == pytest.approx(fine.residual, rel=1e-4)


def test_a_sharper_unit_is_refused(of_units):
    with pytest.raises(ValueError, match=r"coefficient 6 is 201, the .*; give at most 200: a sh"):
        of_units(2).checked([0.0, 0.1, 0.1, 0.0, 0.0, 201.0, 1.0])
    with pytest.raises(ValueError, match=r"coefficient 4 is -1e\+06"):
        of_units(1).checked([0.0, 0.1, 0.1, -1e6])
