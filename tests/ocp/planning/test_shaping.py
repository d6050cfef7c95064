"""Shaped moves of the plants: what is left, by CVODES and SciPy; plans, limits, files."""

import math
from dataclasses import replace

import numpy as np
import pytest
from fixed_steps import rollout
from third_opinion import followed

import quietarm as qa
from quietarm.models import JointMotion

pi = math.pi
LINEAR = qa.SingleLinkManipulator(beta2=0.0, zeta=0.0)
names = pytest.mark.parametrize("shaper", ["zv", "zvd", "ei"])


def test_the_shaper_is_for_the_target_or_the_average():
    task = qa.PointToPoint(qa.ArmOnFlexibleLink(), pi / 2, 1.2)
    at_target = qa.shaped_cycloid(task, "zv")
    assert at_target.frequencies == pytest.approx((7.320,))  # cos(pi/2) = 0
    assert at_target.damping_ratios == pytest.approx((1.5e-3,))
    # Over time along the plain cycloid, by a finer sum.
    t = np.linspace(0, 2 * pi, 20001)
    mass = 1 - 1.055e-1 * np.cos(pi / 2 * (t - np.sin(t)) / (2 * pi))
    [average] = qa.shaped_cycloid(task, "zv", "average").frequencies
    assert average == pytest.approx((7.320 / np.sqrt(mass)).mean(), rel=1e-4)


@pytest.mark.parametrize(
    ("plant", "modes", "duration"),
    [
        (qa.SingleLinkManipulator(), 1, 0.635),  # hardly longer than the shaper
        (qa.DualLinkManipulator(), 2, 1.3),
    ],
)
def test_scipy_restarted_at_every_impulse_agrees(plant, modes, duration):
    task = qa.PointToPoint(plant, 1.0, duration)
    profile = qa.shaped_cycloid(task, "zvd")
    cycloid = duration - profile.length
    impulses = list(zip(*profile.impulses, strict=True))

    def joint(t):
        angle = speed = acceleration = 0.0
        for share, begin in impulses:
            x = 2 * pi * min(max((t - begin) / cycloid, 0.0), 1.0)
            angle += share * (x - math.sin(x)) / (2 * pi)
            speed += share * (1 - math.cos(x)) / cycloid
            acceleration += share * 2 * pi * math.sin(x) / cycloid**2
        return JointMotion(angle, speed, acceleration)

    corners = sorted({0.0, duration, *profile.impulses.times})
    corners = sorted({*corners, *(begin + cycloid for _, begin in impulses)})
    state, _ = followed(plant, joint, corners, max_step=2e-3)
    motion = qa.JudgedMotion.of_profile(task, profile, []).motion
    arrival = qa.JudgedMotion.of_profile(task, profile, []).sample([duration]).modes[0]
    assert arrival == pytest.approx(state[:modes], abs=1e-8)
    assert motion.net_work == pytest.approx(state[-2], rel=1e-6)
    assert motion.energy == pytest.approx(state[-1], rel=1e-5)
    # Fixed steps do not stop where a cycloid begins: they are coarser here than for polynomials.
    assert rollout(task, profile, []).motion.energy == pytest.approx(motion.energy, rel=2e-2)


def test_a_limit_that_the_only_motion_breaks_is_named(tasks):
    task = tasks["single link"]
    plan = qa.plan_move(task, qa.shaped_cycloid(task, "zv"))
    kept = replace(task, torque_limit=plan.motion.peak_torque * 1.01)
    assert qa.plan_move(kept, plan.profile).motion.peak_torque == plan.motion.peak_torque
    broken = replace(task, torque_limit=plan.motion.peak_torque / 2)
    with pytest.raises(qa.InfeasibleTaskError, match="torque"):
        qa.plan_move(broken, plan.profile)
    with pytest.raises(qa.InfeasibleTaskError, match="residual"):
        qa.plan_move(task, plan.profile, residual_limit=plan.residual / 2)
    with pytest.raises(qa.InfeasibleTaskError, match="residual"):  # 0: at rest
        qa.plan_move(task, qa.CycloidPolynomial(0), residual_limit=0.0)
    qa.plan_move(task, plan.profile, residual_limit=plan.residual * 2)


def test_a_plant_that_does_not_vibrate_has_no_shaper():
    overdamped = qa.PointToPoint(qa.SingleLinkManipulator(zeta=1.5), 1.0, 0.8)
    with pytest.raises(ValueError, match="do not vibrate"):
        qa.shaped_cycloid(overdamped, "zv")


def test_a_shapers_plan_records_no_limit_that_nobody_gave(tasks):
    task = replace(tasks["single link"], duration=1.5)
    profile = qa.shaped_cycloid(task, "zv")
    assert qa.plan_move(task, profile).residual_limit is None
    assert qa.plan_move(task, profile, residual_limit=0.1).residual_limit == 0.1
