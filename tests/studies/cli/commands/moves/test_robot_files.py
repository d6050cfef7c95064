"""Files of robots, limits and paths on the command line: what is used, named and refused."""

import re
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from small_robots import ARM, ARM_FILE, MIXED, write_robot
from trajectories import trajectory_text, trapezoid

import quietarm as qa

MOVE = "--start=0,0 --target=0.4,0.3 --duration 1 --coefficients=0"
LINE = "robot.yaml --start=0.4,1.0 --line-by=0.1,0,0 --duration 1"


def _words(out):
    """Return what was printed, in one line."""
    return " ".join(out.split())


def test_limits_of_a_gripper_are_no_limits_of_the_move(folder, call):
    write_robot(folder, ARM, f"{ARM_FILE}limits: urdf\n")
    code, out, _ = call(f"evaluate robot.yaml {MOVE}")
    assert code == 0
    assert "limits torque a, b 150 N m, speed a, b 3 rad/s" in _words(out)
    assert "grip" not in out


def test_the_task_of_a_command_is_the_one_that_the_robot_makes(folder, call, refused):
    file = write_robot(folder, ARM, ARM_FILE, "a: {max_acceleration: 8}")
    limits = "--torque-limit a=90 --speed-limit b=170"
    code, out, _ = call(f"evaluate robot.yaml {MOVE} {limits}")
    assert code == 0
    far = "warning: speed limit far above the URDF's: b 170 rad/s (URDF 3); were degrees meant?"
    assert far in _words(out)
    assert out.count("far above") == 1
    move = f"evaluate robot.yaml {MOVE} --torque-limit a=90"
    removed = "--acceleration-limit none --speed-limit b=none"
    assert call(f"{move} {removed} --output plan.json")[0] == 0
    path = qa.GeometricPath.line([0.0, 0.0], [0.4, 0.3], joints=("a", "b"))
    robot = qa.Robot.load(file)
    task = robot.task(path, 1.0, torque_limit={"a": 90.0}, acceleration_limit=None)
    assert [limit.name for limit in task.limits] == ["torque", "speed"]
    task = replace(task, bounds={**task.bounds, "speed": {"a": task.bounds["speed"]["a"]}})
    assert qa.Plan.load("plan.json").task == task
    all_kept = robot.task(path, 1.0, torque_limit={"a": 90.0})
    assert [limit.name for limit in all_kept.limits] == ["torque", "speed", "acceleration"]
    assert "robot has no joint 'c'" in refused(f"{move} --speed-limit c=none")


def test_what_a_file_of_limits_leaves_out_stands_beside_the_figures(folder, call):
    write_robot(
        folder, ARM, ARM_FILE, "a: {max_acceleration: 8, max_deceleration: -3}\n  wheel: {}"
    )
    for line in (f"evaluate robot.yaml {MOVE}", "list robot.yaml"):
        code, out, _ = call(line)
        words = _words(out)
        assert code == 0
        assert words.count("warning limits file joint_limits.yaml: ") == 2
        assert "limits of joints that the URDF does not have: wheel" in words
        assert "max_acceleration and max_deceleration bounds both directions: a 3" in words
    assert "acceleration limit a 3 rad/s^2" in words


def test_an_unknown_limit_is_refused_in_one_line(folder, refused):
    write_robot(folder, ARM, ARM_FILE, "a: {max_acc: 8}")
    assert "max_acc of a in limits: did you mean max_acceleration?" in refused("list robot.yaml")


@pytest.mark.slow
def test_the_path_says_how_far_its_spline_swings_out(folder, call):
    write_robot(folder, ARM, ARM_FILE)
    Path("way.csv").write_text("time,a,b,grip\n0,0,0,0\n1,0.5,0,0\n2,0.5,0.5,0\n3,0,0.5,0\n")
    # of joint a by hand: the natural quintic passes the middle of the square's side at 0.5625
    swing = "up to 0.11 rad from the straight lines between waypoints, at b (a 0.063 rad)"
    for line in ("list robot.yaml", "evaluate robot.yaml --duration 2 --coefficients=0"):
        code, out, _ = call(f"{line} --path way.csv")
        words = _words(out)
        assert code == 0
        assert "path not used of the table: times; " in words
        assert "joints that the robot does not drive are left out: grip; " in words
        assert f"; the spline is {swing}" in words


def test_a_line_whose_orientation_is_free_is_one_for_two_joints(folder, call, refused):
    write_robot(folder, ARM, ARM_FILE)
    line = "list robot.yaml --start=0.3,0.9 --line-by=-0.1,0.02,0"
    message = refused(f"plan {LINE}")
    assert "within reach, but not with the orientation that a line keeps, for which 2" in message
    assert "leave it free by --free-orientation (turns=False), or give waypoints" in message
    code, out, _ = call(f"{line} --free-orientation")
    assert code == 0
    assert "driven a, b" in _words(out)


def test_waypoints_are_blended_and_taken_in_part(folder, call, refused):
    write_robot(folder, ARM, ARM_FILE)
    Path("points.csv").write_text("b,a\n0,0\n0.3,0.5\n0.9,0.2\n1.2,0.8\n")
    code, out, _ = call("list robot.yaml --path points.csv --waypoints 2:4 --blend 5mm")
    assert code == 0
    assert re.search(r"waypoint 3 is passed at [\d.]+ mm, blended within 5 mm", _words(out))
    first, *_ = lines = out.splitlines()
    assert re.match(r"arm, 2 driven joints: along the path it swings at .* Hz, and sags by", first)
    assert max(len(line.rstrip()) for line in lines) <= 100
    assert out.count("\npath") == 1
    assert "waypoint 2" not in out  # they are numbered as in the file
    for words, remedy in (
        ("--waypoints 2-4", "--waypoints is '2-4'; give two numbers, such as 2:4"),
        ("--waypoints 3:9", "path points.csv: waypoints 3:9 are none of 4; give the numbers of"),
        ("--blend 5mm --path-tolerance 1deg", "--path-tolerance is for a spline, and --blend"),
    ):
        assert remedy in refused(f"list robot.yaml --path points.csv {words}")
    Path("back.csv").write_text("a,b\n0,0\n0.2,0.1\n0.5,0.3\n0.2,0.1\n0.6,0.8\n")
    for words in ("", " --path-tolerance 0.001", " --blend 5mm"):
        error = refused(f"list robot.yaml --path back.csv --waypoints 2:5{words}")
        assert "the path turns back at waypoint 3, a corner" in error


@pytest.mark.slow
def test_radii_that_do_not_fit_the_waypoints_are_refused(folder, refused):
    write_robot(folder, ARM, ARM_FILE)
    Path("points.csv").write_text("b,a\n0,0\n0.3,0.5\n0.9,0.2\n1.2,0.8\n")
    for words, remedy in (
        ("--blend 2deg", "'2deg' is not a radius of --blend"),
        ("--blend 50", "m apart; were millimetres meant? give 50mm"),
        ("--blend 1mm,2mm,3mm", "path points.csv: there are 3 radii and 2 waypoints between"),
        ("--waypoints 3:4 --blend 5mm", "a blend is at a waypoint between two others"),
    ):
        assert remedy in refused(f"list robot.yaml --path points.csv {words}")
    assert "--blend is for the waypoints of --path" in refused(f"plan {LINE} --blend 5mm")
    timed = "evaluate robot.yaml --path points.csv --as-timed --blend 5mm"
    assert "--blend" in refused(timed)


def test_a_repeated_waypoint_is_named(folder, call):
    write_robot(folder, ARM, ARM_FILE)
    Path("close.csv").write_text("a,b\n0,0\n0.5,0.3\n0.50001,0.30001\n1.0,0.5\n")
    code, out, _ = call("list robot.yaml --path close.csv")
    assert code == 0
    assert "waypoints 2 and 3 are 1.4e-05 rad (or m) apart and taken as one" in _words(out)


def test_limits_of_joints_that_turn_and_slide_are_typed_by_name(folder, call, refused):
    write_robot(folder, MIXED)
    move = "robot.yaml --start=0.2,0.1 --target=700mm,50deg --duration 1 --coefficients=0"
    code, out, _ = call(f"evaluate {move} --speed-limit x=1500mm/s,radial-axis=120deg/s")
    assert code == 0
    assert "speed x 1.5 m/s; radial-axis 2.0944 rad/s" in _words(out)
    message = refused(f"evaluate {move} --speed-limit 1500mm/s")
    assert "the robot has both; give a limit of each by its name" in message


@pytest.mark.slow_after(1)
@pytest.mark.parametrize("columns", ["position:mm,force:kN", "angle:mm,torque"])
def test_a_linear_axis_has_columns_of_positions(folder, call, columns):
    axis = qa.PointToPoint(qa.LinearAxis(), target=0.3, duration=0.8)
    qa.evaluate_coefficients(axis, []).save(folder / "plan.json")
    code, out, _ = call(f"export plan.json --output - --columns {columns} --rate 10")
    assert code == 0
    assert out.startswith("position_mm,force_")
    assert out.splitlines()[-1].startswith("300,")


LAW = partial(trapezoid, 0.25, duration=0.6)


@pytest.mark.slow
@pytest.mark.parametrize(("option", "offers"), [
    ("", ["feasible with all else unchanged: residual limit 0.00", "acceleration limit 1",
          "rad/s^2 at a"]),
    (" --error payload=10% --residual-limit 0.01mm", ["may be feasible", "residual limit 0.00"]),
])  # fmt: skip
def test_what_would_do_may_be_a_limit_that_is_of_no_joint(folder, refused, option, offers):
    """No rigid joint is too slow here; the residual, of no joint, is beside a joint's limit."""
    write_robot(folder, ARM, f"{ARM_FILE}limits: urdf\n")
    line = "plan robot.yaml --start=0,0 --target=0.5,0.4 --duration 0.6 --terms 4"
    error = refused(f"{line} --acceleration-limit 8{option}", status=1)
    assert "found no motion of 4 terms with" in error
    for words in offers:
        assert words in error


@pytest.mark.slow
def test_a_trajectory_is_judged_as_it_is_timed(folder, call):
    """Its figures, the limits that it passes, and what makes it ring."""
    write_robot(folder, ARM, ARM_FILE, "a: {has_jerk_limits: true, max_jerk: 900}")
    text = trajectory_text(("a", "b", "grip"), [0, 0.1, 0.01], [1, 0.6, 0.03], 0.6, LAW)
    Path("moveit.yaml").write_text(text)
    code, out, _ = call("evaluate robot.yaml --path moveit.yaml --as-timed")
    words = _words(out)
    assert code == 0
    assert "warning: joint 'grip' moves by 0.02 m, and the robot's file does not drive it" in words
    assert "arm, as it is timed in 0.6 s" in words
    assert "(beyond the limit of a 900)" in words
    assert "step the acceleration of a jumps by" in words
    assert "mm after arrival; of these" in words
    assert "the jerk makes it ring" in words
    assert "with the same path and time a plan leaves" in words


@pytest.mark.parametrize(("line", "words"), [
    ("evaluate robot.yaml --as-timed", "give its file and --path trajectory.yaml"),
    ("evaluate single-link --path way.csv --as-timed", "is for the trajectory of a robot"),
    ("evaluate robot.yaml --path way.csv --as-timed", "way.csv: has no times; give time_from_"),
    ("evaluate robot.yaml --path way.csv --as-timed --terms 4", "--terms is not for a trajectory"),
    ("list robot.yaml --path way.csv --path-tolerance 2kg", "'2kg' is not an angle; give"),
    ("list robot.yaml --path way.csv --path-tolerance 0", "--path-tolerance is 0 rad; give a pos"),
    (f"evaluate robot.yaml {MOVE} --path-tolerance 1deg", "is for the waypoints of --path"),
    ("evaluate single-link --target 1 --duration 1 --coefficients=0 --path-tolerance 1deg",
     "--path-tolerance is for a robot, whose file is PLANT"),
])  # fmt: skip
def test_trajectories_and_tolerances_that_cannot_be_used_are_refused(folder, refused, line, words):
    write_robot(folder, ARM, ARM_FILE)
    Path("way.csv").write_text("a,b\n0,0\n0.5,0.2\n0.5,1\n")
    assert words in refused(line)


def test_a_path_with_corners_is_rounded_within_its_tolerance(folder, call):
    write_robot(folder, ARM, ARM_FILE)
    Path("way.csv").write_text("a,b\n0,0\n0.5,0\n0.5,0.5\n")
    code, out, _ = call("list robot.yaml --path way.csv --path-tolerance 0.5deg")
    words = _words(out)
    assert code == 0
    assert "straight between 3 of 3 points, with round corners, within 0.00873 rad" in words
    # 0.45 of 0.5 deg at the corner: half a right angle from both
    assert "the path is up to 0.0056 rad from the straight lines between waypoints" in words
    assert re.search(r"and the tip [\d.]+ mm", words)


@pytest.mark.slow
def test_the_misfit_of_every_posture_stands_in_one_row(folder, call):
    entries = ["{frequency: 3Hz, at: [0, 0]}", "{frequency: 3.06Hz, at: [0.4, 1rad]}"]
    write_robot(folder, ARM, f"{ARM_FILE}measured: [{', '.join(entries)}]\n")
    code, out, _ = call("list robot.yaml")
    assert code == 0
    # upright axes: the two have one frequency, 1 % from each
    words = _words(out)
    assert "the load as stated: these frequencies do not tell it from the springs" in words
    assert "misfit 3 Hz -0.99 %, 3.06 Hz +1 %" in words
