"""Joints that mimic others: in dynamics, limits, exports and pictures."""

import numpy as np
import pytest
from robots import urdf_of
from small_robots import torques_of
from two_links import (
    BASE,
    ELBOW,
    INERTIAL,
    SHOULDER,
    URDF,
    limits_of,
    robot_of,
    with_elbow,
    words_of,
)

import quietarm as qa
from quietarm.ocp.planning.move_table import move_table

MIMIC = with_elbow('<mimic joint="shoulder" multiplier="-2" offset="0.3"/>')
SLIDER = f"""<link name="slide">{INERTIAL}</link><joint name="slider" type="prismatic">
<parent link="lower"/><child link="slide"/><axis xyz="1 0 0"/>
<limit lower="-1" upper="1" effort="9" velocity="1"/>
<mimic joint="elbow" multiplier="0.1"/></joint>"""
CHAIN = MIMIC.replace("</robot>", f"{SLIDER}</robot>")
"""A slider that mimics the elbow, which mimics the shoulder: slider = -0.2 shoulder + 0.03."""


def _torques(robot, motion):
    """Return torques of the driven joints, the base still."""
    still = np.zeros((3, robot.dynamics.sprung))
    torques = torques_of(robot, *np.hstack([motion, still]))
    return torques[: len(robot.joints)]


def test_inertias_and_torques_are_those_of_the_joints_by_virtual_work():
    """Bodies with every joint driven, put where the followers are, need the same."""
    alone = CHAIN
    for tag in ('<mimic joint="shoulder" multiplier="-2" offset="0.3"/>',
                '<mimic joint="elbow" multiplier="0.1"/>'):  # fmt: skip
        alone = alone.replace(tag, "")
    following = robot_of(CHAIN, gravity=(3.0, -9.81, 0.0))
    driven = robot_of(alone, gravity=(3.0, -9.81, 0.0))
    assert following.joints == ("shoulder",)
    slopes = np.array([1.0, -2.0, -0.2])
    offsets = np.array([0.0, 0.3, 0.03])
    motion = np.array([[0.4], [1.3], [-2.1]])
    whole = motion * slopes + np.array([offsets, 0 * offsets, 0 * offsets])
    expected = slopes @ _torques(driven, whole)
    assert _torques(following, motion) == pytest.approx([expected], rel=1e-12)


@pytest.mark.slow
def test_fingers_of_a_gripper_are_pinocchios():
    """Pinocchio follows <mimic> itself where it is asked to."""
    pinocchio = pytest.importorskip("pinocchio")
    robot = qa.Robot(urdf=urdf_of("panda.urdf"), base=BASE)
    assert len(robot.joints) == 8
    model = pinocchio.buildModelFromUrdf(str(urdf_of("panda.urdf")), True)
    q = np.random.default_rng(0).uniform(-1, 1, 8)
    theirs = pinocchio.crba(model, model.createData(), q)
    theirs = np.triu(theirs) + np.triu(theirs, 1).T
    mine = robot.dynamics.masses(np.append(q, [0.0, 0.0]))[:8, :8]
    assert mine == pytest.approx(theirs, rel=1e-9, abs=1e-9)


@pytest.mark.slow
def test_rotors_and_friction_of_followers_are_felt_by_their_leader():
    """Rotor and viscous friction by the multiplier squared, Coulomb friction by its size."""
    entries = {"rotor_inertia": {"elbow": 0.3}, "friction": {"elbow": 5.0}}
    motion = np.array([[0.4], [1.3], [-2.1]])
    more = _torques(robot_of(MIMIC, **entries), motion) - _torques(robot_of(MIMIC), motion)
    assert more == pytest.approx([4 * (0.3 * -2.1 + 5.0 * 1.3)], rel=1e-9)
    path = qa.GeometricPath.line([0.0], [0.8])
    task = [
        qa.PointToPoint(robot_of(MIMIC, coulomb=coulomb).along(path), target=1.0, duration=2.0)
        for coulomb in ({}, {"elbow": 3.0})
    ]
    torques = [
        np.array(qa.evaluate_coefficients(each, []).sampled([1.0]).sample.torques) for each in task
    ]
    assert torques[1] - torques[0] == pytest.approx(2 * 3.0, rel=1e-3)  # at 0.8 rad/s and more


def test_dynamics_of_a_follower_in_the_urdf_are_used():
    text = with_elbow('<dynamics damping="5" friction="3"/>', MIMIC)
    robot = robot_of(text)
    assert (robot.friction, robot.coulomb) == ({"elbow": 5.0}, {"elbow": 3.0})


def test_the_range_of_a_follower_binds_its_leader():
    """Elbow = -2 shoulder + 0.3 within -2 to 2: the shoulder within -0.85 to 1.15."""
    robot = robot_of(MIMIC)
    assert robot.ranges() == [pytest.approx((-0.85, 1.15))]
    words = r"joint 'shoulder' is at .*; its range is -0\.85 to 1\.15 \(with elbow, following it\)"
    with pytest.raises(ValueError, match=words):
        robot.along(qa.GeometricPath.line([0.0], [1.2]))


def test_speeds_of_followers_bind_their_leaders(tmp_path):
    """3 rad/s of the elbow are 1.5 rad/s of the shoulder; 1 m/s of the slider would be 5."""
    limits = limits_of(tmp_path, CHAIN)
    assert limits["speed"] == {"shoulder": 1.5}
    assert limits["torque"] == {"shoulder": 50.0}
    assert limits_of(tmp_path, CHAIN, "held: {elbow: 0}")["speed"]["shoulder"] == 3.0


def test_a_follower_of_a_held_joint_is_held():
    robot = robot_of(CHAIN.replace(SHOULDER, SHOULDER + _lift()), held={"shoulder": 0.5})
    assert robot.joints == ("lift",)
    assert robot.followers == {}
    assert robot.held_position("elbow") == pytest.approx(-0.7)
    assert robot.held_position("slider") == pytest.approx(-0.07)


def _lift():
    """A joint before none of the others."""
    return (
        f'<link name="lifted">{INERTIAL}</link><joint name="lift" type="prismatic">'
        '<parent link="ground"/><child link="lifted"/><axis xyz="0 0 1"/></joint>'
    )


@pytest.mark.slow
def test_a_follower_that_is_held_by_name_stays_there_and_it_is_said():
    robot = robot_of(MIMIC, held={"elbow": 0.1})
    assert robot.followers == {}
    assert robot.held_position("elbow") == 0.1
    assert "elbow is held at 0.1, where the URDF has it mimic shoulder" in words_of(robot)
    # both of a gripper's fingers, as the second one follows
    fingers = {"panda_finger_joint1": 0.02, "panda_finger_joint2": 0.02}
    gripper = qa.Robot(urdf=urdf_of("panda.urdf"), base=BASE, held=fingers)
    assert "is held at" not in words_of(gripper)


def test_a_follower_of_a_sprung_joint_swings_with_it():
    """One mode of two equal links whose springs' angles are q and -2 q + 0.3, without gravity."""
    lift = MIMIC.replace(SHOULDER, SHOULDER + _lift())
    robot = qa.Robot(
        urdf=lift, springs={"shoulder": 100.0}, joints=["lift"], gravity=(0.0, 0.0, 0.0)
    )
    assert set(robot.followers) == {"elbow"}
    inertia = robot.dynamics.masses([0.0, 0.0])[1, 1]
    assert robot.frequencies([0.0])[0] == pytest.approx(np.sqrt(100.0 / inertia))


def test_a_joint_whose_leader_the_urdf_lacks_is_held_and_named():
    text = with_elbow('<mimic joint="hidden" offset="0.2"/>')
    robot = robot_of(text)
    assert robot.joints == ("shoulder",)
    assert robot.held_position("elbow") == 0.2
    assert "elbow mimics 'hidden'" in words_of(robot)


def test_where_the_leader_is_mistyped_the_joint_that_is_meant_is_asked_for():
    text = with_elbow('<mimic joint="sholder"/>')
    assert "mimics 'sholder' (did you mean 'shoulder'?)" in words_of(robot_of(text))
    words = "'elbow', which has an entry in friction, mimics 'sholder' .did you mean 'shoulder'"
    with pytest.raises(ValueError, match=words):
        robot_of(text, friction={"elbow": 1.0})


@pytest.mark.parametrize(("entries", "words"), [
    ({"joints": ["shoulder", "elbow"]}, "'elbow' of the URDF mimics 'shoulder' and follows it; le"),
    ({"springs": {"elbow": 10.0}}, "leave it out of springs, or <mimic> out of the URDF"),
    ({"rotor_inertia": {"wrist": 1.0}}, "has no driven joint, for rotor_inertia, 'wrist'"),
])  # fmt: skip
def test_what_a_follower_cannot_be_is_refused(entries, words):
    with pytest.raises(ValueError, match=words):
        robot_of(MIMIC, **entries)


@pytest.mark.slow
def test_gears_of_followers_bend():
    gears = {"shoulder": 1e4, "elbow": 5e3}
    robot = qa.Robot(
        urdf=MIMIC, elastic_joints=gears, rotor_inertia={"shoulder": 0.5, "elbow": 0.3}
    )
    assert robot.mechanism.spring_names == ["gear of shoulder", "gear of elbow"]
    plant = robot.along(qa.GeometricPath.line([0.0], [0.8]))
    plan = qa.evaluate_coefficients(qa.PointToPoint(plant, target=1.0, duration=1.0), [])
    assert plan.verification.agrees
    # by the whole equations, in which nothing is reduced
    assert plan.candidate.in_full.energy == pytest.approx(plan.energy, rel=1e-3)


def test_exports_have_the_followers():
    plant = robot_of(MIMIC).along(qa.GeometricPath.line([0.2], [0.8]))
    plan = qa.evaluate_coefficients(qa.PointToPoint(plant, target=1.0, duration=1.0), [])
    columns = move_table(plan, "angle,speed,torque:Nm", 100.0)
    assert columns["elbow_angle_rad"] == pytest.approx(0.3 - 2 * columns["angle_rad"])
    assert columns["elbow_speed_rad_s"] == pytest.approx(-2 * columns["speed_rad_s"])
    assert "elbow_torque_Nm" not in columns


def test_pictures_show_the_followers():
    """As the same robot whose joints are both driven on that path."""
    tool = (
        '<link name="tcp"/><joint name="t" type="fixed"><parent link="lower"/><child link="tcp"/>'
        '<origin xyz="0.4 0 0"/></joint></robot>'
    )
    following = robot_of(MIMIC.replace("</robot>", tool))
    driven = robot_of(URDF.replace("</robot>", tool))
    paths = [
        qa.GeometricPath.line([0.2], [0.8]),
        qa.GeometricPath.line([0.2, -0.1], [0.8, -1.3]),
    ]
    for place in (0.0, 1.0):
        drawn = [
            robot.along(path).structure(place, np.zeros(robot.along(path).tips))
            for robot, path in zip((following, driven), paths)
        ]
        for mine, theirs in zip(*drawn, strict=True):
            assert mine.points == pytest.approx(theirs.points, abs=1e-9)


def test_the_move_of_one_joint_is_along_its_path():
    """Not from 0 to 1 rad, which is where its place on the path goes."""
    plant = robot_of(MIMIC).along(qa.GeometricPath.line([0.2], [0.8]))
    assert qa.PointToPoint(plant, target=1.0, duration=1.0).ends == "along its path"
    assert plant.label == "two (1 joint; base)"


def test_a_leader_after_its_follower_in_the_file_leads_as_well():
    turned = MIMIC.replace(SHOULDER, "").replace("</robot>", f"{SHOULDER}</robot>")
    assert turned != MIMIC
    assert ELBOW.split(">")[0] in turned
    motion = np.array([[0.4], [1.3], [-2.1]])
    assert _torques(robot_of(turned), motion) == pytest.approx(_torques(robot_of(MIMIC), motion))


@pytest.mark.slow
def test_along_a_path_a_follower_swings_the_tip_as_a_driven_joint_would():
    """A driven elbow leaves the same residual, and needs the same torques by virtual work."""
    beam = qa.Beam(
        at="lower", length=0.5, bending_stiffness=30.0, mass_per_length=0.2, tip_mass=0.3, pieces=2
    )
    tag = '<mimic joint="shoulder" multiplier="-2" offset="0.3"/>'
    following = robot_of(MIMIC, beam=beam)
    driven = robot_of(MIMIC.replace(tag, ""), beam=beam)
    ends = np.array([0.0, 0.5])
    paths = (
        qa.GeometricPath.line(ends[:1], ends[1:]),
        qa.GeometricPath.line(*np.column_stack([ends, 0.3 - 2 * ends])),
    )
    plans = [
        qa.evaluate_coefficients(robot.along(path).task(1.0, 0.6), [])
        for robot, path in zip((following, driven), paths)
    ]
    assert plans[0].residual > 1e-4
    assert plans[0].residual == pytest.approx(plans[1].residual, rel=1e-6)
    in_full = [plan.candidate.in_full.residual for plan in plans]
    assert in_full[0] == pytest.approx(in_full[1], rel=1e-6)
    times = np.linspace(0.0, 0.6, 7)
    torques = [np.array(plan.sampled(times).sample.torques) for plan in plans]
    felt = torques[1].reshape(2, -1)
    assert torques[0].ravel() == pytest.approx(felt[0] - 2 * felt[1], rel=1e-6, abs=1e-6)
