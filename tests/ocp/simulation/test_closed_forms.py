"""The independent integrator: closed forms of energy and residual."""

import math
from dataclasses import dataclass
from math import cos, sin

import numpy as np
import pytest

import quietarm as qa
from quietarm.ocp.profiles.free_motion import PiecewiseMotion
from quietarm.ocp.profiles.joint_profile import JointProfile

pi = math.pi
PLAIN = qa.CycloidPolynomial(0)


RIGID = qa.SingleLinkManipulator(alpha1=0.02, alpha2=0.0, c=0.0)
SWINGS = np.polynomial.chebyshev.cheb2poly([0.0] * 8 + [0.2]).tolist()


@pytest.mark.parametrize(("a", "turns"), [([0.3, 0.4], 1), (SWINGS, 8)])
def test_braking_costs_as_much_as_driving(a, turns):
    # A rigid body that overshoots: every change of the kinetic energy alpha1 theta'^2/2 is paid,
    # between the extremes of the speed and its zeros.
    task, profile = qa.PointToPoint(RIGID, 1.0, 0.8), qa.CycloidPolynomial(len(a))
    path, grid = profile.path(a, *task.move), np.linspace(0, 0.8, 250_001)
    speed = path(grid, 1)
    kinetic = 0.02 * speed**2 / 2
    motion = qa.JudgedMotion.of_profile(task, profile, a).motion
    assert np.abs(np.diff(np.sign(speed[1:-1]))).sum() / 2 >= turns  # back and forth on the way
    assert motion.energy == pytest.approx(np.abs(np.diff(kinetic)).sum(), rel=1e-9)
    assert motion.net_work == pytest.approx(0.0, abs=1e-10)
    assert motion.overshoot == pytest.approx(path(grid[::25]).max() - 1.0, abs=1e-5)


@dataclass(frozen=True)
class _InPowers(JointProfile):
    """theta from the start to the target along a polynomial of t/T, without coefficients."""

    powers: tuple[float, ...]

    @property
    def size(self):
        return 0

    def angle(self, coefficients, fraction):
        share = 0 * fraction
        for power in reversed(self.powers):
            share = share * fraction + power
        return share


def test_a_power_that_is_exactly_zero_at_a_sample_parts_the_work():
    # theta' = 6 f (1 - f) span/T with f = t/T: a rigid body's power is 0 at f = 1/2, where its
    # speed is 3/2 span/T. Starting and stopping each cost alpha1 theta'^2/2.
    rigid = qa.SingleLinkManipulator(alpha1=0.02, alpha2=0.0, c=0.0)
    motion = qa.JudgedMotion.of_profile(
        qa.PointToPoint(rigid, 0.7, 1.0), _InPowers((0.0, 0.0, 3.0, -2.0)), []
    ).motion
    assert motion.energy == pytest.approx(0.02 * (1.5 * 0.7) ** 2, rel=1e-9)


def test_every_sign_change_of_a_long_ringing_move_is_found():
    # theta'' = A from the first moment on: W'' = -beta1 A cos(omega t), and with alpha1 = c = 0
    # the power is -alpha2 beta1 A^2 t cos(omega t): 477 sign changes in 1500 radians.
    omega, T, span = 50.0, 30.0, 700.0
    plant = qa.SingleLinkManipulator(
        omega=omega, zeta=0.0, beta2=0.0, alpha1=0.03, alpha2=0.1, beta1=0.25, c=0.0
    )
    with pytest.warns(UserWarning, match="700 rad, more than a turn; were degrees meant"):
        task = qa.PointToPoint(plant, span, T)
    given = qa.JudgedMotion(task, PiecewiseMotion.of_profile(task, _InPowers((0.0, 0.0, 1.0)), []))
    motion = given.perturbed({"alpha1": -1.0}).motion  # no plant has alpha1 = 0
    zeros = np.arange(pi / 2, omega * T, pi) / omega
    t = np.array([0.0, *zeros, T])
    primitive = t * np.sin(omega * t) / omega + np.cos(omega * t) / omega**2
    expected = 0.1 * 0.25 * (2 * span / T**2) ** 2 * np.abs(np.diff(primitive)).sum()
    # CVODES at 1e-11 a step has lost 2e-6 after 240 periods.
    assert motion.energy == pytest.approx(expected, rel=5e-6)


@pytest.mark.parametrize("omega", [10.0, 300.0])
def test_the_residual_of_an_undamped_arm_is_its_amplitude(omega):
    # The closed form of W, W' at arrival (see test_rollout): F1 = phi sqrt(W^2 + (W'/omega)^2).
    span, T = pi / 6, 0.8
    plant = qa.SingleLinkManipulator(omega=omega, zeta=0.0, beta2=0.0)
    drive = 2 * pi / T
    gain = -2.555e-1 * (2 * pi * span / T**2) / (omega**2 - drive**2)
    W, dW = -gain * drive / omega * sin(omega * T), gain * drive * (1 - cos(omega * T))
    motion = qa.JudgedMotion.of_profile(qa.PointToPoint(plant, span, T), PLAIN, []).motion
    # Samples miss 1.2e-6 of a peak at most.
    assert motion.residual == pytest.approx(2.28 * math.hypot(W, dW / omega), rel=2e-6)
