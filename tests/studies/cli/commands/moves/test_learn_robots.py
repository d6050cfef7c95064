"""`quietarm learn` of a robot's plan, by the csv of its controller."""

import re
from dataclasses import replace

import numpy as np
import pytest
from small_robots import ARM, ARM_FILE, write_robot

import quietarm as qa

STEP = 0.002


@pytest.fixture
def plan(folder):
    """A plan of two joints, and a log of it on springs that are 1.2 times as stiff."""
    return logged(folder, stiffness=1.2)


def logged(folder, *, stiffness, **limits):
    """Save a plan and a log of it on other springs; return the motion there."""
    robot = qa.Robot.load(write_robot(folder, ARM, ARM_FILE))
    plant = robot.along(qa.GeometricPath.through([[0.0, 0.5], [1.0, 1.0]]))
    task = qa.PointToPoint(plant, target=1.0, duration=0.5)
    planned = qa.plan_move(task, qa.CycloidPolynomial(6), starts=1, **limits)
    planned.save(folder / "plan.json")
    actual = qa.PointToPoint(replace(plant, stiffness=stiffness), target=1.0, duration=0.5)
    moved = qa.evaluate_coefficients(actual, planned.coefficients, profile=planned.profile)
    sample = moved.sampled(np.arange(0, 2, STEP)).sample
    joints = [joint.angle for joint in sample.joints]
    table = np.stack([-sample.torques[0], -sample.torques[1], *joints], axis=1)
    table = np.concatenate([np.repeat(table[:1], 100, axis=0), table])
    table[:, :2] += np.random.default_rng(0).normal(0, 0.02, (len(table), 2))
    time = 1e3 * STEP * np.arange(len(table))
    header = "time_ms,tau_ext[0],tau_ext[1],q[0],q[1]"
    np.savetxt("log.csv", np.c_[time, table], "%.6g", ",", header=header, comments="")
    return moved


@pytest.mark.slow
def test_the_springs_are_learned_from_a_log(done, refused, plan, folder):
    line = "learn plan.json log.csv --torque tau_ext --scale torque=-1 --angle q"
    out = " ".join(done(f"{line} --output next.json --dearer 10%").split())
    left = float(re.match(r"The move left ([\d.]+) mm", out)[1])
    assert left == pytest.approx(1e3 * plan.residual, rel=0.1)
    assert re.search(r"springs 1\.2(?:00\d*)? times as stiff, 5\.367 Hz, model 4\.899 Hz", out)
    assert "moves of robots differ by 1.8 %" in out
    assert "state it by --delay" in out
    assert qa.Plan.load(folder / "next.json").learned is not None
    assert "--torque, or an accelerometer at the tip" in refused(
        "learn plan.json log.csv --tip q[0]"
    )
    assert "what to write into the robot's file" in refused(f"{line} --machine m.json")
    assert "no 2 columns of 'tau'" in refused("learn plan.json log.csv --torque tau")


@pytest.mark.slow
@pytest.mark.parametrize(("stiffness", "limit"), [(1.0, 8e-3), (1.2, 2e-3)])
def test_what_a_robots_plan_itself_leaves_is_in_the_promise(done, folder, stiffness, limit):
    moved = logged(folder, stiffness=stiffness, residual_limit=limit)
    line = "learn plan.json log.csv --torque tau_ext --scale torque=-1 --angle q --dearer 10%"
    out = " ".join(done(f"{line} --output next.json").split())
    if stiffness == 1:
        assert moved.residual == pytest.approx(limit, rel=1e-3)  # as far as it may
        assert out.startswith("Nothing more to learn: the move leaves what the plan allows (8")
    else:
        following = qa.Plan.load(folder / "next.json")
        task = replace(moved.task, plant=replace(moved.task.plant, stiffness=1.2))
        after = qa.evaluate_coefficients(
            task, following.coefficients, profile=following.profile
        ).residual
        promised = float(re.search(r"the next move leaves at most ([\d.]+) mm", out)[1])
        assert 1e-3 < after < 1e-3 * promised
