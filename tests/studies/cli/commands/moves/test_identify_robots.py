"""`quietarm identify` of a robot, by the csv of its controller."""

import re
from dataclasses import replace

import numpy as np
import pytest
from ring_downs import POSTURE, RATE, ring_down
from small_robots import ARM, ARM_FILE, write_robot

import quietarm as qa


@pytest.mark.slow
def test_the_file_that_is_written_swings_as_it_was_measured(done, refused, folder):
    robot = qa.Robot.load(write_robot(folder, ARM, ARM_FILE))
    other = replace(robot, beam=replace(robot.beam, tip_mass=0.36))
    recording = ring_down(other, "torques", 4.0)
    moving = np.linspace(0, 1, 150)[:, None]  # before it, a move of 0.6 s
    q = np.concatenate([moving * POSTURE, np.tile(POSTURE, (len(recording.time), 1))])
    torques = np.concatenate([20 * np.sin(2 * np.pi * moving) * [1, 0.5], recording.torques])
    table = np.c_[np.arange(len(q)) / RATE, torques, q]
    header = "time,a_effort,b_effort,a_position,b_position"
    np.savetxt("ring.csv", table, "%.8g", ",", header=header, comments="")
    out = " ".join(done("identify robot.yaml ring.csv --output again.yaml").split())
    assert out.startswith("The robot swings at ")
    assert re.search(r"measured: - \{frequency: [\d.]+Hz, at: \[0.2, 0.8\]", out)
    again = qa.Robot.load("again.yaml")
    assert again.frequencies(POSTURE)[0] == pytest.approx(other.frequencies(POSTURE)[0], rel=1e-3)
    assert again.frequencies(POSTURE)[1] == pytest.approx(other.frequencies(POSTURE)[1], rel=1e-3)
    # the axes are upright: gravity does not show the load in their torques
    assert "the load is not told" in out
    assert "is given twice" in refused("identify ring.csv robot.yaml --output robot.yaml")
    assert "is no file of a robot" in refused("identify ring.csv robot.yaml --output m.json")
    assert "is for plants of one joint" in refused("identify ring.csv robot.yaml --free omega")
    assert "is for a robot" in refused("identify ring.csv flexible-beam --tip a --posture 0,0")
