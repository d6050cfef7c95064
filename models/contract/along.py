"""A plant's equations along a move: they must have values all the way."""

from __future__ import annotations

import math
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from models.contract.calls import Calls
from models.plant import Plant

_ANGLES = 101
_AT_REST, _MOVING = 0.0, 1.0
"""Speed and acceleration of the joint, W, W' and W'': all of them alike."""


@lru_cache(maxsize=1024)
def check_along(plant: Plant, start: float, target: float) -> None:
    """Check that a plant's equations have values at every angle of a move.

    A plant may be undefined at some angles, such as a crank at its dead centre, but not on the way.

    Parameters
    ----------
    plant : Plant
        A plant that keeps its contract.
    start, target : float
        Joint angles at the ends [rad].

    Raises
    ------
    ValueError
        With the method, its value and the angle.
    """
    angles = _angles(start, target)
    columns = [np.full((3 * (1 + plant.modes), len(angles)), x) for x in (_AT_REST, _MOVING)]
    for column in columns:
        column[0] = angles
    values = _equations(plant)(np.hstack(columns)).full()
    wrong = np.argwhere(~np.isfinite(values.T))
    if not wrong.size:
        return
    place, output = wrong[0]
    methods = ["modal_accelerations"] * plant.modes + ["torque"]
    method = (methods + ["tip_displacements"] * plant.tips)[output]
    raise ValueError(
        f"plant {plant.name!r}: {method} is {values[output, place]} with the joint at "
        f"{angles[place % len(angles)]:.4g} rad, on the way from {start:.4g} to {target:.4g} rad; "
        "move where its equations hold, or check them and the parameters"
    )


@lru_cache(maxsize=256)
def _equations(plant: Plant) -> ca.Function:
    """(joint motion, W, W', W'') -> every output, a column for each motion."""
    arguments = [ca.SX.sym(f"x{i}") for i in range(3 * (1 + plant.modes))]
    outputs = Calls(plant, 1).outputs(arguments).all
    return ca.Function("equations", [ca.vertcat(*arguments)], [ca.densify(ca.vertcat(*outputs))])


def _angles(start: float, target: float) -> NDArray[np.float64]:
    """Angles along a move, with the right angles among them, where sines and cosines are 0."""
    low, high = sorted((start, target))
    right = np.arange(math.ceil(low / (math.pi / 2)), math.floor(high / (math.pi / 2)) + 1)
    spread = np.linspace(low, high, _ANGLES)
    return np.concatenate([[start, target], right[:_ANGLES] * math.pi / 2, spread])
