"""What moves: plants as symbolic equations, and nothing else."""

import casadi

if not hasattr(casadi, "SX"):  # a script's own file of that name was imported in its place
    raise ImportError(f"{casadi.__file__} hides the library casadi; give that file another name")

from quietarm.models.arm_on_flexible_link import ArmOnFlexibleLink
from quietarm.models.drawing import Body, flexible_link, rigid_link
from quietarm.models.dual_link import DualLinkManipulator
from quietarm.models.flexible_beam import FlexibleBeam
from quietarm.models.joint_motion import Expression, JointMotion, deg, joint_unit
from quietarm.models.linear_axis import LinearAxis
from quietarm.models.plant import Plant, known_plants, parameter
from quietarm.models.plant_file import PlantFile, file_of_plant, load_plant_file
from quietarm.models.robot import Base, Beam, GeometricPath, Measured, Robot, RobotOnPath, Spring
from quietarm.models.single_link import SingleLinkManipulator

__version__ = "2.0.0.dev0"

__all__ = [
    "ArmOnFlexibleLink",
    "Base",
    "Beam",
    "Body",
    "DualLinkManipulator",
    "Expression",
    "FlexibleBeam",
    "GeometricPath",
    "JointMotion",
    "LinearAxis",
    "Measured",
    "Plant",
    "PlantFile",
    "Robot",
    "RobotOnPath",
    "SingleLinkManipulator",
    "Spring",
    "__version__",
    "deg",
    "file_of_plant",
    "flexible_link",
    "joint_unit",
    "known_plants",
    "load_plant_file",
    "parameter",
    "rigid_link",
]
