"""Read a swing from the joint and its torque: its frequency, and what the structure must do.

While the joint moves, its torque accelerates the masses, overcomes friction, and holds against the
swing. Which frequency the swing has is fitted to that. What swings at arrival then follows from the
joint's recorded motion by the plant's equations: after arrival dry friction holds the joint, and
its torque shows little.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.fits.columns import BasisColumns, Driven, Forced
from quietarm.machine.identify.fits.part_fitter import PartFitter
from quietarm.machine.identify.fits.swing_model import SwingModel
from quietarm.machine.identify.identified import Part
from quietarm.machine.learn.reading.read_swing import (
    AfterMove,
    modal_names,
    read_swing,
    starts_near,
)
from quietarm.machine.recordings.fitted_spline import fit_spline
from quietarm.machine.recordings.recording import Recording, noise_of
from quietarm.models import Plant
from quietarm.ocp.planning.executed import ArrivalSwing, RecordedArrival

Array = NDArray[np.float64]


_OF_LARGE_SWINGS = 0.001
"""Share of a frequency that it is less certain after a swing as large as that during the move: of
two machines a move with a wrong model tells it as well as those with the right one."""


class TorqueColumns(BasisColumns):
    """The parts of a torque while the joint moves: the swing's reaction, inertia and friction.

    The structure rests at the start. All is averaged over some rows, as the torque is: further
    modes and the servo's answer to its encoder's steps are faster than the swing.

    Parameters
    ----------
    reaction : BasisColumns
        Of an accelerometer at the tip: what the joint's motion does to it comes first, the joint's
        own acceleration last.
    speed : array, shape (rows,)
        Of the joint.
    size : int
        How many rows are averaged, twice.
    """

    driven = False

    def __init__(self, reaction: BasisColumns, speed: Array, size: int) -> None:
        self.count = reaction.count
        self._reaction = reaction
        self._size = size
        slow = 0.01 * float(np.abs(speed).max())
        self._friction = np.column_stack([speed, np.tanh(speed / slow)])

    def __call__(self, p: Array, derivatives: bool = True) -> tuple[Array, Array]:
        """Columns (signals, rows, columns), and their derivatives (parameters, as these)."""
        columns, slopes = self._reaction(p, derivatives)
        friction = np.broadcast_to(self._friction, (len(columns), *self._friction.shape))
        kept = [0, columns.shape[-1] - 1]
        unmoved = np.zeros((*slopes.shape[:-1], self._friction.shape[1]))
        whole = np.concatenate([columns[..., kept], friction], axis=-1)
        by_p = np.concatenate([slopes[..., kept], unmoved], axis=-1)
        return averaged(whole, self._size), averaged(by_p, self._size)


def averaged(values: Array, size: int) -> Array:
    """Means over so many rows, twice; the rows are the axis before the last."""
    from scipy.ndimage import uniform_filter1d  # not at the top: it takes long to load

    once: Array = uniform_filter1d(values, size, axis=-2)
    twice: Array = uniform_filter1d(once, size, axis=-2)
    return twice[..., size : values.shape[-2] - size, :]


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
    names = modal_names(plant)  # a wrong damping draws the frequency aside
    fitter = PartFitter(plant, names, moving, 1.0)
    fitter.frequency = float(fitter.frequencies[0])
    part = fitter.part(slice(0, len(moving.time)), hub="moves")
    model = torque_model(fitter, moving)
    start = min(starts_near(fitter, model), key=model.cost)
    fitter.frequency = fitter.frequency_of(start)
    model = torque_model(fitter, moving)
    best = fitter.fit_model(model, part, start)
    misfit = best.misfit
    noise = float(noise_of(model.values)[0] / np.maximum(best.swinging.std(axis=0)[0], 1e-300))
    most_unexplained = 0.2
    if misfit**2 - noise**2 > most_unexplained**2:
        warning = (
            f"inertia, swing and friction leave {misfit:.0%} of the torque during the move, which "
            "then tells no frequency; record the tip as well"
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


def torque_model(fitter: PartFitter, moving: Recording) -> SwingModel:
    """The torque of a move as what the joint's motion makes of it."""
    averaged_over = 0.06  # of a period
    piece = fitter.thinned(moving)
    spline = _close_spline(moving, fitter.frequency)
    reaction = _answer(fitter, piece.time, spline)
    size = max(1, round(averaged_over / (fitter.frequency * piece.step)))
    assert piece.acceleration is not None
    means = averaged(piece.acceleration[:, None], size)[:, 0]
    inner = replace(piece, time=piece.time[size:-size], angle=None, acceleration=means)
    model = SwingModel(inner, TorqueColumns(reaction, spline(piece.time, 1), size))
    model.trend = model.trend[:, :0]  # dry friction has an offset of its own
    return model


def _close_spline(recording: Recording, frequency: float) -> Any:
    """A spline of the joint's angle whose knots are as close as the swing needs."""
    knots_a_period = 24
    rows = len(recording.time)
    count = int(min(knots_a_period * frequency * np.ptp(recording.time), rows / 3))
    inner = np.linspace(0, rows - 1, max(count, 12))[1:-1]
    assert recording.angle is not None
    return fit_spline(
        recording.time, recording.angle, np.interp(inner, np.arange(rows), recording.time)
    )


def _answer(fitter: PartFitter, time: Array, spline: Any) -> BasisColumns:
    """Return the answer of a fitter's signals to a joint's motion."""
    fastest = 2 * np.pi * fitter.fastest
    if fitter.response.is_linear:
        return Forced(fitter.response, time, spline, fastest)
    return Driven(fitter.response, time, spline, fastest, linear=False)


def swing_by_joint(
    recording: Recording, part: Part, arrival: float, plant: Plant, place: float
) -> AfterMove:
    """The swing at arrival that follows from the joint's recorded motion, and what a part tells."""
    tips, swings = _swings(recording, arrival, plant, place)
    largest = max(float(np.abs(tips).max()), 1e-300)
    swung = sum(swing.amplitude for swing in swings) / largest
    deviations = {
        name: float(np.hypot(deviation, _OF_LARGE_SWINGS * swung * part.values[name]))
        for name, deviation in part.deviations.items()
    }
    part = replace(part, deviations=deviations)
    measured = RecordedArrival(recording.name, tuple(swings), part.values, part.deviations)
    notes = (f"warning: {recording.name}: {part.warning}",) if part.warning else ()
    return AfterMove(measured, part if part.values else None, notes)


def _swings(
    recording: Recording, arrival: float, plant: Plant, place: float
) -> tuple[Array, list[ArrivalSwing]]:
    """The tip's displacement that the recorded motion makes, and the swing of every mode in it."""
    rows = len(recording.time)
    seen = Recording(
        recording.time, angle=recording.angle, tip=np.zeros((rows, plant.tips)), name=recording.name
    )
    fitter = PartFitter(plant, modal_names(plant), seen, 1.0)
    fitter.frequency = float(fitter.frequencies[0])
    spline = _close_spline(seen, fitter.frequency)
    columns, _ = _answer(fitter, seen.time, spline)(fitter.of_plant, False)
    tips = columns[:, :, 0].T
    seen = replace(seen, angle=None, tip=tips)
    return tips, list(read_swing(seen, arrival, plant, place, told=False).measured.swings)
