"""Plans in the forms that controllers read."""

import csv
import re
from ctypes import c_double
from dataclasses import replace
from functools import partial
from math import inf, nan, pi

import numpy as np
import pytest
import yaml
from c_library import compiled, joint_by, needs_compiler
from scipy.interpolate import BPoly
from scipy.io import loadmat

from quietarm.models import SingleLinkManipulator
from quietarm.ocp import (
    CycloidGaussians,
    CycloidNetwork,
    CycloidPolynomial,
    CycloidSpline,
    PointToPoint,
    Uncertainty,
    evaluate_coefficients,
    plan_move,
    shaped_cycloid,
)
from quietarm.views.formats.between_rows import interpolation_note, residual_between
from quietarm.views.formats.formats import export_plan

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


@pytest.mark.slow_after(2)
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


@pytest.mark.slow
def test_the_command_writes_source_and_header(call, plan, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    plan.save("plan.json")
    code, out, err = call("export plan.json --output move.c")
    assert (code, out.splitlines()[:2], err) == (0, ["wrote move.h", "wrote move.c"], "")
    told = " ".join(out.split())
    assert "exact at any time; straight lines between calls 1 ms apart are at most" in told
    assert "void move_at(double time" in (tmp_path / "move.h").read_text()
    code, _, err = call("export plan.json --output move.csv --columns tme")
    assert (code, "did you mean 'time'" in err) == (2, True)


@pytest.mark.slow
def test_a_rate_that_is_too_coarse_says_what_a_controller_leaves():
    task = replace(LINK, start=0.0, acceleration_limit=40.0, jerk_limit=2000.0)
    plan = plan_move(task, CycloidPolynomial(12), starts=1)
    # by hand, a third way: quintics between the points, and their motion by fixed small steps
    times = np.arange(9) / 10
    quintics = BPoly.from_derivatives(times, plan.sampled(times).joint)
    left = residual_by_small_steps(task, quintics.derivative(2), quintics.derivative(1))
    assert residual_between(plan, 10, 3) == pytest.approx(left, rel=1e-3)
    note = interpolation_note(plan, 10)
    assert note.startswith("10 Hz is coarse: a controller that interpolates by quintics of angle, ")
    assert f"leaves {1e3 * left:.2g}"[:10] in note
    finer = float(re.search(r"; --rate (\S+) leaves", note)[1])
    assert residual_between(plan, finer, 3) < plan.residual + 1e-3 * plan.motion.peak_deflection
    assert interpolation_note(plan, finer) == interpolation_note(plan, 1000) == ""
    assert "by cubics of angle and speed" in interpolation_note(plan, 10, ("angle", "speed"))
    assert "by a cubic spline of the angle" in interpolation_note(plan, 10, ("time", "angle"))
    assert interpolation_note(plan, 10, ("time", "torque")) == ""


def residual_by_small_steps(task, acceleration, speed):
    """Largest tip displacement in the second after arrival, by eq (9) and the midpoint rule."""
    link, steps = task.plant, 20_000
    h, W, rate = task.duration / steps, 0.0, 0.0
    middles = (np.arange(steps) + 0.5) * h
    forces, speeds = -link.beta1 * acceleration(middles), speed(middles)
    stiffness = link.omega**2 + link.beta2 * speeds**2
    damping = 2 * link.zeta * link.omega
    for force, k in zip(forces.tolist(), stiffness.tolist(), strict=True):
        half_rate = rate + h / 2 * (force - k * W - damping * rate)
        half = W + h / 2 * rate
        W, rate = W + h * half_rate, rate + h * (force - k * half - damping * half_rate)
    # then the free vibration of a damped oscillator
    t, decay = np.linspace(0, 1, 20_001), link.zeta * link.omega
    damped = link.omega * np.sqrt(1 - link.zeta**2)
    swing = W * np.cos(damped * t) + (rate + decay * W) / damped * np.sin(damped * t)
    return link.phi * np.abs(swing * np.exp(-decay * t)).max()


@pytest.mark.slow_after(1)
@pytest.mark.parametrize(
    ("typed", "begins"),
    [
        ("", "time_s,angle_rad,speed_rad_s,acceleration_rad_s2,tip_m,torque_Nm,power_W\n0,"),
        ("--columns time:ms,angle:deg", "time_ms,angle_deg\n0,"),
        ("--format ros", "joint_names:\n- 'joint'\n"),
    ],
)
def test_a_table_goes_to_standard_output_and_words_to_standard_error(call, folder, typed, begins):
    plan_along(shaped_cycloid(LINK, "zvd")).save("plan.json")
    code, out, err = call(f"export plan.json --output - --rate 4 {typed}")
    assert (code, out[: len(begins)]) == (0, begins)
    assert err.startswith("4 Hz is coarse: a controller that interpolates by ")
    assert [path.name for path in folder.iterdir()] == ["plan.json"]


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


@pytest.mark.slow
def test_python_writes_films_and_pages_as_the_command_does(plan, tmp_path):
    written = export_plan(plan, tmp_path / "move.gif", width=200, rate=4)
    assert written == [tmp_path / "move.gif"]
    assert written[0].read_bytes().startswith(b"GIF8")
    export_plan(plan, tmp_path / "move.html")
    assert (tmp_path / "move.html").read_text().lower().startswith("<!doctype html>")


@pytest.mark.parametrize(
    ("settings", "why"),
    [
        ({"columns": "time"}, "columns is for csv and mat, not for ros"),
        ({"rats": 5.0}, r"unknown setting of ros 'rats'; did you mean 'rate'\?"),
        ({"rate": "often"}, "rate is 'often'; give a number in Hz"),
        ({"joint": 3}, "joint is 3; give a text"),
    ],
)
def test_a_setting_that_a_format_does_not_have_is_refused(plan, tmp_path, settings, why):
    with pytest.raises(ValueError, match=why):
        export_plan(plan, tmp_path / "move.yaml", **settings)
    assert not list(tmp_path.iterdir())
