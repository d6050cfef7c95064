"""Baselines at their own shortest duration, and motions by the time to act."""

import math
from dataclasses import replace
from math import pi

import numpy as np
import pytest

from quietarm.models import LinearAxis
from quietarm.ocp import CopperLoss, ModalState, PointToPoint, evaluate_coefficients
from quietarm.ocp.acting import time_to_act
from quietarm.ocp.profiles.shaped_cycloid import extra_insensitive
from quietarm.studies.compare import compare_plans
from quietarm.studies.compare.baselines import EVERY, baseline, fastest_baseline
from quietarm.studies.compare.plan_comparison import plans_report
from quietarm.studies.compare.s_curves import bounds_of, s_curve, tuned_s_curve

AXIS = LinearAxis(omega1=2 * pi * 4.5, zeta1=0.007, mass=82.7, load=15.0, friction=50.0)
LIMITS = {"speed_limit": 1.5, "acceleration_limit": 7.0, "jerk_limit": 150.0, "torque_limit": 780.0}
MOVE = PointToPoint(AXIS, 0.8, 1.2, **LIMITS)
BAND = replace(MOVE, band=1e-4)


def duration_of(moved):
    return (moved.task if hasattr(moved, "path") else moved.candidate.task).duration


def test_the_s_curve_is_as_fast_as_its_limits_allow():
    """Seven phases: way over speed, speed over acceleration, and acceleration over jerk."""
    free = s_curve(MOVE, bounds_of(MOVE))
    assert free.times[-1] == pytest.approx(0.8 / 1.5 + 1.5 / 7 + 7 / 150, rel=1e-9)
    places, speeds = free.boundaries(0.0)
    assert (places[-1], speeds[-1]) == pytest.approx((0.8, 0.0), abs=1e-12)
    assert np.abs(free.acceleration).max() == pytest.approx(7.0)


def test_ruckig_finds_the_same_motion():
    pytest.importorskip("ruckig")
    ours, theirs = (fastest_baseline(name, MOVE) for name in ("zv-s-curve", "zv-ruckig"))
    assert duration_of(ours) == pytest.approx(duration_of(theirs), rel=1e-9)
    assert ours.energy == pytest.approx(theirs.energy, rel=1e-6)


@pytest.mark.parametrize("duration", [None, 1.2])
def test_the_tuned_s_curve_keeps_its_limits_and_leaves_an_undamped_mode_at_rest(duration):
    move = replace(MOVE, plant=replace(AXIS, zeta1=0.0))
    free = tuned_s_curve(move, bounds_of(move), duration)
    places, speeds = free.boundaries(0.0)
    assert places[-1] == pytest.approx(0.8, abs=1e-9)
    assert np.abs(speeds).max() <= 1.5 * (1 + 1e-6)
    assert np.abs(free.acceleration).max() <= 7 * (1 + 1e-6)
    assert np.abs(free.jerk).max() <= 150 * (1 + 1e-6)
    assert duration is None or free.times[-1] == pytest.approx(duration, abs=1e-9)
    # the cruise of 0.8/1.5 s, a ramp of one period, and the rounding of 150 m/s^3 between them
    least = 0.8 / 1.5 + 1 / 4.5 + 1.5 * 4.5 / 150
    assert duration or free.times[-1] == pytest.approx(least, rel=1e-6)
    motion = (
        baseline("tuned-s-curve", move) if duration else fastest_baseline("tuned-s-curve", move)
    )
    unshaped = baseline("s-curve", move) if duration else fastest_baseline("s-curve", move)
    assert motion.residual < 1e-3 * unshaped.residual


def test_where_the_torque_counts_accelerations_are_reduced_until_it_holds():
    weak = replace(MOVE, torque_limit=500.0)
    strong = fastest_baseline("s-curve", MOVE)
    slow = fastest_baseline("s-curve", weak)
    assert strong.figures.peak_torque > 500 * 1.01
    assert slow.figures.peak_torque <= 500 * 1.001
    assert slow.figures.peak_torque > 500 * 0.98
    assert duration_of(slow) > 1.02 * duration_of(strong)


@pytest.mark.slow
def test_a_baseline_that_keeps_a_limit_at_no_duration_says_so():
    # the load swings by 5 mm when the move begins
    swinging = replace(BAND, initial=ModalState((5e-3,), (0.0,)), deflection_limit=2e-3)
    (judged,) = compare_plans({}, ["s-curve"], task=swinging)
    assert "it passes the limit of deflection even with a thousandth of the accel" in judged.why
    assert judged.why in plans_report(BAND, [judged]).markdown()


def test_ei_lets_the_share_pass_that_it_is_asked_for():
    """The residual of EI's impulses at its frequency, as a share of that of one impulse."""
    omega = 2 * pi * 4.5
    amplitudes, times = extra_insensitive(omega, 0.0, 0.013)
    left = abs(sum(a * np.exp(1j * omega * t) for a, t in zip(amplitudes, times, strict=True)))
    assert left == pytest.approx(0.013, rel=1e-9)


@pytest.fixture(scope="module")
def judged():
    plans = {"cycloid plan": evaluate_coefficients(BAND, [])}
    names = ["zvd-s-curve", "ei-band-s-curve"]
    return compare_plans(plans, names, {"frequency": 0.05})


def test_times_to_act_are_those_of_the_motion_at_each_error(judged):
    zvd = next(one for one in judged if one.name == "zvd-s-curve")
    motion = fastest_baseline("zvd-s-curve", MOVE)
    signs = [motion.perturbed({"frequency": error}) for error in (-0.05, 0.05)]
    assert zvd.acting.at[0.05] == pytest.approx(max(time_to_act(one, 1e-4) for one in signs))
    assert zvd.acting.at[0.0] == pytest.approx(time_to_act(motion, 1e-4))
    assert set(zvd.acting.at) == {0.0, 0.02, 0.05, 0.1}
    assert zvd.acting.latest.after >= max(zvd.acting.at[e] for e in (0.0, 0.02, 0.05))
    assert zvd.duration == pytest.approx(duration_of(motion))
    # the integral of the squared force is the copper loss of a motor constant of 1
    loss = motion.on(replace(motion.task, energy=CopperLoss(1.0))).energy
    assert zvd.rms_torque**2 * zvd.duration == pytest.approx(loss, rel=1e-6)


def test_ei_of_the_band_leaves_a_third_of_it_and_acts_within_the_range(judged):
    ei = next(one for one in judged if one.name == "ei-band-s-curve")
    assert ei.acting.left[0.0] < 1e-4 / 3
    assert ei.acting.latest.after < ei.duration


def test_the_answer_names_who_acts_first_and_the_best_of_the_others(judged):
    report = plans_report(BAND, judged)
    text = " ".join(report.markdown().split())
    best = min(judged, key=lambda one: one.acting.latest.after)
    assert f" {best.name} may act first, after " in text
    assert ", within 0.1 mm for frequency errors up to 5 %" in text
    assert "the first of the plans is cycloid plan, " in text
    table = report.tables["motions"].set_index("motion")
    columns = ["acts after [s] at 5 %", "acts after [s] within the errors", "residual [mm] at 5 %"]
    assert set(columns) <= set(table.columns)


@pytest.mark.slow
def test_the_picture_names_at_most_five_curves_at_their_ends(judged):
    more = [*judged, *(replace(judged[-1], name=f"again {k}") for k in range(4))]
    (axes,) = plans_report(BAND, more).figures["motions.png"]().axes
    curves = [line for line in axes.get_lines() if not line.get_label().startswith("_")]
    named = {text.get_text() for text in axes.texts}
    assert len(curves) == 5
    assert {line.get_label() for line in curves} <= named


def test_a_plant_that_does_not_vibrate_has_no_frequency_to_err_in():
    still = replace(BAND, plant=replace(AXIS, zeta1=1.5))
    with pytest.raises(ValueError, match="has no frequency to err in: nothing of it vibrates"):
        compare_plans({}, ["s-curve"], task=still)


def test_without_limits_no_duration_is_the_shortest():
    free = PointToPoint(AXIS, 0.8, 1.2, band=1e-3)
    with pytest.raises(ValueError, match="the move has no limits, so that no time is the shortest"):
        compare_plans({}, ["zv"], task=free, durations="own")
    (judged,) = compare_plans({}, ["zv"], task=free)
    assert judged.duration == 1.2


def test_both_durations_have_a_row_each():
    judged = compare_plans({}, ["zv-s-curve"], task=BAND, durations="both")
    assert [one.name for one in judged] == ["zv-s-curve", "zv-s-curve in 1.2 s"]
    assert judged[0].duration < judged[1].duration == 1.2


@pytest.mark.slow
def test_every_baseline_has_a_row_or_a_reason():
    pytest.importorskip("ruckig")
    pytest.importorskip("toppra")
    judged = compare_plans({}, ["all"], task=BAND, durations="own")
    assert [one.name for one in judged] == list(EVERY)
    assert [one.name for one in judged if one.why] == []
    assert all(math.isfinite(one.acting.latest.after) for one in judged)
    kept = {one.name: one.exceeded for one in judged if one.exceeded}
    assert kept == {"toppra": ("jerk",)}
