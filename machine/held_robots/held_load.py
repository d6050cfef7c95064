"""The load at a robot's tip by the torques that hold its joints at rest."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from quietarm.models.robot import Robot
from quietarm.models.robot.dynamics.modes import sag_at

Array = NDArray[np.float64]
_LEAST_LEVER = 1e-3
"""Of a robot's weight [m], below which gravity shows no posture in the torques of its joints."""
_WHOLE = 0.1
"""Share of the torques, beyond which they are not those that hold this robot."""
_LEAST_UNSURE = 0.005
"""Share of a load that torques leave unsure at least: masses of a URDF are not exact."""


class TurnedTorquesError(ValueError):
    """Torques at rest that are those which hold the robot, with the other sign."""


class HeldLoad(NamedTuple):
    """A load [kg] and its standard deviation, or why the torques do not tell it."""

    mass: float
    deviation: float
    why: str = ""


def load_at_rest(robot: Robot, held: Sequence[tuple[Sequence[float], Array]]) -> HeldLoad:
    """Return the mass at the end of the beam by the torques at postures.

    Parameters
    ----------
    robot : Robot
        With springs as they are.
    held : sequence of (posture, torques)
        Mean torques of the driven joints.

    Raises
    ------
    TurnedTorquesError
        When the torques have the other sign.
    """
    from scipy.special import stdtrit  # not at the top: it takes long to load

    told, lever, seen = _at_rest(robot, held)
    power = float(lever @ lever)
    if power < 1e-6 or len(seen) < 2:
        return HeldLoad(0.0, np.inf, "gravity does not show the load at these postures")
    turned = _apart(seen, -told)
    if turned < _WHOLE < _apart(seen, told):
        raise TurnedTorquesError(
            "the torques at rest have the other sign, as those that act on the robot from outside; "
            "turn it, by --scale torque=-1"
        )
    more = float(lever @ (seen - told)) / power
    left = seen - told - more * lever
    if np.linalg.norm(left) > _WHOLE * np.linalg.norm(told):
        return HeldLoad(0.0, np.inf, "the torques at rest are not those that hold this robot")
    freedom = len(seen) - 1
    spread = float(np.sqrt(left @ left / freedom / power))
    mass = robot.payload + more
    deviation = float(stdtrit(freedom, 0.975)) / 2 * spread
    return HeldLoad(mass, float(np.hypot(deviation, _LEAST_UNSURE * mass)))


def unfit_share(robot: Robot, held: Sequence[tuple[Sequence[float], Array]]) -> float:
    """Return by what share torques at rest are others than hold the robot, with whatever load.

    It is 0 where they fit within what masses of a URDF are wrong by, with either sign, and where
    gravity acts on no joint.
    """
    told, lever, seen = _at_rest(robot, held)
    weight = sum(link.mass for link in robot.description.links.values())
    size = float(np.linalg.norm(told))
    least = weight * float(np.linalg.norm(robot.gravity)) * _LEAST_LEVER
    if not size > least:
        return 0.0
    power = float(lever @ lever)
    shares = list[float]()
    for signed in (seen, -seen):
        left = signed - told
        if power > 0:
            left = left - float(lever @ left) / power * lever
        shares.append(float(np.linalg.norm(left)) / size)
    return share if (share := min(shares)) > _WHOLE else 0.0


def _at_rest(
    robot: Robot, held: Sequence[tuple[Sequence[float], Array]]
) -> tuple[Array, Array, Array]:
    """Return torques that hold the robot, those of 1 kg at its beam's end, and those recorded."""
    stated, of_one, recorded = list[Array](), list[Array](), list[Array]()
    dynamics = robot.dynamics
    for posture, torques in held:
        q = np.asarray(posture, float)
        x = np.concatenate([q, sag_at(dynamics, q)])
        stated.append(dynamics.at_rest(x)[0][: dynamics.driven])
        if robot.beam is not None:
            of_one.append(robot.of_one_kilogram.at_rest(x)[0][: dynamics.driven])
        else:
            of_one.append(np.zeros(dynamics.driven))
        recorded.append(torques)
    return np.concatenate(stated), np.concatenate(of_one), np.concatenate(recorded)


def _apart(one: Array, other: Array) -> float:
    """Return by what share torques differ."""
    return float(np.linalg.norm(one - other) / max(float(np.linalg.norm(other)), 1e-300))
