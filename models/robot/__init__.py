"""Robots of many joints along a path: from a URDF, with what of them bends."""

from quietarm.models.robot.beam import Beam
from quietarm.models.robot.flexibility import Base, Measured, Spring
from quietarm.models.robot.path import GeometricPath
from quietarm.models.robot.robot import Robot, RobotOnPath

__all__ = ["Base", "Beam", "GeometricPath", "Measured", "Robot", "RobotOnPath", "Spring"]
