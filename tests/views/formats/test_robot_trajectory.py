"""Moves as MoveIt's RobotTrajectory: read back, thinned, and what a controller leaves of them."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from small_robots import ARM, ARM_FILE, MIXED, write_robot

import quietarm as qa
from quietarm.models import TimedMotion
from quietarm.ocp import evaluate_as_timed
from quietarm.views.formats.formats import export_plan, write_in
from quietarm.views.formats.robot_trajectory import RobotTrajectory

ENDS = ([0.0, 0.1], [1.0, 0.6])


@pytest.fixture(scope="module")
def plan(tmp_path_factory):
    robot = qa.Robot.load(write_robot(tmp_path_factory.mktemp("arm"), ARM, ARM_FILE))
    task = robot.task(qa.GeometricPath.line(*ENDS), 0.7)
    return qa.evaluate_coefficients(task, [0.01, -0.1])


def test_a_robot_trajectory_has_what_moveit_has(plan, tmp_path):
    export_plan(plan, tmp_path / "move.moveit", rate=100, frame="base's link")
    message = yaml.safe_load((tmp_path / "move.moveit").read_text())
    assert [*message] == ["joint_trajectory", "multi_dof_joint_trajectory"]
    of_joints = message["joint_trajectory"]
    assert of_joints["header"] == {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "base's link"}
    assert of_joints["joint_names"] == ["a", "b"]
    assert len(of_joints["points"]) == 71
    assert message["multi_dof_joint_trajectory"]["points"] == []
    last = of_joints["points"][-1]
    assert last["positions"] == pytest.approx(ENDS[1])
    assert last["time_from_start"] == {"sec": 0, "nanosec": 700_000_000}


def test_thinned_points_keep_joints_within_a_tolerance_and_say_what_is_left(plan, tmp_path):
    files, (note,) = write_in(
        RobotTrajectory(), [plan], tmp_path / "move.moveit", {"thin": 1e-5, "rate": 500.0}
    )
    motion = TimedMotion.load(files[0])
    count = len(motion.points)
    assert 3 < count < 30
    times = (motion.times[1:] + motion.times[:-1]) / 2
    joints = plan.sampled(times).sample.joints
    exact = np.column_stack([joint.angle for joint in joints])
    assert motion.at(np.array([0.5]))[:, 0] == pytest.approx(exact, abs=1.5e-5)
    left = evaluate_as_timed(plan.task.plant.robot, motion).residual
    assert note.startswith(f"{count} points; a controller that joins them by quintics leaves ")
    stated = float(note.split("leaves ")[1].split(" mm")[0])
    assert stated == pytest.approx(1e3 * left, rel=0.02)
    assert left == pytest.approx(plan.candidate.in_full.residual, rel=0.1)


def test_units_are_those_of_each_joint(tmp_path):
    robot = qa.Robot.load(write_robot(tmp_path, MIXED))
    path = qa.GeometricPath.line([0.0, 0.1], [0.5, 0.6])
    plan = qa.evaluate_coefficients(robot.task(path, 1.5), [])
    text = RobotTrajectory().content(plan, rate=10.0)
    assert text.startswith("# joints: 'x' in m, 'radial-axis' in rad\n")


@pytest.mark.slow
def test_an_exported_move_is_a_path_again(folder, call, plan):
    write_robot(folder, ARM, ARM_FILE)
    plan.save("plan.json")
    code, out, _ = call("export plan.json --output move.moveit --thin 0.001deg")
    assert code == 0
    assert "points; a controller that joins them by quintics leaves" in out
    code, out, _ = call("list robot.yaml --path move.moveit")
    assert code == 0
    assert "not used of the trajectory: velocities, accelerations, times" in " ".join(out.split())
    assert Path("move.moveit").exists()
