"""Read the swing after a robot's move from torques of its joints or an accelerometer at its tip.

All signals are fitted with the same frequencies and dampings, each with amplitudes of its own; the
plant's modes then say which swing of the tip has these. For a while after arrival the arm itself
rings, at 5 to 7 Hz with a damping of 0.1 to 0.35, and so may a base or a gear: that is fitted as
further modes, or left out by a later window, whichever leaves the swing surer. Where frequency and
damping depend on the amplitude, the first periods alone are read.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import tau

import numpy as np

from quietarm.machine.learn.robots.swing_fit import (
    PERIODS,
    SETTLES,
    SwingFit,
    SwingingModes,
    Window,
    damping_of,
)
from quietarm.machine.recordings.robot_recording import RobotRecording
from quietarm.models.one_thread import on_one_thread
from quietarm.ocp.planning.executed import ArrivalSwing, RecordedArrival

LATER = 0.65
"""Seconds after arrival from which on the arm itself rings no more."""
LEAST_PERIODS = 2.0
"""Of the slowest mode, that have to be recorded after that."""
_FEW_PERIODS = 3.0
"""Those that are read where the frequency depends on the amplitude."""
_RINGS = 3
"""How many rings beside the modes are told: of the arm, a base in two directions, a gear."""
_SEEN = 2.5
"""Deviations, below which a swing is taken as none: torques hardly show some modes."""
_STANDS_OUT = 5.0
"""Deviations, from which on a mode tells its frequency."""


@dataclass(frozen=True)
class RobotSwing:
    """The swing that was read after one move.

    Attributes
    ----------
    measured : RecordedArrival
        For the history; its values are the frequencies of modes that stand out [Hz].
    notes : tuple of str
        How it was read.
    other : float
        How far the tip rings beside its modes [m].
    dampings : dict of str to (float, float)
        Damping ratios of the modes that stand out, and their standard deviations.
    unexplained : float
        Share of the swing that is not met, beside the noise.
    """

    measured: RecordedArrival
    notes: tuple[str, ...]
    other: float
    dampings: dict[str, tuple[float, float]]
    unexplained: float


def mode_name(number: int) -> str:
    """Return the name of a mode in a history, the slowest with the number 0."""
    return f"mode {number + 1}"


def check_length(recording: RobotRecording, arrival: float, modes: SwingingModes) -> None:
    """Refuse a recording of too little after arrival."""
    slowest = float(modes.frequencies[0])
    least = SETTLES + LEAST_PERIODS / slowest
    lasts = float(recording.time[-1]) - arrival
    if lasts < 0.97 * least:
        raise ValueError(
            f"{recording.name}: it is too short: it ends {max(lasts, 0.0):.2g} s after arrival; "
            f"record until {least:.2g} s after it, better {SETTLES + PERIODS / slowest:.2g} s"
        )


@on_one_thread
def read_robot_swing(
    recording: RobotRecording,
    arrival: float,
    modes: SwingingModes,
    late: float,
    unsure: float,
    periods: float = PERIODS,
) -> RobotSwing:
    """The swing of every mode at arrival.

    Parameters
    ----------
    recording : RobotRecording
        Of the move.
    arrival : float
        When it ended [s].
    modes : SeenModes
        Those of the plant at the end of its path.
    late : float
        By how much the signals are late [s].
    unsure : float
        Standard deviation of the arrival's time [s].
    periods : float
        Of the slowest mode, that are read.
    """
    with_rings = _with_rings(Window(recording, arrival, modes, periods=periods))
    fit, notes = _best_fit(with_rings)
    seen = np.abs(fit.at_arrival) > _SEEN * fit.deviations
    amplitudes = np.where(seen, fit.at_arrival * np.exp(fit.by_mode * late), 0.0)
    # a wrong start turns the phase
    deviations = np.hypot(fit.deviations, np.abs(amplitudes * fit.by_mode) * unsure / 2**0.5)
    swings = tuple(ArrivalSwing.of(complex(a), float(d)) for a, d in zip(amplitudes, deviations))
    telling = np.abs(amplitudes) > _STANDS_OUT * fit.deviations
    values = {
        mode_name(k): float(abs(fit.by_mode[k]) / tau) for k in np.flatnonzero(telling).tolist()
    }
    spreads = {
        mode_name(k): float(abs(fit.by_mode[k]) / tau * fit.rate_deviations[k])
        for k in np.flatnonzero(telling).tolist()
    }
    dampings = {
        mode_name(k): (damping_of(fit.by_mode[k]), float(fit.damping_deviations[k]))
        for k in np.flatnonzero(telling).tolist()
    }
    measured = RecordedArrival(recording.name, swings, values, spreads)
    named = tuple(f"{recording.name}: {note}" for note in notes)
    return RobotSwing(measured, named, with_rings.other, dampings, fit.unexplained)


def _best_fit(best: SwingFit) -> tuple[SwingFit, list[str]]:
    """The fit that makes the swing at arrival surest, of one with rings and later ones, and how."""
    window = best.window
    notes = list[str]()
    if best.rings:
        notes.append(
            "what the arm itself rings is not in the plan's model, and stays: describe a gear or a "
            "base that gives in the robot's file"
        )
        rings = " and ".join(f"{f:.2g} Hz with a damping of {z:.2g}" for f, z in best.rings)
        words = f"the arm itself rings after arrival, at {rings}: "
        later = _later(window)
        if later is not None and later.deviations.sum() < best.deviations.sum():
            best = later
            notes.insert(0, f"{words}the swing is read from {LATER:g} s after arrival on")
        else:
            notes.insert(0, f"{words}that is fitted beside the swing")
    short = _shorter(best)
    if short is not None:
        longer, few = best.clearest, short.clearest
        notes.append(
            f"frequency and damping depend on the amplitude, {few[0]:.4g} Hz and {few[1]:.2g} in "
            f"the first {_FEW_PERIODS:g} periods, {longer[0]:.4g} Hz and {longer[1]:.2g} in "
            f"{best.window.periods:g}: the first are read"
        )
        best = short
    return best, notes


def _with_rings(window: Window) -> SwingFit:
    """The fit of the modes, and of as many rings beside them as clearly help."""
    clearly = 0.7  # share of what is left without one more ring
    best = more = SwingFit(window)
    for _ in range(_RINGS):  # of two that beat, one alone hardly helps
        more = SwingFit(window, more.with_ring())
        if more.left < clearly * best.left and more.are_apart:
            best = more
    return best


def _later(window: Window) -> SwingFit | None:
    """The fit of a window that begins later; None where too little is recorded."""
    later = replace(window, begin=LATER)
    enough = len(later.recording.time[later.rows]) > 8
    return SwingFit(later) if enough and later.lasts >= LEAST_PERIODS else None


def _shorter(fit: SwingFit) -> SwingFit | None:
    """A fit of the first periods alone, where it meets them clearly better than one of all."""
    clearly = 0.6
    apart = 3.0  # deviations
    window = fit.window
    if window.lasts < 1.2 * _FEW_PERIODS:
        return None
    short = SwingFit(replace(window, periods=_FEW_PERIODS), fit.found if fit.rings else None)
    differs = abs(np.log(short.clearest[0] / fit.clearest[0]))
    of_both = float(np.hypot(short.rate_deviations.min(), fit.rate_deviations.min()))
    if short.left < clearly * fit.left and differs > apart * of_both:
        return short
    return None
