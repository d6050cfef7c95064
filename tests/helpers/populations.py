"""Tasks and random populations that the tests of the objective share."""

import math

import numpy as np
import pytest

from quietarm.ocp import CycloidPolynomial

pi = math.pi
PROFILE = CycloidPolynomial(6)
PLANTS = pytest.mark.parametrize("name", ["single link", "arm", "two links"])


def candidates(count, bound, seed=1):
    return np.random.default_rng(seed).uniform(-bound, bound, (count, PROFILE.size))


def same_bits(one, other):
    return all(
        np.array_equal(getattr(one, name).view(np.uint64), getattr(other, name).view(np.uint64))
        for name in ("sampled_residual", "energy", "violations")
    )
