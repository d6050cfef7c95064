"""Moves whose fronts several tests find."""

import math

from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
from quietarm.ocp import (
    PointToPoint,
)

CASES = {
    "arm": (PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8), 0.5),
    "single link": (PointToPoint(SingleLinkManipulator(), math.pi / 6, 0.8), 0.2),
}
