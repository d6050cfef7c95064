"""Residuals of a motion on a plant that is not as it was modelled: one batch of fixed steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.checks import takes
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.planning.shaper import shaped_cycloid
from quietarm.ocp.simulation.free_vibration import FreeVibration
from quietarm.ocp.simulation.mesh import default_steps
from quietarm.ocp.simulation.rollout import Simulation
from quietarm.ocp.uncertainty import FREQUENCY, perturb_plant

Array = NDArray[np.float64]

SHARES: Mapping[str, tuple[float, ...]] = {FREQUENCY: (0.02, 0.05, 0.10), "payload": (0.10,)}
"""Relative errors that are looked at by the parameter that has them; a robot has a payload."""
_SHARE_OF_ZV = 0.05
_STEPS = 56
"""Least steps: on the plants of the paper residuals are within 1e-4 of those by CVODES. As many are
built without a search for common terms, which takes longer: see `MOST_STEPS_OF_CSE`."""


@dataclass(frozen=True)
class OffModel:
    """Residuals of a motion whose plant is off its model.

    Attributes
    ----------
    residuals : mapping of str to mapping of float to float
        Residual [m] by the parameter's name and the size of its relative error, the larger of both
        signs.
    of_zv : float or None
        The same of a cycloid behind a ZV shaper in the same time, with 5 % of the frequency; None
        where the time is too short for it, or the plant does not vibrate.
    """

    residuals: Mapping[str, Mapping[float, float]] = field(hash=False)
    of_zv: float | None = None


@takes(motion=JudgedMotion)
def off_model(motion: JudgedMotion) -> OffModel:
    """Return what a motion leaves with errors of the frequency, of a robot also of its load."""
    certain = motion.on(motion.task.certain)
    plant = certain.task.plant
    names = [name for name in SHARES if name == FREQUENCY or name in plant.measured]
    residuals = {
        name: dict(zip(SHARES[name], _largest(certain, name, SHARES[name]))) for name in names
    }
    return OffModel(residuals, _of_zv(certain))


def _of_zv(motion: JudgedMotion) -> float | None:
    task = motion.task
    try:
        zv = JudgedMotion.of_profile(task, shaped_cycloid(task, "zv"), [])
    except ValueError:  # too short, or nothing vibrates
        return None
    return max(_largest(zv, FREQUENCY, [_SHARE_OF_ZV]))


def _largest(motion: JudgedMotion, name: str, shares: Sequence[float]) -> list[float]:
    """Return the residuals by errors of one parameter [m], the larger of both signs of each."""
    rows = [[error] for share in shares for error in (share, -share)]
    return _residuals(motion, [name], rows).reshape(-1, 2).max(axis=1).tolist()


def _residuals(
    motion: JudgedMotion, names: Sequence[str], rows: Sequence[Sequence[float]]
) -> Array:
    """Residuals with these errors [m]; of a motion without a profile by CVODES."""
    task = motion.task
    if motion.profile is None:
        return np.array([motion.perturbed(dict(zip(names, row))).residual for row in rows])
    simulation = Simulation(
        task.plant,
        motion.profile,
        default_steps(task, least=_STEPS),
        errors=tuple(names),
        breaks=motion.profile.breaks(task.duration),
    )
    errors = np.array(rows)
    arrivals = simulation.arrivals(motion.coefficients, (*task.move, *task.initial_state), errors)
    perturbed = perturb_plant(task.plant, dict(zip(names, map(ca.DM, errors.T))))
    vibration = FreeVibration(perturbed, [task.target] * len(errors), task.residual_window)
    return vibration.peak(task.missed(arrivals))
