"""What moves: plants as symbolic equations, and nothing else."""

from models.arm_on_flexible_link import ArmOnFlexibleLink
from models.dual_link import DualLinkManipulator
from models.plant import Expression, JointMotion, Plant, known_plants, parameter
from models.single_link import SingleLinkManipulator
from models.version import __version__

__all__ = [
    "ArmOnFlexibleLink",
    "DualLinkManipulator",
    "Expression",
    "JointMotion",
    "Plant",
    "SingleLinkManipulator",
    "__version__",
    "known_plants",
    "parameter",
]
