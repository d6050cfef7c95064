"""A base that twists about z besides, held against a sprung joint of the URDF."""

import numpy as np
import pytest
from small_robots import ARM, ARM_FILE, torques_of, write_robot

import quietarm as qa
from quietarm.models import Base, Spring
from quietarm.ocp.saved import plain, typed

ON_A_JOINT = ARM.replace(
    '<link name="ground"/>',
    '<link name="foot"/><link name="ground"/><joint name="twist" type="continuous">'
    '<parent link="foot"/><child link="ground"/><axis xyz="0 0 1"/></joint>',
)
ROCKS = (6e4, 5e4)


def arm(urdf, base, **others):
    held = {"grip": 0.02}
    return qa.Robot(urdf=urdf, joints=("a", "b"), held=held, base=base, modes=3, **others)


def test_a_base_that_twists_is_a_sprung_joint_about_z():
    twisting = arm(ARM, Base((*ROCKS, 3e4), (20.0, 10.0, 5.0), height=0.5))
    jointed = arm(ON_A_JOINT, Base(ROCKS, (20.0, 10.0), height=0.5), springs={"twist": (3e4, 5.0)})
    rng = np.random.default_rng(3)
    positions, speeds, accelerations = rng.normal(size=(3, 5))
    torques = [torques_of(robot, positions, speeds, accelerations) for robot in (twisting, jointed)]
    assert torques[0] == pytest.approx(torques[1], rel=1e-12)
    frequencies = [robot.frequencies([0.3, -0.4]) for robot in (twisting, jointed)]
    assert frequencies[0] == pytest.approx(frequencies[1], rel=1e-9)
    assert jointed.springs["twist"] == Spring(3e4, 5.0)


def test_its_frequencies_are_those_of_its_masses_and_three_springs():
    robot = arm(ARM, Base((*ROCKS, 3e4)), gravity=(0.0, 0.0, 0.0))
    at_rest = np.zeros(5)
    masses = np.array([torques_of(robot, at_rest, at_rest, turn) for turn in np.eye(5)])[2:, 2:]
    squares = np.sort(np.linalg.eigvals(np.linalg.solve(masses, np.diag([*ROCKS, 3e4]))).real)
    assert robot.frequencies([0.0, 0.0]) == pytest.approx(np.sqrt(squares), rel=1e-9)


def test_a_file_has_two_numbers_or_three_and_a_saved_base_of_two_loads(tmp_path):
    entries = f"{ARM_FILE}base: {{stiffness: [6e4, 6e4, 3e4], damping: 20, height: 0.5}}\n"
    base = qa.Robot.load(write_robot(tmp_path, ARM, entries)).base
    assert base == Base((6e4, 6e4, 3e4), (20.0, 20.0, 20.0), 0.5)
    for stated in (Base(ROCKS, (1.0, 2.0), 0.3), base):
        assert typed(plain(stated), Base) == stated


@pytest.mark.parametrize(("base", "words"), [
    (Base((1.0, 1.0, 1.0, 1.0)), "stiffness of the base has 4 numbers; give one, or two, about x"),
    (Base((1.0, 1.0, 1.0), (1.0, 1.0)), "damping of the base has 2 numbers and its stiffness 3"),
    (Base((1e4, 1e4, -1.0)), "stiffness of the base is -1"),
])  # fmt: skip
def test_what_is_no_base_is_refused(base, words):
    with pytest.raises(ValueError, match=words):
        arm(ARM, base)
