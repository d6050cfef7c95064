"""Paths of joints: what they pass through, how smooth they are, and what is no path."""

from itertools import pairwise

import numpy as np
import pytest
from robots import END, START, straight
from scipy.spatial import cKDTree
from small_robots import ARM, ARM_FILE, write_robot

import quietarm as qa
from quietarm.models.robot.path.joint_table import read_joint_table
from quietarm.ocp.saved import plain, typed

PLACES = np.linspace(0.0, 1.0, 401)


def _waypoints():
    """Six, beside the straight line."""
    beside = np.random.default_rng(3).uniform(-0.15, 0.15, (6, 6))
    beside[[0, -1]] = 0.0
    return START + np.linspace(0.0, 1.0, 6)[:, None] * (END - START) + beside


def test_a_line_is_straight():
    path = straight()
    assert path(PLACES) == pytest.approx(START + PLACES[:, None] * (END - START), abs=1e-15)
    assert path(0.3, order=1) == pytest.approx(END - START, abs=1e-14)
    assert path(0.3, order=2) == pytest.approx(np.zeros(6), abs=1e-14)


@pytest.mark.parametrize(("degree", "continuous"), [(5, 4), (3, 2)])
def test_a_spline_goes_smoothly_through_its_waypoints(degree, continuous):
    waypoints = _waypoints()
    path = qa.GeometricPath.through(waypoints, degree=degree)
    assert path(path.knots) == pytest.approx(waypoints, abs=1e-13)
    for order in range(1, continuous + 1):
        size = np.abs(path(PLACES, order)).max()
        for knot in path.knots[1:-1]:
            before, after = path([knot - 1e-9, knot + 1e-9], order)
            assert np.abs(after - before).max() < 1e-6 * size


def test_a_quintic_spline_bends_nowhere_beyond_its_ends():
    """It is natural: of all splines through these points, of the least third derivatives."""
    path = qa.GeometricPath.through(_waypoints())
    assert np.abs(path([0.0, 1.0], 3)).max() < 1e-8 * np.abs(path(PLACES, 3)).max()


def test_waypoints_lie_by_the_way_between_them_or_where_they_are_put():
    waypoints = np.array([[0.0, 0.0], [0.3, 0.4], [0.3, 1.4]])
    assert qa.GeometricPath.through(waypoints).knots == pytest.approx((0.0, 1 / 3, 1.0))
    path = qa.GeometricPath.through(waypoints, at=[0.0, 0.7, 1.0])
    assert path(0.7) == pytest.approx([0.3, 0.4])


def test_a_function_is_followed_within_1e_12():
    def circle(s):
        return [np.cos(2 * s), np.sin(2 * s), np.exp(s)]

    path = qa.GeometricPath.of(circle)
    assert path(PLACES) == pytest.approx(np.array([circle(s) for s in PLACES]), abs=1e-12)


@pytest.mark.parametrize("path", [straight(), qa.GeometricPath.through(_waypoints())])
def test_a_path_goes_on_smoothly_beyond_its_ends(path):
    """A motion may overshoot a little: with the slope and the curvature of the end."""
    for end in (0.0, 1.0):
        for order in range(3):
            before, after = path([end - 1e-8, end + 1e-8], order)
            assert after == pytest.approx(before, abs=1e-5)


@pytest.mark.parametrize(("make", "words"), [
    (lambda: qa.GeometricPath.line(START, START), "the path has a length of 0"),
    (lambda: qa.GeometricPath.of(lambda s: [abs(s - 0.3)]), r"corner or a jump near s = 0\.(3|29)"),
    (lambda: qa.GeometricPath.of(lambda s: [float(s > 0.5)]), r"jump at s = 0\.5"),
    (lambda: qa.GeometricPath.of(lambda s: [np.nan]), "path at s = .* finite number"),
    (lambda: qa.GeometricPath.through([START, END], degree=1), "give 5 or 3: a robot can follow"),
    (lambda: qa.GeometricPath.through([START, START]), "a length of 0 and ends where it begins"),
    (lambda: qa.GeometricPath.through([START, END, START]), "turns back at waypoint 2, a corner"),
    (lambda: qa.GeometricPath.through([START]), "give two rows or more"),
    (lambda: qa.GeometricPath.through([START, [np.nan] * 6]), "waypoint 2 has nan for its joint 1"),
    (lambda: qa.GeometricPath.through([START, END], at=[0.0, 0.9]), "rising from 0 to 1"),
    (lambda: qa.GeometricPath.line(START, "home"), "end of the path is 'home'; give a finite"),
    (
        lambda: qa.GeometricPath((0.0, 0.5, 1.0), (((0.0, 1.0),), ((1.5, 0.5),))),
        r"corner at s = 0\.5",
    ),
])  # fmt: skip
def test_what_is_no_path_is_refused(make, words):
    with pytest.raises(ValueError, match=words):
        make()


def test_a_csv_with_names_gives_them(tmp_path):
    file = tmp_path / "waypoints.csv"
    file.write_text("time,elbow_joint,wrist_1_joint\n0,0.1,0.2\n0.5,0.4,0.3\n1,0.9,0.2\n")
    path = qa.GeometricPath.load(file)
    assert path.joints == ("elbow_joint", "wrist_1_joint")
    assert path(1.0) == pytest.approx([0.9, 0.2])


@pytest.mark.parametrize("mark", [",", ";", "\t", " "])
def test_a_csv_without_names_is_in_the_order_of_the_robots_joints(tmp_path, mark):
    file = tmp_path / "waypoints.csv"
    rows = [[0.1, 0.2], [0.4, 0.3], [0.9, 0.2]]
    text = "\n".join(mark.join(map(str, row)) for row in rows)
    file.write_text(text)
    assert qa.GeometricPath.load(file)(1.0) == pytest.approx([0.9, 0.2])
    if mark != ",":  # as spreadsheets of many countries write it
        file.write_text(text.replace(".", ","), encoding="utf-8-sig")
        assert qa.GeometricPath.load(file)(1.0) == pytest.approx([0.9, 0.2])


@pytest.mark.parametrize(("heading", "row"), [
    ("a_deg;b_mm", "90;5,5"),
    ("a [deg];b (mm)", "90;5,5"),
    ("time_ms;a_angle_deg;b_position_mm;a_speed_rad_s;tip_x_mm", "8;90;5.5;3;4"),  # of export
    ("time_s,a_angle_rev,b_position_m", "0.008,0.25,0.0055"),
    ("a;b", "90deg;5.5mm"),
    ("", "90deg;5.5mm"),
])  # fmt: skip
def test_a_csv_says_its_units_in_headings_or_cells(tmp_path, heading, row):
    file = tmp_path / "waypoints.csv"
    zeros = ";".join("0" for _ in row.split(";")) if ";" in row else "0,0,0"
    file.write_text("\n".join(filter(None, [heading, zeros, row])))
    table = read_joint_table(file)
    assert table.joints == (("a", "b") if heading else ())
    assert table.positions[1] == pytest.approx([np.pi / 2, 0.0055])
    if table.times is not None:
        assert table.times[1] == pytest.approx(0.008)
    told = " ".join(table.remarks)
    assert ("a_speed_rad_s and 1 more" in told) == ("speed" in heading)
    assert ("read of a in" in told) == (heading not in ("", "a;b"))


def test_a_name_may_end_like_a_unit(tmp_path):
    file = tmp_path / "waypoints.csv"
    file.write_text("left_m,b\n0,0\n1,2\n")
    table = read_joint_table(file)
    assert (table.joints, table.positions[1].tolist()) == (("left_m", "b"), [1.0, 2.0])


@pytest.mark.parametrize("wrapped", [False, True])
def test_a_joint_trajectory_gives_its_positions_and_no_times(tmp_path, wrapped):
    lines = [
        "joint_names: [a, b]",
        "points:",
        "- {positions: [0.0, 1.0], time_from_start: {sec: 0, nanosec: 0}}",
        "- {positions: [0.5, 1.5], time_from_start: {sec: 3, nanosec: 0}}",
        "- {positions: [1.0, 1.8], time_from_start: {sec: 9, nanosec: 0}}",
    ]
    if wrapped:
        lines = ["joint_trajectory:", *(f"  {line}" for line in lines)]
    file = tmp_path / "trajectory.yaml"
    file.write_text("\n".join(lines) + "\n")
    path = qa.GeometricPath.load(file)
    assert path.joints == ("a", "b")
    assert path(0.0) == pytest.approx([0.0, 1.0])
    assert path(1.0) == pytest.approx([1.0, 1.8])


@pytest.mark.parametrize(("name", "text", "words"), [
    ("a.csv", "", "is empty; give a row for each waypoint"),
    ("a.csv", "a,b\n1,x\n2,3\n", "a row that is no row of numbers"),
    ("a.csv", "1,2\n3\n", "rows of different lengths"),
    ("a.csv", "a,b\n0,5,1,2\n", "names 2 columns and has 4 numbers in a row"),
    ("a.csv", "1,5;2\n3.5;2\n", "commas and with decimal points, such as '1,5' and '3.5'"),
    ("a.csv", "1,2\n1,2\n", "a.csv: the path has a length of 0"),
    ("a.yaml", "points: 3\n", "is no JointTrajectory"),
    ("a.yaml", "joint_names: [a]\npoints: [{x: 1}]\n", "has no positions at point 1 of 1; write"),
    ("a.yaml", "joint_names: [a]\npoints: []\n", "a.yaml has no points; give two or more"),
    ("a.yaml", "joint_names: [a, b]\npoints: [{positions: [1, 2]}, {positions: [1]}]\n",
     "has 1 of 2 positions at point 2 of 2"),
    ("a.yaml", "joint_names: [a]\npoints: [{positions: [x]}]\n", "has position 'x' at point 1"),
    ("a.yaml", "a: [\n", "is no valid YAML"),
])  # fmt: skip
def test_a_file_that_holds_no_path_is_refused(tmp_path, name, text, words):
    file = tmp_path / name
    file.write_text(text)
    with pytest.raises(ValueError, match=words):
        qa.GeometricPath.load(file)


def test_a_file_that_is_not_there_is_named(tmp_path):
    with pytest.raises(ValueError, match=r"none\.csv cannot be read: no such file"):
        qa.GeometricPath.load(tmp_path / "none.csv")


def test_a_repeated_waypoint_is_taken_as_one_and_named():
    """The points of a teach pendant; the path is that without the second of them."""
    points = [[0.0, 0.0], [0.5, 0.3], [0.50001, 0.30001], [1.0, 0.5]]
    path = qa.GeometricPath.through(points)
    (remark,) = path.remarks
    assert remark.startswith("waypoints 2 and 3 are 1.4e-05 rad (or m) apart and taken as one")
    assert path == qa.GeometricPath.through([points[0], points[1], points[3]])


@pytest.mark.parametrize("place", [0, -1])
def test_the_ends_of_a_path_are_kept_where_they_are_repeated(place):
    points = np.array([[0.0, 0.0], [0.5, 0.3], [1.0, 0.5]])
    repeated = np.insert(points, place % 3, points[place] + 1e-6, axis=0)
    path = qa.GeometricPath.through(repeated)
    assert path(0.0) == pytest.approx(repeated[0], abs=1e-12)
    assert path(1.0) == pytest.approx(repeated[-1], abs=1e-12)


def test_a_waypoint_repeated_anywhere_is_no_jump_of_the_curvature():
    """The repeated point is merged whatever way it is off."""
    draws = np.random.default_rng(0)
    for _ in range(12):
        points = np.cumsum(draws.uniform(0.05, 1.0, (draws.integers(3, 8), 2)), axis=0)
        place = draws.integers(len(points))
        off = draws.uniform(-0.7e-5, 0.7e-5, 2)
        path = qa.GeometricPath.through(np.insert(points, place, points[place] + off, axis=0))
        assert len(path.remarks) == 1
        through = qa.GeometricPath.through(points)
        places = np.linspace(0, 1, 9)
        assert path(places) == pytest.approx(through(places), abs=1e-3)


def test_waypoints_that_are_too_near_for_a_spline_are_named():
    with pytest.raises(ValueError, match="waypoints 2 and 3 are too near each other for a spline"):
        qa.GeometricPath.through(
            [[0.0, 0.0], [1.0, 1.0], [2.0, 3.0], [3.0, 3.0]], at=[0.0, 0.5, 0.50001, 1.0]
        )


def test_how_far_a_spline_leaves_the_lines_between_its_waypoints():
    """Three sides of a square: against the nearest point of them, by many samples."""
    points = np.array([[0.0, 0.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]])
    path = qa.GeometricPath.through(points)
    positions = path(np.linspace(0, 1, 2001))
    sides = np.concatenate([
        begin + np.linspace(0, 1, 501)[:, None] * (end - begin)
        for begin, end in pairwise(points)
    ])  # fmt: skip
    gaps = positions[:, None] - sides
    nearest = np.linalg.norm(gaps, axis=2).argmin(axis=1)
    expected = np.abs(gaps[np.arange(len(positions)), nearest]).max(axis=0)
    assert path.off_straight == pytest.approx(expected, abs=2e-3)
    assert path.off_straight[0] == pytest.approx(0.0625, abs=1e-3)  # at the middle, by symmetry


@pytest.mark.parametrize("path", [
    qa.GeometricPath.line(START, END),
    qa.GeometricPath.of(lambda s: [s + 0.2 * np.sin(9 * s), s]),
])  # fmt: skip
def test_a_path_without_waypoints_leaves_none(path):
    assert not path.off_straight.any()


TRAJECTORY = """joint_names: [a, b]
points:
- {positions: [0.0, 1.0], velocities: [0, 0], effort: [], time_from_start: {sec: 0, nanosec: 0}}
- {positions: [0.5, 1.5], velocities: [0, 0], effort: [], time_from_start: {sec: 3, nanosec: 0}}
- {positions: [1.0, 1.8], velocities: [0, 0], effort: [], time_from_start: {sec: 9, nanosec: 0}}
"""
EMPTY = "multi_dof_joint_trajectory: {header: {frame_id: ''}, joint_names: [], points: []}\n"


def _within(name, text):
    """A message as an entry of another."""
    return f"{name}:\n" + "".join(f"  {line}\n" for line in text.splitlines())


MESSAGES = {
    "RobotTrajectory": _within("joint_trajectory", TRAJECTORY) + EMPTY,
    "goal of ExecuteTrajectory": _within(
        "trajectory", _within("joint_trajectory", TRAJECTORY) + EMPTY
    ),
    "goal of FollowJointTrajectory": _within(
        "goal", _within("trajectory", TRAJECTORY) + "path_tolerance: []\n"
    ),
    "DisplayTrajectory": "model_id: arm\ntrajectory_start: {joint_state: {name: [a]}}\n"
    "trajectory:\n- " + _within("joint_trajectory", TRAJECTORY).replace("\n", "\n  ").rstrip()
    + f"\n  {EMPTY}",
    "echo of a topic": f"{TRAJECTORY}---\n",
}  # fmt: skip


@pytest.mark.parametrize("text", MESSAGES.values(), ids=MESSAGES)
def test_a_trajectory_is_found_within_other_messages(tmp_path, text):
    (tmp_path / "message.yaml").write_text(text)
    path = qa.GeometricPath.load(tmp_path / "message.yaml")
    assert path.joints == ("a", "b")
    assert path(1.0) == pytest.approx([1.0, 1.8])
    assert path.remarks == ("not used of the trajectory: velocities, times",)


@pytest.mark.parametrize(("text", "words"), [
    (f"{TRAJECTORY}---\n{TRAJECTORY}---\n", "has 2 documents; give one"),
    (_within("first", TRAJECTORY) + _within("second", TRAJECTORY),
     "has 2 trajectories: number 1 with 3 points of a, b and number 2 with 3 points of a, b; give"),
    (EMPTY, "is no JointTrajectory"),
    (TRAJECTORY.replace("[a, b]", "[a, a]"), "the path has joint 'a' twice"),
    ("joint_names: [a]\npoints:\n- {transforms: [{x: 1}]}\n", "is no JointTrajectory"),
])  # fmt: skip
def test_what_is_no_single_trajectory_is_refused(tmp_path, text, words):
    (tmp_path / "message.yaml").write_text(text)
    with pytest.raises(ValueError, match=words):
        qa.GeometricPath.load(tmp_path / "message.yaml")


def test_joints_that_the_robot_does_not_drive_are_left_out_and_named(tmp_path):
    """A trajectory of arm and gripper, whose joints stand in another order."""
    robot = qa.Robot.load(write_robot(tmp_path, ARM, ARM_FILE))
    file = tmp_path / "waypoints.csv"
    file.write_text("time,b,grip,a\n0,0,0,0\n1,0.4,0.01,0.2\n2,0.5,0.02,0.6\n")
    path = robot.along(qa.GeometricPath.load(file)).path
    assert path.joints == ("a", "b")
    assert path(1.0) == pytest.approx([0.6, 0.5])
    assert path.remarks == (
        "not used of the table: times",
        "joints that the robot does not drive are left out: grip",
        "warning: joint 'grip' moves by 0.02 m, and the robot's file does not drive it, but holds "
        "it at 0.02; add it to joints, beside a, b",
    )
    file.write_text("grip,a\n0,0\n0.01,0.2\n")
    with pytest.raises(ValueError, match="give positions of b as well"):
        robot.along(qa.GeometricPath.load(file))


SQUARE = np.array([[0.0, 0.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5], [-0.3, 0.9]])
TOLERANCE = 2e-3


def _dense(corners, each=200):
    """Straight lines as a controller has them: many points, evenly."""
    shares = np.linspace(0.0, 1.0, each, endpoint=False)[:, None]
    parts = [begin + shares * (end - begin) for begin, end in pairwise(corners)]
    return np.concatenate([*parts, corners[-1:]])


def _off(path, points):
    """Largest distance of a joint of a path from the lines between points, by many of both."""
    each = 40_000 // len(points)
    lines = _dense(np.asarray(points), each)
    positions = path(np.linspace(0.0, 1.0, 1501))
    _, nearest = cKDTree(lines).query(positions)
    return np.abs(positions - lines[nearest]).max()


@pytest.mark.parametrize("points", [SQUARE, _dense(SQUARE)], ids=["corners", "many points"])
def test_straight_lines_with_corners_are_kept_within_a_tolerance(points):
    path = qa.GeometricPath.within(points, TOLERANCE)
    assert _off(path, SQUARE) <= 1.01 * TOLERANCE
    assert path.off_straight.max() == pytest.approx(0.9 * TOLERANCE, rel=0.3)
    assert path([0.0, 1.0]) == pytest.approx(SQUARE[[0, -1]])
    # between its corners it is straight
    assert path(0.1)[1] == pytest.approx(0.0, abs=1e-12)
    assert f"straight between 5 of {len(points)} points, with round corners" in path.remarks[0]


def test_a_rounded_path_has_three_continuous_derivatives():
    path = qa.GeometricPath.within(SQUARE, 0.05)
    for knot in path.knots[1:-1]:
        for order in range(4):
            before, after = path([knot - 1e-9, knot + 1e-9], order)
            scale = np.abs(path(np.linspace(0, 1, 101), order)).max()
            assert after == pytest.approx(before, abs=1e-5 * scale)


def test_a_smooth_path_of_many_points_is_a_spline_through_few():
    """A quarter of a circle and one back: the curve itself, within the tolerance."""
    angles = np.linspace(0.0, np.pi, 3001)
    curve = np.column_stack([np.sin(angles), angles - np.cos(angles)])
    path = qa.GeometricPath.within(curve, TOLERANCE)
    assert len(path.knots) < 15
    assert _off(path, curve[::10]) <= TOLERANCE
    assert path.remarks[0].startswith(f"through {len(path.knots)} of 3001 points, within 0.002 rad")


def test_a_spline_that_is_near_enough_stays():
    points = [[0.0, 0.0], [0.5, 0.3], [1.0, 0.5]]
    path = qa.GeometricPath.within(points, 0.1)
    assert path == qa.GeometricPath.through(points)
    assert not path.remarks


def test_many_points_on_a_line_are_a_line():
    points = np.linspace(0.0, 1.0, 3000)[:, None] * [1.0, -0.5]
    assert qa.GeometricPath.within(points, 1e-6) == qa.GeometricPath.line([0, 0], [1.0, -0.5])


def test_a_short_way_out_and_back_is_left_out():
    """A motion that overshoots: what is left was passed anyway."""
    shares = np.append(np.linspace(0.0, 1.03, 400), np.linspace(1.029, 1.0, 20))
    path = qa.GeometricPath.within(shares[:, None] * [1.0, -0.5], 1e-4)
    assert path == qa.GeometricPath.line([0, 0], [1.0, -0.5])
    assert path.remarks[0] == "0.034 rad (or m) that it goes beyond a point and back are left out"
    there_and_back = np.append(np.linspace(0, 1, 300), np.linspace(0.99, 0.5, 100))
    with pytest.raises(ValueError, match="turns back at waypoint 300, a corner; plan a move to it"):
        qa.GeometricPath.within(there_and_back[:, None] * [1.0, -0.5], 1e-4)


def test_noise_beyond_the_tolerance_is_refused():
    noise = 1e-3 * np.random.default_rng(0).normal(size=(1000, 2))
    points = np.linspace(0.0, 1.0, 1000)[:, None] * [1.0, -0.5] + noise
    with pytest.raises(ValueError, match=r"points are needed to stay within 0.0001 rad .* at most"):
        qa.GeometricPath.within(points, 1e-4)


def test_thousands_of_points_of_a_file_are_thinned(tmp_path):
    """The path keeps what the joints do, and a saved plan tells it."""
    angles = np.linspace(0.0, 2.0, 2500)
    table = np.column_stack([0.01 * np.arange(2500), np.sin(angles), angles])
    np.savetxt(tmp_path / "way.csv", table, delimiter=",", header="time,a,b", comments="")
    path = qa.GeometricPath.load(tmp_path / "way.csv")
    assert path.remarks[0] == "not used of the table: times"
    assert "of 2500 points, within 0.0005 rad (or m) of the lines between all" in path.remarks[1]
    assert _off(path, table[:, 1:]) <= 5.1e-4
    again = typed(plain(path), qa.GeometricPath)
    assert again.off_straight == pytest.approx(path.off_straight)
    turned = path.of_joints(["b", "a"])
    assert turned.off_straight == pytest.approx(path.off_straight[::-1])


def test_a_message_that_was_cut_off_is_refused(tmp_path):
    """`ros2 topic echo` writes so much of a long list."""
    (tmp_path / "message.yaml").write_text(TRAJECTORY + "- '...'\n---\n")
    with pytest.raises(ValueError, match=r"is cut off at '...'; write it whole, .* --full-length"):
        qa.GeometricPath.load(tmp_path / "message.yaml")
