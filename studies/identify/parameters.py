"""Which parameters of a plant say how it swings, where they start and how far they go."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace
from math import tau

import numpy as np
from numpy.typing import NDArray
from quietarm.models import Plant

Array = NDArray[np.float64]
_DAMPING = "zeta"
"""How the name of a damping ratio begins."""
_MOST_DAMPING = 0.9


def is_frequency(plant: Plant, name: str) -> bool:
    """Whether a parameter is the frequency of a mode, by its unit."""
    return (
        next(one.metadata.get("unit", "") for one in fields(plant) if one.name == name) == "rad/s"
    )


def is_modal(plant: Plant, name: str) -> bool:
    """Whether a parameter is the frequency or the damping ratio of a mode."""
    return is_frequency(plant, name) or name.startswith(_DAMPING)


def values_of(plant: Plant, names: Sequence[str]) -> Array:
    """The values of some parameters."""
    return np.array([getattr(plant, name) for name in names])


def bounds_of(plant: Plant, names: Sequence[str], start: Array) -> tuple[Array, Array]:
    """How far parameters may go from a start.

    Dampings a little below 0, as an estimate may; all else below 0 where the plant takes it.
    """
    lower, upper = np.full(len(names), -np.inf), np.full(len(names), np.inf)
    for k, name in enumerate(names):
        if is_frequency(plant, name):
            lower[k], upper[k] = 0.3 * start[k], 3 * start[k]
        elif name.startswith(_DAMPING):
            lower[k], upper[k] = -0.3, _MOST_DAMPING
        elif not _may_be_negative(plant, name):
            lower[k] = -0.3 * max(abs(start[k]), 1e-2)  # so that 0 can be in an interval
    return lower, upper


def _may_be_negative(plant: Plant, name: str) -> bool:
    try:
        replace(plant, **{name: -max(abs(getattr(plant, name)), 1.0)})
    except ValueError:
        return False
    return True


def started_at(plant: Plant, names: Sequence[str], frequency: float) -> Plant:
    """The plant with a swing's frequency [Hz], where it has but one to be set."""
    of_modes = [name for name in names if is_frequency(plant, name)]
    return (
        replace(plant, **{of_modes[0]: tau * frequency})
        if len(of_modes) == 1 and frequency
        else plant
    )
