"""The first moves of the paper's two plants, and its boxes of eqs (12) and (17)."""

import math

import quietarm as qa

ARM = qa.PointToPoint(qa.ArmOnFlexibleLink(), math.pi / 2, 0.8)
CASES = {
    "arm": (ARM, 0.5),
    "single link": (qa.PointToPoint(qa.SingleLinkManipulator(), math.pi / 6, 0.8), 0.2),
}
