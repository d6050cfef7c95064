"""Straight lines in space: the link goes where Pinocchio says, by its own reading of the URDF."""

from functools import lru_cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from robots import BAR, START, UR5_JOINTS, ur5_with_bar, urdf_of

import quietarm as qa

pinocchio = pytest.importorskip("pinocchio")
pytestmark = pytest.mark.slow

PANDA_JOINTS = tuple(f"panda_joint{number}" for number in range(1, 8))
PANDA_START = np.array([0.3, -0.4, 0.2, -1.9, 0.3, 1.6, 0.5])
PLACES = np.linspace(0.0, 1.0, 97)


@lru_cache
def _panda():
    joints = PANDA_JOINTS
    return qa.Robot(
        urdf=urdf_of("panda.urdf"), joints=joints, beam=qa.Beam(at="panda_link8", **BAR)
    )


class Truth:
    """Where a link of a URDF stands, by Pinocchio."""

    def __init__(self, urdf, joints, link):
        self.model = pinocchio.buildModelFromUrdf(str(urdf))
        self.data = self.model.createData()
        self.places = [self.model.joints[self.model.getJointId(name)].idx_q for name in joints]
        self.link = self.model.getFrameId(link)

    def __call__(self, q):
        positions = pinocchio.neutral(self.model)
        positions[self.places] = q
        pinocchio.framesForwardKinematics(self.model, self.data, positions)
        pose = self.data.oMf[self.link]
        return pose.rotation.copy(), pose.translation.copy()


@lru_cache
def _of_ur5():
    return Truth(urdf_of("ur5_robot.urdf"), UR5_JOINTS, "tool0")


def _off_line(truth, path, end, turned=None):
    """Largest distance from the line [m], and from the rotation on the way [rad]."""
    rotation, begin = truth(path(0.0))
    turned = rotation if turned is None else turned
    turn = pinocchio.log3(rotation.T @ turned)
    distances, angles = [], []
    for share in PLACES:
        at, place = truth(path(share))
        distances.append(np.linalg.norm(place - (begin + share * (end - begin))))
        wanted = rotation @ pinocchio.exp3(share * turn)
        angles.append(np.linalg.norm(pinocchio.log3(wanted.T @ at)))
    return max(distances), max(angles)


@pytest.mark.parametrize("way", [(0.2, 0.3, -0.1), (0.0, 0.0, -0.2), (-0.15, 0.25, 0.3)])
def test_a_link_goes_straight_and_does_not_turn(way):
    path = qa.GeometricPath.cartesian_line(ur5_with_bar(), START, by=way)
    _, begin = _of_ur5()(START)
    distance, angle = _off_line(_of_ur5(), path, begin + way)
    assert path(0.0) == pytest.approx(START, abs=1e-12)
    assert distance < 1e-9
    assert angle < 1e-9


def test_a_link_goes_straight_to_a_pose_and_turns_there():
    """Roll, pitch, yaw are a URDF's."""
    place, angles = np.array([0.4, 0.35, 0.3]), (2.8, 0.3, 0.6)
    path = qa.GeometricPath.cartesian_line(ur5_with_bar(), START, to=[*place, *angles])
    wanted = pinocchio.rpy.rpyToMatrix(*angles)
    assert _of_ur5()(path(1.0))[0] == pytest.approx(wanted, abs=1e-9)
    distance, angle = _off_line(_of_ur5(), path, place, wanted)
    assert distance < 1e-9
    assert angle < 1e-9


def test_a_robot_of_seven_joints_takes_the_shortest_steps():
    truth = Truth(urdf_of("panda.urdf"), PANDA_JOINTS, "panda_link8")
    way = np.array([0.1, 0.25, -0.15])
    path = qa.GeometricPath.cartesian_line(_panda(), PANDA_START, by=way)
    _, begin = truth(PANDA_START)
    distance, angle = _off_line(truth, path, begin + way)
    assert distance < 1e-9
    assert angle < 1e-9
    assert np.abs(path(1.0) - PANDA_START).max() < 1.0


def test_the_beams_end_can_be_the_link():
    """0.8 m along z of the flange."""
    way = np.array([0.1, 0.1, 0.1])
    path = qa.GeometricPath.cartesian_line(ur5_with_bar(), START, by=way, link="beam end")
    ends = [
        place + 0.8 * rotation[:, 2]
        for rotation, place in (_of_ur5()(path(share)) for share in PLACES)
    ]
    wanted = ends[0] + PLACES[:, None] * way
    assert np.abs(np.array(ends) - wanted).max() < 1e-9


@settings(max_examples=10, deadline=None)
@given(way=st.tuples(*[st.floats(-0.1, 0.1)] * 3).filter(lambda way: np.linalg.norm(way) > 0.01))
def test_all_short_lines_are_straight(way):
    path = qa.GeometricPath.cartesian_line(ur5_with_bar(), START, by=way)
    _, begin = _of_ur5()(START)
    assert max(_off_line(_of_ur5(), path, begin + way)) < 1e-9


@pytest.mark.parametrize(("entries", "words"), [
    ({"by": (2.0, 0.0, 0.0)}, r"tool0 cannot follow the line beyond 0\.\d+ m of its 2 m"),
    ({"by": (0.0, 0.0, 0.0)}, "a length of 0 m; give an end elsewhere than where tool0 is"),
    ({"by": (1.0, 0.0)}, "by of the line has 2 numbers; give x, y, z"),
    ({"to": (1.0, 0.0, 0.0, 0.0)}, "to of the line has 4 numbers; give x, y, z .m., or"),
    ({"to": (1.0, 0.0, float("nan"))}, "give a finite number"),
    ({}, "give either to=, a pose, or by=, a way"),
    ({"to": (1.0, 0.0, 0.0), "by": (1.0, 0.0, 0.0)}, "give either to="),
    ({"by": (0.1, 0.0, 0.0), "link": "tool"}, "no link, for a line, 'tool'; did you mean 'tool0'"),
    ({"start": START[:5], "by": (0.1, 0.0, 0.0)}, "has 5 positions, and the robot drives 6"),
    # through the axis of the first joint, where the arm would have to turn by half a turn at once
    ({"to": (-0.54155121, -0.10921554, 0.30968201)},
     r"beyond 0\.4\d* m of its 1\.1 m: joint 'shoulder_pan_joint' swings over"),
])  # fmt: skip
def test_what_is_no_line_is_refused(entries, words):
    with pytest.raises(ValueError, match=words):
        qa.GeometricPath.cartesian_line(ur5_with_bar(), **({"start": START} | entries))


def test_a_line_beyond_a_joints_range_is_refused():
    """The Panda's elbow ends at -0.07 rad: stretched out it is beyond."""
    start = np.array([0.0, 0.4, 0.0, -0.5, 0.0, 1.6, 0.8])
    with pytest.raises(
        ValueError,
        match=r"joint 'panda_joint\d'.*; its range is|out of reach|not with the orientation",
    ):
        _panda().along(qa.GeometricPath.cartesian_line(_panda(), start, by=(0.1, 0.0, 0.0)))
