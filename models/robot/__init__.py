"""Robots of many joints along a path: from a URDF, with what of them bends."""

from quietarm.models.robot.beam import Beam
from quietarm.models.robot.path import GeometricPath
from quietarm.models.robot.plant import RobotOnPath
from quietarm.models.robot.robot import Base, Measured, Robot, Spring

__all__ = ["Base", "Beam", "GeometricPath", "Measured", "Robot", "RobotOnPath", "Spring"]
