"""Report who of compared motions may act first, and at what energy and force."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import pandas as pd

from quietarm.models import Plant
from quietarm.models.dimensions import EFFORT
from quietarm.ocp.limits import QUANTITIES
from quietarm.studies.compare.acting_in_band import ActingInBand
from quietarm.studies.compare.compared_motions import ComparedMotion
from quietarm.views.pictures.acting_figures import MOST_CURVES
from quietarm.views.report.acting_words import ranges_words
from quietarm.views.tips import tip_words

NEVER = "never"


def ranked(motions: Sequence[ComparedMotion]) -> list[ComparedMotion]:
    """Return the motions that there are, the first to act within the ranges of errors first.

    Of motions that act within a millisecond of each other the one of less energy is first. Those
    that pass a limit are last.
    """
    return sorted((motion for motion in motions if motion.motion is not None), key=_rank)


def _rank(judged: ComparedMotion) -> tuple[bool, float, float]:
    assert judged.motion is not None
    after = _acting(judged).latest.after
    return (
        bool(judged.exceeded),
        round(after, 3) if math.isfinite(after) else after,
        judged.motion.energy,
    )


def _acting(judged: ComparedMotion) -> ActingInBand:
    assert judged.acting is not None
    return judged.acting


def few_to_draw(motions: Sequence[ComparedMotion]) -> list[ComparedMotion]:
    """Return at most five motions for a picture: the first plans, and the first of the others."""
    plans_at_most = 3
    order = [motion for motion in ranked(motions) if not motion.exceeded] or ranked(motions)
    plans = [motion for motion in order if not motion.is_baseline][:plans_at_most]
    others = [motion for motion in order if motion.is_baseline]
    return [*plans, *others[: MOST_CURVES - len(plans)]]


def few_by_residual(motions: Sequence[ComparedMotion]) -> list[ComparedMotion]:
    """Return at most five motions for a picture: plans, and the baselines that ring least."""

    def left(judged: ComparedMotion) -> float:
        assert judged.motion is not None
        return judged.motion.residual if judged.worst is None else judged.worst.residual

    there = [motion for motion in motions if motion.motion is not None]
    baselines = sorted((motion for motion in there if motion.is_baseline), key=left)
    given = [motion for motion in there if not motion.is_baseline]
    kept = [*given, *baselines][:MOST_CURVES]
    return [motion for motion in there if any(motion is one for one in kept)]


def answer_of(motions: Sequence[ComparedMotion], plant: Plant) -> str:
    """Return one sentence: who may act first within the ranges of errors, and at what energy."""
    order = [motion for motion in ranked(motions) if not motion.exceeded]
    if not order:
        return "No motion keeps the limits."
    first, *others = order
    acting = _acting(first)
    band = tip_words(acting.band, plant.tip_unit)
    within = f"within {band} {ranges_words(acting.ranges)}"
    if math.isinf(acting.latest.after):
        return f"No motion keeps the tip {within}."
    words = f"{first.name} may act first, {_after_and_energy(first)}, {within}"
    same_kind = [motion for motion in others if motion.is_baseline == first.is_baseline]
    rivals = [motion for motion in others if motion.is_baseline != first.is_baseline]
    if rivals:
        best = rivals[0]
        kind = "plans" if first.is_baseline else "others"
        words += f"; the first of the {kind} is {best.name}, {_after_and_energy(best)}"
    elif same_kind:
        words += f"; {same_kind[0].name} is next, {_after_and_energy(same_kind[0])}"
    return f"{words}."


def title_of_answer(motions: Sequence[ComparedMotion]) -> str:
    """Return the answer as the line above a picture."""
    order = [motion for motion in ranked(motions) if not motion.exceeded]
    if not order:
        return "No motion keeps the limits"
    first, *others = order
    next_one = next((motion for motion in others if motion.is_baseline != first.is_baseline), None)
    next_one = next_one or (others[0] if others else None)
    words = f"{first.name} may act {_time_words(first)}"
    return words if next_one is None else f"{words}, {next_one.name} {_time_words(next_one)}"


def _time_words(judged: ComparedMotion) -> str:
    after = _acting(judged).latest.after
    return NEVER if math.isinf(after) else f"after {after:.3g} s"


def _after_and_energy(judged: ComparedMotion) -> str:
    assert judged.motion is not None
    return f"{_time_words(judged)} and for {judged.motion.energy:.3g} J"


def acting_table(motions: Sequence[ComparedMotion], plant: Plant) -> pd.DataFrame:
    """Return a row for each motion that there is, as a plant buys it, in the order of `ranked`.

    Times to act are by the error of the frequency, the later of both signs.
    """
    unit = EFFORT.of(plant.joint, plant.tip_unit)
    rows = [dict(_cells(motion, unit)) for motion in ranked(motions)]
    return pd.DataFrame(rows).dropna(axis=1, how="all")


def _cells(judged: ComparedMotion, unit: str) -> Iterator[tuple[str, float | str | None]]:
    assert judged.motion is not None
    yield "motion", judged.name
    yield "T [s]", judged.duration
    for error, after in _acting(judged).at.items():
        yield f"{100 * error:g} % [s]", NEVER if math.isinf(after) else f"{after:.4g}"
    yield "energy [J]", judged.motion.energy
    yield f"RMS [{unit}]", judged.rms_torque
    yield f"peak [{unit}]", judged.motion.get(QUANTITIES["torque"].peak)


def acting_columns(acting: ActingInBand, tip: str, scale: float) -> Mapping[str, float | str]:
    """Return what files have of a motion that was judged by a band, by heading."""
    errors = ", ".join(
        f"{name} {100 * error:+.3g} %" for name, error in acting.latest.errors.items()
    )
    return {
        f"band [{tip}]": scale * acting.band,
        **{f"acts after [s] at {100 * error:g} %": time for error, time in acting.at.items()},
        "acts after [s] within the errors": acting.latest.after,
        "acts latest at": errors,
        **{
            f"residual [{tip}] at {100 * error:g} %": scale * size
            for error, size in acting.left.items()
        },
    }
