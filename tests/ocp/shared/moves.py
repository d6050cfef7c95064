"""The first moves of the paper's two plants, and its boxes of eqs (12) and (17)."""

import math

from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
from quietarm.ocp import PointToPoint

ARM = PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8)
CASES = {
    "arm": (ARM, 0.5),
    "single link": (PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8), 0.2),
}
