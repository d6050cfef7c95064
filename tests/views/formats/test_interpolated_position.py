"""Records of CiA 402's interpolated position mode, read back as a drive would follow them."""

import csv
import math
import re

import numpy as np
import pytest
from robots import UR5_JOINTS, straight, ur5_with_bar

import quietarm as qa
from quietarm.models import LinearAxis, SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, PointToPoint, evaluate_coefficients
from quietarm.views.formats.between_rows import residual_through
from quietarm.views.formats.deviation import CUBIC, LINEAR, motion_at
from quietarm.views.formats.formats import export_plan

LINK = PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8, start=-0.2)
AXIS = PointToPoint(LinearAxis(), 0.3, 0.5)


def plan_of(task):
    return evaluate_coefficients(task, [0.003, -0.17], profile=CycloidPolynomial(2))


def records_of(plan, path, **settings):
    """The header, the heading and the rows."""
    export_plan(plan, path, **settings)
    lines = path.read_text().splitlines()
    header = [line.removeprefix("# ") for line in lines if line.startswith("#")]
    heading, *rows = csv.reader(line for line in lines if not line.startswith("#"))
    assert all(cell.lstrip("-").isdigit() for row in rows for cell in row[1:])
    return header, heading, np.array(rows, dtype=float)


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("period", [0.004, 0.002, 0.001])
def test_positions_are_the_plans_in_whole_increments(period, tmp_path):
    plan = plan_of(LINK)
    turn = 2**20
    settings = {"increments_per_revolution": turn, "polarity": -1, "zero": 500}
    header, heading, rows = records_of(plan, tmp_path / "move.cia402", period=period, **settings)
    assert heading == ["time_ms", "60C1h:01 position"]
    assert f"6060h = 7, 60C2h:01 = {1e3 * period:g}, 60C2h:02 = -3, 60C0h = 0" in header
    assert "increments/rad, 500 at 0" in " ".join(header)
    assert rows[:, 0] == pytest.approx(1e3 * period * np.arange(len(rows)))
    angle = plan.sampled(rows[:, 0] / 1e3).joint[:, 0]
    assert abs(rows[:, 1] - 500 + angle * turn / (2 * math.pi)).max() <= 0.5 + 1e-6


def test_cubics_have_speeds_and_a_linear_axis_counts_metres(tmp_path):
    plan = plan_of(AXIS)
    header, heading, rows = records_of(
        plan, tmp_path / "move.cia402", period=0.0125, increments=4e6, between="cubic"
    )
    assert heading == ["time_ms", "60C1h:01 position", "60C1h:02 speed"]
    # 12.5 ms are 125 tenths
    assert any(line.startswith("6060h = 7, 60C2h:01 = 125, 60C2h:02 = -4, 60C0h = -1")
               for line in header)  # fmt: skip
    assert "4000000 increments/m" in " ".join(header)
    joint = plan.sampled(rows[:, 0] / 1e3).joint
    assert abs(rows[:, 1:] - 4e6 * joint[:, :2]).max() <= 0.5 + 1e-3


def test_the_header_says_what_is_off_at_most(tmp_path):
    plan = plan_of(LINK)
    header, _, rows = records_of(plan, tmp_path / "move.cia402", period=0.004, increments=1e5)
    (told,) = [line for line in header if "off the plan" in line]
    proven, sampled = map(float, re.findall(r"(?:most|sampled) (\S+) rad", told))
    times = np.random.default_rng(4).uniform(0, 0.8, 5000)
    drive = np.interp(times, rows[:, 0] / 1e3, rows[:, 1] / 1e5)
    error = abs(drive - plan.sampled(np.sort(times)).joint[:, 0][np.argsort(np.argsort(times))])
    assert sampled == pytest.approx(error.max(), rel=0.05)
    assert error.max() <= proven * 1.005 <= 1.1 * error.max()
    # increments of 1e-5 rad: half of one is part of it
    assert proven > 5e-6


def test_residuals_of_straight_lines_are_those_of_small_steps():
    """The drive's straight lines, by impulses of the speed in the equations of a linear axis."""
    plan = plan_of(AXIS)
    period = 0.025
    times = period * np.arange(21)
    positions, speeds, _ = (values[:, 0] for values in motion_at(plan, times))
    left = residual_through(plan, times, [positions, speeds], LINEAR)
    # of the modes, each an oscillator that the carriage's acceleration pushes: their exact swing
    plant = plan.task.plant
    assert plant.modes == 1
    w, zeta = plant.omega1, plant.zeta1
    damped = w * math.sqrt(1 - zeta**2)
    jumps = np.diff([0.0, *np.diff(positions) / period, 0.0])
    after = np.linspace(0, plan.task.residual_window, 4001) + times[-1]
    lags = after[:, None] - times
    swing = -(jumps * np.exp(-zeta * w * lags) * np.sin(damped * lags) / damped).sum(axis=1)
    expected = np.abs(swing).max()
    assert left == pytest.approx(expected, rel=0.01)
    finer = residual_through(plan, times, [positions, speeds], CUBIC)
    assert abs(finer - plan.residual) < abs(left - plan.residual)


@pytest.mark.slow
def test_a_robot_has_the_records_of_all_joints(tmp_path):
    task = qa.PointToPoint(ur5_with_bar().along(straight()), target=1.0, duration=1.0)
    plan = qa.evaluate_coefficients(task, [0.01, -0.12, -0.04, 0.12])
    header, heading, rows = records_of(plan, tmp_path / "move.cia402", period=0.004)
    assert heading[1:] == [f"{name} 60C1h:01 position" for name in UR5_JOINTS]
    joints = plan.sampled(rows[:, 0] / 1e3).sample.joints
    for joint, column in zip(joints, rows[:, 1:].T, strict=True):
        assert abs(column - 1e6 * joint.angle).max() <= 0.5 + 1e-3
    assert "interpolated along its path, then leaves" in " ".join(header)


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        ({"between": "quintic"}, "between is 'quintic'; give linear or cubic"),
        ({"polarity": 0}, "polarity is 0; give 1 or -1"),
        ({"period": 0.00125}, "period is 1.25 ms, which 60C2h cannot hold; give a multiple of"),
        ({"period": 0.0301}, "period is 30.1 ms, which 60C2h cannot hold; give up to 25.5 ms"),
        ({"period": 1.0}, "period is 1 s; give a number from 0.0001 up to 0.255 s"),
        ({"increments": 1e12}, "and a record holds 2147483647; give fewer increments"),
    ],
)
def test_what_no_drive_takes_is_refused(settings, told, tmp_path):
    with pytest.raises(ValueError, match=told):
        export_plan(plan_of(LINK), tmp_path / "move.cia402", **settings)
    assert not list(tmp_path.iterdir())


def test_revolutions_are_of_joints_that_turn(tmp_path):
    with pytest.raises(ValueError, match="is 1000, and no joint turns; give increments, in a m"):
        export_plan(plan_of(AXIS), tmp_path / "a.cia402", increments_per_revolution=1000)


def test_a_plan_of_a_drive_has_its_set_points_through_the_drive(tmp_path):
    drive = qa.Drive(position_loop=60, speed_loop=40, reset_time=0.03, recorded="held")
    plan = plan_of(PointToPoint(LinearAxis(drive=drive), 0.3, 0.5))
    header, _, rows = records_of(plan, tmp_path / "move.cia402", period=0.002, increments=1e6)
    asked = plan.commanded(500)
    np.testing.assert_allclose(rows[:, 0], 1e3 * asked.time)
    (joint,) = asked.sample.joints
    assert np.abs(rows[:, 1] / 1e6 - joint.angle).max() <= 0.5e-6  # whole increments
    assert np.abs(rows[:, 1] / 1e6 - plan.sampled(asked.time).sample.path.angle).max() > 1e-5
    assert "set points through the drive" in header[-1]
    with pytest.raises(ValueError, match="plan's set points go through its drive"):
        export_plan(plan, tmp_path / "move.yaml", thin=1e-3)
    export_plan(plan, tmp_path / "move.c")
    assert "the path of the load, without the drive" in (tmp_path / "move.h").read_text()
