"""A user's own profiles: however they are written, derivatives and plans are right."""

import math
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np
import pytest

import quietarm as qa
from quietarm.ocp.profiles.cycloid import Cycloid
from quietarm.ocp.simulation.mesh import Mesh
from quietarm.ocp.solvers.node import Path

pi = math.pi


def _waves(coefficients, fraction):
    """The input U = x + sum_j a_j sin(j pi x), x = t/T."""
    U = fraction
    for j, a in enumerate(coefficients, start=1):
        U = U + a * ca.sin(j * pi * fraction)
    return U


@dataclass(frozen=True)
class _Waves(qa.JointProfile):
    """The cycloid of waves, as an angle alone."""

    name: ClassVar[str] = "waves-of-a-test"
    waves: int = 4

    @property
    def size(self):
        return self.waves

    def angle(self, coefficients, fraction):
        U = _waves(coefficients, fraction)
        return U - ca.sin(2 * pi * U) / (2 * pi)  # eq (1)


@dataclass(frozen=True)
class _GivenWaves(_Waves):
    """Waves with formulas of their derivatives."""

    name: ClassVar[str] = "given-waves-of-a-test"

    def derivatives(self, coefficients, fraction):
        U, dU, ddU = _waves(coefficients, fraction), 1.0, 0.0
        for j, a in enumerate(coefficients, start=1):
            dU = dU + a * j * pi * ca.cos(j * pi * fraction)
            ddU = ddU - a * (j * pi) ** 2 * ca.sin(j * pi * fraction)
        sine, cosine = ca.sin(2 * pi * U), ca.cos(2 * pi * U)
        return (
            U - sine / (2 * pi),
            (1 - cosine) * dU,
            2 * pi * sine * dU**2 + (1 - cosine) * ddU,
        )


@dataclass(frozen=True)
class _CycloidOfWaves(Cycloid):
    """Waves as a cycloid of an input, in which the coefficients are linear."""

    name: ClassVar[str] = "cycloid-of-waves-of-a-test"
    waves: int = 4

    @property
    def size(self):
        return self.waves

    def input(self, coefficients, fraction):
        return _waves(coefficients, fraction)


class _MinimumJerk(qa.TermProfile):
    """The motion of least jerk and a polynomial: its angle is linear in the coefficients."""

    name = "minimum-jerk-of-a-test"

    def angle(self, coefficients, fraction):
        x = fraction
        bump = (x * (1 - x)) ** 3
        shape = sum(a * x**k for k, a in enumerate(coefficients))
        return x**3 * (10 - 15 * x + 6 * x**2) + bump * shape


WAVES = [_Waves, _GivenWaves, _CycloidOfWaves]


@pytest.mark.parametrize(
    "profile", [kind(4) for kind in (*WAVES, _MinimumJerk)], ids=lambda p: p.name
)
def test_each_derivative_is_that_of_the_one_before(profile):
    a = np.random.default_rng(0).uniform(-0.3, 0.3, profile.size)
    path, times = profile.path(a, -0.4, 1.1, 0.7), np.linspace(0.05, 0.65, 9)
    for order in range(3):
        slope = (path(times + 1e-6, order) - path(times - 1e-6, order)) / 2e-6
        assert path(times, order + 1) == pytest.approx(slope, rel=1e-6, abs=1e-6)


def test_a_profile_is_called_by_its_name_and_size():
    labels = [_Waves(n).label for n in (1, 2)]
    assert labels == ["waves-of-a-test of 1 coefficient", "waves-of-a-test of 2 coefficients"]


def test_the_motion_of_least_jerk_in_closed_form():
    # Flash and Hogan (1985): x(t) = x0 + (xf - x0)(10 s^3 - 15 s^4 + 6 s^5), s = t/T.
    path = _MinimumJerk(1).path([0.0], -0.2, 1.0, 0.8)
    s = np.linspace(0.0, 1.0, 11)
    shares = [
        10 * s**3 - 15 * s**4 + 6 * s**5,
        30 * s**2 - 60 * s**3 + 30 * s**4,
        60 * s - 180 * s**2 + 120 * s**3,
        60 - 360 * s + 360 * s**2,
    ]
    for order, share in enumerate(shares):
        expected = (order == 0) * -0.2 + 1.2 * share / 0.8**order
        assert path(0.8 * s, order) == pytest.approx(expected, abs=1e-10)


@pytest.mark.parametrize("kind", [*WAVES, _MinimumJerk])
def test_numbers_symbols_and_populations_have_the_same_motion(kind):
    random = np.random.default_rng(3)
    rows, size, move = 3, 4, (-0.4, 1.1, 0.7)
    a = random.uniform(-0.3, 0.3, (rows, size))
    x = random.uniform(0.0, 1.0, (1, 5))
    one_by_one = [kind(size).path(row, *move)(move[2] * x[0], 3) for row in a]
    columns = [ca.repmat(ca.DM(a[:, k]), 1, x.size) for k in range(size)]
    of_numbers = kind(size).motion(columns, ca.DM(np.tile(x, (rows, 1))), *move, jerk=True)
    symbols = [ca.MX.sym("a", rows, x.size) for _ in range(size)]
    fraction = ca.MX.sym("x", rows, x.size)
    of_symbols = kind(size).motion(symbols, fraction, *move, jerk=True)
    function = ca.Function("motion", [*symbols, fraction], [*of_symbols])
    evaluated = function(*columns, np.tile(x, (rows, 1)))
    assert of_numbers.jerk.full() == pytest.approx(np.array(one_by_one), rel=1e-9, abs=1e-9)
    assert evaluated[3].full() == pytest.approx(np.array(one_by_one), rel=1e-9, abs=1e-9)
    assert evaluated[2].full() == pytest.approx(of_numbers.acceleration.full(), rel=1e-12)


@pytest.mark.parametrize(
    ("kind", "linear"),
    [(_Waves, False), (_GivenWaves, False), (_CycloidOfWaves, True), (_MinimumJerk, True)],
)
def test_it_is_seen_whether_the_coefficients_enter_linearly(kind, linear):
    # the Jacobian of what they enter then depends on time alone, and is computed once
    assert Path(kind(4), Mesh(8), False, 1).linear == linear


def test_plans_do_not_depend_on_how_a_profile_is_written(tasks, tmp_path):
    plans = [qa.plan_move(tasks["arm"], kind(5), starts=1) for kind in WAVES]
    for plan in plans:
        assert plan.residual < 1e-8
        judged = qa.JudgedMotion.of_profile(plan.task, plan.profile, plan.coefficients)
        assert plan.motion == judged.motion
        plan.save(tmp_path / "plan.json")
        assert qa.Plan.load(tmp_path / "plan.json") == plan
    for plan in plans[1:]:
        assert plan.energy == pytest.approx(plans[0].energy, rel=1e-6)


def test_both_solvers_plan_with_an_angle_alone(tasks):
    plans = [
        qa.plan_move(tasks["single link"], _MinimumJerk(6), starts=1, solver=solver)
        for solver in (qa.Sqp(), qa.Ipopt())
    ]
    assert plans[0].residual < 1e-8
    assert plans[1].energy == pytest.approx(plans[0].energy, rel=1e-5)


@pytest.mark.parametrize(
    ("factors", "told"),
    [
        ((0.9, 1.0, 1.0), "its angle is .* where that of the method angle is .* in derivatives"),
        ((1.0, 1.1, 1.1), "its speed is .* where the derivative of the angle is"),
        ((1.0, 1.0, 0.5), "its acceleration is .* where the derivative of the speed is"),
        ((1.0, 1.0, math.nan), "its acceleration is nan"),
    ],
)
@pytest.mark.parametrize("base", [_GivenWaves, _CycloidOfWaves])
def test_derivatives_that_are_wrong_give_no_record(tasks, base, factors, told):
    @dataclass(frozen=True)
    class Wrong(base):
        name: ClassVar[str] = "wrong-waves-of-a-test"

        def derivatives(self, coefficients, fraction):
            values = super().derivatives(coefficients, fraction)
            return tuple(f * x for f, x in zip(factors, values, strict=True))

    with pytest.raises(ValueError, match=f"profile 'wrong-waves-of-a-test': {told}"):
        qa.plan_move(tasks["arm"], Wrong(4))
    with pytest.raises(ValueError, match=told):
        qa.evaluate_coefficients(tasks["arm"], [0.0] * 4, profile=Wrong(4))


@pytest.mark.parametrize(
    ("angle", "told"),
    [
        (
            lambda x: 0.9 * x**2 * (3 - 2 * x),
            "its angle is 0.78 at 1 of the duration, where its end",
        ),
        (lambda x: 0.1 + 0.9 * x**2 * (3 - 2 * x), "its angle is -0.18 at 0 of the duration"),
        (lambda x: x, "its speed is .* where rest at both ends is 0; let angle"),
    ],
)
def test_an_angle_that_is_not_from_rest_to_rest_is_refused(tasks, angle, told):
    @dataclass(frozen=True)
    class Wrong(qa.JointProfile):
        name: ClassVar[str] = "wrong-angle-of-a-test"
        size = 1

        def angle(self, coefficients, fraction):
            return angle(fraction)

    # of a move from -0.3 to 0.9 rad: nine tenths of the way end at 0.78, a tenth begins at -0.18
    with pytest.raises(ValueError, match=told):
        qa.plan_move(tasks["arm"], Wrong())


def test_an_input_that_does_not_end_at_one_is_refused(tasks):
    class Short(_CycloidOfWaves):
        name = "short-waves-of-a-test"

        def input(self, coefficients, fraction):
            return 0.9 * fraction

    with pytest.raises(ValueError, match=r"its angle is .* at 1 of the duration.*input"):
        qa.plan_move(tasks["arm"], Short(4))


def test_what_is_planned_is_what_was_checked():
    """A `motion` of its own escaped the check: an acceleration times 0.6 was planned at 0.0186 J,
    below that of any real motion."""

    def slower(self, coefficients, fraction, *move, jerk=False):
        joint = qa.JointProfile.motion(self, coefficients, fraction, *move, jerk=jerk)
        return joint._replace(acceleration=0.6 * joint.acceleration)

    for base in (qa.JointProfile, qa.CycloidPolynomial):
        with pytest.raises(TypeError, match=r"Lighter has its own motion.*; override angle"):
            type("Lighter", (base,), {"motion": slower})
    mixed_in = type("Mixin", (), {"motion": slower})
    with pytest.raises(TypeError, match="its own motion"):
        type("Lighter", (mixed_in, qa.CycloidPolynomial), {})
    with pytest.raises(TypeError, match="its own path"):
        type("Elsewhere", (qa.CycloidPolynomial,), {"path": lambda self, *arguments: None})


def test_a_profile_is_a_value(tasks):
    @dataclass
    class Changing(qa.JointProfile):
        name: ClassVar[str] = "changing-waves-of-a-test"
        size: ClassVar[int] = 4
        angle = _Waves.angle

    with pytest.raises(TypeError, match="Changing has no hash; make its class a frozen dataclass"):
        qa.plan_move(tasks["arm"], Changing())


@dataclass(frozen=True)
class _LighterBeyond(_GivenWaves):
    """Right up to coefficients of 0.5, where the check at random looks; lighter beyond."""

    name: ClassVar[str] = "lighter-beyond-of-a-test"

    def derivatives(self, coefficients, fraction):
        share, rate, bend = super().derivatives(coefficients, fraction)
        return share, rate, bend * ca.if_else(coefficients[0] > 0.5, 0.6, 1.0)


def test_a_motion_is_checked_at_its_own_coefficients(tasks):
    link, told = tasks["single link"], "its acceleration is .* where the derivative of the speed is"
    assert qa.evaluate_coefficients(link, [0.4], profile=_LighterBeyond(1)).energy > 0
    with pytest.raises(ValueError, match=told):
        qa.evaluate_coefficients(link, [0.6], profile=_LighterBeyond(1))
    with pytest.raises(ValueError, match=told):
        qa.JudgedMotion.of_profile(link, _LighterBeyond(1), [0.6])
