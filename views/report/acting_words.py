"""Words on when a tool may act: the first line of an answer with a band."""

from __future__ import annotations

import math
from collections.abc import Mapping

from quietarm.ocp import Front, Plan
from quietarm.ocp.judged_motion import JudgedMotion
from quietarm.ocp.planning.certify import OVERRUN
from quietarm.ocp.uncertainty import FREQUENCY
from quietarm.views.tips import tip_words


def acting_words(motion: JudgedMotion) -> str:
    """Say when the tip stays in the task's band: "may act after 0.88 s: within 0.1 mm for ..."."""
    task = motion.task
    acting = motion.acting
    assert acting is not None
    assert task.band is not None
    band = tip_words(task.band, "m")
    errors = ranges_words(task.ranges)
    if not math.isfinite(acting.after):
        return f"may never act: the tip does not stay within {band} {errors}"
    words = f"may act after {acting.after:.3g} s: within {band} {errors}"
    knows_its_way = task.plant.has_path or task.plant.tip_reach is not None
    if knows_its_way or acting.after > task.duration:
        return words
    return (
        f"{words}; {task.plant.name} does not say where its tip goes with the joint, so that it is "
        "taken to arrive with it"
    )


def arrival_words(motion: JudgedMotion) -> str:
    """Say that a learned motion may act from its arrival on: "may act after 0.9 s: within 0.1 mm".

    For a move that leaves less than its task's band on the machine that it was learned from.
    """
    assert motion.task.band is not None
    band = tip_words(motion.task.band, "m")
    return f"may act after {motion.task.duration:.3g} s: within {band} on this machine"


def ranges_words(ranges: Mapping[str, float]) -> str:
    """Say for which errors something holds: "for frequency errors up to 5 %"."""
    if not ranges:
        return "without errors"
    if list(ranges) == [FREQUENCY]:
        return f"for frequency errors up to {100 * ranges[FREQUENCY]:.3g} %"
    parts = [f"{name} up to {100 * size:.3g} %" for name, size in ranges.items()]
    return f"for errors of {' and of '.join(parts)}"


def path_lines(motion: JudgedMotion) -> list[str]:
    """The first line of the answer of a recorded path with a band; none without one."""
    return [] if motion.task.band is None else [acting_words(motion)]


def band_lines_of_front(front: Front) -> list[str]:
    """The first line of a front whose task has a band: of its motion that acts first.

    Of several the cheapest. The first point is the plan for the band, where the front's profile has
    one; else it may be that none keeps the band from arrival on.
    """
    task = front.task
    limit = task.band_limit
    if limit is None or task.band is None:
        return []
    motions = [front.judged(point) for point in front.points]
    first = min(motions, key=lambda motion: (motion.acts_after, motion.energy))
    acts_late = task.duration < first.acts_after < math.inf
    if acts_late:
        return [
            f"no motion of this front stays within {tip_words(task.band, 'm')} from arrival on "
            f"{ranges_words(task.ranges)}; the first may act after {first.acts_after:.3g} s, by "
            f"{first.energy:.4g} J; quietarm plan --band looks for one that does"
        ]
    words = f"{acting_words(first)}, by {first.energy:.4g} J"
    if all(point.residual > (1 + OVERRUN) * limit for point in front.points):
        words += (
            f"; no motion of this front leaves less than {tip_words(limit, 'm')}, the band over "
            "its margin; quietarm plan --band looks for one that does"
        )
    return [words]


def band_lines(plan: Plan) -> list[str]:
    """The first lines of the answer of a plan with a band; none without one."""
    if plan.task.band is None:
        return []
    lines = [acting_words(plan.candidate)]
    by_band = plan.task.band_limit
    limit = plan.residual_limit
    if by_band is not None and limit is not None and not math.isclose(limit, by_band, rel_tol=1e-6):
        lines.append(
            f"the residual limit is {tip_words(limit, 'm')}, as stated, in place of the band's "
            f"{tip_words(by_band, 'm')} with a margin of {plan.task.margin:g}"
        )
    return lines
