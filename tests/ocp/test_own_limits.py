"""A plant makes its task, within limits of its own."""

from dataclasses import dataclass, replace

import pytest
from small_robots import ARM, ARM_FILE, write_robot

import quietarm as qa

PATH = qa.GeometricPath.line([0.0, 0.0], [0.5, 1.0], joints=("a", "b"))


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    """Its URDF has limits of torque and speed, its joint_limits.yaml one of acceleration."""
    folder = tmp_path_factory.mktemp("robot")
    return qa.Robot.load(write_robot(folder, ARM, ARM_FILE, "a: {max_acceleration: 8}"))


def test_a_robot_makes_its_task_within_its_limits(robot):
    task = robot.task(PATH, 1.0)
    assert task == qa.PointToPoint(
        robot.along(PATH), target=1.0, duration=1.0,
        torque_limit={"a": 150.0, "b": 150.0}, speed_limit={"a": 3.0, "b": 3.0},
        acceleration_limit={"a": 8.0},
    )  # fmt: skip


def test_a_limit_that_is_given_is_in_the_place_of_the_robots_own(robot):
    others = {"duration": 1.0, "jerk_limit": 400.0, "residual_window": 0.5}
    task = robot.task(PATH, torque_limit={"a": 90.0}, speed_limit=None, **others)
    assert task.torque_limit == {"a": 90.0, "b": 150.0}  # the other joint keeps its own
    assert task.speed_limit is None
    assert task.jerk_limit == 400.0
    assert task.residual_window == 0.5
    assert robot.task(PATH, torque_limit=90.0, **others).torque_limit == 90.0
    without = robot.task(PATH, torque_limit={"a": None}, **others)
    assert without.torque_limit == {"b": 150.0}
    assert robot.task(PATH, acceleration_limit={"a": None}, **others).acceleration_limit is None


def test_a_multiple_of_the_payload_has_the_robots_limits(robot):
    heavy = replace(robot.along(PATH), payload=1.1)
    assert heavy.task(1.0, 1.0).limits == robot.task(PATH, 1.0).limits


@dataclass(frozen=True)
class DrivenLink(qa.SingleLinkManipulator):
    """A link with its drive."""

    name = "driven-link"

    @property
    def limits(self):
        return {"torque": 0.2, "speed": (-1.0, 2.0)}


def test_any_plant_makes_its_task_and_may_have_limits():
    assert qa.SingleLinkManipulator().task(0.5, 0.8) == qa.PointToPoint(
        qa.SingleLinkManipulator(), target=0.5, duration=0.8
    )
    task = DrivenLink().task(0.5, 0.8, speed_limit=3.0)
    assert (task.torque_limit, task.speed_limit) == (0.2, 3.0)


@dataclass(frozen=True)
class OddLink(qa.SingleLinkManipulator):
    """A link with a limit of something that nobody knows."""

    name = "odd-link"

    @property
    def limits(self):
        return {"speeed": 3.0}


def test_a_limit_of_something_else_is_refused():
    with pytest.raises(ValueError, match="odd-link has no limit of 'speeed'; did you mean 'speed'"):
        OddLink().task(0.5, 0.8)
