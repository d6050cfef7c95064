"""Plans in the forms that controllers read."""

import csv
from ctypes import c_double
from dataclasses import replace
from functools import partial
from math import inf, nan, pi

import numpy as np
import pytest
import yaml
from c_library import compiled, joint_by, needs_compiler
from quietarm.models import SingleLinkManipulator
from quietarm.ocp import (
    CycloidGaussians,
    CycloidNetwork,
    CycloidPolynomial,
    CycloidSpline,
    PointToPoint,
    Uncertainty,
    evaluate_coefficients,
    shaped_cycloid,
)
from quietarm.studies.export.formats import export_plan
from scipy.io import loadmat

LINK = PointToPoint(SingleLinkManipulator(), pi / 6, 0.8, start=-0.2)
PROFILES = {
    "polynomial": CycloidPolynomial(6),
    "spline": CycloidSpline(6),
    "network": CycloidNetwork(5),
    "gaussians": CycloidGaussians(5),
    "zvd": shaped_cycloid(LINK, "zvd"),
}


def plan_along(profile, task=LINK):
    rng = np.random.default_rng(5)
    coefficients = profile.plain + 0.1 * rng.uniform(-1, 1, profile.size)
    return evaluate_coefficients(task, coefficients, profile=profile)


@pytest.fixture
def plan():
    return plan_along(CycloidPolynomial(6))


@needs_compiler
@pytest.mark.parametrize("profile", PROFILES.values(), ids=PROFILES)
def test_c_gives_the_joints_motion_at_any_time(profile, tmp_path):
    plan = plan_along(profile)
    export_plan(plan, tmp_path / "move.c")
    joint = partial(joint_by, compiled(tmp_path / "move.c").move_at)
    times = np.sort(np.random.default_rng(1).uniform(0, 0.8, 200))
    expected = plan.sampled(times).joint
    found = np.array([joint(c_double(time)) for time in times])
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-12 * np.abs(expected).max())
    assert joint(c_double(-1.0)) == [-0.2, 0.0, 0.0]
    assert joint(c_double(5.0)) == [pi / 6, 0.0, 0.0]
    assert joint(c_double(inf)) == [pi / 6, 0.0, 0.0]
    assert joint(c_double(nan)) == [-0.2, 0.0, 0.0]  # no number, and no motion


def test_csv_has_the_columns_units_and_rate_that_are_asked_for(plan, tmp_path):
    path = tmp_path / "move.csv"
    export_plan(plan, path, columns="time:ms,speed:rpm,angle:deg,tip:mm,torque", rate=100)
    rows = list(csv.DictReader(path.read_text().splitlines()))
    assert list(rows[0]) == ["time_ms", "speed_rpm", "angle_deg", "tip_mm", "torque_Nm"]
    assert [float(row["time_ms"]) for row in rows] == pytest.approx(10.0 * np.arange(81))
    motion = plan.sampled(np.arange(81) / 100)
    # a turn a minute is 2 pi in 60 s
    expected = {
        "speed_rpm": motion.joint[:, 1] * 30 / pi, "tip_mm": 1e3 * motion.tips[:, 0],
        "angle_deg": np.degrees(motion.joint[:, 0]), "torque_Nm": motion.torque,
    }  # fmt: skip
    for name, values in expected.items():
        least = 1e-10 if name == "torque_Nm" else 1e-9
        assert [float(row[name]) for row in rows] == pytest.approx(values, abs=least)


def test_ros_reads_a_trajectory_of_the_joint(plan, tmp_path):
    export_plan(plan, tmp_path / "move.yaml", rate=30, joint="arm's shoulder")
    message = yaml.safe_load((tmp_path / "move.yaml").read_text())
    # trajectory_msgs/msg/JointTrajectory: joint_names, points; of a point: positions, velocities,
    # accelerations, time_from_start with sec and nanosec
    assert message["joint_names"] == ["arm's shoulder"]
    times = [p["time_from_start"] for p in message["points"]]
    seconds = np.array([t["sec"] + 1e-9 * t["nanosec"] for t in times])
    assert seconds == pytest.approx(np.arange(25) / 30, abs=1e-9)
    joint = plan.sampled(np.arange(25) / 30).joint
    names = ("positions", "velocities", "accelerations")
    found = [[point[name][0] for name in names] for point in message["points"]]
    assert np.array(found) == pytest.approx(joint, abs=1e-10)
    assert all(isinstance(p["positions"][0], float) for p in message["points"])


def test_matlab_reads_columns_and_coefficients(plan, tmp_path):
    export_plan(plan, tmp_path / "move.mat", columns="time,angle:deg", rate=50)
    read = loadmat(tmp_path / "move.mat")
    assert read["angle_deg"].shape == (41, 1)
    assert read["coefficients"].ravel().tolist() == list(plan.coefficients)
    assert read["duration_s"].item() == 0.8


def test_the_command_writes_source_and_header(call, plan, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    plan.save("plan.json")
    code, out, err = call("export plan.json --output move.c")
    assert (code, out.split(), err) == (0, ["wrote", "move.h", "wrote", "move.c"], "")
    assert "void move_at(double time" in (tmp_path / "move.h").read_text()
    code, _, err = call("export plan.json --output move.csv --columns tme")
    assert (code, "did you mean 'time'" in err) == (2, True)


def test_the_tips_of_a_robust_plan_are_named_by_their_scenarios(tmp_path):
    task = replace(LINK, uncertainty=Uncertainty({"frequency": 0.05}, ((-0.05,), (0.05,))))
    plan = plan_along(CycloidPolynomial(6), task)
    export_plan(plan, tmp_path / "move.csv", columns="time,tip:mm", rate=100)
    rows = list(csv.DictReader((tmp_path / "move.csv").read_text().splitlines()))
    names = ["time_s", "tip_mm", "tip_mm frequency -5 %", "tip_mm frequency +5 %"]
    assert list(rows[0]) == names
    softer = plan.candidate.perturbed({"frequency": -0.05}).sample(np.arange(81) / 100)
    found = [float(row[names[2]]) for row in rows]
    assert found == pytest.approx(1e3 * softer.tips[:, 0], abs=1e-9)
    export_plan(plan, tmp_path / "move.mat", columns="tip:mm", rate=50)
    assert "tip_mm_frequency_minus_5" in loadmat(tmp_path / "move.mat")


def test_a_film_is_not_written_as_a_table(plan, tmp_path):
    with pytest.raises(ValueError, match=r"is a film; make it by animate\(plan\)"):
        export_plan(plan, tmp_path / "move.gif")
