"""Joints that slide have metres and newtons wherever a robot's move is shown."""

import csv
import io
from dataclasses import replace
from functools import lru_cache
from types import SimpleNamespace

import numpy as np
import pytest
from small_robots import ARM, ARM_FILE, FILE, GANTRY, MIXED, write_robot

import quietarm as qa
from quietarm.models.dimensions import EFFORT, Words
from quietarm.ocp import Figure, add_figure, remove_figure, rms
from quietarm.studies.compare.compared_motions import ComparedMotion
from quietarm.studies.compare.plan_comparison import motions_table
from quietarm.views import pictures
from quietarm.views.formats.csv_rows import CsvRows
from quietarm.views.formats.formats import export_plan
from quietarm.views.report.first_lines import plan_answer
from quietarm.views.report.plan_rows import plan_rows
from quietarm.views.report.robot_rows import robot_rows

LIMITS = {"torque_limit": {"x": 900.0, "radial-axis": 500.0}, "speed_limit": {"radial-axis": 2.0}}


def csv_text(plan, columns, rate):
    """A table as text."""
    return CsvRows().content(plan, columns=columns, rate=rate)


@pytest.fixture(scope="module")
def plan_of(tmp_path_factory):
    """The plain cycloid of a robot by its URDF, within limits."""

    @lru_cache
    def make(urdf):
        folder = tmp_path_factory.mktemp("robot")
        robot = qa.Robot.load(write_robot(folder, urdf, f"{FILE}friction: {{x: 5Ns/m}}\n"))
        path = qa.GeometricPath.line([0.2, 0.1], [0.7, 0.9])
        task = qa.PointToPoint(robot.along(path), target=1.0, duration=1.0, **LIMITS)
        return qa.evaluate_coefficients(task, [])

    return make


def test_rows_of_a_gantry_are_in_metres_and_newtons(plan_of):
    plan = plan_of(GANTRY)
    rows = dict(plan_rows(plan))
    assert rows["peak force"] == f"{plan.motion.peak_torque:.4g} N (x)"  # the lower carriage
    assert rows["peak speed"] == f"{plan.motion.peak_speed:.4g} m/s (radial-axis)"  # goes farther
    assert rows["peak acceleration"].startswith(f"{plan.motion.peak_acceleration:.4g} m/s^2")
    assert "force x 900 N; radial-axis 500 N, speed radial-axis 2 m/s" in rows["limits"]
    assert rows["limits"].endswith("speed radial-axis 2 m/s (none for x)")
    html = plan._repr_html_()
    assert "force x 900 N; radial-axis 500 N" in html
    assert "peak force" in html
    assert "m/s²" in html


def test_a_limit_that_is_broken_is_told_with_its_joint(plan_of):
    plan = plan_of(GANTRY)
    task = replace(plan.task, torque_limit={"x": 1.0}, speed_limit=None)
    broken = qa.evaluate_coefficients(task, [])
    words = f"{plan.motion.peak_torque:.4g} N at x"
    assert dict(plan_rows(broken))["limits"].endswith(f"(broken: {words})")
    assert "beyond its limit of force at x" in " ".join(plan_answer(broken))


def test_rows_of_a_mixed_robot_have_each_kind_of_joint(plan_of):
    plan = plan_of(MIXED)
    rows = dict(plan_rows(plan))
    slope = 2 * 0.5, 2 * 0.8  # peak of a cycloid's speed, of the ways of both joints
    assert rows["peak speed"] == f"{slope[0]:.4g} m/s (x) and {slope[1]:.4g} rad/s (radial-axis)"
    torques = np.abs(plan.trajectory.sample.torques).max(axis=1)
    words = rows["peak torque or peak force"]
    assert words == f"{torques[0]:.4g} N (x) and {torques[1]:.4g} N m (radial-axis)"
    assert "x 900 N; radial-axis 500 N m" in rows["limits"]
    assert "speed radial-axis 2 rad/s" in rows["limits"]


def test_an_rms_over_newtons_and_newton_metres_is_none(plan_of):
    add_figure(Figure("rms_effort", EFFORT, Words("RMS torque", "RMS force"), rms("torque")))
    try:
        assert "rms_effort" not in plan_of(MIXED).figures
        assert dict(plan_rows(plan_of(GANTRY)))["RMS force"].endswith(" N")
    finally:
        remove_figure("rms_effort")


def test_rows_of_a_robot_have_the_units_of_its_joints(tmp_path):
    entries = (
        "rotor_inertia: {x: 2kg, radial-axis: 0.3}\nelastic_joints: {x: 2kN/m}\nlimits: urdf\n"
    )
    robot = qa.Robot.load(write_robot(tmp_path, MIXED, FILE + entries))
    path = qa.GeometricPath.line([0.2, 0.1], [0.7, 0.9])
    rows = dict(robot_rows(robot, path))
    assert rows["rotor inertia"] == "x 2 kg; radial-axis 0.3 kg m^2"
    assert rows["gear of x"] == "2000 N/m, 0 N s/m"
    assert rows["speed limit"] == "x 2 m/s; radial-axis 2 rad/s"
    assert rows["torque limit or force limit"] == "x 900 N; radial-axis 500 N m"
    assert rows["at the start"].endswith(", at 0.2m, 5.73deg")


def _headings(text):
    return next(csv.reader(io.StringIO(text)))


def test_columns_of_joints_that_slide(plan_of, tmp_path):
    plan = plan_of(GANTRY)
    text = csv_text(plan, "time:ms,position:mm,force:kN,speed:mm/s", 10.0)
    assert _headings(text) == [
        "time_ms", "x_position_mm", "radial-axis_position_mm", "x_force_kN", "radial-axis_force_kN",
        "x_speed_mm_s", "radial-axis_speed_mm_s",
    ]  # fmt: skip
    last = text.splitlines()[-1].split(",")
    assert float(last[1]) == pytest.approx(700.0)
    assert _headings(csv_text(plan, "angle", 10.0)) == ["x_position_m", "radial-axis_position_m"]
    plan.save_csv(tmp_path / "plan.csv", 10.0)
    header = _headings((tmp_path / "plan.csv").read_text())
    assert header[1:4] == ["x_position_m", "radial-axis_position_m", "x_speed_m_s"]
    assert header[-3:] == ["x_force_N", "radial-axis_force_N", "power_W"]


def test_columns_of_a_mixed_robot(plan_of, tmp_path):
    plan = plan_of(MIXED)
    text = csv_text(plan, "angle:deg,position:mm,torque,speed:rpm", 10.0)
    assert _headings(text) == [
        "x_position_mm", "radial-axis_angle_deg", "x_force_N", "radial-axis_torque_Nm",
        "x_speed_m_s", "radial-axis_speed_rpm",
    ]  # fmt: skip
    last = text.splitlines()[-1].split(",")
    assert [float(cell) for cell in last[:2]] == pytest.approx([700.0, np.degrees(0.9)])
    assert _headings(csv_text(plan, "angle", 10.0)) == ["x_position_m", "radial-axis_angle_rad"]
    plan.save_csv(tmp_path / "plan.csv", 10.0)
    header = _headings((tmp_path / "plan.csv").read_text())
    assert header[2:7:2] == [
        "radial-axis_angle_rad", "radial-axis_speed_rad_s", "radial-axis_acceleration_rad_s2",
    ]  # fmt: skip


def test_cams_and_records_of_a_mixed_robot_have_the_units_of_each_joint(plan_of, tmp_path):
    plan = plan_of(MIXED)
    export_plan(plan, tmp_path / "a.cam", unit="deg", points=5)
    heading = _headings((tmp_path / "a.cam").read_text())
    assert heading[1::3] == ["x_position_m", "radial-axis_angle_deg"]
    turn = 4096
    records = {"increments": 1e6, "increments_per_revolution": turn, "period": 0.1}
    export_plan(plan, tmp_path / "a.cia402", **records)
    *_, last = (tmp_path / "a.cia402").read_text().splitlines()
    # 700 mm and 0.9 rad
    assert last.split(",")[1:] == ["700000", str(round(0.9 * turn / (2 * np.pi)))]
    told = (tmp_path / "a.cia402").read_text()
    assert " m (proven; sampled " in told
    assert " rad (proven; sampled " in told
    export_plan(plan, tmp_path / "a.st")
    block = (tmp_path / "a.st").read_text()
    assert "joint 1: x [m] *)" in block
    assert "joint 2: radial-axis [rad] *)" in block


@pytest.mark.parametrize(("urdf", "columns", "words"), [
    (GANTRY, "position:deg", "unknown unit of position 'deg'"),
    (GANTRY, "angle,position", "column position is given twice"),
    (MIXED, "angle,position:mm", "column position is given twice"),
    (MIXED, "position:deg", "unknown unit of position 'deg'"),
    (MIXED, "position:mm,angle:m", "column angle is given twice"),
])  # fmt: skip
def test_columns_that_are_none(plan_of, urdf, columns, words):
    with pytest.raises(ValueError, match=words):
        csv_text(plan_of(urdf), columns, 10.0)


def test_positions_are_columns_of_joints_that_slide_alone():
    axis = qa.PointToPoint(qa.LinearAxis(), target=0.3, duration=0.8)
    text = csv_text(qa.evaluate_coefficients(axis, []), "position:mm,force", 10.0)
    assert _headings(text) == ["position_mm", "force_N"]
    arm = qa.PointToPoint(qa.SingleLinkManipulator(), target=0.3, duration=0.8)
    with pytest.raises(ValueError, match="unknown column 'position'"):
        csv_text(qa.evaluate_coefficients(arm, []), "position", 10.0)


def test_axes_of_pictures_are_in_the_units_of_each_joint(plan_of):
    figure = pictures.motion_figure(plan_of(MIXED), quantities=["angle", "speed", "torque"])
    titles = [ax.get_title(loc="left").replace("\n", " ") for ax in figure.axes]
    assert titles[:3] == ["joint position [m]", "joint speed [m/s]", "drive force [N]"]
    assert titles[3:6] == ["joint angle [rad]", "joint speed [rad/s]", "joint torque [N m]"]
    gantry = pictures.motion_figure(plan_of(GANTRY), quantities=["speed", "torque"])
    assert [ax.get_title(loc="left") for ax in gantry.axes][:3] == [
        "joint speed [m/s]", "drive force [N]", "",
    ]  # fmt: skip
    both = pictures.draw_quantity(plan_of(MIXED), "torque").get_title(loc="left")
    assert both == "joint torque or drive force [N m or N]"


def test_names_of_compared_motions_keep_the_letters_of_units(plan_of):
    """Headings of peaks are of the kind of joint; what is swept has its own name."""
    swept = SimpleNamespace(name="radius", insensitivity=None)
    robustness = SimpleNamespace(sweeps=[swept], percentile=lambda *_: 0.0)
    judged = ComparedMotion("plan", motion=plan_of(GANTRY).motion, robustness=robustness)
    columns = list(motions_table([judged], "linear"))
    assert "peak force [N]" in columns
    assert "peak acceleration [m/s^2]" in columns
    assert "radius within 5 %" in columns


def test_a_sliding_joints_entries_are_refused_in_its_units(tmp_path):
    for entries, words in {
        "friction: {x: 5Nms/rad}": "a number in N s/m|N s/m",
        "springs: {x: 1}\nheld: {x: 1}": "is held and in springs",
        "elastic_joints: {x: {damping: 1}}": "has no stiffness; give it in N/m",
        "elastic_joints: {x: -2}": "stiffness of x in elastic_joints is -2 N/m",
    }.items():
        with pytest.raises(ValueError, match=words):
            qa.Robot.load(write_robot(tmp_path, MIXED, f"{FILE}{entries}\n"))


def test_an_arm_keeps_its_units(tmp_path):
    robot = qa.Robot.load(write_robot(tmp_path, ARM, ARM_FILE))
    plant = robot.along(qa.GeometricPath.line([0.0, 0.0], [0.4, 0.3]))
    assert (plant.joint, plant.joint_kinds) == ("rotary", ("rotary", "rotary"))


class _Half:
    """A joint that goes half as far."""

    def motion(self, leading):
        return type(leading)(*(value / 2 for value in leading))


def test_a_joint_that_follows_has_columns_in_its_own_units(plan_of, monkeypatch):
    """A finger that slides follows a joint that turns."""
    plan = plan_of(MIXED)
    plant = type(plan.task.plant)
    monkeypatch.setattr(plant, "followers", {"finger": (1, _Half())})
    monkeypatch.setattr(plant, "kind_of", lambda _, name: "rotary" if "-" in name else "linear")
    text = csv_text(plan, "angle:deg,position:mm,torque", 10.0)
    assert _headings(text) == [
        "x_position_mm", "radial-axis_angle_deg", "finger_position_mm", "x_force_N",
        "radial-axis_torque_Nm",
    ]  # fmt: skip
    assert float(text.splitlines()[-1].split(",")[2]) == pytest.approx(450.0)
