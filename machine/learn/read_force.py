"""What the joint and its torque tell of a swing: the frequency, and what the structure must do.

While the joint moves, its torque accelerates the masses, overcomes friction, and holds against the
swing. Which frequency the swing has is fitted to that. What swings at arrival then follows from the
joint's recorded motion by the plant's equations: after arrival dry friction holds the joint, and its
torque shows little.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.fits.columns import BasisColumns
from quietarm.machine.identify.fits.part_fitter import FEW_SAMPLES, PartFitter
from quietarm.machine.identify.fits.swing_model import SwingModel
from quietarm.machine.identify.identified import Part
from quietarm.machine.learn.read_swing import AfterMove, modal_names, read_swing, starts_near
from quietarm.machine.recordings.fitted_spline import smooth
from quietarm.machine.recordings.recording import Recording, noise_of
from quietarm.models import Plant
from quietarm.ocp.planning.executed import Measured, Swing
from quietarm.ocp.uncertainty import with_values

Array = NDArray[np.float64]


class TorqueColumns(BasisColumns):
    """What a torque consists of while the joint moves: the swing's reaction, inertia and friction.

    The structure rests at the start.

    Parameters
    ----------
    reaction : BasisColumns
        Of an accelerometer at the tip: what the joint's motion does to it comes first, the joint's
        own acceleration last.
    speed : array, shape (rows,)
        Of the joint.
    """

    driven = False

    def __init__(self, reaction: BasisColumns, speed: Array) -> None:
        self.count = reaction.count
        self._reaction = reaction
        slow = 0.01 * float(np.abs(speed).max())
        self._friction = np.column_stack([speed, np.tanh(speed / slow)])

    def __call__(self, p: Array, derivatives: bool = True) -> tuple[Array, Array]:
        """Columns (signals, rows, columns), and their derivatives (parameters, as these)."""
        columns, slopes = self._reaction(p, derivatives)
        friction = np.broadcast_to(self._friction, (len(columns), *self._friction.shape))
        kept = [0, columns.shape[-1] - 1]
        unmoved = np.zeros((*slopes.shape[:-1], self._friction.shape[1]))
        return (
            np.concatenate([columns[..., kept], friction], axis=-1),
            np.concatenate([slopes[..., kept], unmoved], axis=-1),
        )


def read_torque(recording: Recording, begin: float, end: float, plant: Plant) -> Part:
    """Frequencies and dampings of a plant by joint and torque during a move [s], as a part.

    Its values are empty where they tell none, with a warning that says why.
    """
    rows = recording.rows(begin, end)
    moving = Recording(
        recording.time[rows],
        angle=_rows(recording.angle, rows),
        acceleration=_rows(recording.torque, rows),
        name=recording.name,
    )
    names = modal_names(plant)
    fitter = PartFitter(plant, names, moving, 1.0)
    fitter.frequency = float(fitter.frequencies[0])
    part = fitter.part(slice(0, len(moving.time)), hub="moves")
    rough = _model(fitter, part, FEW_SAMPLES)
    start = min(starts_near(fitter, rough), key=rough.cost)
    fitter.frequency = fitter.frequency_of(start)
    model = _model(fitter, part, 64)
    best = fitter.fit_model(model, part, start)
    misfit = best.misfit
    noise = float(noise_of(model.values)[0] / np.maximum(best.swinging.std(axis=0)[0], 1e-300))
    most_unexplained = 0.2
    if misfit**2 - noise**2 > most_unexplained**2:
        warning = (
            f"inertia, swing and friction leave {misfit:.0%} of the torque during the move, so that "
            "it tells no frequency; record the tip as well"
        )
        return replace(part, cause="misfit", warning=warning, misfit=misfit, noise=noise)
    return replace(
        part,
        values=dict(zip(names, best.p.tolist())),
        deviations=dict(zip(names, best.deviations.tolist())),
        amplitude=float(np.abs(best.swinging).max()),
        misfit=misfit,
        noise=noise,
    )


def _rows(values: Array | None, rows: slice) -> Array:
    assert values is not None  # the caller has seen to it
    return values[rows]


def _model(fitter: PartFitter, part: Part, samples: float) -> SwingModel:
    """The torque of a move as a model of so many samples a period."""
    whole = fitter.piece(part)
    piece = fitter.thinned(whole, samples)
    reaction = fitter.columns_with_joint(part, whole, piece)
    speed = smooth(fitter.thinned(whole))(piece.time, 1)
    return SwingModel(piece, TorqueColumns(reaction, speed))


def swing_by_joint(
    recording: Recording, part: Part, arrival: float, plant: Plant, place: float
) -> AfterMove:
    """The swing at arrival that follows from the joint's recorded motion, and what a part tells.

    Its deviation is that of the frequency.
    """
    swings = _swings(recording, arrival, plant, place)
    unsure = np.zeros(len(swings))
    for name, deviation in part.deviations.items():
        shifted = with_values(plant, {name: getattr(plant, name) + deviation})
        others = _swings(recording, arrival, shifted, place)
        unsure += [
            abs(one.complex_amplitude - other.complex_amplitude) ** 2
            for one, other in zip(swings, others)
        ]
    known = [
        Swing.of(swing.complex_amplitude, float(np.hypot(swing.deviation, root)))
        for swing, root in zip(swings, np.sqrt(unsure / 2))
    ]
    measured = Measured(recording.name, tuple(known), part.values, part.deviations)
    notes = (f"warning: {recording.name}: {part.warning}",) if part.warning else ()
    return AfterMove(measured, part if part.values else None, notes)


def _swings(recording: Recording, arrival: float, plant: Plant, place: float) -> list[Swing]:
    """Of every mode, by the tip's displacement that the recorded motion makes."""
    rows = len(recording.time)
    seen = Recording(
        recording.time,
        angle=recording.angle,
        tip=np.zeros((rows, plant.tips)),
        name=recording.name,
    )
    fitter = PartFitter(plant, modal_names(plant), seen, 1.0)
    fitter.frequency = float(fitter.frequencies[0])
    part = fitter.part(slice(0, rows), hub="moves")
    columns, _ = fitter.columns_with_joint(part, seen, seen)(fitter.of_plant, False)
    tip = replace(seen, angle=None, tip=columns[:, :, 0].T)
    return list(read_swing(tip, arrival, plant, place, told=False).measured.swings)
