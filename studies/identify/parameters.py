"""Which parameters of a plant say how it swings, where they start and how far they go."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from quietarm.models import Plant

Array = NDArray[np.float64]
_DAMPING = "zeta"
"""How the name of a damping ratio begins."""
_MOST_DAMPING = 0.9


def is_frequency(plant: Plant, name: str) -> bool:
    """Whether a parameter is the frequency of a mode, by its unit."""
    return plant.units()[name] == "rad/s"


def is_modal(plant: Plant, name: str) -> bool:
    """Whether a parameter is the frequency or the damping ratio of a mode."""
    return is_frequency(plant, name) or name.startswith(_DAMPING)


def values_of(plant: Plant, names: Sequence[str]) -> Array:
    """The values of some parameters."""
    return np.array([getattr(plant, name) for name in names])


def bounds_of(plant: Plant, names: Sequence[str], start: Array) -> tuple[Array, Array]:
    """How far parameters may go from a start: dampings a little below 0, as an estimate may."""
    lower, upper = np.full(len(names), -np.inf), np.full(len(names), np.inf)
    for k, name in enumerate(names):
        if is_frequency(plant, name):
            lower[k], upper[k] = 0.3 * start[k], 3 * start[k]
        elif is_modal(plant, name):
            lower[k], upper[k] = -0.3, _MOST_DAMPING
    return lower, upper
