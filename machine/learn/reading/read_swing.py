"""Read the swing after a move: frequency, damping, and each mode's swing at arrival."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import tau
from typing import Any

import numpy as np
from numpy.typing import NDArray

from quietarm.machine.identify.fits.diagnosis import saturated
from quietarm.machine.identify.fits.fitting import power_near
from quietarm.machine.identify.fits.part_fitter import FEW_SAMPLES, PartFitter
from quietarm.machine.identify.fits.swing_model import SwingModel
from quietarm.machine.identify.identified import Part, is_frequency, is_modal, values_of
from quietarm.machine.identify.swings.ring_down_fit import fit_ring_down
from quietarm.machine.identify.swings.ring_downs import LEAST_PERIODS
from quietarm.machine.identify.swings.swing_changes import has_changes, with_changes
from quietarm.machine.learn.tip_modes import TipModes
from quietarm.machine.recordings.recording import Recording, noise_of
from quietarm.models import Plant
from quietarm.ocp.planning.executed import ArrivalSwing, RecordedArrival
from quietarm.ocp.uncertainty import with_values

Array = NDArray[np.float64]
SETTLES = 0.25
"""Periods after arrival that are not read: the servo has not settled, and further modes die out."""
_FIRST_PERIODS = 6.0
"""Periods by which amplitude and phase at arrival are fitted: later ones may have another
frequency, where that depends on the amplitude."""
_STANDS_OUT = 5.0
"""Deviations of the noise, from which on a swing tells its frequency."""
FAR = 0.5
"""Share by which a machine's frequency may be off the plan's."""


@dataclass(frozen=True)
class AfterMove:
    """The swing that was read after one move.

    Attributes
    ----------
    measured : RecordedArrival
        For the history.
    part : Part or None
        The ring-down, as `identify` fits it; None where the swing is lost in the noise.
    notes : tuple of str
        What is to be known of it.
    other : float
        Amplitude of what moves the tip then beside its modes and the sensor's noise [m]: further
        modes, friction, the servo; 0 of an accelerometer.
    settling : float
        How far the tip may be off that swing while the servo settles, before it is read [m]: what
        is seen of it there, and twice what the noise hides; 0 of an accelerometer.
    """

    measured: RecordedArrival
    part: Part | None
    notes: tuple[str, ...] = ()
    other: float = 0.0
    settling: float = 0.0


def modal_names(plant: Plant) -> list[str]:
    """The parameters of a plant that are the frequency or the damping of a mode."""
    return [name for name in plant.measured if is_modal(plant, name)]


def check_length(recording: Recording, arrival: float, plant: Plant, place: float) -> None:
    """Refuse a recording of too little after arrival."""
    slowest = float(TipModes(plant, place).frequencies[0])
    periods = (float(recording.time[-1]) - arrival) * slowest
    least = LEAST_PERIODS + SETTLES
    if periods < least - 0.1:
        needed = arrival + least / slowest
        raise ValueError(
            f"{recording.name}: it is too short: it ends {max(periods, 0.0):.2g} periods after "
            f"arrival; record until {least:g} periods after it, to {needed:.4g} s"
        )


def read_swing(
    recording: Recording, arrival: float, plant: Plant, place: float, told: bool = True
) -> AfterMove:
    """The swing of a tip or an accelerometer after arrival.

    Parameters
    ----------
    recording : Recording
        Of the tips, or of accelerometers at them.
    arrival : float
        When the move ends, in the recording's time [s].
    plant : Plant
        Whose modes swing.
    place : float
        Where its joint then rests.
    told : bool
        Whether the frequency is sought in it; else it is the plant's.

    Raises
    ------
    ValueError
        When most samples are at the sensor's limit.
    """
    slowest = float(TipModes(plant, place).frequencies[0])
    begin = arrival + SETTLES / slowest
    rows = recording.rows(begin, float(recording.time[-1]))
    after = Recording(
        recording.time[rows],
        tip=None if recording.tip is None else recording.tip[rows],
        acceleration=None if recording.tip is not None else _rows_of(recording.acceleration, rows),
        name=recording.name,
    )
    whole = slice(0, len(after.time))
    names = modal_names(plant)
    fitter = PartFitter(plant, names, after, slowest)
    p = values_of(plant, names)
    part = None
    fitted = fitter.part(whole)
    if told and names:
        fitted, p = _fitted(fitter, whole)
        _refuse_clipped(fitter, fitted)
    swings = _at_arrival(fitter, fitted, p, arrival, place)
    stands_out = any(swing.amplitude > _STANDS_OUT * swing.deviation for swing in swings)
    if told and names and stands_out and _is_swing(fitter, fitted):
        part = fitted
    elif told and names:  # the plant's own frequencies, which the noise does not draw aside
        p = values_of(plant, names)
        fitted = fitter.part(whole)
        swings = _at_arrival(fitter, fitted, p, arrival, place)
    values = dict(part.values) if part else {}
    deviations = dict(part.deviations) if part else {}
    measured = RecordedArrival(recording.name, tuple(swings), values, deviations)
    as_fitted = with_values(plant, dict(zip(names, p.tolist())))
    return AfterMove(
        measured,
        part,
        _notes(fitter, fitted, part),
        _other(fitter, fitted, p),
        _settling(recording, arrival, begin, swings, as_fitted, place),
    )


def _notes(fitter: PartFitter, fitted: Part, part: Part | None) -> tuple[str, ...]:
    """Return notes on a swing: how it changes with its amplitude, and what is doubted."""
    name = fitter.recording.name
    notes = list[str]()
    for parameter, (low, high) in (part.spread if part else {}).items():
        if is_frequency(fitter.plant, parameter):
            hertz = f"{low / tau:.4g} to {high / tau:.4g} Hz"
            notes.append(f"{name}: {parameter} depends on the amplitude of the swing, {hertz}")
    if part and part.warning and part.cause != "amplitude":
        notes.append(f"warning: {name}: {part.warning}")
    if fitted.saturated:
        notes.append(f"{name}: {fitted.saturated} samples at the sensor's limit are left out")
    return tuple(notes)


def _other(fitter: PartFitter, part: Part, p: Array) -> float:
    """Amplitude of what a tip does beside its modes and its noise."""
    if "tip" not in fitter.recording.signals:
        return 0.0
    model = fitter.model(replace(part, values={}))
    left = model.residual(model.start(p))
    thinned = len(fitter.piece(part).time) / len(model.time)
    noise = noise_of(fitter.piece(part).values) / thinned**0.5
    power = np.maximum((left**2).mean(axis=1) - noise**2, 0.0)
    return float(np.sqrt(2 * power.max()))


def _settling(
    recording: Recording,
    arrival: float,
    begin: float,
    swings: list[ArrivalSwing],
    plant: Plant,
    place: float,
) -> float:
    """Return how far a tip is off the swings that were read, from arrival until they are read."""
    if recording.tip is None:
        return 0.0
    modes = TipModes(plant, place)
    amplitudes = np.array([swing.complex_amplitude for swing in swings])
    end = begin + _FIRST_PERIODS / float(modes.frequencies[0])
    rows = recording.rows(arrival, min(end, float(recording.time[-1])))
    since = recording.time[rows] - arrival
    told = (np.exp(np.outer(since, modes.values)) * amplitudes) @ modes.tips.T
    beside = recording.tip[rows].reshape(len(since), -1) - told.real
    beside = beside - beside[since >= begin - arrival].mean(axis=0)
    noise = noise_of(recording.tip[rows].reshape(len(since), -1))
    halves = np.array_split(beside[since < begin - arrival], 2)
    many = 2.0  # deviations
    sizes = [
        np.abs(half.mean(axis=0)) + many * noise / len(half) ** 0.5 for half in halves if len(half)
    ]
    return float(np.max(sizes)) if sizes else 0.0


def _rows_of(values: Array | None, rows: slice) -> Array | None:
    return None if values is None else values[rows]


def _is_swing(fitter: PartFitter, part: Part) -> bool:
    """Return whether a fit meets a swing and tells its frequency, not noise or drift instead."""
    most_unexplained = 0.2
    most_unsure = 0.01  # share of a frequency
    unsure = [
        part.deviations[name] / max(part.values[name], 1e-300)
        for name, is_rate in zip(fitter.names, fitter.are_rates)
        if is_rate
    ]
    certain = min(unsure, default=1.0) < most_unsure
    return certain and part.unexplained < most_unexplained and part.cause != "bound"


def _fitted(fitter: PartFitter, rows: slice) -> tuple[Part, Array]:
    """All of some rows as one ring-down, from the frequency near the plant's that meets it best."""
    rough = fitter.model(fitter.part(rows), samples=FEW_SAMPLES)
    best_start = min(starts_near(fitter, rough), key=rough.cost)
    fitter.frequency = fitter.frequency_of(best_start)
    part, best = fit_ring_down(fitter, rows, rows.start, by_hand=True)
    if has_changes(fitter, part, best):
        spread = with_changes(fitter, part, best, rows)
        part = replace(part, spread=spread.spread, warning=spread.warning, cause=spread.cause)
    return part, part.vector


def starts_near(fitter: PartFitter, model: SwingModel) -> list[Array]:
    """The plant's parameters with other frequencies, of which a fit begins from the best."""
    seconds = float(np.ptp(model.time))
    count = int(np.clip(8 * FAR * fitter.frequency * seconds, 30, 400))
    factors = np.linspace(1 - FAR, 1 + FAR, count)
    return [np.where(fitter.are_rates, f * fitter.of_plant, fitter.of_plant) for f in factors]


def _refuse_clipped(fitter: PartFitter, part: Part) -> None:
    """Refuse a swing of which most is beyond the sensor's limit."""
    values = fitter.recording.values
    flat = saturated(values)
    most = 0.5
    if flat.mean() > most and np.ptp(values) > 0:
        raise ValueError(
            f"{fitter.recording.name}: {flat.mean():.0%} of its samples after arrival are at the "
            "sensor's limit; give it a wider range, or begin with a smaller or slower move"
        )


def _at_arrival(
    fitter: PartFitter, part: Part, p: Array, arrival: float, place: float
) -> list[ArrivalSwing]:
    """Amplitude and phase of every mode at arrival, by its first periods with some parameters."""
    plant = with_values(fitter.plant, dict(zip(fitter.names, p.tolist())))
    modes = TipModes(plant, place)
    lasts = _FIRST_PERIODS / float(modes.frequencies[0])
    short = fitter.recording.rows(part.begin, min(part.end, part.begin + lasts))
    if part.saturated:
        short = fitter.rows(part)
    model = fitter.model(replace(part, begin=float(fitter.recording.time[short][0]),
                                 end=float(fitter.recording.time[short][-1])))  # fmt: skip
    x = model.start(p)
    found = x[model.count :].reshape(model.values.shape[1], -1)[:, : 2 * len(modes.values)]
    by_signal = found[:, 0::2] - 1j * found[:, 1::2]  # of cosine and sine
    deviation = _deviation(model, x, modes)
    since = float(model.time[0]) - arrival
    scale = np.exp(-modes.values * since)
    if "acceleration" in fitter.recording.signals:
        scale = scale / modes.values**2
    by_signal = by_signal * scale
    deviation = deviation * np.abs(scale)
    weights = modes.tips.conj() / (np.abs(modes.tips) ** 2).sum(axis=0)
    amplitudes = (weights * by_signal).sum(axis=0)
    return [ArrivalSwing.of(complex(a), float(d)) for a, d in zip(amplitudes, deviation)]


def _deviation(model: SwingModel, x: Array, modes: TipModes) -> Array:
    """Standard deviation of the parts of each mode's amplitude, of the signal that has most."""
    residual = model.residual(x)
    slopes = model.jacobian(x)
    largest = np.zeros(len(modes.values))
    time = model.time[model.counts]
    for signal in range(len(residual)):
        width = (slopes.shape[-1] - model.count) // len(residual)
        first = model.count + signal * width
        columns = slopes[signal][:, first : first + width]
        power = power_near(time, residual[signal][None], float(modes.frequencies[0]), width)
        covariance: Any = np.linalg.pinv(columns.T @ columns, hermitian=True)
        of_parts = np.sqrt(np.diag(covariance)[: 2 * len(largest)] * power)
        largest = np.maximum(largest, of_parts.reshape(-1, 2).max(axis=1))
    return largest
