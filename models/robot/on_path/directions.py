"""Directions along which the length of a displacement is seen."""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import product

import numpy as np

from quietarm.models.joint_motion import Array

_LINES_OF_A_PLANE = 8
"""They are 22.5 degrees apart: 1 / cos of half of that is 1.02."""
_STEPS_IN_SPACE = 2
"""Whole numbers of a vector: 49 lines, of which one is within 18 degrees of any direction."""


@lru_cache
def lines_in(dimensions: int) -> Array:
    """Unit vectors of a line, a plane or space, of which one is near any direction."""
    if dimensions == 1:
        return np.ones((1, 1))
    if dimensions == 2:
        angles = np.pi * np.arange(_LINES_OF_A_PLANE) / _LINES_OF_A_PLANE
        return np.column_stack([np.cos(angles), np.sin(angles)])
    entries = range(-_STEPS_IN_SPACE, _STEPS_IN_SPACE + 1)
    vectors = {
        vector
        for vector in product(entries, repeat=dimensions)
        if math.gcd(*vector) == 1 and next(filter(None, vector)) > 0
    }
    lines = np.array(sorted(vectors), float)
    return lines / np.linalg.norm(lines, axis=1)[:, None]
