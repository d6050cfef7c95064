"""Residuals of a motion on a plant that is not as it was modelled: one batch of fixed steps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from quietarm.ocp.checks import takes
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.planning.shaper import shaped_cycloid
from quietarm.ocp.simulation.evaluator import with_errors
from quietarm.ocp.simulation.free_vibration import FreeVibration
from quietarm.ocp.simulation.mesh import default_steps
from quietarm.ocp.simulation.rollout import Simulation
from quietarm.ocp.task import PointToPoint
from quietarm.ocp.uncertainty import FREQUENCY

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
    off_plants = {name: _PlantOff(certain.task, name) for name in names}
    residuals = {
        name: dict(zip(SHARES[name], off_plant.largest(certain)))
        for name, off_plant in off_plants.items()
    }
    return OffModel(residuals, _of_zv(certain.task, off_plants[FREQUENCY]))


def _of_zv(task: PointToPoint, off_plant: _PlantOff) -> float | None:
    try:
        zv = JudgedMotion.of_profile(task, shaped_cycloid(task, "zv"), [])
    except ValueError:  # too short, or nothing vibrates
        return None
    return off_plant.largest(zv)[SHARES[FREQUENCY].index(_SHARE_OF_ZV)]


class _PlantOff:
    """The plant of a task with the errors of one parameter, of both signs."""

    def __init__(self, task: PointToPoint, name: str) -> None:
        self._task = task
        self._name = name
        self._errors = np.array([[sign * share] for share in SHARES[name] for sign in (1, -1)])

    def largest(self, motion: JudgedMotion) -> list[float]:
        """Return what a motion leaves by the size of the error [m], the larger of both signs."""
        return self._residuals(motion).reshape(-1, 2).max(axis=1).tolist()

    def _residuals(self, motion: JudgedMotion) -> Array:
        """Residuals with these errors [m]; of a motion without a profile by CVODES."""
        if motion.profile is None:
            errors = self._errors[:, 0].tolist()
            return np.array([motion.perturbed({self._name: error}).residual for error in errors])
        task = self._task
        simulation = Simulation(
            task.plant,
            motion.profile,
            default_steps(task, least=_STEPS),
            errors=(self._name,),
            breaks=motion.profile.breaks(task.duration),
        )
        row = (*task.move, *task.initial_state)
        arrivals = simulation.arrivals(motion.coefficients, row, self._errors)
        return self._vibration.peak(task.missed(arrivals))

    @cached_property
    def _vibration(self) -> FreeVibration:
        """After arrival, with each of the errors."""
        return with_errors(self._task, [self._name], self._errors)
