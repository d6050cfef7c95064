"""Parts of a URDF that are used, that are refused and that are named as not used."""

import math
from dataclasses import asdict

import numpy as np
import pytest
from robots import urdf_of
from two_links import (
    BASE,
    ELBOW,
    INERTIA,
    INERTIAL,
    LIMIT,
    SHOULDER,
    URDF,
    limits_of,
    robot_of,
    with_elbow,
    words_of,
)

import quietarm as qa
from quietarm.models.robot.urdf.read_urdf import read_urdf
from quietarm.models.robot.urdf.urdf_text import dynamics_of, passed_over


@pytest.mark.parametrize(("old", "new", "words"), [
    ("</robot>", '<link name="lower"/></robot>', "two links are called 'lower' in the URDF; give"),
    ("</robot>", f"{ELBOW}</robot>", "two joints are called 'elbow' in the URDF"),
    ("</robot>", f'<robot name="b">{SHOULDER}</robot></robot>', "holds several robots"),
    ("</robot>", '</robot><robot name="b"/>', "goes on after </robot>, as with several robots"),
    ("<robot", "<sdf", "no valid XML"),
    (INERTIAL, INERTIAL + INERTIAL, "link 'upper' of the URDF has two <inertial>; give one"),
    (INERTIA, INERTIA + INERTIA, "link 'upper' of the URDF has two <inertia>"),
    ('<mass value="1"/>', '<mass value="1"/><mass value="2"/>', "'upper' .* has two <mass>"),
    ('<axis xyz="0 0 1"/>', '<axis xyz="0 0 1"/><axis xyz="1 0 0"/>', "'shoulder' .* two <axis>"),
    (LIMIT, LIMIT + LIMIT, "joint 'shoulder' of the URDF has two <limit>"),
    ('<parent link="upper"/>', '<parent link="upper"/><parent link="lower"/>', "two <parent>"),
    ('<child link="upper"/>', '<child link="upper"/><child link="lower"/>', "two <child>"),
    ('<origin xyz="0.5 0 0"/>', '<origin xyz="0.5 0 0"/><origin xyz="1 0 0"/>', "two <origin>"),
    ("</joint></robot>", '<mimic joint="shoulder"/><mimic joint="elbow"/></joint></robot>',
     "joint 'elbow' of the URDF has two <mimic>"),
    ("</joint></robot>", '<dynamics damping="1"/><dynamics friction="1"/></joint></robot>',
     "joint 'elbow' of the URDF has two <dynamics>"),
    ("</joint></robot>", "<dynamics/><dynamics/><dynamics/></joint></robot>", "has 3 <dynamics>"),
    ('effort="50"', 'effort="-50"', "effort of joint 'shoulder' of the URDF is -50; give 0"),
    ('velocity="3"', 'velocity="-3"', "velocity of joint 'shoulder' of the URDF is -3; give 0"),
    ('velocity="3"', 'velocity="3" jerk="-1"', "jerk of joint 'shoulder' of the URDF is -1"),
    ('lower="-2" upper="2"', 'lower="2" upper="-2"',
     "limit of joint 'shoulder' of the URDF: lower 2 is above upper -2; swap"),
    ("</joint></robot>", '<dynamics damping="-1"/></joint></robot>',
     "damping of .*'elbow'.* is -1;"),
    ("<limit ", "<limits ", "joint 'shoulder' of the URDF has no entry <limits>; did you mea"),
    ("<limit ", "<Limit ", "has no entry <Limit>; did you mean <limit>"),
    ("</joint></robot>", '<dynamic damping="1"/></joint></robot>', "did you mean <dynamics>"),
    ('<mass value="1"/>', '<mas value="1"/>', "'upper' of the URDF has no entry <mas>; did you me"),
    ("</link>", "<inertail/></link>", "has no entry <inertail>; did you mean <inertial>"),
    ("</robot>", "<links/></robot>", "the URDF has no entry <links>; did you mean <link>"),
    ('effort="50"', 'effrot="50"', "<limit> of joint 'shoulder' of the URDF has no 'effrot'; did"),
    ('velocity="3"', 'max_velocity="3"', "has no 'max_velocity'; did you mean 'velocity'"),
    ("</joint></robot>", '<mimic joint="shoulder" multiplyer="2"/></joint></robot>',
     "'multiplyer'; did you mean 'multiplier'"),
    ("</joint></robot>", "<mimic/></joint></robot>", "'elbow' of the URDF mimics no joint; name"),
    ("</joint></robot>", '<mimic joint="elbow"/></joint></robot>',
     "mimic each other in a circle, elbow and elbow; let one of them move by itself"),
    ('xyz="0.5 0 0"', 'xyz="0.5 0 0" quat_xyzw="0 0 0 0"', "quat_xyzw of .*'elbow'.* is 0 0 0 0"),
    ('xyz="0.5 0 0"', 'quat_xyzw="0 0 0 1" rpy="0 0 0"', "has rpy and quat_xyzw; give one of them"),
])  # fmt: skip
def test_what_is_twice_impossible_or_mistyped_is_refused(old, new, words):
    assert old in URDF
    with pytest.raises(ValueError, match=words) as refusal:
        robot_of(URDF.replace(old, new, 1))
    assert "\n" not in str(refusal.value)


def test_a_circle_of_mimics_is_refused():
    """Whichever of them is read first."""
    shoulder = SHOULDER.replace("</joint>", '<mimic joint="elbow"/></joint>')
    text = with_elbow('<mimic joint="shoulder"/>').replace(SHOULDER, shoulder)
    with pytest.raises(ValueError, match="in a circle, shoulder and elbow and shoulder"):
        robot_of(text)


@pytest.mark.parametrize("name", ["command_effort", "gear_velocity", "soft_lower_limit"])
def test_what_others_add_is_not_taken_for_a_mistake(name):
    """As in URDFs of ANYmal: it is named, and nothing is refused."""
    robot = robot_of(URDF.replace('effort="50"', f'effort="50" {name}="1"'))
    joints = "'shoulder' and 1 more"
    assert words_of(robot) == f"not read of the URDF: {name} of limit of {joints}"


def test_what_does_not_bear_on_the_motion_is_not_named():
    shape = '<visual name="a"><geometry><box size="1 1 1"/></geometry></visual>'
    text = URDF.replace('<link name="ground"/>', f'<link name="ground">{shape}{shape}</link>')
    text = text.replace("</robot>", '<gazebo reference="lower"/><material name="red"/></robot>')
    assert passed_over(text) == []
    assert words_of(robot_of(text)) == ""
    assert "visual" not in dynamics_of(text)


def test_what_is_not_read_stays_named_when_the_robot_is_made_again():
    robot = robot_of(with_elbow('<safety_controller soft_upper_limit="1"/><dynamics D="3"/>'))
    entries = "safety_controller (none to 1) of 'elbow', D of dynamics of 'elbow'"
    words = f"not read of the URDF: {entries}"
    assert words_of(robot) == words
    assert words_of(qa.Robot(**{entry: getattr(robot, entry) for entry in asdict(robot)})) == words


def test_a_fixed_joint_has_neither_axis_nor_limit():
    text = URDF.replace(
        "</robot>",
        '<link name="tcp"/><joint name="t" type="fixed"><parent link="lower"/><child link="tcp"/>'
        '<axis xyz="0 0 0"/><limit lower="1" upper="0" effort="-1"/></joint></robot>',
    )
    assert "tcp" in robot_of(text).description.links


def test_a_rotation_by_a_quaternion_is_that_by_roll_pitch_and_yaw():
    """Half a turn of x to y, and URDF 1.2's quat_xyzw of it."""
    turned = URDF.replace('xyz="0.5 0 0"', f'xyz="0.5 0 0" rpy="0 0 {math.pi / 2}"')
    half = math.sqrt(0.5)
    by_quaternion = URDF.replace('xyz="0.5 0 0"', f'xyz="0.5 0 0" quat_xyzw="0 0 {half} {half}"')
    frames = [read_urdf(text).joints["elbow"].frame.rotation for text in (turned, by_quaternion)]
    assert frames[0] == pytest.approx(frames[1], abs=1e-15)
    assert frames[1] @ [1.0, 0.0, 0.0] == pytest.approx([0.0, 1.0, 0.0], abs=1e-15)


def test_limits_of_urdf_1_2_are_kept(tmp_path):
    more = 'velocity="3" acceleration="5" deceleration="-4" jerk="60"'
    text = URDF.replace('velocity="3"', more)
    limits = limits_of(tmp_path, text)
    assert limits["acceleration"] == {"shoulder": 4.0, "elbow": 4.0}
    assert limits["jerk"] == {"shoulder": 60.0, "elbow": 60.0}
    assert limits["speed"] == {"shoulder": 3.0, "elbow": 3.0}
    words = "limits of deceleration are smaller, and are kept while joints speed up"
    assert words in words_of(robot_of(text, limits=limits))
    larger = URDF.replace('velocity="3"', 'velocity="3" acceleration="5" deceleration="7"')
    assert limits_of(tmp_path, larger)["acceleration"]["elbow"] == 5.0
    assert words_of(robot_of(larger, limits=limits_of(tmp_path, larger))) == ""


@pytest.mark.parametrize(("moments", "words"), [
    ('ixx="0.004" iyy="0.6" izz="0.06"',
     "link 'upper' of the URDF has a moment of inertia of 0.6 kg m^2, above the sum of the two "
     "others, 0.064, which no body has (so have 'lower'); mend it"),
    ('ixx="0.1" iyy="0.1" izz="0.2005"', ""),  # of a plate, in few digits
    ('ixx="0.1" iyy="0.1" izz="0"', ""),
])  # fmt: skip
def test_inertias_that_no_body_has_are_named(moments, words):
    assert words_of(robot_of(URDF.replace('ixx="0.1" iyy="0.1" izz="0.1"', moments))) == words


def test_a_moment_below_0_is_a_warning_where_it_does_not_matter():
    """TIAGo's antennas, on the base, have one; a link that moves with no other is refused."""
    antenna = '<inertial><mass value="1e-6"/><inertia ixx="-3.5e-8" iyy="1e-6" izz="1e-6"/>'
    still = URDF.replace(
        '<link name="ground"/>', f'<link name="ground">{antenna}</inertial></link>'
    )
    robot = qa.Robot(urdf=still, elastic_joints={"elbow": 100.0})
    assert words_of(robot).startswith("link 'ground' of the URDF has a moment of inertia of -3.5e")
    with pytest.raises(ValueError, match=r"'upper' .* a moment of inertia of -0\.1 .*, below 0; g"):
        robot_of(URDF.replace('ixx="0.1"', 'ixx="-0.1"'))


def test_a_robot_without_masses_says_which_figures_hold():
    bar = qa.Beam("lower", 0.5, 0.01, 0.01, 70e9, 2700.0)
    empty = URDF.replace(INERTIAL, "")
    (note,) = qa.Robot(urdf=empty, beam=bar).notes
    assert note.about == ("energy", "torque")
    assert "only the residual holds" in note.words
    (rocking,) = qa.Robot(urdf=empty, beam=bar, base=BASE).notes
    assert rocking.about == ("energy", "torque", "residual")
    assert not qa.Robot(urdf=URDF, beam=bar).notes


def test_damping_and_friction_of_the_urdf_are_used():
    """Per joint, where the robot has none of its own; what is 0 is none."""
    text = with_elbow('<dynamics damping="5" friction="3"/>')
    robot = robot_of(text)
    assert (robot.friction, robot.coulomb) == ({"elbow": 5.0}, {"elbow": 3.0})
    assert words_of(robot) == ""
    own = robot_of(text, friction={"elbow": 2.0, "shoulder": 1.0}, coulomb={"elbow": 0.0})
    assert own.friction == {"elbow": 2.0, "shoulder": 1.0}
    assert own.coulomb == {"elbow": 0.0}
    assert "friction as given in place of the URDF's damping: elbow 2 (URDF 5)" in (words_of(own))
    assert "in place of the URDF's friction: elbow 0 (URDF 3) N m" in words_of(own)
    assert robot_of(with_elbow('<dynamics damping="0" friction="0"/>')).friction == {}
    held = robot_of(text, held={"elbow": 0.1})
    assert held.friction == {}


def test_damping_of_a_passive_joint_is_named_where_springs_has_another():
    text = with_elbow('<dynamics damping="5"/>')
    assert "dynamics of elbow in the URDF are not used" in (
        words_of(robot_of(text, springs={"elbow": (100.0, 1.0)}))
    )
    assert words_of(robot_of(text, springs={"elbow": (100.0, 5.0)})) == ""


def test_modes_are_by_default_as_many_as_there_are_springs():
    one = qa.Robot(urdf=URDF, elastic_joints={"shoulder": 100.0})
    assert one.modes == 1
    assert robot_of(URDF).modes == 2
    with pytest.raises(ValueError, match="modes is 2; the robot has 1 spring, give at most that"):
        qa.Robot(urdf=URDF, elastic_joints={"shoulder": 100.0}, modes=2)


def test_motors_without_inertia_on_springs_alone_are_told_what_to_give():
    path = qa.GeometricPath.line([0.0, 0.0], [1.0, 0.5])
    both = {"shoulder": 100.0, "elbow": 100.0}
    words = r"needs rotor_inertia of shoulder, elbow \(motor's inertia times the gear ratio squ"
    with pytest.raises(ValueError, match=words):
        qa.Robot(urdf=URDF, elastic_joints=both).along(path)
    one = qa.Robot(urdf=URDF, elastic_joints=both, rotor_inertia={"shoulder": 0.1})
    with pytest.raises(ValueError, match="needs rotor_inertia of elbow"):
        one.along(qa.GeometricPath.line([0.0, 0.0], [0.0, 1.0]))
    # the elbow's link turns with the path whatever the shoulder's gear does
    assert qa.Robot(urdf=URDF, elastic_joints={"shoulder": 100.0}).along(path)


def test_links_in_millimetres_are_asked_for():
    text = URDF.replace('xyz="0.5 0 0"', 'xyz="500 0 0"').replace('xyz="0.2', 'xyz="200')
    upright = text.replace('<axis xyz="0 0 1"/>', '<axis xyz="0 1 0"/>')
    robot = qa.Robot(urdf=upright, elastic_joints={"shoulder": 1e4})
    assert words_of(robot) == "links are 500 m long; are origins in mm?"
    with pytest.raises(ValueError, match=r"too soft .*; links are 500 m long; are origins in mm"):
        robot.sag([0.0, 0.0])


@pytest.mark.parametrize("name", ["width", "height"])
def test_a_bar_wider_than_long_is_asked_for_millimetres(name):
    sizes = {"width": 0.005, "height": 0.005, name: 5.0}
    words = rf"{name} of the beam is 5 m, and its length 0\.5 m; is it in mm, such as 5mm\?"
    with pytest.raises(ValueError, match=words):
        qa.Beam("lower", 0.5, youngs_modulus=70e9, density=2700.0, **sizes)


def test_a_bar_heavier_than_its_robot_is_refused(tmp_path):
    (tmp_path / "two.urdf").write_text(URDF)
    file = tmp_path / "two.yaml"
    file.write_text(
        "{urdf: two.urdf, beam: {at: lower, length: 0.5, width: 0.05, height: 0.05, "
        "youngs_modulus: 70GPa, density: 2700}}"
    )
    words = r"the beam has 3\.375 kg, more than the robot's 2 kg; are its sizes in mm"
    with pytest.raises(ValueError, match=words):
        qa.Robot.load(file)


@pytest.mark.slow
def test_many_joints_are_listed_in_a_line_of_some_length():
    with pytest.raises(ValueError, match=r"'finger' .* and 95 more") as refusal:
        robot_of(urdf_of("tiago_dual.urdf"), joints=["finger"])
    assert len(str(refusal.value)) < 400


def test_a_range_with_one_end_begins_or_ends_at_0():
    """As the format says; without both a joint is endless, and named."""
    upper = URDF.replace('lower="-2" upper="2"', 'upper="2"', 1)
    assert robot_of(upper).ranges()[0] == (0.0, 2.0)
    none = URDF.replace('lower="-2" upper="2"', "", 1)
    assert robot_of(none).ranges()[0] == (-np.inf, np.inf)
    assert words_of(robot_of(none)) == (
        "the URDF has neither lower nor upper of shoulder: taken as endless"
    )
