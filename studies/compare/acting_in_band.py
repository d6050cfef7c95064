"""Times when a tool may act after compared motions: at several errors, and within their range."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from quietarm.ocp import JudgedMotion, PointToPoint
from quietarm.ocp.acting import Acting, time_to_act, worst_time_to_act
from quietarm.ocp.simulation.free_vibration import FreeVibration
from quietarm.ocp.uncertainty import FREQUENCY

ERRORS = (0.0, 0.02, 0.05, 0.10)
"""Relative errors of the frequency at which every motion is judged, to both signs."""


@dataclass(frozen=True)
class ActingInBand:
    """The time when a tool may act after a motion.

    Attributes
    ----------
    band : float
        Largest distance of the tip from its target [m].
    at : mapping of float to float
        Time from the command's start until the tip stays within the band [s], by the error of the
        frequency: the later of both signs. It is infinite where the tip never does.
    left : mapping of float to float
        Residual at the same errors [m], the larger of both signs.
    latest : Acting
        The latest such time for all errors within the ranges, and the errors for which it is.
    ranges : mapping of str to float
        Largest relative errors by name.
    motions : tuple of JudgedMotion
        The motion at the errors of the frequency within the ranges, and where it acts latest.
    """

    band: float
    at: Mapping[float, float] = field(hash=False)
    left: Mapping[float, float] = field(hash=False)
    latest: Acting
    ranges: Mapping[str, float] = field(hash=False)
    motions: tuple[JudgedMotion, ...] = field(repr=False, compare=False, default=())

    def latest_of(self, bands: ArrayLike) -> NDArray[np.float64]:
        """Return the latest times to act for other bands [s], at the same errors."""
        sizes = np.asarray(bands, dtype=float)
        return np.array([max(time_to_act(one, band) for one in self.motions) for band in sizes])


def refuse_still(task: PointToPoint) -> None:
    """Refuse a task of whose plant nothing vibrates: there is no frequency to err in."""
    if not FreeVibration(task.plant, task.target).modes:
        raise ValueError(
            f"plant {task.plant.name!r} has no frequency to err in: nothing of it vibrates; leave "
            "the band out"
        )


def acting_in_band(motion: JudgedMotion, band: float, ranges: Mapping[str, float]) -> ActingInBand:
    """Judge when a tool may act after a motion of a certain task, within ranges of errors."""
    largest = ranges.get(FREQUENCY, 0.0)
    at = dict[float, float]()
    left = dict[float, float]()
    latest = worst_time_to_act(motion, band, ranges)
    within = [motion.perturbed(latest.errors)]
    for error in sorted({*ERRORS, largest}):
        for signed in {error, -error}:
            moved = motion.perturbed({FREQUENCY: signed})
            after = time_to_act(moved, band)
            at[error] = max(at.get(error, 0.0), after)
            left[error] = max(left.get(error, 0.0), moved.residual)
            if error > largest:
                continue
            within.append(moved)
            if after > latest.after:
                latest = Acting(after, {FREQUENCY: signed})
    return ActingInBand(band, at, left, latest, ranges, tuple(within))
