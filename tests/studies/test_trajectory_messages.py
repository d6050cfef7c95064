"""Messages of MoveIt planned anew, as dictionaries with all entries that real ones have."""

import json
import re

import numpy as np
import pytest
from moveit_messages import along, motion_plan_response
from small_robots import ARM, write_robot
from trajectories import trapezoid

import quietarm as qa
from quietarm.studies import MessagePlanner, trajectory_messages

FILE = """urdf: robot.urdf
beam: {at: tool, length: 0.5, width: 6mm, height: 10mm, youngs_modulus: 70GPa, density: 2700,
       tip_mass: 0.3, damping: 0.5%, pieces: 2}
joints: [a, b]
held: {grip: 20mm}
modes: 1
"""
NAMES = ("b", "grip", "a")
"""In another order than the robot's, and with a joint that it does not drive."""


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    return qa.Robot.load(write_robot(tmp_path_factory.mktemp("arm"), ARM, FILE))


def trajectory(start=(0.1, 0.02, 0.0), end=(0.6, 0.02, 0.8), duration=1.3):
    return along(NAMES, start, end, duration, lambda time: trapezoid(0.3, time, duration))


def response(grip=0.02):
    message = trajectory((0.1, grip, 0.0), (0.6, grip, 0.8))
    return motion_plan_response(message, {"a": 0.0, "b": 0.1, "grip": grip})


def test_the_answer_is_a_message_of_the_same_joints_along_the_same_path(robot, monkeypatch):
    """With the plain cycloid in place of a plan, whose solve the slow tests do."""
    monkeypatch.setattr(
        trajectory_messages, "plan_move", lambda task, _: qa.evaluate_coefficients(task, [])
    )
    planned = MessagePlanner(robot, terms=2, rate=50.0, judge=False).plan(response(grip=0.0))
    assert json.loads(json.dumps(planned.message)) == planned.message  # plain numbers and texts
    message = planned.message["joint_trajectory"]
    assert message["joint_names"] == list(NAMES)
    assert message["header"] == {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "world"}
    nothing = {"sec": 0, "nanosec": 0}
    assert planned.message["multi_dof_joint_trajectory"] == {
        "header": {"stamp": nothing, "frame_id": "world"}, "joint_names": [], "points": [],
    }  # fmt: skip
    points = message["points"]
    assert len(points) == 66  # 1.3 s at 50 Hz
    assert points[0]["time_from_start"] == nothing
    assert points[-1]["time_from_start"] == {"sec": 1, "nanosec": 300_000_000}
    assert {len(point["effort"]) for point in points} == {0}
    table = np.array(
        [[point[kind] for kind in ("positions", "velocities", "accelerations")] for point in points]
    )
    np.testing.assert_allclose(table[0, 0], [0.1, 0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(table[-1, 0], [0.6, 0.0, 0.8], atol=1e-9)
    np.testing.assert_allclose(table[[0, -1], 1:], 0.0, atol=1e-6)
    np.testing.assert_array_equal(table[:, 1:, 1], 0.0)  # the gripper stands
    share = table[:, 0, 2] / 0.8
    np.testing.assert_allclose(table[:, 0, 0], 0.1 + 0.5 * share, atol=1e-9)  # on the line
    assert planned.report.startswith("1.3 s, 66 points: ")
    assert "\n" not in planned.report
    assert planned.remarks[0] == ("joint 'grip' is at 0, and the robot's file holds it at 0.02")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda m: m.pop("trajectory"), "no JointTrajectory; give one with joint_names"),
        (lambda m: m["trajectory"]["joint_trajectory"].update(points=[]), "has no points"),
        (
            lambda m: m["trajectory"]["joint_trajectory"]["points"][0].update(
                velocities=[0.3, 0.0, 0.0]
            ),
            "begins while joint 'b' moves at 0.3 rad/s",
        ),
        (
            lambda m: m["trajectory"]["joint_trajectory"]["points"][4]["positions"].__setitem__(
                1, 0.03
            ),
            "joint 'grip' moves by 0.01 m, and the robot's file does not drive it, but holds it at",
        ),
        (
            lambda m: m["trajectory_start"]["joint_state"]["position"].__setitem__(0, 0.2),
            "joint 'a' is at 0.2 in the start state and at 0 in the first point",
        ),
        (
            lambda m: m["trajectory"]["joint_trajectory"].update(joint_names=["b", "grip", "c"]),
            "of the joints b, grip, c, without a, which the robot's file drives",
        ),
        (
            lambda m: m["trajectory"]["multi_dof_joint_trajectory"].update(
                joint_names=["base"], points=[{"transforms": [{}]}]
            ),
            "the message moves base in several degrees of freedom",
        ),
        (
            lambda m: [
                point.update(time_from_start={"sec": 0, "nanosec": 0})
                for point in m["trajectory"]["joint_trajectory"]["points"]
            ],
            "no times that increase, and no duration was given; give a duration",
        ),
    ],
    ids=["none", "empty", "moving", "gripper", "start", "other joints", "base", "no times"],
)
def test_what_is_no_motion_of_the_robot_is_refused_in_a_line(robot, change, words):
    message = response()
    change(message)
    with pytest.raises(ValueError, match=re.escape(words)) as error:
        MessagePlanner(robot).plan(message)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"slowest": 0.5}, "slowest is 0.5; give 1 or more"),
        ({"rate": 0.0}, "rate is 0"),
        ({"path_tolerance": -1.0}, "path_tolerance is -1"),
        ({"terms": 0}, "terms"),
    ],
)
def test_options_out_of_range_are_refused(robot, options, words):
    with pytest.raises(ValueError, match=words):
        MessagePlanner(robot, **options)


@pytest.mark.slow
def test_limits_by_shares_take_longer_and_the_report_says_what_the_message_left(robot, tmp_path):
    limits = "a: {has_acceleration_limits: true, max_acceleration: 6.0}\n  b: {}"
    limited = qa.Robot.load(write_robot(tmp_path, ARM, FILE, limits))
    planner = MessagePlanner(limited, terms=6)
    message = trajectory(duration=1.1)
    planned = planner.plan(message, acceleration_scale=0.5)
    points = planned.message["joint_trajectory"]["points"]
    peak = max(abs(point["accelerations"][2]) for point in points)
    assert 0.5 * 3.0 < peak < 3.0 * 1.001  # half of what the robot's file allows
    assert planned.plan.task.duration > 1.1
    assert planned.plan.residual < 1e-5
    assert "in 1.1 s no plan is within the limits" in planned.report
    assert "after arrival by the whole equations (the message as it was timed:" in planned.report
