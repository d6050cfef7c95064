"""Measures that a plant pays for: when the tool may act, what still swings, force and energy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .machines import Machine
from .simulate import TICKS, Runs, SetPoints

NEVER = 0.1
"""A tool that is outside its band within so many seconds [s] of the end never stays in it."""


@dataclass(frozen=True)
class Outcome:
    """The outcome of one run.

    Parameters
    ----------
    acts_after
        Time from the command's start until the tool stays within the band [s]; infinite where it
        does not before the end.
    residual
        Half of the tool's range in a second after the command, or in two periods if longer [m].
    farthest
        Largest distance of the tool from the target after the command's end [m].
    offset
        Mean distance from the target in the last second [m].
    following
        Largest difference of the motor's place from the set point during the command [m].
    peak_force
        Largest force of the motor [N].
    energy
        Electrical energy [J]: power and copper loss until half a second after the command; what
        the motor generates is burnt.
    """

    acts_after: float
    residual: float
    farthest: float
    offset: float
    following: float
    peak_force: float
    energy: float


def outcomes(
    runs: Runs,
    machines: Sequence[Machine],
    set_points: Sequence[SetPoints],
    bands: Sequence[float],
) -> list[Outcome]:
    """Measure every case of the runs, each with the distance from its target at which it acts."""
    return [
        _outcome(runs, case, machine, asked, band)
        for case, (machine, asked, band) in enumerate(zip(machines, set_points, bands))
    ]


def _outcome(runs: Runs, case: int, machine: Machine, asked: SetPoints, band: float) -> Outcome:
    (omega,), _ = machine.actual_beam.modes(1)
    away = runs.tool[:, case] - asked.place[-1]
    done = runs.time >= asked.duration
    outside = np.flatnonzero(np.abs(away) > band)
    acts_after = float(runs.time[outside[-1]]) if len(outside) else 0.0
    if acts_after > runs.time[-1] - NEVER:
        acts_after = np.inf
    rings = away[done][: round(max(1.0, 4 * np.pi / omega) * TICKS)]
    force = runs.force[:, case]
    electrical = np.maximum(runs.work[:, case] + force**2 / machine.heat / TICKS, 0.0)
    late = np.append(runs.asked[1:, case], runs.asked[-1, case])
    return Outcome(
        acts_after=acts_after,
        residual=float(np.ptp(rings) / 2),
        farthest=float(np.abs(away[done]).max()),
        offset=float(away[-TICKS:].mean()),
        following=float(np.abs(late - runs.motor[:, case])[~done].max()),
        peak_force=float(np.abs(force).max()),
        energy=float(electrical[runs.time <= asked.duration + 0.5].sum()),
    )
