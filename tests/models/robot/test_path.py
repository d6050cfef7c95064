"""Paths of joints: what they pass through, how smooth they are, and what is no path."""

import numpy as np
import pytest
from robots import END, START, straight

import quietarm as qa

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
    file.write_text("\n".join(mark.join(map(str, row)) for row in rows))
    assert qa.GeometricPath.load(file)(1.0) == pytest.approx([0.9, 0.2])


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
    ("a.csv", "1,2\n1,2\n", "a.csv: the path has a length of 0"),
    ("a.yaml", "points: 3\n", "is no JointTrajectory"),
    ("a.yaml", "joint_names: [a]\npoints: [{x: 1}]\n", "a point without positions"),
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
