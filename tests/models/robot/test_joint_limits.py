"""Limits of the joints from a URDF and from files of MoveIt and ros2_control."""

import pytest
from small_robots import ARM, ARM_FILE, write_robot

import quietarm as qa

BOTH = "has_acceleration_limits: true, max_acceleration: 8, has_deceleration_limits: true"


def _robot(folder, limits):
    return qa.Robot.load(write_robot(folder, ARM, ARM_FILE, limits))


def _notes(robot):
    return " / ".join(note.words for note in robot.notes)


@pytest.mark.parametrize(
    "size", ["-3.0", "3.0"]
)  # MoveIt's are negative, those of ros2_control not
def test_the_smaller_of_acceleration_and_deceleration_bounds_both(tmp_path, size):
    robot = _robot(tmp_path, f"a: {{{BOTH}, max_deceleration: {size}}}")
    assert robot.limits["acceleration"] == {"a": 3.0}
    assert "the smaller of max_acceleration and max_deceleration" in _notes(robot)
    assert "a 3" in _notes(robot)


def test_the_bounds_of_one_direction_bound_both(tmp_path):
    robot = _robot(
        tmp_path, "a: {max_velocity: 2, min_velocity: -1.5}\n  b: {max_deceleration: -4}"
    )
    assert robot.limits["speed"] == {"a": 1.5, "b": 3.0}
    assert robot.limits["acceleration"] == {"b": 4.0}
    assert "the smaller of max_velocity and min_velocity bounds both directions: a 1.5" in _notes(
        robot
    )


def test_limits_that_are_switched_off_are_not_used_and_named(tmp_path):
    """MoveIt's assistant writes 0 where there is none; that is not named."""
    robot = _robot(
        tmp_path,
        "a: {has_velocity_limits: false, max_velocity: 2, has_acceleration_limits: false, "
        "max_acceleration: 0}",
    )
    assert robot.limits["speed"] == {"a": 3.0, "b": 3.0}
    assert "acceleration" not in robot.limits
    assert "has_..._limits is false: max_velocity of a" in _notes(robot)
    assert "max_acceleration" not in _notes(robot)


def test_a_limit_in_degrees_is_named_with_the_urdfs(tmp_path):
    """A speed of 170 deg/s is 2.967 rad/s; nothing is asked of limits near the URDF's."""
    robot = _robot(tmp_path, "a: {max_velocity: 170}\n  b: {max_velocity: 4, max_effort: 600}")
    words = _notes(robot)
    assert "speed limit far above the URDF's: a 170 rad/s (URDF 3); were degrees meant?" in words
    assert "170 deg/s are 2.967 rad/s" in words
    assert "torque limit far above the URDF's: b 600 N m (URDF 150); is it right?" in words


def test_narrower_positions_narrow_the_range(tmp_path):
    robot = _robot(tmp_path, "a: {has_position_limits: true, min_position: -1, max_position: 1}")
    assert robot.ranges() == [(-1.0, 1.0), (-3.0, 3.0)]
    with pytest.raises(
        ValueError, match=r"joint 'a' is at 2 at s = 1 of the path; its range is -1"
    ):
        robot.along(qa.GeometricPath.line([0.0, 0.0], [2.0, 1.0]))


def test_a_narrower_range_is_saved_with_a_plan(tmp_path):
    robot = _robot(tmp_path, "a: {min_position: -1, max_position: 1}")
    plant = robot.along(qa.GeometricPath.line([0.0, 0.0], [0.5, 1.0]))
    plan = qa.evaluate_coefficients(qa.PointToPoint(plant, target=1.0, duration=1.0), [])
    plan.save(tmp_path / "plan.json")
    loaded = qa.Plan.load(tmp_path / "plan.json").task.plant.robot
    assert loaded == robot
    assert loaded.ranges()[0] == (-1.0, 1.0)


def test_joints_of_another_robot_are_one_warning(tmp_path):
    robot = _robot(tmp_path, "wheel: {max_velocity: 1}\n  arm_9: {max_velocity: 1}")
    (note,) = robot.notes
    assert "limits of joints that the URDF does not have: wheel, arm_9" in note.words
    assert robot.limits["speed"] == {"a": 3.0, "b": 3.0}


def test_limits_of_held_joints_are_not_limits_of_the_move(tmp_path):
    urdf = qa.Robot.load(write_robot(tmp_path, ARM, f"{ARM_FILE}limits: urdf\n"))
    assert urdf.limits == {"torque": {"a": 150.0, "b": 150.0}, "speed": {"a": 3.0, "b": 3.0}}
    moveit = _robot(tmp_path, "grip: {max_velocity: 0.1, max_position: 1}")
    assert moveit.limits == urdf.limits


def test_a_driven_joint_that_nothing_limits_is_named(tmp_path):
    text = ARM.replace('effort="150" velocity="3"', 'effort="0" velocity="3"', 1)
    robot = qa.Robot.load(write_robot(tmp_path, text, f"{ARM_FILE}limits: urdf\n"))
    assert robot.limits == {"torque": {"b": 150.0}, "speed": {"a": 3.0, "b": 3.0}}
    (note,) = robot.notes
    assert note.words == "no limit of torque for a: the URDF's effort is 0, or missing"


def test_what_is_for_controllers_and_requests_is_named(tmp_path):
    write_robot(tmp_path, ARM, f"{ARM_FILE}limits: joint_limits.yaml\n")
    (tmp_path / "joint_limits.yaml").write_text("""
default_velocity_scaling_factor: 0.1
default_acceleration_scaling_factor: 1.0
cartesian_limits: {max_trans_vel: 1}
joint_limits:
  a: {has_soft_limits: true, k_position: 10, k_velocity: 5, soft_lower_limit: -2,
      soft_upper_limit: 2, angle_wraparound: false, max_effort: 100}
""")
    robot = qa.Robot.load(tmp_path / "robot.yaml")
    words = _notes(robot)
    assert robot.limits["torque"] == {"a": 100.0, "b": 150.0}
    assert "for controllers: has_soft_limits of a, k_position of a, k_velocity of a" in words
    assert "in full: default_velocity_scaling_factor 0.1, cartesian_limits" in words
    assert "wraparound" not in words
    assert "default_acceleration" not in words


def test_limits_may_stand_within_the_parameters_of_a_node(tmp_path):
    write_robot(tmp_path, ARM, f"{ARM_FILE}limits: joint_limits.yaml\n")
    (tmp_path / "joint_limits.yaml").write_text(
        "/**: {ros__parameters: {robot_description_planning: {joint_limits: {b: {max_jerk: 9}}}}}"
    )
    assert qa.Robot.load(tmp_path / "robot.yaml").limits["jerk"] == {"b": 9.0}


@pytest.mark.parametrize(("limits", "words"), [
    ("a: {max_acc: 8}", "max_acc of a in limits: did you mean max_acceleration?"),
    ("a: {max_jerks: 8}", "max_jerks of a in limits: did you mean max_jerk?"),
    ("grip: {has_velocity_limit: true}", "did you mean has_velocity_limits?"),
    ("a: {max_velocity: 1, max_velocity: 2}", "has 'max_velocity' twice, again in line 2"),
    ("a: {max_velocity: 1}\n  a: {max_velocity: 2}", "has 'a' twice, again in line 3"),
    ("a: {max_position: 4}", "max_position of a in limits is 4, beyond the URDF's 3"),
    ("a: {min_position: 1, max_position: 0.5}", "give a range"),
    ("a: {has_position_limits: true}", "give min_position and max_position"),
    ("a: {max_deceleration: 0}", "max_deceleration of a .* is 0 rad/s.2; give a positive number"),
    ("a: {max_velocity: -2}", "max_velocity of a in limits is -2 rad/s; give a positive number"),
    ("a: {max_velocity: 2, min_velocity: 1}", "min_velocity .* is 1 rad/s; give a negative number"),
    ("a: {has_velocity_limits: true}", "max_velocity of a in limits is None; give a number"),
    ("a: {has_velocity_limits: 'on'}", "has_velocity_limits of a in limits is 'on'; give true or"),
    ("a: 3", "limits of a are 3; give has_velocity_limits"),
])  # fmt: skip
def test_what_a_file_of_limits_may_not_say(tmp_path, limits, words):
    with pytest.raises(ValueError, match=words):
        _robot(tmp_path, limits)


@pytest.mark.parametrize(("text", "words"), [
    ("joint_limit: {a: {max_velocity: 1}}", "did you mean 'joint_limits'?"),
    ("joint_limits: {}\nscaling: 3", "has no entry 'scaling'"),
    ("joint_limits: 3", "has no joint_limits by joint"),
    ("[]", "has no joint_limits; give a joint_limits.yaml"),
    ("elbow: {max_velocity: 1}", "begins with elbow; give joint_limits: as its first line"),
    ("a: {has_jerk_limits: true}\nb: {}", "begins with a; give joint_limits: as its first line"),
])  # fmt: skip
def test_what_is_no_file_of_limits(tmp_path, text, words):
    write_robot(tmp_path, ARM, f"{ARM_FILE}limits: joint_limits.yaml\n")
    (tmp_path / "joint_limits.yaml").write_text(text)
    with pytest.raises(ValueError, match=words):
        qa.Robot.load(tmp_path / "robot.yaml")


def test_an_entry_of_a_robot_that_is_given_twice_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"robot.yaml has 'tip' twice, again in line 7"):
        qa.Robot.load(write_robot(tmp_path, ARM, f"{ARM_FILE}tip: tool\ntip: fore\n"))


@pytest.mark.parametrize(("entries", "words"), [
    ({"positions": {"grip": (0.0, 0.02)}}, "no driven joint, for positions, 'grip'"),
    ({"positions": {"a": (-4.0, 1.0)}}, "give a range within the URDF's, -3 to 3"),
    ({"positions": {"a": 2.0}}, "positions of a are 2.0; give the least and the largest"),
])  # fmt: skip
def test_ranges_lie_within_the_urdfs(entries, words):
    with pytest.raises(ValueError, match=words):
        qa.Robot(urdf=ARM, held={"grip": 0.0}, elastic_joints={"a": 1e4}, modes=1, **entries)
