"""The move whose floor several tests find, and the settings of a quick search."""

import math

from quietarm.models import ArmOnFlexibleLink
from quietarm.ocp import (
    PointToPoint,
)

ARM = PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8)
SHORT = {"starts": 1}
