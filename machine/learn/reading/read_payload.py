"""Read how heavy a machine is, and what swings on it, from the joint and its torque during a move.

A frequency alone does not tell a heavier load from a softer structure. The torque does: by what it
takes to accelerate the joint, and by what the swing takes beside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.fits.fitting import power_near
from quietarm.machine.identify.fits.part_fitter import PartFitter
from quietarm.machine.identify.identified import Estimate
from quietarm.machine.learn.reading.read_force import torque_model
from quietarm.machine.learn.reading.read_move import ReadMove
from quietarm.machine.learn.reading.read_swing import modal_names
from quietarm.machine.recordings.recording import Recording
from quietarm.models import Plant
from quietarm.ocp.judged_motion import JudgedMotion

Array = NDArray[np.float64]
SWINGS = "what swings"
MOVES = "all that moves"


def read_payload(
    motion: JudgedMotion, read: Sequence[ReadMove], duration: float
) -> tuple[Estimate, ...]:
    """Estimate how many times as heavy as the plant what swings is, and all that moves.

    Empty where no recording has the joint and its torque, and for a plant of several modes, whose
    reactions one tip does not tell apart. The intervals are those of 95 in 100 cases.

    Parameters
    ----------
    motion : JudgedMotion
        The executed move on the plant, with the frequency that the recordings tell.
    read : sequence of ReadMove
        Recordings of it.
    duration : float
        Of the move [s].
    """
    plant = motion.task.plant
    if plant.modes > 1 or plant.tips > 1:
        return ()
    told = list[tuple[Array, Array]]()
    for one in read:
        recording = one.recording
        if recording.angle is None or recording.torque is None:
            continue
        rows = recording.rows(one.start, one.arrival)
        moving = Recording(
            recording.time[rows], angle=recording.angle[rows], acceleration=recording.torque[rows]
        )
        sample = motion.sample(np.clip(moving.time - one.start, 0.0, duration))
        as_planned = Recording(moving.time, angle=sample.joint[:, 0], acceleration=sample.torque)
        planned, _ = _inertias(plant, as_planned)
        measured, deviations = _inertias(plant, moving)
        told.append((measured / planned, np.abs(deviations / planned)))
    if not told:
        return ()
    values, deviations = (np.stack(each) for each in zip(*told))
    weights = deviations**-2.0
    means = (weights * values).sum(axis=0) / weights.sum(axis=0)
    unsure = 2 * np.sqrt(np.mean(deviations**2, axis=0))  # what torques hide, all hide alike
    return tuple(
        Estimate(name, float(mean), float(mean - away), float(mean + away))
        for name, mean, away in zip((SWINGS, MOVES), means, unsure)
    )


def _inertias(plant: Plant, moving: Recording) -> tuple[Array, Array]:
    """The sizes of the swing's reaction and of the joint's inertia, and their deviations."""
    fitter = PartFitter(plant, modal_names(plant), moving, 1.0)
    fitter.frequency = float(fitter.frequencies[0])
    model = torque_model(fitter, moving)
    x = model.start(fitter.of_plant)
    slopes = model.jacobian(x)[0]
    power = power_near(
        model.time, model.residual(x), fitter.frequency, slopes.shape[1] - model.count
    )
    covariance: Any = np.linalg.pinv(slopes.T @ slopes, hermitian=True)
    first = slice(model.count, model.count + 2)
    return x[first], np.sqrt(np.diag(covariance)[first] * power)
