"""Plans of robots with other flexibilities than a bar alone, against MuJoCo."""

import pytest
from mujoco_robots import FlexibleRobot, Truth, motion_of
from robots import BAR, UR5_JOINTS, straight, urdf_of

import quietarm as qa
from quietarm.models import Base

# 0.5 m high, it rocks at 10.3 and 10.7 Hz under the robot.
PEDESTAL = Base(stiffness=(6e4, 6e4), damping=(5.0, 5.0), height=0.5)


def _on_pedestal(robot):
    """The robot of MuJoCo, on the pedestal."""
    robot.add_base(PEDESTAL.stiffness[0], PEDESTAL.damping[0], PEDESTAL.height)
    return robot


def _plan(robot, duration, path=None):
    plant = robot.along(path or straight())
    return qa.plan_move(qa.PointToPoint(plant, target=1.0, duration=duration))


def test_a_robot_on_a_rocking_pedestal_arrives_still():
    """Within 0.001 mm; the plain cycloid leaves 0.09 mm, of which the model knows."""
    robot = qa.Robot(urdf=urdf_of("ur5_robot.urdf"), base=PEDESTAL, tip="wrist_3_link")
    plan = _plan(robot, 0.8)
    in_mujoco = _on_pedestal(FlexibleRobot(urdf_of("ur5_robot.urdf"), tip=("wrist_3_link", 0.0)))
    truth = Truth(in_mujoco, UR5_JOINTS)
    residual, energy, _ = truth.residual_and_energy(motion_of(plan), 0.8)
    assert residual <= 1e-6
    assert energy == pytest.approx(plan.energy, rel=1e-5)
    cycloid = qa.evaluate_coefficients(plan.task, [])
    residual, energy, _ = truth.residual_and_energy(motion_of(cycloid), 0.8)
    assert cycloid.residual == pytest.approx(residual, rel=0.01)
    assert residual > 0.05e-3
    assert cycloid.energy == pytest.approx(energy, rel=1e-5)


@pytest.mark.slow
def test_a_pedestal_and_a_bar_are_followed_by_four_modes():
    """Two of the bar, two of the pedestal; what is left is of the order of that without one."""
    bar = qa.Beam(at="tool0", **BAR)
    robot = qa.Robot(urdf=urdf_of("ur5_robot.urdf"), beam=bar, base=PEDESTAL, modes=4)
    plan = _plan(robot, 1.0)
    in_mujoco = FlexibleRobot(urdf_of("ur5_robot.urdf"))
    hinges = in_mujoco.add_bar("tool0", **BAR)
    truth = Truth(_on_pedestal(in_mujoco), UR5_JOINTS, BAR["damping"], hinges)
    residual, energy, _ = truth.residual_and_energy(motion_of(plan), 1.0)
    assert residual <= 0.05e-3
    assert energy == pytest.approx(plan.energy, rel=1e-3)
