"""Plans of one move beside shapers and ruckig, on the nominal plant and under errors."""

import math
import re
import sys
from dataclasses import replace
from math import pi

import numpy as np
import pytest
from matplotlib.colors import to_hex

from quietarm.models import Drive, FlexibleBeam, JointMotion, LinearAxis, SingleLinkManipulator
from quietarm.ocp import PointToPoint, Uncertainty, evaluate_coefficients, plan_move
from quietarm.ocp.profiles.free_motion import FreeMotion
from quietarm.ocp.profiles.shaped_cycloid import SHAPERS
from quietarm.studies.compare import compare_plans
from quietarm.studies.compare.baselines import ruckig_motion, shaped
from quietarm.studies.compare.plan_comparison import plans_report
from quietarm.studies.compare.toppra_motion import toppra_motion

BEAM = FlexibleBeam(omega=2 * pi * 3.2, zeta=0.01)
MOVE = PointToPoint(BEAM, pi / 3, 0.7, torque_limit=1.5, acceleration_limit=80.0)
ROBUST = replace(MOVE, uncertainty=Uncertainty({"frequency": 0.08}))
BASELINES = ("cycloid", "zvd", "3hump-ei", "ruckig", "zvd-ruckig", "3hump-ei-ruckig")


@pytest.fixture(scope="module")
def judged():
    plans = {"plan": plan_move(MOVE, starts=1), "robust": plan_move(ROBUST, starts=1)}
    return compare_plans(plans, BASELINES, samples=200)


@pytest.fixture(scope="module")
def found(judged):
    return {one.name: one for one in judged}


@pytest.mark.slow
def test_each_motion_has_its_worst_case_within_the_errors_of_the_plans(found):
    assert list(found) == ["plan", "robust", *BASELINES]
    for one in found.values():
        assert (one.motion is None) == bool(one.why)
        if one.motion:
            assert one.worst.residual >= one.motion.residual * (1 - 1e-6)
            assert abs(one.worst.errors["frequency"]) <= 0.08
    assert found["robust"].worst.residual < found["plan"].worst.residual / 5
    # its impulses take two periods of 0.3125 s, and the rest is too short for 60 degrees
    assert re.match(r"within the limits it takes 0\.\d+ s", found["3hump-ei-ruckig"].why)


@pytest.mark.slow
def test_the_worst_case_is_that_of_a_fine_grid_by_cvodes(found):
    plan = found["zvd"]
    shaper = compare_plans({}, ["zvd"], {"frequency": 0.08}, 0, task=MOVE)[0]
    candidate = evaluate_coefficients(MOVE, [], profile=_profile("zvd")).candidate
    grid = [candidate.perturbed({"frequency": e}).residual for e in np.linspace(-0.08, 0.08, 33)]
    assert shaper.worst.residual == plan.worst.residual
    assert plan.worst.residual == pytest.approx(max(grid), rel=1e-3)


def _profile(shaper):
    from quietarm.ocp import shaped_cycloid

    return shaped_cycloid(MOVE, shaper)


@pytest.mark.slow
def test_a_limit_is_exceeded_beyond_a_thousandth(found):
    # the shaper leaves a tenth of a second for 60 degrees
    assert found["3hump-ei"].exceeded == ("acceleration",)
    assert found["3hump-ei"].motion.peak_acceleration > 80 * 1.001
    assert found["ruckig"].exceeded == ()
    assert found["ruckig"].motion.peak_acceleration == pytest.approx(80, rel=1e-6)


@pytest.mark.slow
def test_the_report_has_a_row_for_each_and_says_what_is_missing(judged):
    report = plans_report(MOVE, judged)
    table = report.tables["motions"].set_index("motion")
    assert table.loc["zvd-ruckig", "worst case [mm]"] == pytest.approx(1.308, rel=1e-3)
    assert "- 3hump-ei-ruckig: within the limits" in report.markdown()
    figure = report.figures["motions.png"]()
    assert [ax.get_xlabel() for ax in figure.axes][1:] == ["error of frequency [%]"]


def test_the_picture_names_five_motions_at_most_beside_their_curves_without_a_legend():
    kinds = ["cycloid", "zv", "zvd", "mzv", "ei", "2hump-ei", "3hump-ei"]
    judged = compare_plans({}, kinds, task=replace(MOVE, duration=1.4))
    figure = plans_report(MOVE, judged).figures["motions.png"]()
    (ax,) = figure.axes
    assert (figure.legends, ax.get_legend()) == ([], None)
    names = [line.get_label() for line in ax.get_lines() if line.get_label()[0] != "_"]
    assert sorted(text.get_text() for text in ax.texts) == sorted(names)
    assert len(names) == 5
    colours = {line.get_label(): to_hex(line.get_color()) for line in ax.get_lines()}
    assert all(to_hex(text.get_color()) == colours[text.get_text()] for text in ax.texts)


def test_plans_of_another_move_are_refused(plan, cycloid):
    other = evaluate_coefficients(replace(plan.task, duration=0.9), [])
    with pytest.raises(ValueError, match=r"other is of another move than ours: its duration is"):
        compare_plans({"ours": plan, "other": other})
    limited = evaluate_coefficients(replace(plan.task, torque_limit=0.5), [])
    assert len(compare_plans({"ours": plan, "limited": limited})) == 2


def test_ruckig_is_followed_exactly_and_keeps_its_limits():
    task = replace(MOVE, speed_limit=2.5, jerk_limit=4000.0)
    free = ruckig_motion(task)
    angle, speed = free.boundaries(task.start)
    assert free.times[-1] == pytest.approx(0.7)
    assert angle[-1] == pytest.approx(pi / 3, abs=1e-9)
    assert speed[-1] == pytest.approx(0, abs=1e-9)
    assert np.abs(speed).max() <= 2.5 * (1 + 1e-9)
    assert np.abs(free.jerk).max() <= 4000 * (1 + 1e-9)


NO_RUCKIG = {
    "no limit": (
        replace(MOVE, acceleration_limit=None),
        "ruckig moves within an acceleration limit, and the move has none; plan it with one",
    ),
    "no time": (
        replace(MOVE, acceleration_limit=5.0),
        # 60 degrees by full acceleration and braking: twice the root of pi/3 over 5, 0.915 s
        "within the limits it takes 0.9153 s, more than the 0.7 s that it has; give a longer",
    ),
}


@pytest.mark.slow_after(1)
@pytest.mark.parametrize(("task", "why"), NO_RUCKIG.values(), ids=NO_RUCKIG)
def test_a_baseline_without_a_row_of_figures_says_why_and_what_to_do(task, why):
    judged = compare_plans({}, ["all"], task=task)
    report = plans_report(task, judged)
    table = report.tables["motions"].set_index("motion")
    for motion in judged:
        assert (motion.motion is None) == bool(motion.why)
        if motion.why:
            assert table.loc[motion.name, "why there is none"] == motion.why
            assert "; give" in motion.why or "; plan" in motion.why
            assert motion.why in report.markdown()
    (ruckig,) = [motion for motion in judged if motion.name == "ruckig"]
    assert ruckig.why.startswith(why)


def test_toppra_is_as_fast_as_the_limits_allow_and_stretched_to_the_duration():
    """A rigid joint from rest to rest: bang-bang in 2 sqrt(span / acceleration), a closed form."""
    pytest.importorskip("toppra")
    task = replace(MOVE, jerk_limit=None, speed_limit=None, torque_limit=None)
    task = replace(task, acceleration_limit=80.0)
    least = 2 * math.sqrt(task.span / 80.0)
    fastest = toppra_motion(replace(task, duration=1.001 * least))
    assert np.abs(fastest.acceleration).max() == pytest.approx(80.0, rel=3e-3)
    with pytest.raises(ValueError, match="within the limits it takes"):
        toppra_motion(replace(task, duration=0.99 * least))
    motion = toppra_motion(task)
    assert motion.times[-1] == pytest.approx(task.duration)
    angles, speeds = motion.boundaries(task.start)
    assert angles[-1] == pytest.approx(task.target, abs=1e-9)
    assert speeds[-1] == pytest.approx(0.0, abs=1e-9)
    stretched = 80.0 * (least / task.duration) ** 2
    assert np.abs(motion.acceleration).max() == pytest.approx(stretched, rel=3e-3)


def test_toppra_keeps_a_torque_and_goes_backwards():
    """The rigid joint's torque stays below its limit; the link, which swings, takes more."""
    pytest.importorskip("toppra")
    plant = SingleLinkManipulator()
    task = PointToPoint(plant, start=0.5, target=-0.2, duration=0.8, torque_limit=0.12)
    free = toppra_motion(task)
    still = [0.0] * plant.modes
    pushed = [JointMotion(0.0, 0.0, push) for push in free.acceleration.tolist()]
    torques = [plant.torques(motion, still, still, still)[0] for motion in pushed]
    assert np.abs(torques).max() <= 0.12 * (1 + 1e-6)
    assert free.boundaries(task.start)[0][-1] == pytest.approx(-0.2)


def test_toppra_leaves_room_for_coulomb_friction():
    """Half of the force goes into friction: the axis brakes three times as hard as it starts."""
    pytest.importorskip("toppra")
    axis = LinearAxis(mass=10, load=1e-3, friction=0, drive=Drive(friction_load=20))
    way, force = 0.5, 40.0
    speeds_up, brakes = (force - 20) / 10, (force + 20) / 10
    least = math.sqrt(2 * way * (1 / speeds_up + 1 / brakes))  # a closed form
    motion = toppra_motion(PointToPoint(axis, way, 1.001 * least, torque_limit=force))
    assert motion.acceleration.max() == pytest.approx(speeds_up, rel=0.01)
    assert motion.acceleration.min() == pytest.approx(-brakes, rel=0.01)


def test_toppra_needs_a_limit_and_to_be_installed(monkeypatch):
    (found,) = compare_plans(
        {}, ["toppra"], task=replace(MOVE, acceleration_limit=None, torque_limit=None)
    )
    assert found.why.startswith("toppra moves within a limit of acceleration or torque, and")
    monkeypatch.setitem(sys.modules, "toppra.algorithm", None)
    (found,) = compare_plans({}, ["toppra"], task=MOVE)
    assert found.why.startswith("toppra is not installed; install it: pip install")


def test_ruckig_that_is_not_installed_says_how_to_install_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "ruckig", None)
    (found,) = compare_plans({}, ["ruckig"], task=MOVE)
    assert found.why.startswith("ruckig is not installed; install it: pip install")


def test_a_shaped_motion_is_the_sum_of_its_delayed_shares():
    free = FreeMotion([0, 0.1, 0.25, 0.35], [1.0, 1.3, -1.75], [3.0, -14.0, 3.0])
    impulses = SHAPERS["zvd"](20.0, 0.05)
    both = shaped(free, impulses)

    def angle_at(motion, times):
        angle, speed = motion.boundaries(0.0)
        k = np.clip(np.searchsorted(motion.times, times, side="right") - 1, 0, motion.steps - 1)
        t = np.clip(times, 0.0, motion.times[-1]) - motion.times[k]
        bends = motion.acceleration[k] / 2 + t * motion.jerk[k] / 6
        on = np.maximum(times - motion.times[-1], 0.0) * speed[-1]
        return angle[k] + t * (speed[k] + t * bends) + on

    times = np.linspace(0, both.times[-1], 37)
    parts = [share * angle_at(free, times - begin) for share, begin in zip(*impulses, strict=True)]
    assert both.times[-1] == pytest.approx(0.35 + impulses.times[-1])
    assert angle_at(both, times) == pytest.approx(np.sum(parts, axis=0), abs=1e-12)
