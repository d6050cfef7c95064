"""What moves: plants as symbolic equations, and nothing else."""

from models.arm_on_flexible_link import ArmOnFlexibleLink
from models.drawing import Body, flexible_link, rigid_link
from models.dual_link import DualLinkManipulator
from models.joint_motion import Expression, JointMotion
from models.plant import Plant, known_plants, parameter
from models.plant_file import PlantFile, file_of_plant, load_plant_file
from models.single_link import SingleLinkManipulator
from models.version import __version__

__all__ = [
    "ArmOnFlexibleLink",
    "Body",
    "DualLinkManipulator",
    "Expression",
    "JointMotion",
    "Plant",
    "PlantFile",
    "SingleLinkManipulator",
    "__version__",
    "file_of_plant",
    "flexible_link",
    "known_plants",
    "load_plant_file",
    "parameter",
    "rigid_link",
]
