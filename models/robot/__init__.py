"""Robots of many joints along a path: from a URDF, with what of them bends."""

from quietarm.models.robot.elastic.beam import Beam
from quietarm.models.robot.elastic.flexibility import Base, Measured, Spring
from quietarm.models.robot.path.geometric_path import GeometricPath
from quietarm.models.robot.path.timed_motion import TimedMotion
from quietarm.models.robot.robot import Robot, RobotOnPath

__all__ = [
    "Base",
    "Beam",
    "GeometricPath",
    "Measured",
    "Robot",
    "RobotOnPath",
    "Spring",
    "TimedMotion",
]
