"""Robots from a URDF and from a file: what is read, and what is refused."""

import dataclasses
import json
import math
import pickle
import re

import numpy as np
import pytest
from robots import BAR, END, START, UR5_JOINTS, ur5_with_bar, urdf_of
from small_robots import ARM, ARM_FILE, write_robot

import quietarm as qa
from quietarm.models import Base, Spring
from quietarm.models.robot.on_path.path_tables import modes_on, swings_of
from quietarm.ocp.simulation.evaluator import Evaluator

FILE = """
urdf: {urdf}
beam: {{at: tool0, length: 0.8, width: 8mm, height: 12mm, youngs_modulus: 70GPa, density: 2700,
       tip_mass: 500g, damping: 0.5%}}
"""
# Two links that turn in a level plane; `elbow` stands for any joint.
LINK = '<inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1"/></inertial>'
URDF = f"""<robot name="two">
<link name="ground"/><link name="upper">{LINK}</link><link name="lower">{LINK}</link>
<joint name="shoulder" type="revolute"><parent link="ground"/><child link="upper"/>
<axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="50" velocity="3"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/>
<origin xyz="0.5 0 0"/><axis xyz="0 0 1"/>
<limit lower="-2" upper="2" effort="20" velocity="4"/></joint>
</robot>"""
GEARS = {"shoulder": 800.0, "elbow": 300.0}


def _file(tmp_path, more=""):
    file = tmp_path / "robot.yaml"
    file.write_text(FILE.format(urdf=urdf_of("ur5_robot.urdf")) + more)
    return file


def test_a_file_gives_the_robot_of_its_entries(tmp_path):
    robot = qa.Robot.load(_file(tmp_path))
    assert robot == ur5_with_bar()
    assert robot.joints == UR5_JOINTS
    assert robot.modes == 2


def test_every_entry_of_a_file(tmp_path):
    robot = qa.Robot.load(
        _file(
            tmp_path,
            """
joints: [shoulder_pan_joint, shoulder_lift_joint, elbow_joint]
held: {wrist_1_joint: -90deg}
springs: {wrist_2_joint: {stiffness: 8kNm/rad, damping: 2 N m s/rad}}
elastic_joints: {elbow_joint: 20000}
base: {stiffness: [200kNm/rad, 3e5], damping: 10, height: 300mm}
tip: wrist_3_link
gravity: [0, 0, -9.81]
rotor_inertia: {elbow_joint: 0.2}
friction: {elbow_joint: 5}
modes: 4
""",
        )
    )
    assert robot.held["wrist_1_joint"] == pytest.approx(-math.pi / 2)
    assert robot.springs["wrist_2_joint"] == Spring(8000.0, 2.0)
    assert robot.elastic_joints["elbow_joint"] == Spring(20000.0)
    assert robot.base == Base((2e5, 3e5), (10.0, 10.0), 0.3)
    assert (robot.tip, robot.gravity[2], robot.modes) == ("wrist_3_link", -9.81, 4)
    # the wrist's spring, the gear, two axes of the base, five hinges in two planes
    assert len(robot.mechanism.sprung) == 1 + 1 + 2 + 10


def test_a_measured_frequency_scales_the_springs(tmp_path):
    file = _file(
        tmp_path, "measured: {frequency: 3.05Hz, at: [0, -80deg, 97deg, -107deg, -90deg, 0]}\n"
    )
    robot = qa.Robot.load(file)
    at = robot.measured.at
    assert robot.frequencies(at)[0] == pytest.approx(math.tau * 3.05, rel=1e-9)
    assert ur5_with_bar().frequencies(at)[0] > math.tau * 3.1


def test_limits_are_of_the_urdf_or_of_moveit(tmp_path):
    of_urdf = qa.Robot.load(_file(tmp_path, "limits: urdf\n"))
    assert of_urdf.limits["torque"]["wrist_1_joint"] == 28.0
    assert of_urdf.limits["speed"]["elbow_joint"] == 3.15
    (tmp_path / "joint_limits.yaml").write_text("""
joint_limits:
  elbow_joint: {has_velocity_limits: true, max_velocity: 2.5, has_acceleration_limits: true,
                max_acceleration: 10, has_jerk_limits: false, max_jerk: 0.0}
""")
    robot = qa.Robot.load(_file(tmp_path, "limits: joint_limits.yaml\n"))
    assert robot.limits["speed"]["elbow_joint"] == 2.5
    assert robot.limits["speed"]["wrist_1_joint"] == 3.2
    assert robot.limits["acceleration"] == {"elbow_joint": 10.0}
    assert "jerk" not in robot.limits


def test_positions_are_limited_by_the_urdf_or_narrower(tmp_path):
    # the UR5's elbow goes from -pi to pi
    text = "joint_limits: {{elbow_joint: {{has_position_limits: true, max_position: {}}}}}"
    (tmp_path / "joint_limits.yaml").write_text(text.format(3.1416))
    robot = qa.Robot.load(_file(tmp_path, "limits: joint_limits.yaml\n"))
    assert robot.ranges()[2][1] == pytest.approx(math.pi, abs=1e-6)
    (tmp_path / "joint_limits.yaml").write_text(text.format(1.5))
    robot = qa.Robot.load(_file(tmp_path, "limits: joint_limits.yaml\n"))
    assert robot.ranges()[2] == (pytest.approx(-math.pi, abs=1e-6), 1.5)


@pytest.mark.slow
def test_a_joint_that_slides_is_held_in_metres(tmp_path):
    fingers = "{panda_finger_joint1: 20mm, panda_finger_joint2: 0.02}"
    (tmp_path / "robot.yaml").write_text(
        f"urdf: {urdf_of('panda.urdf')}\nheld: {fingers}\n"
        "elastic_joints: {panda_joint1: 1e4}\nmodes: 1\n"
    )
    robot = qa.Robot.load(tmp_path / "robot.yaml")
    assert robot.held == {"panda_finger_joint1": 0.02, "panda_finger_joint2": 0.02}


def test_gears_bend_under_gravity_and_swing_at_their_frequency(tmp_path):
    """Two links of 1 kg hang on springs: k angle = m g r, and sqrt(k / J) with the elbow held."""
    upright = URDF.replace('xyz="0 0 1"', 'xyz="0 1 0"').replace(
        '<mass value="1"/>', '<origin xyz="0.3 0 0"/><mass value="1"/>'
    )
    robot = qa.Robot(urdf=upright, elastic_joints={"elbow": 1000.0}, modes=1)
    p = robot.dynamics.sag(np.zeros(2))
    assert 1000.0 * p[0] == pytest.approx(9.80665 * 0.3 * math.cos(p[0]), rel=1e-12)
    level = qa.Robot(urdf=upright, elastic_joints={"elbow": 1000.0}, modes=1, gravity=(0, 0, 0))
    assert level.frequencies([0.0, 0.0])[0] == pytest.approx(math.sqrt(1000 / (0.1 + 0.3**2)))


def test_a_robot_is_the_same_in_another_process():
    robot = ur5_with_bar()
    _ = robot.dynamics.masses
    assert pickle.loads(pickle.dumps(robot)) == robot


@pytest.mark.parametrize(("more", "words"), [
    ("colour: red\n", "a robot has no entry 'colour'"),
    ("joints: [elbow]\n", "has no moving joint, for joints, 'elbow'; did you mean 'elbow_joint'"),
    ("tip: tool7\n", "has no link, for the tip, 'tool7'; did you mean 'tool0'"),
    ("modes: 0\n", "modes is 0; give a whole number from 1 up"),
    ("modes: 13\n", "modes is 13; give at most 12"),
    ("held: {elbow_joint: 1}\njoints: [elbow_joint]\n", "is driven and in held"),
    ("friction: {elbow_joint: fast}\n", "'fast' is not friction of elbow_joint"),
    ("springs: {elbow_joint: 0}\n", "stiffness of elbow_joint in springs is 0"),
    ("springs: {elbow_joint: {softness: 3}}\n", "springs of elbow_joint has no entry 'softness'"),
    ("base: {stiffness: [1, 2, 3, 4]}\n", "stiffness of the base has 4 numbers"),
    ("limits: none.yaml\n", "none.yaml cannot be read: no such file"),
    ("limits: 3\n", "give a joint_limits.yaml of MoveIt, or urdf"),
    ("measured: {frequency: 3, at: [0, 0, 0, 0, 0, 0]}\n", "say its unit, such as 3Hz"),
    ("measured: {frequency: 900Hz, at: [0, 0, 0, 0, 0, 0]}\n", "measured frequency is 900 Hz"),
    ("measured: {frequency: 3Hz, at: [0, 0]}\n", "measured has 2 positions and the robot 6 joints"),
    ("measured: {frequency: 3.05Hz, at: [0, -80, 97, -107, -90, 0]}\n",
     "measured has joint 'shoulder_lift_joint' at -80; its range is .* degrees meant. give -80deg"),
    ("held: {wrist_3_joint: 90}\n", "held has joint 'wrist_3_joint' at 90; .* degrees meant"),
    ("gravity: [0, 9.81]\n", "gravity has 2 numbers; give three"),
    ("a: [\n", "is no valid YAML"),
    ("tip: 2026-13-45\n", "has no link, for the tip, '2026-13-45'"),
    ("tip: !!timestamp soon\n", "could not determine a constructor for the tag"),
    ("tip: !!bool perhaps\n", "has a value that is none: 'perhaps' as bool; mend it"),
    ("tip: tool0\nmodes: 2\ntip: tool0\n", "has 'tip' twice, again in line"),
    ("base: {stiffness: 1, stiffness: 2}\n", "has 'stiffness' twice"),
    (f"modes: {'1:' * 100_000}1\n", "modes is '1:1:"),
    (f"modes: !!int {'1:' * 100_000}1\n", "has a value that is none: '1:1:"),
    (f"modes: 0b{'1' * 100_000}\n", "modes is '0b1"),
    (f"gravity: [0, 0, {'9' * 100_000}]\n", "is not gravity; give"),
    (f"gravity: [0, 0, '1{' ' * 100_000}x']\n", "is not gravity; give"),
    (f"a: {'[' * 100_000}\n", "is nested too deeply; write it flat"),
    ("a: 1\n---\nb: 1\n", "has 2 documents; give one"),
    ("#" * 3_000_001, "has over 3000000 bytes"),
    ("base: &a {stiffness: *a}\n", "repeats its aliases to over 1000000 entries"),
    ("a: &a [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n"
     + "".join(f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'.replace('a-1', 'a')] * 10)}]\n"
               for k in range(8)), "repeats its aliases to over 1000000 entries"),
    ("!!python/object/apply:os.system ['true']\n", "is no valid YAML"),
])  # fmt: skip
def test_what_a_file_may_not_say(tmp_path, more, words):
    with pytest.raises(ValueError, match=words):
        qa.Robot.load(_file(tmp_path, more))


@pytest.mark.parametrize(("old", "new", "words"), [
    (LINK, "", "moves no mass; give the links beyond it an <inertial>"),
    ('<link name="ground"/>', '<link name="ground"/><link name="other"/>', "has 2 roots"),
    ('revolute"><parent link="upper"', 'floating"><parent link="upper"', "is 'floating'; give"),
    ('<parent link="upper"/>', '<parent link="none"/>', "joins 'none', which is no link"),
    ('<child link="lower"/>', '<child link="upper"/>', "hangs on 2 joints, a closed loop"),
    ('<axis xyz="0 0 1"/>', '<axis xyz="0 0 0"/>', "axis of joint .* is 0 0 0"),
    ('<mass value="1"/>', '<mass value="heavy"/>', "mass of link .* is 'heavy'; give a number"),
    ('<mass value="1"/>', '<mass value="-1"/>', "has a mass of -1 kg"),
    ("<robot", '<!DOCTYPE r [<!ENTITY a "b">]><robot', "XML entities, which are not read"),
    ("<robot", "<robots", "no valid XML"),
    ('<robot name="two">', '<robot xmlns:xacro="x"><xacro:arm/>', "run xacro on it first"),
])  # fmt: skip
def test_a_urdf_that_cannot_be_followed_is_refused(old, new, words):
    assert old in URDF
    with pytest.raises(ValueError, match=words):
        qa.Robot(urdf=URDF.replace(old, new), elastic_joints=GEARS)


@pytest.mark.slow
def test_a_mimicking_joint_that_is_held_is_no_trouble():
    robot = qa.Robot(
        urdf=urdf_of("panda.urdf"), base=Base((1e5, 1e5)),
        held={"panda_finger_joint1": 0.02, "panda_finger_joint2": 0.02},
    )  # fmt: skip
    assert len(robot.joints) == 7


def test_a_robot_that_does_not_bend_is_refused():
    with pytest.raises(ValueError, match="has nothing that bends; give a beam"):
        qa.Robot(urdf=URDF)


def test_a_spring_too_soft_to_carry_its_load_is_refused():
    """Thirty kilograms at the end of a bar that lies level: more than a metre of sag."""
    heavy = qa.Beam(at="tool0", **(BAR | {"tip_mass": 30.0}))
    soft = qa.Robot(urdf=urdf_of("ur5_robot.urdf"), beam=heavy)
    level = qa.GeometricPath.line(np.zeros(6), np.full(6, 0.2))
    with pytest.raises(ValueError, match=r"spring beam . about . is too soft to carry its load"):
        soft.along(level)


def test_a_modulus_that_no_material_has_is_named(tmp_path):
    file = ARM_FILE.replace("70GPa", "70")
    robot = qa.Robot.load(write_robot(tmp_path, ARM, file))
    words = "youngs_modulus of the beam is 70 Pa, softer than any bar; was 70GPa meant?"
    assert [note.words for note in robot.notes] == [words]
    with pytest.raises(ValueError, match=f"too soft to carry its load .*; {re.escape(words)}$"):
        robot.along(qa.GeometricPath.line([0.0, 0.0], [0.2, 0.2]))
    stiff = qa.Robot.load(write_robot(tmp_path, ARM, file.replace(": 70,", ": 7e13,")))
    assert "7e+13 Pa, stiffer than diamond; give it such as 70GPa" in stiff.notes[0].words


@pytest.mark.parametrize(("path", "words"), [
    (qa.GeometricPath.line(START[:5], END[:5]), "is of 5 joints, and the robot drives 6"),
    (qa.GeometricPath.line(START, END, list("abcdef")), "is of the joints a, b, c, d, e, f"),
    (qa.GeometricPath.line(START, 3 * END), "'elbow_joint' is at .* its range is"),
])  # fmt: skip
def test_a_path_that_the_robot_cannot_follow_is_refused(path, words):
    with pytest.raises(ValueError, match=words):
        ur5_with_bar().along(path)


def test_a_path_that_names_its_joints_may_have_them_in_any_order():
    turned = [3, 1, 0, 2, 5, 4]
    names = [UR5_JOINTS[i] for i in turned]
    plant = ur5_with_bar().along(qa.GeometricPath.line(START[turned], END[turned], joints=names))
    assert plant.path(1.0) == pytest.approx(END)


def test_a_robots_content_is_plain():
    """Everything that a plan's file holds of a robot can be written as JSON."""
    from dataclasses import asdict

    assert json.loads(json.dumps(asdict(ur5_with_bar())))["beam"]["length"] == 0.8


@pytest.mark.slow
def test_modes_that_the_path_excites_are_followed():
    """A robot with a bar on a pedestal: modes of the bar and of the pedestal, none faster."""
    robot = dataclasses.replace(
        ur5_with_bar(), base=Base((6e4, 6e4), (5.0, 5.0), 0.5), modes="excited"
    )
    path = qa.GeometricPath.line(START, END)
    swings = swings_of(robot, path)
    numbers = modes_on(robot, path)
    largest = max(swing.leaves for swing in swings)
    assert numbers == tuple(swing.number for swing in swings if swing.leaves >= 1e-3 * largest)
    assert numbers == (0, 1, 2, 3)
    assert robot.along(path).modes == len(numbers) < len(swings)
    with pytest.raises(ValueError, match="modes is 'all'; give a whole number, or excited"):
        dataclasses.replace(robot, modes="all")


@pytest.mark.slow
def test_what_a_left_out_mode_leaves_is_what_the_cycloid_leaves():
    """The bound, undamped and at the worst phase, is above what a plain cycloid leaves alone."""
    robot = dataclasses.replace(ur5_with_bar(), modes=1)
    path = qa.GeometricPath.line(START, END)
    (slowest, *_) = swings_of(robot, path)
    duration = 2 * math.tau / slowest.frequency
    task = qa.PointToPoint(robot.along(path), target=1.0, duration=1.1 * duration)
    left = qa.evaluate_coefficients(task, []).residual
    assert 0.1 * slowest.leaves < left < 1.5 * slowest.leaves


@pytest.mark.parametrize("value", [1e300, 1e-300, math.inf, math.nan])
@pytest.mark.parametrize("name", ["length", "width", "youngs_modulus", "density", "tip_mass"])
def test_a_beam_of_no_size_is_refused(name, value):
    with pytest.raises(ValueError, match=f"{name.replace('_', '.')} of the beam is .*; give "):
        qa.Beam(at="lower", **{**BAR, name: value})


def _chain(count, kind):
    """So many links, each on the one before it."""
    links = "".join(f'<link name="l{k}">{LINK}</link>' for k in range(count))
    joints = "".join(
        f'<joint name="j{k}" type="{kind}"><parent link="l{k - 1}"/><child link="l{k}"/></joint>'
        for k in range(1, count)
    )
    return f'<robot name="chain">{links}{joints}</robot>'


def test_a_robot_of_too_many_joints_is_refused_with_the_bound():
    words = "has 199 joints that move; give at most 100, others as fixed ones or in held"
    with pytest.raises(ValueError, match=words):
        qa.Robot(urdf=_chain(200, "revolute"), base=Base((1e4, 1e4)))


@pytest.mark.slow
@pytest.mark.parametrize(("urdf", "words"), [
    (_chain(30_000, "fixed"), "has 30000 links; give at most 1000"),
    ('<robot name="deep">' + '<link name="a">' * 20_000 + "</link>" * 20_000 + "</robot>",
     "has no moving joint"),
    (URDF.replace('<mass value="1"/>', '<mass value="1e300"/>'), "is 1e.300; give at most 1e.09"),
    (URDF.replace('ixx="0.1"', 'ixx="1e200"'), "ixx of link .* is 1e.200; give at most 1e.09"),
    (URDF.replace('xyz="0.5 0 0"', 'xyz="1e200 0 0"'), "origin of .* give numbers of at most 1e."),
])  # fmt: skip
def test_a_urdf_of_no_robot_is_refused_with_the_bound(urdf, words):
    with pytest.raises(ValueError, match=words):
        qa.Robot(urdf=urdf, elastic_joints=GEARS)


def test_a_text_never_names_a_file(tmp_path):
    """A saved plan or a robot's file is a stranger's: its text of a URDF opens no file."""
    file = tmp_path / "two.urdf"
    file.write_text(URDF)
    assert qa.Robot(urdf=file, elastic_joints=GEARS) == qa.Robot(urdf=URDF, elastic_joints=GEARS)
    with pytest.raises(ValueError, match=r"urdf is no text of a URDF.*its file as a pathlib.Path"):
        qa.Robot(urdf=str(file), elastic_joints=GEARS)


def test_an_argument_of_a_wrong_type_is_refused_with_what_is_wanted():
    for entries, words in (
        ({"urdf": 3}, r"urdf is 3; give the text of a URDF, or a file as a Path"),
        ({"beam": {"at": "tool"}}, r"beam is \{'at': 'tool'\}; give qa\.models\.Beam\(at="),
        ({"joints": "a"}, "joints is 'a'; give a list of names"),
        ({"springs": {"a": "soft"}}, "spring of a in springs is 'soft'; give qa.models.Spring"),
        ({"gravity": 9.81}, "gravity is 9.81; give three numbers"),
        (
            {"limits": {"a": 3}},
            r"limits has joint 'a' where a quantity belongs; .* \{'speed': \{'a'",
        ),
        ({"limits": {"speed": {"x": 3}}}, "no driven joint, for limits of speed, 'x'"),
    ):
        with pytest.raises((TypeError, ValueError), match=words):
            qa.Robot(**{"urdf": ARM, **entries})


def test_rows_of_other_stiffness_move_as_the_robots_that_have_it():
    """Two candidates with errors of the springs, in one call and each on a plant of its own."""
    hand = '<link name="hand"/><joint name="wrist" type="fixed"><parent link="lower"/>'
    urdf = URDF.replace(
        "</robot>", f'{hand}<child link="hand"/><origin xyz="0.4 0 0"/></joint></robot>'
    )
    robot = qa.Robot(urdf=urdf, elastic_joints={"elbow": 1000.0}, modes=1)
    plant = robot.along(qa.GeometricPath.line([0.0, 0.2], [0.8, 1.0]))
    task, profile = qa.PointToPoint(plant, 1.0, 0.6), qa.CycloidPolynomial(2)
    coefficients = [[0.1, -0.05], [0.0, 0.02]]
    both = Evaluator(task, profile, 16, error_names=["stiffness"])(coefficients, [[0.1], [-0.2]])
    for place, multiple in enumerate((1.1, 0.8)):
        other = dataclasses.replace(task, plant=dataclasses.replace(plant, stiffness=multiple))
        expected = Evaluator(other, profile, 16)(coefficients)
        assert both.arrival[:, place] == pytest.approx(expected.arrival[:, 0], rel=1e-9, abs=1e-12)
        assert both.energy[:, place] == pytest.approx(expected.energy[:, 0], rel=1e-9)


def test_a_joint_whose_name_begins_as_the_beams_is_drawn_as_a_joint(tmp_path):
    """The link before it is rigid in the picture, as with any other name."""
    figures = []
    for name in ("a", "beam 1"):
        urdf = ARM.replace('joint name="a"', f'joint name="{name}"')
        entries = ARM_FILE.replace("joints: [a, b]", f'joints: ["{name}", b]')
        robot = qa.Robot.load(write_robot(tmp_path, urdf, entries))
        plant = robot.along(qa.GeometricPath.line([0.0, 0.5], [0.5, 1.0]))
        figures.append([body.points.shape for body in plant.structure(0.0, np.zeros(plant.tips))])
    assert figures[0] == figures[1]
