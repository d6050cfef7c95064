"""The one simulation: closed forms, accuracy at the default steps, populations, symmetries."""

import math

import casadi as ca
import numpy as np
import pytest
from fixed_steps import rollout

import quietarm as qa
from quietarm.ocp import ModalState, symbolic_rollout
from quietarm.ocp.simulation.collocation import GAUSS_NODES, GAUSS_WEIGHTS, NODES

pi = math.pi
PLAIN = qa.CycloidPolynomial(0)


def _undamped(omega, **changes):
    return qa.SingleLinkManipulator(omega=omega, zeta=0.0, beta2=0.0, **changes)


@pytest.mark.parametrize("omega", [10.43, 25.0])
def test_an_undamped_oscillator_driven_by_the_plain_cycloid(omega):
    # W'' + omega^2 W = -beta1 theta'', theta'' = A sin(O t), O = 2 pi/T, A = 2 pi span/T^2:
    # W = -beta1 A/(omega^2 - O^2) (sin(O t) - O/omega sin(omega t)).
    span, T = pi / 6, 0.8
    O, A = 2 * pi / T, 2 * pi * span / T**2  # noqa: E741
    gain = -2.555e-1 * A / (omega**2 - O**2)
    W = -gain * O / omega * math.sin(omega * T)
    dW = gain * O * (1 - math.cos(omega * T))
    arrival = rollout(qa.PointToPoint(_undamped(omega), span, T), PLAIN, []).arrival
    assert arrival == pytest.approx([W, dW], rel=1e-9, abs=1e-10)


def test_an_initial_state_decays_beside_the_move():
    # The equations are linear without beta2: what is added at the start turns as W + i W'/omega.
    plant, T, omega = _undamped(10.43), 0.8, 10.43
    still, ringing = (
        rollout(qa.PointToPoint(plant, pi / 6, T, initial=state), PLAIN, []).arrival
        for state in (None, ModalState((0.01,), (0.2,)))
    )
    cosine, sine = math.cos(omega * T), math.sin(omega * T)
    added = [0.01 * cosine + 0.2 / omega * sine, 0.2 * cosine - 0.01 * omega * sine]
    assert ringing - still == pytest.approx(added, rel=1e-7)


def test_energy_of_a_rigid_body_is_what_it_takes_to_start_and_to_stop():
    # torque = alpha1 theta'': alpha1 v^2/2 to start and again to stop, v = 2 span/T halfway.
    rigid = qa.SingleLinkManipulator(alpha1=0.02, alpha2=0.0, c=0.0)
    motion = rollout(qa.PointToPoint(rigid, pi / 6, 0.8), PLAIN, []).motion
    assert motion.energy == pytest.approx(0.02 * (2 * (pi / 6) / 0.8) ** 2, rel=1e-9)
    assert motion.net_work == pytest.approx(0.0, abs=1e-12)
    # alpha1 times the largest theta'' = 2 pi span/T^2.
    assert motion.peak_torque == pytest.approx(0.02 * 2 * pi * (pi / 6) / 0.8**2, rel=1e-4)


@pytest.mark.parametrize("name", ["single link", "arm", "two links"])
def test_the_jerk_of_the_plain_cycloid_is_largest_at_both_ends(tasks, name):
    # Eq (1) with U = t/T: theta''' = 4 pi^2 span/T^3 cos(2 pi t/T).
    peak = 4 * pi**2 * abs(tasks[name].span) / tasks[name].duration ** 3
    exact = qa.JudgedMotion.of_profile(tasks[name], PLAIN, []).motion
    for motion in (exact, rollout(tasks[name], PLAIN, []).motion):
        assert motion.peak_jerk == pytest.approx(peak, rel=1e-12)


def test_energy_of_friction_alone():
    # torque = c theta': c span^2/T^2 times the integral of (1 - cos)^2, 3/2 T; all of it is lost.
    friction = qa.SingleLinkManipulator(alpha1=1e-30, alpha2=0.0, c=0.03)
    motion = rollout(qa.PointToPoint(friction, pi / 6, 0.8), PLAIN, []).motion
    assert motion.energy == pytest.approx(1.5 * 0.03 * (pi / 6) ** 2 / 0.8, rel=1e-12)
    assert motion.net_work == pytest.approx(motion.energy, rel=1e-12)


# -- accuracy at the default steps (docs/accuracy.md) --

BOXES = {"single link": 0.2, "arm": 0.5}
"""Eqs (12) and (17)."""
CONDITIONS = [
    # Tables 3 and 6: start, target, duration.
    ("single link", 0.0, pi / 6, 0.8),
    ("single link", 0.0, pi / 2, 1.1),
    ("arm", 0.0, pi / 2, 0.8),
    ("arm", -pi / 2, pi / 2, 1.2),
]


@pytest.mark.parametrize(("name", "start", "target", "duration"), CONDITIONS)
def test_default_steps_are_as_accurate_as_stated(plants, name, start, target, duration):
    # F2 within 1e-5 relative and W at arrival within 1e-7 m of CVODES, coefficients in the box.
    task = qa.PointToPoint(plants[name], target, duration, start=start)
    random, profile, box = np.random.default_rng(20), qa.CycloidPolynomial(6), BOXES[name]
    inside, corners = random.uniform(-box, box, (4, 6)), random.choice([-box, box], (2, 6))
    energy, arrival = [], []
    for a in np.vstack([inside, corners]):
        fixed = rollout(task, profile, a)
        reference = qa.JudgedMotion.of_profile(task, profile, a)
        energy.append(abs(fixed.motion.energy / reference.energy - 1))
        W = slice(task.plant.modes)
        arrival.append(np.abs(reference.arrival[0, W] - fixed.arrival[W]).max())
    assert max(energy) < 1e-5
    assert max(arrival) < 1e-7


@pytest.mark.parametrize("name", ["single link", "arm", "two links"])
def test_the_diagnostics_are_those_of_the_other_integrator(tasks, name):
    a = [0.02, -0.15, 0.05, -0.1]
    fixed = rollout(tasks[name], qa.CycloidPolynomial(4), a).motion
    reference = qa.JudgedMotion.of_profile(tasks[name], qa.CycloidPolynomial(4), a).motion
    assert fixed.net_work == pytest.approx(reference.net_work, rel=1e-7)
    # Sampling misses 5e-5 of a peak at most (`residual`), beside 1e-7 m of the state.
    assert fixed.residual == pytest.approx(reference.residual, rel=6e-5, abs=1e-6)
    for quantity in ("torque", "speed", "acceleration", "deflection"):
        # Sampled at different times: a smooth peak differs in second order of the spacing.
        assert fixed.peak(quantity) == pytest.approx(reference.peak(quantity), rel=1e-4)


def test_the_error_falls_with_the_sixth_power_of_the_step():
    # Gauss with three nodes is of order six: a factor 64 for half the step.
    task = qa.PointToPoint(qa.ArmOnFlexibleLink(), pi / 2, 0.8)
    a, profile = [-0.1, -0.4], qa.CycloidPolynomial(2)
    exact = np.array(rollout(task, profile, a, steps=320).arrival)
    errors = [np.abs(rollout(task, profile, a, steps=k).arrival - exact).max() for k in (20, 40)]
    assert errors[0] / errors[1] == pytest.approx(64, rel=0.25)


@pytest.mark.parametrize("power", range(2 * NODES))
def test_the_weights_integrate_up_to_degree_five_exactly(power):
    integral = sum(w * x**power for w, x in zip(GAUSS_WEIGHTS, GAUSS_NODES, strict=True))
    assert integral == pytest.approx(1 / (power + 1), abs=1e-15)


@pytest.mark.parametrize("profile", [qa.CycloidPolynomial(6), qa.CycloidSpline(6)])
def test_a_rollout_needs_all_coefficients_of_its_profile(tasks, profile):
    task = tasks["arm"]
    with pytest.raises(ValueError, match="got 5 coefficients for a profile of 6; give one each"):
        symbolic_rollout(task.plant, profile, ca.SX.sym("a", 5), task.move, 20)


def test_the_weights_of_a_rollout_sum_to_the_duration(tasks):
    task, profile = tasks["arm"], qa.CycloidPolynomial(2)
    motion = symbolic_rollout(task.plant, profile, ca.DM([-0.1, -0.4]), task.move, 20)
    assert sum(float(ca.sum2(one)) for one in motion.weights) == pytest.approx(
        task.duration, rel=1e-12
    )
    broken = symbolic_rollout(task.plant, profile, [0.0, 0.0], task.move, 20, breaks=(0.5,))
    assert (motion.unbroken, broken.unbroken) == (True, False)
