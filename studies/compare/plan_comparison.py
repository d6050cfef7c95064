"""Plans of one move beside baselines and under parameter errors: one table, one picture."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import pandas as pd

from quietarm.models import Plant
from quietarm.models.dimensions import TORQUE
from quietarm.models.joint_motion import ROTARY
from quietarm.ocp import JudgedMotion, Plan, PointToPoint, QuietarmError
from quietarm.ocp.checks import takes, unknown
from quietarm.ocp.figures import ACTS_AFTER, added_figures, figures_in
from quietarm.ocp.limits import COMPARISON, QUANTITIES
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY
from quietarm.ocp.profiles.shaped_cycloid import TOLERATED
from quietarm.ocp.task import RANGE_OF_BAND
from quietarm.ocp.uncertainty import FREQUENCY
from quietarm.studies.compare.acting_in_band import refuse_still
from quietarm.studies.compare.acting_report import (
    acting_columns,
    acting_table,
    answer_of,
    few_by_residual,
    few_to_draw,
    title_of_answer,
)
from quietarm.studies.compare.baselines import (
    EI_OF_BAND,
    S_CURVE,
    TOPPRA,
    baseline,
    choose_baselines,
    fastest_baseline,
    meaning_of_baseline,
)
from quietarm.studies.compare.compare_sentences import answer_by_residual
from quietarm.studies.compare.compared_motions import (
    SAMPLES,
    ComparedMotion,
    judge_motion,
    merged_ranges,
    refuse_other_moves,
)
from quietarm.views import pictures
from quietarm.views.report import Report
from quietarm.views.report.acting_words import ranges_words
from quietarm.views.report.words import (
    note_lines,
    title_of,
    title_of_picture,
    unit_of_way,
    window_words,
)
from quietarm.views.tips import tip_scale, tip_words

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_WHY = "why there is none"
"""Column of a table for files; a page lists the reasons below."""
_WINDOW = "residual window [s]"
_DURATION = "duration [s]"


OWN = "own"
PLANS = "plan"
BOTH = "both"
DURATIONS = (OWN, PLANS, BOTH)
"""Durations of baselines: the shortest of each, the first plan's, or a row for each."""
_MOST_TOLERATED = 0.2
"""By EI, of the vibration: beyond it two impulses nearly do."""


@takes(plans={str: Plan}, task=PointToPoint)
def compare_plans(
    plans: Mapping[str, Plan],
    baselines: Sequence[str] = (),
    ranges: Mapping[str, float] | None = None,
    samples: int = SAMPLES,
    *,
    task: PointToPoint | None = None,
    durations: str | None = None,
) -> list[ComparedMotion]:
    """Evaluate plans of one move and baselines for it, in this order.

    Parameters
    ----------
    plans : mapping of str to Plan
        Plans by their names in tables. Baselines have the move and limits of the first plan, and
        all are checked against its limits; residuals are within the longest window of all plans.
    baselines : sequence of str
        Names of `BASELINES`, or "all".
    ranges : mapping of str to float, optional
        Largest relative parameter errors by name; by default those that the plans are made for, and
        with a band 5 % of the frequency if they are made for none.
    samples : int
        Random plants for the percentiles; with a band there are none.
    task : PointToPoint, optional
        Move, limits, energy and band, in the place of the first plan's. With a band motions are
        judged by the time until the tip stays within, and plans may be of several durations.
    durations : {"own", "plan", "both"}, optional
        How long baselines take: the shortest time of each within the limits, as long as the first
        plan, or a row of each. By default their own with a band and limits, else the plan's.

    Returns
    -------
    list of ComparedMotion
        A baseline that is impossible for the move says why.

    Raises
    ------
    ValueError
        When the plans are of several moves, a name is not known or a number is out of range.
    """
    names = choose_baselines(baselines)
    tasks = {"the move": task} if task else {}
    energy = None if task is None else {"energy": task.energy}
    tasks |= {name: replace(plan.task, **energy or {}) for name, plan in plans.items()}
    first = next(iter(tasks.values()))
    banded = next((planned for planned in tasks.values() if planned.band is not None), first)
    first = replace(first, band=banded.band, margin=banded.margin)
    refuse_other_moves(tasks, any_duration=first.band is not None)
    window = max(planned.residual_window for planned in tasks.values())
    task = replace(first, residual_window=window)
    ranges = ranges or merged_ranges(tasks.values())
    if task.band is not None:
        refuse_still(task)
        ranges = ranges or RANGE_OF_BAND
    durations = _durations(durations, task)
    judged = [judge_motion(name, plan, ranges, task, samples) for name, plan in plans.items()]
    for kind in (OWN, PLANS):
        if durations in (kind, BOTH):
            suffix = f" in {task.duration:.4g} s" if (durations, kind) == (BOTH, PLANS) else ""
            make = fastest_baseline if kind == OWN else baseline
            judged += [
                _judged_baseline(name, suffix, make, ranges, task, samples) for name in names
            ]
    return judged


def _durations(durations: str | None, task: PointToPoint) -> str:
    """Return which durations baselines take; ValueError if nothing says how short theirs are."""
    if durations is None:
        return OWN if task.band is not None and task.limits else PLANS
    if durations not in DURATIONS:
        raise ValueError(unknown("durations", durations, DURATIONS))
    if durations != PLANS and not task.limits:
        raise ValueError(
            f"durations are {durations!r}, and the move has no limits, so that no time is the "
            "shortest; plan it with some, such as --acceleration-limit 40, or take 'plan'"
        )
    return durations


def _judged_baseline(
    name: str,
    suffix: str,
    make: Callable[..., Plan | JudgedMotion],
    ranges: Mapping[str, float],
    task: PointToPoint,
    samples: int,
) -> ComparedMotion:
    """A baseline as `make` makes it, or why there is none."""
    try:
        tolerated = None
        if name == EI_OF_BAND and task.band_limit is not None:
            tolerated = _tolerated(task, task.band_limit, ranges)
        moved = make(name, task, tolerated)
        judged = judge_motion(name + suffix, moved, ranges, task, samples)
        meaning = judged.meaning or meaning_of_baseline(name)
        return replace(judged, meaning=meaning, is_baseline=True)
    except (QuietarmError, ValueError) as error:
        return ComparedMotion(name + suffix, why=str(error), is_baseline=True)


def _tolerated(task: PointToPoint, limit: float, ranges: Mapping[str, float]) -> float:
    """Share of the S-curve's vibration that a residual limit allows: the band over its margin."""
    moved = fastest_baseline(S_CURVE, task) if task.limits else baseline(S_CURVE, task)
    unshaped = moved if isinstance(moved, JudgedMotion) else moved.candidate
    error = ranges.get(FREQUENCY, RANGE_OF_BAND[FREQUENCY])
    swing = max(unshaped.perturbed({FREQUENCY: e}).residual for e in (-error, 0.0, error))
    if swing <= limit:
        raise ValueError(
            f"the S-curve leaves {tip_words(swing, task.plant.tip_unit)} without a shaper, which "
            f"fits the band; take {S_CURVE}"
        )
    return min(limit / swing, _MOST_TOLERATED)


def motions_table(
    motions: Sequence[ComparedMotion], joint: str = ROTARY, tip_unit: str = "m"
) -> pd.DataFrame:
    """A row for each motion with all its figures; what is known of none is left out."""
    rows = [{"motion": motion.name, **dict(_cells(motion, joint, tip_unit))} for motion in motions]
    return pd.DataFrame(rows).dropna(axis=1, how="all")


def _cells(
    judged: ComparedMotion, joint: str, tip_unit: str
) -> Iterator[tuple[str, float | str | None]]:
    motion = judged.motion
    yield "parameters", judged.parameters
    if motion is None:
        yield _WHY, judged.why
        return
    yield _DURATION, judged.duration
    yield "energy [J]", motion.energy
    shown, scale = tip_scale(tip_unit)
    if judged.acting is not None:
        yield from acting_columns(judged.acting, shown, scale).items()
    yield f"residual [{shown}]", scale * motion.residual
    yield _WINDOW, judged.window
    if judged.worst is not None:
        yield f"worst case [{shown}]", scale * judged.worst.residual
        errors = (f"{name} {100 * error:+.3g} %" for name, error in judged.worst.errors.items())
        yield "worst case at", ", ".join(errors)
    if judged.robustness is not None:
        yield f"95 % of samples [{shown}]", scale * judged.robustness.percentile("residual", 95)
        for sweep in judged.robustness.sweeps:
            ends = sweep.insensitivity
            words = "none" if ends is None else f"{100 * ends[0]:.2g} to {100 * ends[1]:.2g} %"
            yield f"{sweep.name} within {100 * TOLERATED:g} %", words
    for figure in figures_in(COMPARISON):
        if figure.name not in (*RESIDUAL_AND_ENERGY, ACTS_AFTER):
            unit = figure.unit.of(joint, tip_unit)
            yield f"{figure.label.of(joint)} [{unit or '-'}]", motion.get(figure.name)
    torque = QUANTITIES["torque"]
    effort = torque.unit.of(joint, tip_unit)
    yield f"RMS {torque.words.of(joint)} [{effort}]", judged.rms_torque
    yield "exceeds", ", ".join(judged.exceeded) or None
    yield "time [s]", judged.seconds


def shown(table: pd.DataFrame) -> pd.DataFrame:
    """Return a table as a page has room for; residuals in whole thousandths of a mm: 0 is rest."""
    lengths = [column for column in table if str(column).endswith("[mm]")]
    rounded = table.round(dict.fromkeys(lengths, 3))
    rounded.columns = [_shortened(str(column), rounded.columns) for column in rounded.columns]
    files_alone = ["parameters", "time [s]", _WHY, _WINDOW, _DURATION]
    return rounded.drop(columns=files_alone, errors="ignore")


def _shortened(heading: str, others: Iterable[str]) -> str:
    """The heading of a peak without that word, unless another figure has what is left."""
    peak_of = heading.removeprefix("peak ")
    if peak_of == heading or peak_of in others:
        return heading
    begin, *rest = peak_of.split(" ", 1)
    return " ".join(["accel." if begin == "acceleration" else begin, *rest])


def remarks(motions: Sequence[ComparedMotion], unit: str = "rad") -> list[str]:
    """Say why a motion is missing, and which joints turn back."""
    # a joint that goes back by more [rad] is said to
    least_turn = 1e-4
    reasons: dict[str, list[str]] = {}
    for motion in motions:
        if motion.why:
            reasons.setdefault(motion.why, []).append(motion.name)
    back = [
        f"{m.name} by {m.turns_back:.2g} {unit}"
        for m in motions
        if (m.turns_back or 0) > least_turn
    ]
    return [
        *(f"{', '.join(names)}: {why}" for why, names in reasons.items()),
        *(
            f"{motion.name} passes its limit of {' and '.join(motion.exceeded)}"
            for motion in motions
            if motion.acting and motion.exceeded
        ),
        *([f"The joint turns back on its way: {', '.join(back)}"] if back else []),
    ]


def plans_report(task: PointToPoint, motions: Sequence[ComparedMotion]) -> Report:
    """Motions as a table, what to know of them, and a picture; by a band who may act first."""
    plant = task.plant
    table = motions_table(motions, plant.joint, plant.tip_unit)
    robust = next((motion.robustness for motion in motions if motion.robustness), None)
    ranges = next((motion.worst.errors for motion in motions if motion.worst), {})
    acting = next((motion.acting for motion in motions if motion.acting), None)
    further = _own_figures(table, plant) if acting else shown(table)
    own = [motion for motion in motions if motion.is_baseline and motion.duration]
    return Report(
        "studies/compare/plans.md",
        {
            "title": title_of(task),
            "acting": acting_table(motions, plant) if acting else None,
            "band": acting and tip_words(acting.band, plant.tip_unit),
            "within": acting and ranges_words(acting.ranges),
            "energy": task.energy.label,
            "shown": further,
            "remarks": [
                *remarks(motions, unit_of_way(plant)),
                *(_words_of_way(plant) if acting else []),
                *note_lines(plant),
            ],
            "errors": list(ranges),
            "window": window_words(
                next((motion.window for motion in motions if motion.window), task.residual_window)
            ),
            "robust": robust,
            "tolerated": f"{100 * TOLERATED:g} %",
            "has_dry_friction": task.plant.drive is not None and task.plant.drive.coulomb > 0,
            "effort": TORQUE.of(task.plant.joint),
            "own_durations": any(motion.duration != task.duration for motion in own),
            "ruckig": any("ruckig" in motion.name for motion in motions),
            "toppra": any(motion.name.startswith(TOPPRA) for motion in motions),
        },
        {"motions": table},
        {"motions.png": partial(_picture, task, motions)},
        answer=answer_of(motions, plant) if acting else answer_by_residual(motions),
    )


def _words_of_way(plant: Plant) -> list[str]:
    """Say what is assumed of a tip whose way a plant does not say."""
    if plant.has_path or plant.tip_reach is not None:
        return []
    return [f"{plant.name} does not say where its tip goes: it is taken to arrive with the joint"]


def _picture(task: PointToPoint, motions: Sequence[ComparedMotion]) -> Figure:
    tip_unit = task.plant.tip_unit
    if any(motion.acting for motion in motions):
        few = few_to_draw(motions)
        return pictures.acting_figure(few, title_of_answer(motions), tip_unit)
    return pictures.motions_figure(few_by_residual(motions), title_of_picture(task), tip_unit)


def _own_figures(table: pd.DataFrame, plant: Plant) -> pd.DataFrame:
    """The columns of a table that figures of the user's own have."""
    units = ((figure, figure.unit_on(plant) or "-") for figure in added_figures())
    columns = [f"{figure.label_on(plant)} [{unit}]" for figure, unit in units]
    return table.filter(["motion", *columns])
