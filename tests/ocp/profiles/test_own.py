"""A user's own profiles: whichever way the coefficients enter, derivatives and plans are right."""

import math
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np
import pytest
from quietarm.models import JointMotion
from quietarm.ocp import JointProfile, Plan, PointToPoint, plan_move, resimulate, rollout
from quietarm.ocp.program.batch import batch

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
class _Waves(JointProfile):
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
        del start, target
        U, dU, ddU = fraction, 1 / duration, 0.0
        for j, a in enumerate(coefficients, start=1):
            rate, sine = j * pi / duration, ca.sin(j * pi * fraction)
            U, dU = U + a * sine, dU + a * rate * ca.cos(j * pi * fraction)
            ddU = ddU - a * rate**2 * sine
        return U, dU, ddU

    def outer(self, inner, start, target, duration):
        del duration
        return JointMotion(*_cycloid(*inner, start, target))


@dataclass(frozen=True)
class _Neurons(JointProfile):
    """U = t/T + (1 - T^2) sum_j v_j tanh(k_j T + b_j), T = -1 + 2 t/TE: `inner` is not linear.

    A network in the place of the polynomial, as in docs/physics.md, 'Comparators named by the
    paper'. Coefficients are v, k, b of one neuron after another, k about 1.
    """

    name: ClassVar[str] = "neurons-of-a-test"
    neurons: int = 2

    @property
    def size(self):
        return 3 * self.neurons

    def _input(self, coefficients, fraction, duration):
        T, rate = 2 * fraction - 1, 2 / duration
        p = dp = ddp = 0.0
        for j in range(self.neurons):
            v, k, b = coefficients[3 * j : 3 * j + 3]
            k = k + 1 + j
            y = ca.tanh(k * T + b)
            slope = 1 - y * y  # and its own derivative is -2 y slope
            p, dp = p + v * y, dp + v * k * slope
            ddp = ddp - 2 * v * k**2 * y * slope
        bump = 1 - T * T
        return (
            fraction + bump * p,
            1 / duration + rate * (bump * dp - 2 * T * p),
            rate**2 * (bump * ddp - 4 * T * dp - 2 * p),
        )

    def derivatives(self, coefficients, fraction, start, target, duration):
        return _cycloid(*self._input(coefficients, fraction, duration), start, target)

    def inner(self, coefficients, fraction, start, target, duration):
        del start, target
        return self._input(coefficients, fraction, duration)

    def outer(self, inner, start, target, duration):
        del duration
        return JointMotion(*_cycloid(*inner, start, target))


PROFILES = {"waves": _Waves(4), "linear waves": _LinearWaves(4), "neurons": _Neurons(2)}


@pytest.fixture(params=PROFILES)
def profile(request):
    return PROFILES[request.param]


def _coefficients(profile, seed=0):
    return np.random.default_rng(seed).uniform(-0.3, 0.3, profile.size)


# -- the profile itself --


def test_the_layers_give_the_motion_of_the_derivatives(profile):
    a, times = _coefficients(profile), ca.DM(np.linspace(0.0, 1.0, 21))
    move = (-0.4, 1.1, 0.7)
    inner = profile.inner(list(a), times, *move)
    for layered, direct in zip(
        profile.outer(inner, *move)[:3], profile.motion(list(a), times, *move)[:3], strict=True
    ):
        assert layered.full() == pytest.approx(direct.full(), rel=1e-12, abs=1e-12)


def test_each_derivative_is_that_of_the_one_before(profile):
    path, times = profile.path(_coefficients(profile), -0.4, 1.1, 0.7), np.linspace(0.05, 0.65, 9)
    for order in range(3):
        slope = (path(times + 1e-6, order) - path(times - 1e-6, order)) / 2e-6
        assert path(times, order + 1) == pytest.approx(slope, rel=1e-6, abs=1e-6)


# -- derivatives by the coefficients --


@pytest.mark.parametrize("name", ["arm", "two links"])
def test_derivatives_are_the_limit_of_differences(plants, profile, name):
    made = batch(plants[name], profile, 6, ("torque", "jerk"))
    random, h, count = np.random.default_rng(3), 1e-5, made.parts[-1][1].stop
    move, none, sharp = np.array([[-0.4, 1.1, 0.7]]), np.zeros((1, 0)), np.zeros(1)
    of_states, of_values = (random.normal(size=(1, n)) for n in (2 * made.kind.plant.modes, count))
    at = _coefficients(profile)

    def found(away):
        weights = sharp, of_states, of_values
        return made.derivatives((at + away)[None], move, none, sharp, weights)

    def gradient(one):
        return of_states @ one.by_arrival[0] + of_values @ one.by_limited[0]

    here, away = found(0.0), [[found(s * h * e) for s in (1, -1)] for e in np.eye(profile.size)]
    for n, (there, back) in enumerate(away):
        for value, slope in (
            ("energy", here.gradient[0, n]),
            ("arrival", here.by_arrival[0, :, n]),
            ("limited", here.by_limited[0, :, n]),
        ):
            expected = (getattr(there, value)[0] - getattr(back, value)[0]) / (2 * h)
            assert slope == pytest.approx(expected, abs=1e-6 * np.abs(expected).max())
        expected = (gradient(there) - gradient(back)).ravel() / (2 * h)
        size = np.abs(here.curvature).max()
        assert here.curvature[0, n] == pytest.approx(expected, abs=1e-6 * size)


# -- plans --


@pytest.mark.parametrize("residual_limit", [0.0, 1e-3])
def test_a_plan_of_neurons_is_a_minimum(tasks, residual_limit):
    task, profile = tasks["single link"], _Neurons(2)
    plan = plan_move(task, profile, residual_limit=residual_limit, bound=1.0, starts=1)
    assert plan.residual <= max(residual_limit * (1 + 1e-6), 1e-8)
    # docs/physics.md: the plain cycloid's 0.09115 J, with 3.382e-2 m of residual max |W|.
    assert plan.energy < 0.09115
    assert np.abs(plan.coefficients).max() <= 1.0 + 1e-7
    # Bound or not, no step along which the state on arrival stays costs less.
    steps, h, at = plan.verification.steps, 1e-6, np.array(plan.coefficients)

    def simulated(a):
        return rollout(task, profile, a, steps=steps)

    jacobian = np.column_stack([
        np.subtract(simulated(at + h * e).arrival, simulated(at - h * e).arrival) / (2 * h)
        for e in np.eye(profile.size)
    ])  # fmt: skip
    random, best = np.random.default_rng(4), simulated(at)
    for _ in range(20):
        away = random.normal(size=profile.size)
        away -= np.linalg.lstsq(jacobian, jacobian @ away)[0]
        a = at + 1e-3 * away / np.linalg.norm(away)
        for _ in range(5):
            a -= np.linalg.lstsq(jacobian, np.subtract(simulated(a).arrival, best.arrival))[0]
        if np.abs(a).max() <= 1.0:
            assert simulated(a).motion.energy >= best.motion.energy * (1 - 1e-6)


@pytest.mark.parametrize("profile", [_Waves(5), _LinearWaves(5), _Neurons(2)], ids=lambda p: p.name)
@pytest.mark.parametrize("name", ["arm"])
def test_a_users_profile_is_planned_with_and_kept(tasks, tmp_path, name, profile):
    # A bound, since neurons that cancel each other may otherwise grow for ever.
    plan = plan_move(tasks[name], profile, starts=1, bound=1.0)
    assert plan.residual < 1e-8
    assert plan.motion == resimulate(plan.task, plan.profile, plan.coefficients)
    plan.save(tmp_path / "plan.json")
    assert Plan.load(tmp_path / "plan.json") == plan


def test_limits_hold_for_a_profile_whose_coefficients_enter_nonlinearly(tasks):
    task = tasks["arm"]
    free = plan_move(task, _Neurons(2), starts=1, bound=1.0)
    limit = 0.95 * free.motion.peak_torque
    limited = PointToPoint(task.plant, task.target, task.duration, torque_limit=limit)
    plan = plan_move(limited, _Neurons(2), starts=1, bound=1.0)
    assert plan.motion.peak_torque <= limit * (1 + 1e-6)
    assert plan.residual < 1e-8
    assert plan.energy > free.energy
