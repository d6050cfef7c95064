"""The equations of motion, against Pinocchio's, which reads the URDF itself."""

import numpy as np
import pytest
from robots import UR5_JOINTS, shipped_urdf, urdf_of
from small_robots import torques_of

import quietarm as qa
from quietarm.models import Base
from quietarm.models.robot.urdf.read_urdf import read_urdf
from quietarm.models.robot.urdf.urdf_text import dynamics_of

pinocchio = pytest.importorskip("pinocchio")
pytestmark = pytest.mark.slow

STIFF = Base(stiffness=(1e9, 1e9))  # something has to bend; it adds nothing at rest
FINGERS = ("panda_finger_joint1", "panda_finger_joint2")
ROBOTS = {
    "ur5_robot.urdf": {},
    "panda.urdf": {"held": {FINGERS[0]: 0.01, FINGERS[1]: 0.02}},
    "z1.urdf": {},
}


def _both(name, seed, **entries):
    """Torques by quietarm and by Pinocchio at a random motion of the driven joints.

    Both with the viscous damping of the URDF, which Pinocchio reads and leaves to its user.
    """
    robot = qa.Robot(urdf=urdf_of(name), base=STIFF, **entries)
    model = pinocchio.buildModelFromUrdf(str(urdf_of(name)))
    model.gravity.linear = np.array(robot.gravity)
    motion = np.random.default_rng(seed).uniform(-2, 2, (3, len(robot.joints)))
    mine = torques_of(robot, *np.hstack([motion, np.zeros((3, 2))]))
    theirs = np.zeros((3, model.nv))
    places = [model.joints[model.getJointId(joint)].idx_v for joint in robot.joints]
    theirs[:, places] = motion
    for joint, position in entries.get("held", {}).items():
        theirs[0, model.joints[model.getJointId(joint)].idx_v] = position
    torques = pinocchio.rnea(model, model.createData(), *theirs) + model.damping * theirs[1]
    return mine[: len(robot.joints)], torques[places]


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("seed", [0, 1])
def test_torques_are_pinocchios(name, seed):
    mine, theirs = _both(name, seed, **ROBOTS[name])
    # a URDF's rpy has pi/2 to eleven digits, which quietarm takes as pi/2
    assert mine == pytest.approx(theirs, rel=1e-9, abs=1e-8)


def test_sliding_joints_are_driven_as_turning_ones(tmp_path):
    """The fingers of the Panda, without the word that the second mimics the first."""
    text = urdf_of("panda.urdf").read_text().replace('<mimic joint="panda_finger_joint1"/>', "")
    file = tmp_path / "panda.urdf"
    file.write_text(text)
    robot = qa.Robot(urdf=file, base=STIFF)
    assert set(FINGERS) < set(robot.joints)
    model = pinocchio.buildModelFromUrdf(str(file))
    model.gravity.linear = np.array(robot.gravity)
    motion = np.random.default_rng(2).uniform(-1, 1, (3, len(robot.joints)))
    mine = torques_of(robot, *np.hstack([motion, np.zeros((3, 2))]))
    theirs = pinocchio.rnea(model, model.createData(), *motion) + model.damping * motion[1]
    assert list(model.names)[1:] == list(robot.joints)
    assert mine[: len(robot.joints)] == pytest.approx(theirs, rel=1e-9, abs=1e-9)


def test_mass_matrix_is_pinocchios():
    robot = qa.Robot(urdf=urdf_of("ur5_robot.urdf"), base=STIFF)
    model = pinocchio.buildModelFromUrdf(str(urdf_of("ur5_robot.urdf")))
    q = np.random.default_rng(3).uniform(-3, 3, 6)
    mine = robot.dynamics.masses(np.append(q, [0.0, 0.0]))[:6, :6]
    theirs = pinocchio.crba(model, model.createData(), q)
    theirs = np.triu(theirs) + np.triu(theirs, 1).T
    assert mine == pytest.approx(theirs, rel=1e-9, abs=1e-9)


def test_rotors_and_friction_add_their_torques():
    rotor = {"elbow_joint": 0.3}
    friction = {"wrist_1_joint": 2.0}
    plain = qa.Robot(urdf=urdf_of("ur5_robot.urdf"), base=STIFF)
    more = qa.Robot(
        urdf=urdf_of("ur5_robot.urdf"), base=STIFF, rotor_inertia=rotor, friction=friction
    )
    motion = np.random.default_rng(4).uniform(-1, 1, (3, 8))
    difference = torques_of(more, *motion) - torques_of(plain, *motion)
    expected = np.zeros(8)
    expected[UR5_JOINTS.index("elbow_joint")] = 0.3 * motion[2, 2]
    expected[UR5_JOINTS.index("wrist_1_joint")] = 2.0 * motion[1, 3]
    assert difference == pytest.approx(expected, abs=1e-12)


def test_the_ur5_of_the_quick_tests_is_the_shipped_one():
    name = "ur5_robot.urdf"
    ours, theirs = (read_urdf(file(name).read_text()) for file in (urdf_of, shipped_urdf))
    assert ours.joints.keys() == theirs.joints.keys()
    assert dynamics_of(urdf_of(name).read_text()) == dynamics_of(shipped_urdf(name).read_text())
