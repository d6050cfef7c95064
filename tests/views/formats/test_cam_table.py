"""Cams, read back by the descriptions of the tools that docs/cams.md names."""

import csv
import math

import numpy as np
import pytest
from robots import UR5_JOINTS, straight, ur5_with_bar

import quietarm as qa
from quietarm.models import LinearAxis, SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial, PointToPoint, evaluate_coefficients
from quietarm.views.formats.formats import export_plan

LINK = PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8, start=-0.2)
AXIS = PointToPoint(LinearAxis(), 0.3, 0.5)


def plan_of(task):
    return evaluate_coefficients(task, [0.003, -0.17], profile=CycloidPolynomial(2))


def text_of(plan, path, **settings):
    export_plan(plan, path, **settings)
    return path.read_text()


def test_a_table_has_position_speed_and_acceleration_over_time(tmp_path):
    plan = plan_of(AXIS)
    rows = list(csv.reader(text_of(plan, tmp_path / "a.cam", unit="mm", points=26).splitlines()))
    assert rows[0] == ["time_s", "position_mm", "speed_mm_s", "acceleration_mm_s2"]
    table = np.array(rows[1:], dtype=float)
    assert table[:, 0] == pytest.approx(np.linspace(0, 0.5, 26))
    joint = plan.sampled(table[:-1, 0]).joint
    assert table[:-1, 1:] == pytest.approx(1e3 * joint, rel=1e-9, abs=1e-8)
    assert table[-1] == pytest.approx([0.5, 300.0, 0.0, 0.0], abs=1e-9)


def test_derivatives_are_by_the_masters_position(tmp_path):
    text = text_of(plan_of(LINK), tmp_path / "a.cam", master=360.0, span=1.0, points=2001)
    rows = list(csv.reader(text.splitlines()))
    assert rows[0] == [
        "master",
        "angle_span",
        "speed_span_by_master",
        "acceleration_span_by_master2",
    ]
    master, slave, speed, acceleration = np.array(rows[1:], dtype=float).T
    assert (master[0], master[-1], slave[0], slave[-1]) == pytest.approx((0, 360, 0, 1))
    assert np.gradient(slave, master)[1:-1] == pytest.approx(speed[1:-1], abs=1e-7)
    assert np.gradient(speed, master)[2:-2] == pytest.approx(acceleration[2:-2], abs=1e-8)


LAYOUTS = {
    "codesys": ([], "\t", []),
    "lenze": ([], " ", []),
    "sew": (["9"], ";", []),
    "kollmorgen": (["CYCLIC;NO;", "TABLE_BEGIN;;"], ";", ["SPLINE"]),
    "rockwell": (["Master,Slave,Type"], ",", ["1"]),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_a_layout_is_that_of_its_description(layout, tmp_path):
    before, between, more = LAYOUTS[layout]
    text = text_of(plan_of(LINK), tmp_path / "a.cam", layout=layout, points=9, unit="deg")
    lines = text.splitlines()
    after = ["TABLE_END;;"] if layout == "kollmorgen" else []
    assert lines[: len(before)] == before
    assert lines[len(lines) - len(after) :] == after
    rows = [line.split(between) for line in lines[len(before) : len(lines) - len(after)]]
    assert len(rows) == 9
    assert all(row[2:] == more for row in rows)
    pairs = np.array([row[:2] for row in rows], dtype=float)
    assert (np.diff(pairs[:, 0]) > 0).all()  # in ascending order of the master
    angles = np.degrees(plan_of(LINK).sampled(pairs[:, 0]).joint[:, 0])
    assert pairs[:, 1] == pytest.approx(angles, abs=1e-7)


@pytest.mark.slow
def test_a_robot_has_a_table_of_all_joints_or_a_cam_of_one(tmp_path):
    task = qa.PointToPoint(ur5_with_bar().along(straight()), target=1.0, duration=1.0)
    plan = qa.evaluate_coefficients(task, [0.01, -0.12, -0.04, 0.12])
    text = text_of(plan, tmp_path / "a.cam", unit="deg", points=11)
    heading, *rows = csv.reader(text.splitlines())
    assert heading[1::3] == [f"{name}_angle_deg" for name in UR5_JOINTS]
    table = np.array(rows, dtype=float)
    joints = plan.sampled(table[:, 0]).sample.joints
    assert table[:, 1] == pytest.approx(np.degrees(joints[0].angle), abs=1e-6)
    with pytest.raises(ValueError, match="the layout sew has one slave, and 6 joints move; give"):
        export_plan(plan, tmp_path / "b.cam", layout="sew")
    text = text_of(plan, tmp_path / "c.cam", layout="sew", points=11, slave=UR5_JOINTS[2])
    last = text.splitlines()[-1].split(";")
    assert [float(cell) for cell in last] == pytest.approx([1.0, joints[2].angle[-1]])


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        ({"layout": "kolmorgen"}, r"unknown layout 'kolmorgen'; did you mean 'kollmorgen'\?"),
        ({"unit": "mm"}, "unknown unit of the slave 'mm'"),
        ({"points": 2}, "points is 2; give a whole number from 5"),
        ({"master": 0.0}, "master is 0; give a number from 1e-06"),
        ({"slave": "elbow"}, "unknown joint 'elbow'"),
    ],
)
def test_what_no_cam_has_is_refused(settings, told, tmp_path):
    with pytest.raises(ValueError, match=told):
        export_plan(plan_of(LINK), tmp_path / "a.cam", **settings)
