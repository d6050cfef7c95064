"""Robots and the bar that they carry in the tests: a UR5, and others of example-robot-data."""

import importlib.metadata
from functools import lru_cache
from pathlib import Path

import numpy as np

import quietarm as qa
from quietarm.models import Base

FIXTURES = Path(__file__).parents[1] / "fixtures"
UR5_JOINTS = (
    "shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
    "wrist_1_joint", "wrist_2_joint", "wrist_3_joint",
)  # fmt: skip
# A quarter of a turn to the side, from stretched upwards to stretched out.
START = np.array([0.0, -1.4, 1.7, -1.87, -1.57, 0.0])
END = np.array([1.4, -1.0, 1.2, -1.3, -1.2, 0.6])
# An aluminium bar, 0.8 m of 8 mm by 12 mm, with half a kilogram at its end.
# 0.5 m high, it rocks at 10.3 and 10.7 Hz under the UR5.
PEDESTAL = Base(stiffness=(6e4, 6e4), damping=(5.0, 5.0), height=0.5)
BAR = {
    "length": 0.8, "width": 0.008, "height": 0.012, "youngs_modulus": 70e9, "density": 2700.0,
    "tip_mass": 0.5, "damping": 0.005,
}  # fmt: skip


@lru_cache
def urdf_of(name: str) -> Path:
    """The file of this name, of the fixtures or, in slow tests, of example-robot-data."""
    fixture = FIXTURES / name
    return fixture if fixture.exists() else shipped_urdf(name)


@lru_cache
def shipped_urdf(name: str) -> Path:
    """The file of this name in example-robot-data, which the extra `slow` installs."""
    for file in importlib.metadata.files("example-robot-data"):
        if file.name == name:
            return Path(file.locate())
    raise FileNotFoundError(name)


@lru_cache
def all_urdfs() -> list[Path]:
    """Every URDF of example-robot-data."""
    files = importlib.metadata.files("example-robot-data")
    return sorted(Path(file.locate()) for file in files if file.suffix == ".urdf")


@lru_cache
def ur5_with_bar(**changes):
    """The UR5 whose flange carries the bar."""
    return qa.Robot(urdf=urdf_of("ur5_robot.urdf"), beam=qa.Beam(at="tool0", **BAR), **changes)


def straight():
    """The path of the UR5 in the tests."""
    return qa.GeometricPath.line(START, END)


# Of steel, 0.6 m of 10 mm by 6 mm, with 0.4 kg at its end.
STEEL_BAR = {
    "length": 0.6, "width": 0.01, "height": 0.006, "youngs_modulus": 210e9, "density": 7850.0,
    "tip_mass": 0.4, "damping": 0.004,
}  # fmt: skip
PANDA_START = np.array([-0.6, -0.5, 0.2, -2.0, 0.1, 1.6, 0.4])
PANDA_END = np.array([0.6, 0.1, -0.1, -1.5, -0.2, 1.9, 0.8])
# Of harmonic drives of its size [N m/rad].
PANDA_GEARS = (3e4, 3e4, 2e4, 2e4, 8e3, 8e3, 8e3)


@lru_cache
def panda_with_bar(modes=2):
    """The Panda, whose gears bend and whose hand carries the bar of steel."""
    joints = [f"panda_joint{number}" for number in range(1, 8)]
    return qa.Robot(
        urdf=urdf_of("panda.urdf"),
        joints=joints,
        held={"panda_finger_joint1": 0.01, "panda_finger_joint2": 0.01},
        beam=qa.Beam(at="panda_hand", **STEEL_BAR),
        elastic_joints={joint: (gear, 5.0) for joint, gear in zip(joints, PANDA_GEARS)},
        friction=dict.fromkeys(joints, 0.0),  # as in MuJoCo's twin, in place of 0.003 of the URDF
        modes=modes,
    )
