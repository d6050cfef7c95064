"""Fronts made by hand."""

import math

from quietarm.models import ArmOnFlexibleLink
from quietarm.ocp import (
    CycloidPolynomial,
    Front,
    FrontPoint,
    Generation,
    PointToPoint,
)

TASK = PointToPoint(ArmOnFlexibleLink(), math.pi / 2, 0.8, torque_limit=0.4)


def points(*figures):
    """Points of the given (residual, energy); the coefficient tells them apart."""
    return tuple(FrontPoint((float(i), -0.5), r, e) for i, (r, e) in enumerate(figures))


def front(found=None, **changes):
    given_points = points((1e-4, 0.5), (2e-4, 0.2), (8e-4, 0.1)) if found is None else found
    content = {
        "task": TASK,
        "profile": CycloidPolynomial(2),
        "points": given_points,
        "method": "nsga2",
        "settings": {"bound": 0.5, "population": 20, "generations": None},
        "seed": 3,
        "reference": (0.015, 0.25),
        "evaluations": 60,
        "failed": 2,
        "history": (Generation(20, 0.0), Generation(40, 0.1), Generation(60, 0.7 / 3)),
        "complete": False,
        "seconds": 1.25,
        **changes,
    }
    return Front(**content)
