"""A robot's springs, damping and load from ring-downs with its joints held."""

from dataclasses import replace

import numpy as np
import pytest
from ring_downs import POSTURE, RATE, ring_down
from small_robots import ARM, ARM_FILE, write_robot

import quietarm as qa
from quietarm.machine import RobotRecording, identify_robot


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    return qa.Robot.load(write_robot(tmp_path_factory.mktemp("arm"), ARM, ARM_FILE))


@pytest.mark.slow
def test_the_springs_are_told_by_a_tip_and_the_load_is_not(robot):
    stiffer = replace(robot, measured=qa.models.Measured(
        1.1 * float(robot.frequencies(POSTURE)[0]), POSTURE))  # fmt: skip
    recording = ring_down(stiffer, "tip")
    found = identify_robot([recording], robot, [POSTURE])
    first = found.modes[0]
    assert first.frequency.value == pytest.approx(
        1.1 * float(robot.frequencies(POSTURE)[0]) / (2 * np.pi), rel=5e-4
    )
    # 0.5 % is the damping of the first mode in the robot's file
    assert first.damping.value == pytest.approx(0.005, rel=0.05)
    assert found.stiffness.low < stiffer.fit.stiffness < found.stiffness.high
    assert found.payload is None
    assert "do not tell it from the springs" in found.payload_by
    assert found.robot.frequencies(POSTURE)[0] == pytest.approx(
        2 * np.pi * first.frequency.value, rel=1e-3
    )


def test_a_posture_is_needed_and_has_to_fit_the_recordings(robot):
    recording = ring_down(robot, "tip")
    with pytest.raises(ValueError, match="has no positions of the joints; give them by --posture"):
        identify_robot([recording], robot)
    with pytest.raises(ValueError, match="2 postures are given for 3 recordings"):
        identify_robot([recording] * 3, robot, [POSTURE] * 2)


def test_what_is_no_ring_down_is_refused_in_a_line(robot):
    noise = np.random.default_rng(0).normal(0, 1e-3, (500, 3))
    recording = RobotRecording(np.arange(500) / RATE, tip=noise, name="run.csv")
    with pytest.raises(ValueError, match=r"^run.csv") as refused:
        identify_robot([recording], robot, [POSTURE])
    assert "--part" in str(refused.value) or "push harder" in str(refused.value)
    assert "\n" not in str(refused.value)
