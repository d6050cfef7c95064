"""Tasks and random populations that the tests of the objective share."""

import math

import numpy as np
import pytest
from quietarm.models import ArmOnFlexibleLink, SingleLinkManipulator
from quietarm.ocp import CycloidPolynomial

pi = math.pi
PROFILE = CycloidPolynomial(6)
SINGLE_LINK, ARM = SingleLinkManipulator(), ArmOnFlexibleLink()
CONDITIONS = [
    # Tables 3 and 6: start, target, duration; boxes of eqs (12) and (17).
    (SINGLE_LINK, 0.0, pi / 6, 0.8, 0.2),
    (SINGLE_LINK, 0.0, pi / 2, 1.0, 0.2),
    (SINGLE_LINK, 0.0, pi / 2, 1.1, 0.2),
    (ARM, 0.0, pi / 2, 0.8, 0.5),
    (ARM, -pi / 2, pi / 4, 1.0, 0.5),
    (ARM, -pi / 2, pi / 2, 1.2, 0.5),
]
PLANTS = pytest.mark.parametrize("name", ["single link", "arm", "two links"])


def candidates(count, bound, seed=1):
    return np.random.default_rng(seed).uniform(-bound, bound, (count, PROFILE.size))


def same_bits(one, other):
    return all(
        np.array_equal(getattr(one, name).view(np.uint64), getattr(other, name).view(np.uint64))
        for name in ("residual", "energy", "violations")
    )
