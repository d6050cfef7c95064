"""Quantities of the joints in words: in the unit of a joint's kind, and which joint is meant."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from quietarm.models import Plant
from quietarm.models.joint_motion import MIXED
from quietarm.ocp.figures import Figure, further_figures
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.limits import QUANTITIES, JointBounds, Limit, ask_for_jerk

Array = NDArray[np.float64]


def heading_unit(unit: str) -> str:
    """Return a unit as it stands in the heading of a column: rad_s2, Nm."""
    return unit.replace("/", "_").replace("^", "").replace(" ", "")


def further_words(candidate: JudgedMotion, place: str) -> list[str]:
    """Figures of one's own that stand in a place, in words: "RMS torque 0.09 N m"."""
    return [
        f"{figure.label_on(candidate.task.plant)} {figure_words(candidate, figure)}"
        for figure in further_figures(place, candidate.task)
        if figure.name in candidate.figures
    ]


def spans_in_words(candidates: Sequence[JudgedMotion], place: str) -> list[str]:
    """Return the range over several motions of each further figure: "RMS torque 0.05 to 0.09 N m".

    A figure that one of the motions lacks is left out.
    """
    words = list[str]()
    for figure in further_figures(place, candidates[0].task) if candidates else []:
        known = [motion for motion in candidates if figure.name in motion.figures]
        if known and len(known) == len(candidates):
            by_size = sorted(known, key=lambda motion: motion.figures[figure.name])
            first = figure_words(by_size[0], figure)
            last = figure_words(by_size[-1], figure)
            plant = known[0].task.plant
            unit = f" {figure.unit_on(plant)}"
            low = first.removesuffix(unit) if last.endswith(unit) else first
            span = last if first == last else f"{low} to {last}"
            words.append(f"{figure.label_on(plant)} {span}")
    return words


def figure_words(candidate: JudgedMotion, figure: Figure, drawn: bool = False) -> str:
    """Return a figure in its unit; a peak of several joints with the joint that has it.

    Of joints of both kinds it is the peak of each kind. As it is `drawn` powers of units are
    raised.
    """
    plant = candidate.task.plant
    quantity = QUANTITIES.get(figure.quantity)
    if quantity is None or len(plant.joint_names) < 2 or not quantity.of_joints:
        return figure.words(candidate.figures[figure.name], plant, drawn)
    peaks = candidate.peaks_of_joints(quantity).tolist()
    if plant.joint != MIXED:
        joint = plant.joint_names[int(np.argmax(peaks))]
        return f"{figure.words(candidate.figures[figure.name], plant, drawn)} ({joint})"
    largest = dict[str, tuple[float, str]]()
    for peak, joint, kind in zip(peaks, plant.joint_names, plant.joint_kinds):
        own = figure.unit.on(kind, plant.tip_unit)
        unit = own.drawn if drawn else str(own)
        largest[unit] = max(largest.get(unit, (0.0, joint)), (peak, joint))
    return " and ".join(
        f"{peak:.{figure.digits}g} {unit} ({joint})" for unit, (peak, joint) in largest.items()
    )


@dataclass(frozen=True)
class JointPeak:
    """The peak of a limited quantity at one of several joints.

    Attributes
    ----------
    value : float
        The value that comes nearest to a bound, or passes it most; absolute where both bounds are
        alike [SI units].
    share : float
        The same as a share of that bound.
    bounds : JointBounds
        The limit of this joint, with the joint's name and unit.
    """

    value: float
    share: float
    bounds: JointBounds

    def times(self, factor: float) -> str:
        """A multiple of the peak, in words: 40.5 N m at elbow_joint."""
        return f"{factor * self.value:.4g} {self.bounds.unit} at {self.bounds.name}"


def joint_peaks(limit: Limit, plant: Plant, ranges: Array) -> list[JointPeak]:
    """Return the peak of each joint that a limit is for; none of a plant of one joint.

    `ranges` has the least and the largest of the limit's values, a row each.
    """
    peaks = list[JointPeak]()
    for bounds, (least, largest) in zip(limit.bounds_of_joints(plant), ranges.tolist()):
        if limit.is_of_shares:
            least, largest = bounds.value(least), bounds.value(largest)
        shares = {least / bounds.lower: least, largest / bounds.upper: largest}
        share = max(shares)
        value = abs(shares[share]) if bounds.lower == -bounds.upper else shares[share]
        peaks.append(JointPeak(value, share, bounds))
    return peaks


def peaks_beyond(limit: Limit, motion: JudgedMotion, tolerance: float = 0.0) -> list[JointPeak]:
    """Return the peaks of joints that pass a limit; of none that does the one nearest to it.

    A plant of one joint has none, nor has a limit of another thing than the joints.
    """
    plant = motion.task.plant
    jumps = ask_for_jerk([limit.quantity]) and not motion.path.has_jerk  # the acceleration does
    if jumps or not limit.bounds_of_joints(plant):
        return []
    ranges = motion.ranges_of_joints(limit.quantity)
    return beyond(joint_peaks(limit, plant, ranges), tolerance)


def beyond(peaks: Sequence[JointPeak], tolerance: float = 0.0) -> list[JointPeak]:
    """Return the peaks that pass their limits by more than a share, or else the nearest to it."""
    passed = [peak for peak in peaks if peak.share > 1 + tolerance]
    return passed or sorted(peaks, key=lambda peak: -peak.share)[:1]


def peak_words(limit: Limit, motion: JudgedMotion, tolerance: float = 0.0) -> str:
    """Return a motion's peak of what is limited: 0.31 N m; of several joints with their names."""
    peaks = peaks_beyond(limit, motion, tolerance)
    if not peaks:
        return limit.describe(limit.peak_of(motion.figures))
    return " and ".join(peak.times(1.0) for peak in peaks)


def passed_words(limit: Limit, motion: JudgedMotion, tolerance: float = 0.0) -> str:
    """Return a peak and the limit that it passes: 40.5 N m at elbow_joint, above its limit of ...

    Of several joints each has its own limit.
    """
    peaks = peaks_beyond(limit, motion, tolerance)
    if not peaks:
        peak = limit.describe(limit.peak_of(motion.figures))
        return f"{peak}, above its limit of {limit.bounds}"
    return above_words(peaks)


def above_words(peaks: Sequence[JointPeak]) -> str:
    """Return peaks of joints in words, each with its limit."""
    return " and ".join(
        f"{peak.times(1.0)}, above its limit of {peak.bounds.text}" for peak in peaks
    )


def broken_limits(motion: JudgedMotion, limits: Sequence[Limit], tolerance: float) -> list[str]:
    """Return the labels of limits that a motion passes; of several joints with their names."""
    exceeded = motion.figures.exceeded(limits, tolerance)
    return [
        f"{limit.label}{_at(peaks_beyond(limit, motion, tolerance))}"
        for limit in limits
        if limit.name in exceeded
    ]


def _at(peaks: Sequence[JointPeak]) -> str:
    return f" at {', '.join(peak.bounds.name for peak in peaks)}" if peaks else ""
