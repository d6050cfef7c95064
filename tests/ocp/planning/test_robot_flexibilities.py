"""Plans of robots with other flexibilities than a bar alone, against MuJoCo."""

import dataclasses

import numpy as np
import pytest
from mujoco_robots import FlexibleRobot, Truth, motion_of
from robots import (
    BAR,
    END,
    PANDA_END,
    PANDA_START,
    PEDESTAL,
    START,
    STEEL_BAR,
    UR5_JOINTS,
    panda_with_bar,
    straight,
    ur5_with_bar,
    urdf_of,
)

import quietarm as qa
from quietarm.models import JointMotion
from quietarm.ocp import FreeVibration, perturb_plant

pytestmark = pytest.mark.slow


def _on_pedestal(robot):
    """The robot of MuJoCo, on the pedestal."""
    robot.add_base(PEDESTAL.stiffness[0], PEDESTAL.damping[0], PEDESTAL.height)
    return robot


def _plan(robot, duration):
    return qa.plan_move(qa.PointToPoint(robot.along(straight()), target=1.0, duration=duration))


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
    assert residual <= 0.06e-3  # 0.058 mm with the twin of twelve hinges a direction
    assert energy == pytest.approx(plan.energy, rel=1e-3)


@pytest.mark.parametrize(("multiples", "tip_mass", "stiffer"), [
    ({"stiffness": 0.9}, 1.0, 0.9),
    pytest.param({"payload": 1.1}, 1.1, 1.0, marks=pytest.mark.slow),
    pytest.param({"stiffness": 1.1, "payload": 0.9}, 0.9, 1.1, marks=pytest.mark.slow),
])  # fmt: skip
def test_multiples_are_other_robots(multiples, tip_mass, stiffer):
    """A plant with other stiffness and payload moves as the robot that has them in its file."""
    plant = ur5_with_bar().along(straight())
    bar = BAR | {
        "tip_mass": tip_mass * BAR["tip_mass"],
        "youngs_modulus": stiffer * BAR["youngs_modulus"],
    }
    robot = qa.Robot(urdf=urdf_of("ur5_robot.urdf"), beam=qa.Beam(at="tool0", **bar))
    changed, expected = (
        qa.evaluate_coefficients(qa.PointToPoint(one, target=1.0, duration=1.0), [])
        for one in (dataclasses.replace(plant, **multiples), robot.along(straight()))
    )
    assert changed.energy == pytest.approx(expected.energy, rel=1e-4)
    # the damping ratio is that of the bar's own first mode, which changes with its mass
    assert changed.residual == pytest.approx(expected.residual, rel=5e-3)


def test_errors_of_the_frequency_change_the_sag():
    """The torque that holds the robot at rest, and the modes in the middle of the move."""
    plant = ur5_with_bar().along(straight())
    stiffer = perturb_plant(plant, {"frequency": 0.05})
    assert stiffer == dataclasses.replace(plant, stiffness=1.05**2)
    assert "payload" in plant.measured


def test_multiples_beyond_the_tables_are_refused():
    plant = ur5_with_bar().along(straight())
    with pytest.raises(ValueError, match=r"stiffness is 1\.5 times the robot's; its tables reach"):
        dataclasses.replace(plant, stiffness=1.5)
    with pytest.raises(ValueError, match=r"frequencies from 0\.84 to 1\.14 times"):
        qa.PointToPoint(plant, 1.0, 1.0, uncertainty=qa.Uncertainty({"frequency": 0.2}))
    without = dataclasses.replace(ur5_with_bar(), beam=None, base=PEDESTAL, tip=None)
    assert "payload" not in without.along(straight()).measured
    with pytest.raises(ValueError, match="no mass at the end of a beam"):
        dataclasses.replace(without.along(straight()), payload=1.1)


def test_the_residual_is_a_distance():
    """In a plane of two directions, it is along the nearest of eight lines."""
    plant = ur5_with_bar().along(straight())
    vibration = FreeVibration(plant, 1.0, 1.0)
    state = np.array([3e-3, 4e-3, 0.0, 0.0])
    tips = plant.tips_at(JointMotion(1.0, 0.0, 0.0), state[:2])
    away = np.hypot(*(float(tip) for tip in tips))
    assert away / 1.02 <= vibration.peak(state)


@pytest.mark.slow
def test_a_robust_plan_keeps_its_residual_limit_in_mujoco():
    """Errors of 5 % of the frequency, 1.2 mm: in MuJoCo at most 5 % more."""
    task = qa.PointToPoint(
        ur5_with_bar().along(straight()),
        target=1.0,
        duration=1.0,
        uncertainty=qa.Uncertainty({"frequency": 0.05}),
    )
    plan = qa.plan_move(task, qa.CycloidPolynomial(8), residual_limit=1.2e-3)
    for frequency in (0.95, 1.0, 1.05):
        robot = FlexibleRobot(urdf_of("ur5_robot.urdf"))
        hinges = robot.add_bar("tool0", **BAR)
        truth = Truth(robot, UR5_JOINTS, BAR["damping"], hinges, softened=frequency**2)
        residual, _, _ = truth.residual_and_energy(motion_of(plan), 1.0)
        assert residual <= 1.26e-3


@pytest.mark.slow
@pytest.mark.parametrize(("modes", "terms", "energy_agrees"), [
    # those that are left out take part in the energy
    (2, 6, 1e-3),
    (4, 10, 1e-4),
])  # fmt: skip
def test_a_panda_with_elastic_joints_and_another_bar_arrives_still(modes, terms, energy_agrees):
    """All seven axes bend, and a bar of steel: nineteen springs."""
    robot = panda_with_bar(modes)
    plant = robot.along(qa.GeometricPath.line(PANDA_START, PANDA_END))
    task = qa.PointToPoint(plant, target=1.0, duration=1.2)
    plan = qa.plan_move(task, qa.CycloidPolynomial(terms))
    in_mujoco = FlexibleRobot(urdf_of("panda.urdf"))
    hinges = in_mujoco.add_bar("panda_hand", **STEEL_BAR)
    for joint, gear in robot.elastic_joints.items():
        in_mujoco.add_gear(joint, gear.stiffness, gear.damping)
    truth = Truth(in_mujoco, robot.joints, STEEL_BAR["damping"], hinges, held=robot.held)
    residual, energy, _ = truth.residual_and_energy(motion_of(plan), 1.2)
    assert residual <= 0.05e-3
    assert energy == pytest.approx(plan.energy, rel=energy_agrees)
    whole = plan.candidate.in_full
    assert whole.energy == pytest.approx(energy, rel=5e-5)
    # by hinges that are neither MuJoCo's nor those planned with
    assert whole.residual == pytest.approx(residual, rel=0.02, abs=1e-7)


def test_coulomb_friction_takes_its_torque_times_the_way():
    """A line on which a joint never turns back: friction times its way, but for where it creeps."""
    plain = ur5_with_bar()
    rough = dataclasses.replace(plain, coulomb={"elbow_joint": 0.5})
    moves = [
        qa.evaluate_coefficients(qa.PointToPoint(robot.along(straight()), 1.0, 1.0), [])
        for robot in (plain, rough)
    ]
    way = abs(END - START)[UR5_JOINTS.index("elbow_joint")]
    assert moves[1].motion.net_work - moves[0].motion.net_work == pytest.approx(0.5 * way, rel=0.01)
    # the motors' friction does not reach the bar
    assert moves[1].residual == pytest.approx(moves[0].residual, rel=1e-9)
    # so do the whole equations say
    assert moves[1].candidate.in_full.energy == pytest.approx(moves[1].energy, rel=1e-3)
