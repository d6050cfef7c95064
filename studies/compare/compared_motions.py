"""Motions of one move, each judged once by CVODES: on the nominal plant and on perturbed ones."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from quietarm.ocp import (
    Figures,
    Floor,
    JudgedMotion,
    Plan,
    PointToPoint,
    Robustness,
    Uncertainty,
    evaluate_robustness,
    task_difference,
)
from quietarm.ocp.checks import takes
from quietarm.ocp.figures import rms
from quietarm.ocp.joint_words import broken_limits
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.ocp.robustness import worst_case, worst_of
from quietarm.ocp.task import MARGIN
from quietarm.studies.compare.acting_in_band import ActingInBand, acting_in_band
from quietarm.views.pictures.meaning import meaning_of

SAMPLES = 2000
"""Random plants for the percentiles."""


@dataclass(frozen=True)
class ComparedMotion:
    """A motion evaluated by CVODES, or why there is none.

    Attributes
    ----------
    name : str
        What tables call it.
    motion : Figures or None
        Residual, energy and peaks on the nominal plant.
    window : float or None
        Time after arrival in which residuals are measured [s].
    worst : JudgedMotion or None
        It with the parameter errors that leave the largest residual.
    exceeded : tuple of str
        Limits that the motion exceeds by more than a thousandth, the tolerance of every plan.
    robustness : Robustness or None
        Of a motion with a profile: insensitivity to each error, and percentiles.
    parameters, turns_back, seconds : int, float, float, or None
        How many numbers were chosen, how far the joint goes back on its way [rad], and how long it
        took to find [s].
    why : str
        Why there is no such motion.
    meaning : str
        What it is in the grammar of pictures, as ``"plan"``; empty of an input shaper's motion.
    duration : float or None
        How long it takes [s].
    rms_torque : float or None
        Root mean square of the torque, or force, over the move; the largest of several joints.
    acting : ActingInBand or None
        When the tool may act after it, where a band was given.
    is_baseline : bool
        Whether it is what is used in place of a plan.
    """

    name: str
    motion: Figures | None = None
    window: float | None = None
    worst: JudgedMotion | None = None
    exceeded: tuple[str, ...] = ()
    robustness: Robustness | None = None
    parameters: int | None = None
    turns_back: float | None = None
    seconds: float | None = None
    why: str = ""
    meaning: str = ""
    duration: float | None = None
    rms_torque: float | None = None
    acting: ActingInBand | None = None
    is_baseline: bool = False

    @property
    def task(self) -> PointToPoint:
        """The move of the nominal plant."""
        assert self.motion is not None
        assert self.motion.candidate is not None  # which CVODES has judged
        return self.motion.candidate.task


@takes(task=PointToPoint)
def judge_motion(
    name: str,
    moved: Plan | Floor | JudgedMotion,
    ranges: Mapping[str, float],
    task: PointToPoint,
    samples: int = 0,
) -> ComparedMotion:
    """Evaluate a motion of a task's move within ranges of parameter errors, and by its limits.

    The motion keeps its own duration. With samples, also the insensitivity, and percentiles over
    that many random plants. For a task with a band it is judged by the time to act, in their place
    and in that of the worst residual.
    """
    candidate = moved if isinstance(moved, JudgedMotion) else moved.candidate
    task = replace(task, duration=candidate.task.duration)
    nominal = JudgedMotion(task.certain, candidate.path)
    judged = ComparedMotion(
        name,
        nominal.motion,
        float(task.residual_window),
        exceeded=tuple(broken_limits(nominal, task.limits, OVERRUN)),
        meaning=meaning_of(moved),
        duration=task.duration,
        rms_torque=rms("torque")(nominal),
    )
    if isinstance(moved, Plan):
        judged = replace(judged, parameters=moved.profile.size, turns_back=moved.turns_back)
    if not isinstance(moved, JudgedMotion):
        judged = replace(judged, seconds=moved.record.seconds)
    if task.band is not None:
        certain = candidate.on(task.certain)
        return replace(judged, acting=acting_in_band(certain, task.band, ranges))
    if not isinstance(moved, Plan):
        return replace(judged, worst=worst_case(nominal, ranges)) if ranges else judged
    uncertain = replace(nominal.task, uncertainty=Uncertainty(ranges) if ranges else None)
    motion = moved.candidate.on(uncertain)
    robustness = (
        evaluate_robustness(motion, ranges, samples=samples) if ranges and samples else None
    )
    return replace(judged, worst=worst_of(motion), robustness=robustness)


def refuse_other_moves(tasks: Mapping[str, PointToPoint], any_duration: bool = False) -> None:
    """Refuse tasks that are not one move; limits, errors and residual windows may differ.

    So may durations, if any will do.
    """
    (first, wanted), *rest = ((name, _bare(task)) for name, task in tasks.items())
    for name, task in rest:
        alike = replace(task, duration=wanted.duration)
        if difference := task_difference(alike if any_duration else task, wanted):
            only_duration = not any_duration and not task_difference(alike, wanted)
            remedy = (
                ", or give a --band: motions of any duration are then compared by the time to act"
            )
            raise ValueError(
                f"{name} is of another move than {first}: its {difference}; compare plans of one "
                f"move{remedy if only_duration else ''}"
            )


def _bare(task: PointToPoint) -> PointToPoint:
    default: Any = None
    bare = replace(task.certain, bounds={}, torque_speed=None, residual_window=default)
    return replace(bare, band=None, margin=MARGIN)


def merged_ranges(tasks: Iterable[PointToPoint]) -> dict[str, float]:
    """The largest parameter error of each kind that the tasks are made for."""
    ranges: dict[str, float] = {}
    for task in tasks:
        for name, size in task.ranges.items():
            ranges[name] = max(size, ranges.get(name, 0.0))
    return ranges
