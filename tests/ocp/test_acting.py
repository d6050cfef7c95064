"""When a tool may act: the time until the tip stays within a band, against dense sampling."""

import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from robots import straight, ur5_with_bar

import quietarm as qa
from quietarm.models import DualLinkManipulator, JointMotion, SingleLinkManipulator
from quietarm.ocp.acting import (
    act_after_arrival,
    time_to_act,
    time_to_act_by_samples,
    worst_time_to_act,
)
from quietarm.ocp.simulation.free_vibration import FreeVibration

AXIS = qa.LinearAxis(omega1=4.5 * math.tau, zeta1=0.01)
MOVE = qa.PointToPoint(AXIS, target=0.3, duration=0.8)


@pytest.fixture(scope="module")
def cycloid():
    return qa.evaluate_coefficients(MOVE, []).candidate


def last_beyond(times, distances, band):
    return times[np.flatnonzero(distances > band)[-1]]


def test_one_mode_crosses_last_where_its_closed_form_does():
    """The closed form is that of x'' + 2 zeta omega x' + omega^2 x = 0 from x = 1 mm at rest."""
    omega, zeta = AXIS.omega1, AXIS.zeta1
    damped = omega * math.sqrt(1 - zeta**2)
    times = np.linspace(0.0, 12.0, 400_001)
    swing = np.cos(damped * times) + zeta * omega / damped * np.sin(damped * times)
    distances = 1e-3 * np.exp(-zeta * omega * times) * np.abs(swing)
    for band in (1e-4, 3.1e-4, 0.999e-3):
        later = act_after_arrival(FreeVibration(AXIS, 0.3), [1e-3, 0.0], band)
        assert later == pytest.approx(last_beyond(times, distances, band), abs=4e-5)
    assert act_after_arrival(FreeVibration(AXIS, 0.3), [1e-3, 0.0], 1.001e-3) == 0.0


def test_a_peak_between_samples_counts():
    """A swing that passes the band by a billionth acts later than one that keeps it by as much."""
    vibration = FreeVibration(AXIS, 0.3)
    half_period = math.pi / (AXIS.omega1 * math.sqrt(1 - AXIS.zeta1**2))
    second_peak = 1e-3 * math.exp(-AXIS.zeta1 * AXIS.omega1 * half_period)
    beyond = act_after_arrival(vibration, [1e-3, 0.0], second_peak * (1 - 1e-9))
    within = act_after_arrival(vibration, [1e-3, 0.0], second_peak * (1 + 1e-9))
    assert beyond == pytest.approx(half_period, rel=1e-3)
    assert within < 0.1 * half_period


def test_two_tips_and_two_modes_are_followed_to_the_last_crossing():
    vibration = FreeVibration(DualLinkManipulator(), 0.5)
    state = np.array([2e-3, -3e-3, 0.01, 0.02])
    times = np.linspace(0.0, 60.0, 60_001)
    tips = vibration.displacements @ vibration.states(state, times).T
    expected = last_beyond(times, np.abs(tips).max(axis=0), 1e-3)
    assert act_after_arrival(vibration, state, 1e-3) == pytest.approx(expected, abs=1.1e-3)


def test_without_damping_a_tip_beyond_the_band_never_stays_in_it():
    vibration = FreeVibration(replace(AXIS, zeta1=0.0), 0.3)
    assert act_after_arrival(vibration, [1e-3, 0.0], 0.99e-3) == math.inf
    assert act_after_arrival(vibration, [1e-3, 0.0], 1.01e-3) == 0.0


def test_a_mode_that_is_damped_critically_comes_back_once():
    vibration = FreeVibration(replace(AXIS, zeta1=1.0), 0.3)
    omega = AXIS.omega1
    times = np.linspace(0.0, 1.0, 1_000_001)
    distances = 1e-3 * (1 + omega * times) * np.exp(-omega * times)  # in closed form
    later = act_after_arrival(vibration, [1e-3, 0.0], 1e-5)
    assert later == pytest.approx(last_beyond(times, distances, 1e-5), abs=1e-5)


def test_a_motion_at_rest_on_arrival_acts_before_its_end(cycloid):
    """By 20001 samples of carriage and load together, less their place on arrival."""
    plan = qa.plan_move(MOVE)
    for motion, band in ((plan.candidate, 1e-4), (cycloid, 0.02)):
        times = np.linspace(0.0, 0.8, 20_001)[1:]
        sampled = motion.sample(times)
        distances = np.abs(sampled.motion.angle - 0.3 + sampled.tips[:, 0])
        expected = last_beyond(times, distances, band)
        assert time_to_act(motion, band) == pytest.approx(expected, abs=5e-5)
        assert expected < 0.8


def test_a_rotary_tip_is_as_far_as_its_arc_and_its_displacement():
    task = qa.PointToPoint(SingleLinkManipulator(), target=qa.deg(30), duration=0.8)
    # the paper's two terms: they leave 0.05 mm
    motion = qa.evaluate_coefficients(task, [0.003347, -0.1697]).candidate
    times = np.linspace(0.0, 0.8, 8001)[1:]
    sampled = motion.sample(times)
    away = np.abs(0.475 * (sampled.motion.angle - task.target) + sampled.tips[:, 0])
    expected = last_beyond(times, away, 5e-3)  # the plate is 0.475 m long: section 3.1
    assert time_to_act(motion, 5e-3) == pytest.approx(expected, abs=1.1e-4)


def test_a_plant_without_a_place_of_its_tip_acts_on_arrival_at_the_earliest():
    """The lengths of the dual link are not published."""
    task = qa.PointToPoint(DualLinkManipulator(), target=qa.deg(30), duration=0.9)
    motion = qa.evaluate_coefficients(task, []).candidate
    assert time_to_act(motion, 1.01 * motion.residual) == 0.9


@pytest.mark.slow
def test_the_worst_case_is_that_of_a_fine_scan(cycloid):
    errors = np.linspace(-0.05, 0.05, 41)
    for band in (1e-3, 0.02):
        times = [time_to_act(cycloid.perturbed({"frequency": e}), band) for e in errors.tolist()]
        worst = worst_time_to_act(cycloid, band, {"frequency": 0.05})
        assert worst.after >= max(times) - 1e-3
        assert worst.after <= max(times) + 0.3 / 4.5  # a fine scan may miss a half swing's part
        assert time_to_act(cycloid.perturbed(worst.errors), band) == worst.after


def test_samples_say_when_the_last_one_beyond_the_band_was():
    times = np.linspace(0.0, 2.0, 201)
    swing = 1e-3 * np.exp(-3 * times) * np.cos(20 * times)
    fine = np.linspace(0.0, 2.0, 200_001)
    expected = last_beyond(fine, np.abs(1e-3 * np.exp(-3 * fine) * np.cos(20 * fine)), 1e-4)
    assert time_to_act_by_samples(times, swing, 1e-4) == pytest.approx(expected, abs=1e-4)
    assert time_to_act_by_samples(times, 0 * times, 1e-4) == 0.0
    assert time_to_act_by_samples(times, swing + 1e-3, 1e-4) == math.inf
    both = np.array([0.8e-4 + 0 * times, 0.8e-4 + 0 * times])
    assert time_to_act_by_samples(times, both, 1e-4) == 0.0
    assert time_to_act_by_samples(times, both, 1e-4, in_space=True) == math.inf


@pytest.mark.parametrize(
    ("times", "deviations", "words"),
    [([0.0, 1.0, 0.5], [0, 0, 0], "decrease"), ([0.0, 1.0], [0, 0, 0], "shape")],
)
def test_samples_that_fit_no_time_are_refused(times, deviations, words):
    with pytest.raises(ValueError, match=words):
        time_to_act_by_samples(times, deviations, 1e-4)


@pytest.mark.slow
def test_the_tip_of_a_robot_is_followed_in_space_with_its_sag():
    """By the whole robot's own kinematics at rest, at places of its path and a little beyond."""
    plant = ur5_with_bar().along(straight())
    full = plant.in_full
    place, angles = ca.SX.sym("place"), ca.SX.sym("angles", full.springs)
    still = JointMotion(place, ca.SX(0), ca.SX(0))
    tip = ca.Function("tip", [place, angles], [full.tip(still, angles)])
    places = np.array([0.0, 0.31, 0.9, 0.999, 1.0, 1.01])
    rests = np.hstack([tip(at, full.at_rest(at)).full() for at in places.tolist()])
    deviations = plant.tip_deviations(places, np.zeros((plant.tips, 6)), 1.0)
    # the whole equations have other hinges than the plant, which bend a little otherwise
    assert np.abs(deviations - (rests - rests[:, 4:5])).max() < 3e-6
    motion = qa.evaluate_coefficients(plant.task(1.0, 1.0), []).candidate
    assert motion.residual > 1e-3
    times = np.linspace(0.0, 30.0, 300_001)
    vibration = motion.vibration
    swings = vibration.displacements @ vibration.states(motion.arrival[0], times).T
    expected = 1.0 + last_beyond(times, np.linalg.norm(swings, axis=0), 1e-3)
    assert time_to_act(motion, 1e-3) == pytest.approx(expected, abs=2e-4)
