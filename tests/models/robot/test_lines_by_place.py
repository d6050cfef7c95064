"""Lines by place alone, what stops a line, and the long way of a joint without ends."""

import numpy as np
import pytest
from small_robots import ARM, GANTRY

import quietarm as qa
from quietarm.models import TimedMotion
from quietarm.models.robot.path.joint_table import JointTable

BEAM = {"length": 0.5, "bending_stiffness": 30.0, "mass_per_length": 0.2, "tip_mass": 0.3}
START = np.array([0.3, 0.9])


def arm(urdf=ARM):
    held = {"grip": 0.02}
    return qa.Robot(urdf=urdf, joints=("a", "b"), held=held, beam=qa.Beam("tool", **BEAM))


def test_two_joints_follow_a_line_whose_orientation_is_free():
    path = qa.GeometricPath.cartesian_line(arm(), START, by=(-0.1, 0.02, 0.0), turns=False)
    angles = path(np.linspace(0.0, 1.0, 41))
    # by the links' lengths, 0.4 m and 0.3 m, in the plane
    ends = [0.4 * np.exp(1j * a) + 0.3 * np.exp(1j * (a + b)) for a, b in angles]
    shares = np.linspace(0.0, 1.0, 41)
    assert ends == pytest.approx(ends[0] + shares * (-0.1 + 0.02j), abs=1e-9)


@pytest.mark.parametrize(("entries", "words"), [
    ({"by": (-0.1, 0.02, 0.0)}, "place is within reach, but not with the orientation that a line "
     "keeps, for which 2 joints are few: it would turn about x of the link; leave it free"),
    ({"by": (0.5, 0.5, 0.0), "turns": False}, r"the place is out of reach, the link comes no "
     r"nearer than \d"),
    ({"by": (0.0, 0.0, 0.1), "turns": False}, "the place is out of reach"),
    ({"to": (0.3, 0.2, 0.0, 0.0, 0.0, 0.0), "turns": False}, "its orientation is free; give x, y"),
    ({"by": (0.0, 0.0, 0.0), "turns": False}, "a length of 0 m"),
])  # fmt: skip
def test_what_stops_a_line_is_said(entries, words):
    with pytest.raises(ValueError, match=words):
        qa.GeometricPath.cartesian_line(arm(), **({"start": START} | entries))


def test_a_joint_without_ends_says_that_it_goes_the_long_way():
    robot = arm(ARM.replace('name="b" type="revolute"', 'name="b" type="continuous"'))
    rows = [[0.0, 3.0], [0.3, 3.1], [0.6, -3.1]]
    (words,) = robot.fitted(qa.GeometricPath.through(rows)).remarks
    assert words == (
        "joint 'b', which has no ends, turns by -6.2 rad between waypoints 2 and 3; for the short "
        "way of 0.08319 rad give 3.1832 in place of -3.1"
    )
    again = robot.fitted(robot.fitted(qa.GeometricPath.through(rows)))
    assert again.remarks == (words,)
    rows[2][1] = 3.1832
    assert not robot.fitted(qa.GeometricPath.through(rows)).remarks
    line = qa.GeometricPath.line([0.0, 0.0], [0.3, 4.0])  # typed, and so meant
    assert not robot.fitted(line).remarks
    slides = GANTRY.replace('lower="0" upper="3" ', "").replace('lower="0" upper="2" ', "")
    gantry = qa.Robot(urdf=slides, beam=qa.Beam("tool", **BEAM))
    assert not gantry.fitted(qa.GeometricPath.through([[0, 0], [5, 1], [9, 2]])).remarks


def test_rows_at_one_time_and_place_are_one():
    places = np.array([[0.0, 0.0], [0.0, 0.0], [0.3, 0.2], [0.6, 0.5], [0.6, 0.5]])
    times = np.array([0.0, 0.0, 0.5, 1.0, 1.0])
    motion = TimedMotion.of_table(JointTable(("a", "b"), places, times))
    assert motion.times.tolist() == [0.0, 0.5, 1.0]
    assert motion.remarks[0] == (
        "points 1 and 2 are at one time and place and taken as one and points 4 and 5 are at one "
        "time and place and taken as one"
    )
    places[1] = 0.01  # at one time elsewhere: a jump
    with pytest.raises(ValueError, match="give times that increase"):
        TimedMotion.of_table(JointTable(("a", "b"), places, times))
