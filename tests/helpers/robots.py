"""Robots of example-robot-data, and the bar that they carry in the tests."""

import importlib.metadata
from functools import lru_cache
from pathlib import Path

import numpy as np

import quietarm as qa

UR5_JOINTS = (
    "shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
    "wrist_1_joint", "wrist_2_joint", "wrist_3_joint",
)  # fmt: skip
# A quarter of a turn to the side, from stretched upwards to stretched out.
START = np.array([0.0, -1.4, 1.7, -1.87, -1.57, 0.0])
END = np.array([1.4, -1.0, 1.2, -1.3, -1.2, 0.6])
# An aluminium bar, 0.8 m of 8 mm by 12 mm, with half a kilogram at its end.
BAR = {
    "length": 0.8, "width": 0.008, "height": 0.012, "youngs_modulus": 70e9, "density": 2700.0,
    "tip_mass": 0.5, "damping": 0.005,
}  # fmt: skip


@lru_cache
def urdf_of(name: str) -> Path:
    """The file of this name in example-robot-data."""
    for file in importlib.metadata.files("example-robot-data"):
        if file.name == name:
            return Path(file.locate())
    raise FileNotFoundError(name)


@lru_cache
def ur5_with_bar(**changes):
    """The UR5 whose flange carries the bar."""
    return qa.Robot(urdf=urdf_of("ur5_robot.urdf"), beam=qa.Beam(at="tool0", **BAR), **changes)


def straight():
    """The path of the UR5 in the tests."""
    return qa.GeometricPath.line(START, END)
