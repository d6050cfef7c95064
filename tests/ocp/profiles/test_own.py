"""A user's own profiles: whichever way the coefficients enter, derivatives and plans are right."""

import math
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np
import pytest
from quietarm.ocp.simulation.grid import Grid
from quietarm.ocp.solvers.node import Path

import quietarm as qa

pi = math.pi


def _cycloid(U, dU, ddU, start, target):
    """Eq (1) and its first two derivatives, from the input and its own."""
    span, turn = target - start, 2 * pi
    sine, cosine = ca.sin(turn * U), ca.cos(turn * U)
    return (
        start + span * (U - sine / turn),
        span * (1 - cosine) * dU,
        span * (turn * sine * dU**2 + (1 - cosine) * ddU),
    )


@dataclass(frozen=True)
class _Waves(qa.JointProfile):
    """U = x + sum_j a_j sin(j pi x), x = t/T: gives `derivatives` only."""

    name: ClassVar[str] = "waves-of-a-test"
    waves: int = 4

    @property
    def size(self):
        return self.waves

    def derivatives(self, coefficients, fraction, start, target, duration):
        U, dU, ddU = fraction, 1 / duration, 0.0
        for j, a in enumerate(coefficients, start=1):
            rate = j * pi / duration
            sine, cosine = ca.sin(j * pi * fraction), ca.cos(j * pi * fraction)
            U, dU = U + a * sine, dU + a * rate * cosine
            ddU = ddU - a * rate**2 * sine
        return _cycloid(U, dU, ddU, start, target)


@dataclass(frozen=True)
class _LinearWaves(_Waves):
    """The same, which says that its coefficients enter U linearly."""

    name: ClassVar[str] = "linear-waves-of-a-test"

    def inner(self, coefficients, fraction, start, target, duration):
        del start, target, duration  # by the fraction: the derivatives by a know nothing of these
        U, dU, ddU = fraction, 1.0, 0.0
        for j, a in enumerate(coefficients, start=1):
            rate, sine = j * pi, ca.sin(j * pi * fraction)
            U, dU = U + a * sine, dU + a * rate * ca.cos(j * pi * fraction)
            ddU = ddU - a * rate**2 * sine
        return U, dU, ddU

    def outer(self, inner, start, target, duration):
        U, dU, ddU = inner
        return qa.JointMotion(*_cycloid(U, dU / duration, ddU / duration**2, start, target))


@pytest.mark.parametrize("profile", [_Waves(4), _LinearWaves(4)], ids=lambda p: p.name)
def test_each_derivative_is_that_of_the_one_before(profile):
    a = np.random.default_rng(0).uniform(-0.3, 0.3, profile.size)
    path, times = profile.path(a, -0.4, 1.1, 0.7), np.linspace(0.05, 0.65, 9)
    for order in range(3):
        slope = (path(times + 1e-6, order) - path(times - 1e-6, order)) / 2e-6
        assert path(times, order + 1) == pytest.approx(slope, rel=1e-6, abs=1e-6)


def test_a_profile_is_called_by_its_name_and_size():
    labels = [_Waves(n).label for n in (1, 2)]
    assert labels == ["waves-of-a-test of 1 coefficient", "waves-of-a-test of 2 coefficients"]


def test_a_profile_says_that_its_coefficients_enter_linearly():
    linear = [Path(kind(4), Grid(8), False, 1).linear for kind in (_Waves, _LinearWaves)]
    assert linear == [False, True]


def test_plans_do_not_depend_on_how_the_coefficients_are_said_to_enter(tasks, tmp_path):
    plans = [qa.plan_move(tasks["arm"], kind(5), starts=1) for kind in (_Waves, _LinearWaves)]
    for plan in plans:
        assert plan.residual < 1e-8
        judged = qa.Candidate.of_profile(plan.task, plan.profile, plan.coefficients)
        assert plan.motion == judged.motion
        plan.save(tmp_path / "plan.json")
        assert qa.Plan.load(tmp_path / "plan.json") == plan
    assert plans[0].energy == pytest.approx(plans[1].energy, rel=1e-6)


@pytest.mark.parametrize(
    ("factors", "told"),
    [
        ((0.9, 0.9, 0.9), "its angle is .* at 1 of the duration"),
        ((1.0, 1.1, 1.1), "its speed is .* where the derivative of the angle is"),
        ((1.0, 1.0, 0.5), "its acceleration is .* where the derivative of the speed is"),
        ((1.0, 1.0, math.nan), "its acceleration is nan"),
    ],
)
def test_a_profile_that_is_wrong_gives_no_record(tasks, factors, told):
    @dataclass(frozen=True)
    class Wrong(_Waves):
        name: ClassVar[str] = "wrong-waves-of-a-test"

        def derivatives(self, coefficients, fraction, start, target, duration):
            angle, *others = super().derivatives(coefficients, fraction, start, target, duration)
            values = angle - start, *others
            angle, *others = (f * x for f, x in zip(factors, values, strict=True))
            return start + angle, *others

    with pytest.raises(ValueError, match=f"profile 'wrong-waves-of-a-test': {told}"):
        qa.plan_move(tasks["arm"], Wrong(4))
    with pytest.raises(ValueError, match=told):
        qa.evaluate_coefficients(tasks["arm"], [0.0] * 4, profile=Wrong(4))


def test_a_profile_that_still_moves_on_arrival_is_refused(tasks):
    @dataclass(frozen=True)
    class Ramp(qa.JointProfile):
        name: ClassVar[str] = "ramp-of-a-test"
        size = 1

        def derivatives(self, coefficients, fraction, start, target, duration):
            span = target - start
            return start + span * fraction, span / duration + 0 * fraction, 0 * fraction

    with pytest.raises(ValueError, match=r"its speed is .* where rest at both ends is 0"):
        qa.plan_move(tasks["arm"], Ramp())


def test_what_is_planned_is_what_was_checked():
    """A `motion` of its own escaped the check: an acceleration times 0.6 was planned at 0.0186 J,
    below that of any real motion."""

    def slower(self, coefficients, fraction, *move, jerk=False):
        joint = qa.JointProfile.motion(self, coefficients, fraction, *move, jerk=jerk)
        return joint._replace(acceleration=0.6 * joint.acceleration)

    for base in (qa.JointProfile, qa.CycloidPolynomial):
        with pytest.raises(TypeError, match=r"Lighter has its own motion.*; override derivatives"):
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
        derivatives = _Waves.derivatives

    with pytest.raises(TypeError, match="Changing has no hash; make its class a frozen dataclass"):
        qa.plan_move(tasks["arm"], Changing())


@dataclass(frozen=True)
class _LighterBeyond(_Waves):
    """Right up to coefficients of 0.5, where the check at random looks; lighter beyond."""

    name: ClassVar[str] = "lighter-beyond-of-a-test"

    def derivatives(self, coefficients, fraction, start, target, duration):
        *angle_and_speed, acceleration = super().derivatives(
            coefficients, fraction, start, target, duration
        )
        return *angle_and_speed, acceleration * ca.if_else(coefficients[0] > 0.5, 0.6, 1.0)


def test_a_motion_is_checked_at_its_own_coefficients(tasks):
    link, told = tasks["single link"], "its acceleration is .* where the derivative of the speed is"
    assert qa.evaluate_coefficients(link, [0.4], profile=_LighterBeyond(1)).energy > 0
    with pytest.raises(ValueError, match=told):
        qa.evaluate_coefficients(link, [0.6], profile=_LighterBeyond(1))
    with pytest.raises(ValueError, match=told):
        qa.Candidate.of_profile(link, _LighterBeyond(1), [0.6])
