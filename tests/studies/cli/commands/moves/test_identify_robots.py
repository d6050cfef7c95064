"""`quietarm identify` of a robot, by the csv of its controller."""

import re
from dataclasses import replace
from pathlib import Path

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


@pytest.mark.slow
def test_torques_that_do_not_fit_the_posture_are_said_first(done, refused, folder):
    """Axes are level, such that gravity tells postures apart."""
    level = ARM.replace('<axis xyz="0 0 1"/>', '<axis xyz="0 1 0"/>')
    recording = ring_down(qa.Robot.load(write_robot(folder, level, ARM_FILE)), "torques", 1.2)
    table = np.c_[recording.time, recording.torques]
    np.savetxt("ring.csv", table, "%.8g", ",", header="time,a_effort,b_effort", comments="")
    words = "torques at rest"
    assert words not in done("identify ring.csv robot.yaml --posture 0.2,0.8").partition("load")[0]
    out = done("identify ring.csv robot.yaml --posture 1.2,0.3 --output again.yaml")
    out = " ".join(out.split())
    assert out.startswith(
        "The torques at rest do not fit the posture (check --posture, or are they external "
        "torques?). If it is right, the robot swings at "
    )
    assert "warning the torques at rest are not those that hold this robot at this posture" in out
    assert "file; the torques at rest are not those that hold this robot at this posture" in out
    assert "do not fit the posture" in Path("again.yaml").read_text()
    line = "identify ring.csv robot.yaml --posture"
    turned = refused(f"{line} 0.2,0.8 --scale torque=-1")
    assert turned.strip().endswith("; leave out --scale torque=-1")


def test_columns_and_postures_that_are_not_the_robots_are_named(refused, folder):
    write_robot(folder, ARM, ARM_FILE)
    rows = "".join(f"{0.01 * k},{k % 7},{k % 5}\n" for k in range(60))
    Path("other.csv").write_text("time,a_effort,c_effort\n" + rows)
    Path("ring.csv").write_text("time,a_effort,b_effort\n" + rows)
    line = "identify robot.yaml other.csv --posture 0.2,0.8"
    assert "no column 'b_effort'; left over of the file: c_effort" in refused(line)
    far = refused("identify robot.yaml ring.csv --posture 11,46")
    assert "'a' at 11; its range is -3 to 3" in far
    assert "were degrees meant? give 11deg" in far
