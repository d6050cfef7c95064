"""Robots on the command line, as typed: from a file and waypoints to a trajectory."""

import csv
from ctypes import c_char_p, c_double
from pathlib import Path

import numpy as np
import pytest
import yaml
from c_library import compiled, needs_compiler
from robots import UR5_JOINTS, urdf_of

import quietarm as qa
from quietarm.studies.compare import baseline

START = "--start=0,-80deg,97deg,-107deg,-90deg,0"
TARGET = "--target=80deg,-57deg,69deg,-75deg,-69deg,34deg"
ENDS = f"{START} {TARGET}"
ROBOT = """
urdf: {urdf}
beam: {{at: tool0, length: 0.8, width: 8mm, height: 12mm, youngs_modulus: 70GPa, density: 2700,
       tip_mass: 500g, damping: 0.5%}}
"""


@pytest.fixture(autouse=True)
def _files(folder):
    """A robot's file, and others that are none."""
    Path("ur5_bar.yaml").write_text(ROBOT.format(urdf=urdf_of("ur5_robot.urdf")))
    Path("stiff.yaml").write_text(f"urdf: {urdf_of('ur5_robot.urdf')}\n")
    Path("corner.csv").write_text(
        "0,-1.4,1.7,-1.8,-1.5,0\n1,-1,1.2,-1,-1,0\n0,-1.4,1.7,-1.8,-1.5,0\n"
    )
    Path("short.csv").write_text("0,-1.4,1.7\n1,-1,1.2\n")


@pytest.mark.slow
def test_a_plan_of_a_robot_and_its_files(call):
    outputs = "--output move.json --output move.yaml --output move.csv --output move.html"
    code, out, _ = call(f"plan ur5_bar.yaml {ENDS} --duration 1 {outputs}")
    assert code == 0
    assert "ur5 (6 joints; beam at tool0), along its path in 1 s" in out
    assert "at rest (below 0.001 mm) at the tip within 1 s" in out
    plan = qa.Plan.load("move.json")
    path = plan.task.plant.path
    assert path(1.0) == pytest.approx(np.radians([80, -57, 69, -75, -69, 34]))
    message = yaml.safe_load(Path("move.yaml").read_text())
    assert tuple(message["joint_names"]) == UR5_JOINTS
    assert len(message["points"]) == 1001
    first, last = message["points"][0], message["points"][-1]
    assert first["positions"] == pytest.approx(path(0.0).tolist())
    assert last["positions"] == pytest.approx(path(1.0).tolist())
    assert last["velocities"] == pytest.approx([0.0] * 6, abs=1e-9)
    assert len(last["accelerations"]) == 6
    with open("move.csv", newline="") as file:
        header, *rows = csv.reader(file)
    assert header[1] == "shoulder_pan_joint_angle_rad"
    assert "wrist_3_joint_torque_Nm" in header
    assert float(rows[-1][1]) == pytest.approx(path(1.0)[0])
    page = Path("move.html").read_text()
    assert "distance from rest" in page  # which is not the peak deflection, along one axis
    assert '"Tip displacement"' not in page


@pytest.mark.slow
def test_a_straight_line_in_space(call):
    """The file has the joints' path, and the answer says how straight the link goes."""
    line = f"plan ur5_bar.yaml {START} --line-by=200mm,300mm,-100mm --duration 1"
    code, out, _ = call(f"{line} --output move.json")
    assert code == 0
    assert "line: tool0 goes straight within 1e-09 mm" in out
    assert "at rest (below 0.001 mm)" in out
    plan = qa.Plan.load("move.json")
    assert plan.task.plant.path.joints == UR5_JOINTS


@pytest.mark.slow
def test_a_plan_is_corrected_by_the_whole_equations(call):
    code, out, _ = call(f"plan ur5_bar.yaml {ENDS} --duration 1 --in-full --output move.json")
    assert code == 0
    words = " ".join(out.split())
    assert "on arrival W -0.0" in words  # what makes up for the modes
    assert "as wanted (below 0.001 mm) at the tip" in words
    plan = qa.Plan.load("move.json")
    assert plan.task.final is not None
    assert plan.candidate.in_full.residual <= 1e-5


@pytest.mark.slow
def test_waypoints_of_another_planner(call):
    """A JointTrajectory, joints in another order, is followed without its times."""
    message = {
        "joint_names": list(reversed(UR5_JOINTS)),
        "points": [
            {"positions": [0.0, -1.57, -1.87, 1.7, -1.4, 0.0], "time_from_start": {"sec": 0}},
            {"positions": [0.2, -1.5, -1.6, 1.5, -1.2, 0.6], "time_from_start": {"sec": 7}},
            {"positions": [0.6, -1.2, -1.3, 1.2, -1.0, 1.4], "time_from_start": {"sec": 9}},
        ],
    }
    Path("waypoints.yaml").write_text(yaml.safe_dump(message))
    code, _, _ = call("plan ur5_bar.yaml --path waypoints.yaml --duration 1 --output move.json")
    assert code == 0
    path = qa.Plan.load("move.json").task.plant.path
    assert path(0.0) == pytest.approx([0.0, -1.4, 1.7, -1.87, -1.57, 0.0])
    assert path(1.0) == pytest.approx([1.4, -1.0, 1.2, -1.3, -1.2, 0.6])


@pytest.mark.slow
def test_a_plan_is_compared_with_shapers_and_ruckig_in_phase(call):
    """Ruckig's joints keep their own limits, and what it leaves is much."""
    limits = "--acceleration-limit 14 --speed-limit shoulder_pan_joint=2.6 --terms 6"
    code, _, _ = call(f"plan ur5_bar.yaml {ENDS} --duration 1 {limits} --output move.json")
    assert code == 0
    code, _, _ = call("compare move.json --baselines cycloid,zvd,ruckig --output compared")
    assert code == 0
    with open("compared/motions.csv", newline="") as file:
        rows = {row["motion"]: row for row in csv.DictReader(file)}
    residuals = {name: float(row["residual [mm]"]) for name, row in rows.items()}
    assert residuals["move"] < 1e-3
    assert min(residuals["zvd"], residuals["ruckig"], residuals["cycloid"]) > 5.0
    in_phase = baseline("ruckig", qa.Plan.load("move.json").task).motion
    assert in_phase.peak_speed <= 2.6 * (1 + 1e-6)  # the pan joint turns furthest
    assert float(rows["ruckig"]["peak acceleration [rad/s^2]"]) <= 14 * (1 + 1e-6)


@pytest.mark.slow
def test_ruckig_does_not_follow_a_curved_path(call):
    """One line says so, and what else to compare with."""
    Path("curved.csv").write_text(
        "0,-1.4,1.7,-1.8,-1.5,0\n0.8,-1.3,1.4,-1.4,-1.3,0\n1.4,-1,1.2,-1.3,-1.2,0.6\n"
    )
    line = "plan ur5_bar.yaml --path curved.csv --duration 1 --acceleration-limit 30 --terms 6"
    assert call(f"{line} --output move.json")[0] == 0
    code, out, _ = call("compare move.json --baselines ruckig")
    assert code == 0
    words = " ".join(out.split())
    assert "ruckig goes straight in joint space, and the path of the plan is curved" in words
    assert "with cycloid, shapers and toppra" in words


@pytest.mark.slow
def test_toppra_follows_a_curved_path_within_the_limits_of_all_joints(call):
    """Speeds and accelerations are kept; what swings is left behind."""
    pytest.importorskip("toppra")
    Path("curved.csv").write_text(
        "0,-1.4,1.7,-1.8,-1.5,0\n0.8,-1.3,1.4,-1.4,-1.3,0\n1.4,-1,1.2,-1.3,-1.2,0.6\n"
    )
    limits = "--acceleration-limit 30 --speed-limit elbow_joint=1.2"
    line = f"plan ur5_bar.yaml --path curved.csv --duration 1 {limits} --terms 6"
    assert call(f"{line} --output move.json")[0] == 0
    code, out, _ = call("compare move.json --baselines toppra --output compared")
    assert code == 0
    assert "none of the jerk: its acceleration jumps" in " ".join(out.split())
    with open("compared/motions.csv", newline="") as file:
        rows = {row["motion"]: row for row in csv.DictReader(file)}
    assert float(rows["toppra"]["residual [mm]"]) > 5.0
    assert "exceeds" not in rows["toppra"] or not rows["toppra"]["exceeds"]


@pytest.mark.slow
def test_durations_are_swept_and_points_are_searched(call):
    code, out, _ = call(f"sweep ur5_bar.yaml {ENDS} --duration 0.9,1.0 --output moves.zarr")
    assert code == 0
    assert "optimal" in out
    line = f"search ur5_bar.yaml {ENDS} --duration 1 --bound 0.2 --terms 3"
    code, out, _ = call(f"{line} --population 6 --generations 2 --output found.json")
    assert code == 0
    assert qa.Front.load("found.json").points


@pytest.mark.slow
@needs_compiler
def test_payloads_are_swept_and_their_moves_exported_to_c(call):
    """Payloads are multiples of the mass at the tip; C gives what the dataset's plans give."""
    line = f"sweep ur5_bar.yaml {ENDS} --set payload=0.95,1.1 --duration 0.9,1.0"
    code, out, _ = call(f"{line} --terms 6 --output moves.zarr")
    assert code == 0
    assert "payload" in out
    code, _, _ = call("plan --from moves.zarr --set payload=1.05 --duration 0.95 -o move.json")
    assert code == 0
    plan = qa.Plan.load("move.json")
    assert plan.task.plant.payload == 1.05
    assert call("export moves.zarr --output moves.c")[0] == 0
    library = compiled(Path("moves.c").resolve())
    coefficients = (c_double * 6)()
    assert library.moves_plan(c_double(1.05), c_double(0.95), coefficients) == 0
    assert list(coefficients) == pytest.approx(plan.coefficients, abs=1e-12)
    assert library.moves_plan(c_double(1.2), c_double(0.95), coefficients) == 1
    names = (c_char_p * 6).in_dll(library, "moves_joints")
    assert tuple(name.decode() for name in names) == UR5_JOINTS
    times = [-1.0, 0.0, 0.1, 0.4, 0.94, 0.95, 2.0, float("nan")]
    for time in times:
        values = [(c_double * 6)() for _ in range(3)]
        library.moves_at(coefficients, c_double(0.95), c_double(time), *values)
        held = np.clip(np.nan_to_num(time), 0.0, 0.95)
        sample = plan.sampled([held] if held else [0.0]).sample
        for order, found in enumerate(values):
            expected = [float(joint[order][0]) for joint in sample.joints]
            assert list(found) == pytest.approx(expected, abs=1e-7), (time, order)


def test_the_page_of_sliders_is_of_plants_of_one_joint(refused):
    assert "give it to quietarm plan, evaluate, front or search" in refused("explore ur5_bar.yaml")


@pytest.mark.slow
def test_ways_are_shares_of_the_path_and_have_no_angles(call):
    """The place on a path goes from 0 to 1, in whatever units the joints are."""
    line = f"evaluate ur5_bar.yaml {ENDS} --duration 1 --coefficients=0,-3 --output move.json"
    code, out, _ = call(line)
    assert code == 0
    words = " ".join(out.split())
    assert "along its path in 1 s" in words
    assert " of the path on the way" in words
    assert "deg" not in words
    code, out, _ = call("compare move.json --baselines cycloid")
    assert code == 0
    assert "The joint turns back on its way: move by" in " ".join(out.split())
    assert " of the path" in " ".join(out.split())


@pytest.mark.slow
def test_limits_by_joint_and_of_the_file(call):
    """A limit that is typed stands in place of that of the file, of the joint that it names."""
    Path("limited.yaml").write_text(Path("ur5_bar.yaml").read_text() + "limits: urdf\n")
    line = f"plan limited.yaml {ENDS} --duration 2 --torque-limit elbow_joint=30,wrist_1_joint=20Nm"
    code, out, _ = call(f"{line} --output move.json")
    assert code == 0
    task = qa.Plan.load("move.json").task
    assert dict(task.torque_limit) == {
        "shoulder_pan_joint": 150.0, "shoulder_lift_joint": 150.0, "elbow_joint": 30.0,
        "wrist_1_joint": 20.0, "wrist_2_joint": 28.0, "wrist_3_joint": 28.0,
    }  # fmt: skip
    assert dict(task.speed_limit)["elbow_joint"] == 3.15
    assert "elbow_joint 30 N m" in out


@pytest.mark.slow
def test_a_robot_is_listed_with_what_was_read(call):
    code, out, _ = call(f"list ur5_bar.yaml {ENDS}")
    assert code == 0
    for words in (
        "upper_arm_link 8.393", "0.2074 kg and 0.5 kg at its end, 5 hinges in each",
        "modes 3.17, 4.71 Hz (left out: 46.3, 69.3 ...)", "sag 14.", "rotor inertia",
        "none: give limits, urdf or a joint_limits.yaml",
    ):  # fmt: skip
        assert words in " ".join(out.split()), words


@pytest.mark.parametrize(("line", "words"), [
    ("list ur5_bar.yaml --path short.csv", "is of 3 joints, and the robot drives 6"),
    (f"list ur5_bar.yaml {START} --target=9,0,0,0,0,0", "its range is -6.28"),
])  # fmt: skip
def test_a_list_refuses_the_paths_that_a_plan_does(refused, line, words):
    assert words in refused(line)


@pytest.mark.slow_after(5)
@pytest.mark.parametrize(("line", "words"), [
    ("plan ur5_bar.yaml --duration 1", "has no path; give --start and --target"),
    (f"plan ur5_bar.yaml {ENDS}", "Missing option '--duration'"),
    (f"plan ur5_bar.yaml {START} --target=1,2 --duration 1", "--target has 2 positions"),
    (f"plan ur5_bar.yaml {START} --target=far,0,0,0,0,0 --duration 1", "'far' is not a position"),
    (f"plan ur5_bar.yaml {START} --target=9,0,0,0,0,0 --duration 1", "its range is -6.28"),
    (f"plan ur5_bar.yaml {START} {START.replace('start', 'target')} --duration 1", "a length of 0"),
    (f"plan ur5_bar.yaml {ENDS} --duration 1 --set x=1", "robot has no parameter 'x'"),
    (f"plan ur5_bar.yaml {START} --target=90,0,0,0,0,0 --duration 1", "were degrees meant?"),
    (f"plan ur5_bar.yaml {ENDS} --duration 1 --path corner.csv", "--start is in the file of"),
    ("plan ur5_bar.yaml --path corner.csv --free-orientation --duration 1", "without --path"),
    (f"plan ur5_bar.yaml {ENDS} --duration 1 --set payload=1.5", "its tables reach from 0.7 to"),
    (f"plan ur5_bar.yaml {ENDS} --duration 1 --set payload=0.9,1.1", "payload has 2 values here"),
    (f"plan ur5_bar.yaml {ENDS} --duration 1 --torque-limit elbow=3", "has no joint 'elbow'"),
    ("plan ur5_bar.yaml --path corner.csv --duration 1", "turns back at waypoint 2, a corner"),
    ("plan ur5_bar.yaml --path short.csv --duration 1", "is of 3 joints, and the robot drives 6"),
    ("plan ur5_bar.yaml --path none.csv --duration 1", "none.csv cannot be read"),
    (f"plan stiff.yaml {ENDS} --duration 1", "has nothing that bends; give a beam"),
    (f"plan none.yaml {ENDS} --duration 1", "none.yaml cannot be read"),
    (f"plan ur5_bar.yaml {START} --line-by 2,0,0 --duration 1", "of its 2 m: the place is within"),
    (f"plan ur5_bar.yaml {START} --line-by 2,0,0 --free-orientation --duration 1", "out of reach"),
    (f"plan ur5_bar.yaml {ENDS} --free-orientation --duration 1", "is for --line-to and --line-by"),
    (f"plan ur5_bar.yaml {START} --line-by 0,0,0 --duration 1", "the line has a length of 0 m"),
    (f"plan ur5_bar.yaml {START} --line-by 1,0 --duration 1", "--line-by has 2 numbers; give x,y"),
    (f"plan ur5_bar.yaml {START} --line-to 1,a,0 --duration 1", "'a' is not a number of --line-to"),
    (f"plan ur5_bar.yaml {START} --line-to 1,0,0,0,180,0 --duration 1", "give 180deg"),
    (f"plan ur5_bar.yaml {START} --line-to 1,0,0 --line-by 1,0,0 --duration 1", "in place of"),
    (f"plan ur5_bar.yaml {ENDS} --line-by 1,0,0 --duration 1", "--target is where joints go"),
    (f"plan ur5_bar.yaml {START} --line-by 1,0,0 --link tool --duration 1", "did you mean 'tool0'"),
    ("plan ur5_bar.yaml --line-by 0,0,0.1 --duration 1", "a line begins somewhere; give --start"),
    (f"plan ur5_bar.yaml {ENDS} --link tool0 --duration 1", "--link is for --line-to and"),
    ("plan single-link --line-by 0,0,1 --target 1 --duration 1", "--line-by is for a robot"),
    ("plan single-link --target 1 --duration 1 --in-full", "only plans of robots are corrected"),
    (f"plan ur5_bar.yaml {ENDS} --duration 1 --in-full --error frequency=5%", "leave the errors"),
    (f"plan ur5_bar.yaml {ENDS} --duration 1 --in-full --profile free", "is not for free"),
    ("plan single-link --path corner.csv --target 1 --duration 1", "--path is for a robot"),
])  # fmt: skip
def test_what_is_refused_in_one_line(refused, line, words):
    assert words in refused(f"{line} --output move.json")
