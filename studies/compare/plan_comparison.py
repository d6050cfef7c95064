"""Plans of one move beside baselines and under parameter errors: one table, one picture."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

import pandas as pd

from quietarm.models.joint_motion import ROTARY
from quietarm.ocp import Plan, PointToPoint, QuietarmError
from quietarm.ocp.checks import takes
from quietarm.ocp.figures import figures_in
from quietarm.ocp.limits import COMPARISON
from quietarm.ocp.objectives import RESIDUAL_AND_ENERGY
from quietarm.ocp.profiles.shaped_cycloid import TOLERATED
from quietarm.studies.compare.baselines import TOPPRA, baseline, choose_baselines
from quietarm.studies.compare.compared_motions import (
    SAMPLES,
    ComparedMotion,
    judge_motion,
    merged_ranges,
    refuse_other_moves,
)
from quietarm.views import pictures
from quietarm.views.report import Report
from quietarm.views.report.words import (
    note_lines,
    title_of,
    title_of_picture,
    unit_of_way,
    window_words,
)
from quietarm.views.tips import tip_scale

_WHY = "why there is none"
"""Column of a table for files; a page lists the reasons below."""
_WINDOW = "residual window [s]"


@takes(plans={str: Plan}, task=PointToPoint)
def compare_plans(
    plans: Mapping[str, Plan],
    baselines: Sequence[str] = (),
    ranges: Mapping[str, float] | None = None,
    samples: int = SAMPLES,
    *,
    task: PointToPoint | None = None,
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
        Largest relative parameter errors by name; by default those that the plans are made for.
    samples : int
        Random plants for the percentiles.
    task : PointToPoint, optional
        Move and limits, in the place of the first plan's.

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
    tasks |= {name: plan.task for name, plan in plans.items()}
    refuse_other_moves(tasks)
    window = max(planned.residual_window for planned in tasks.values())
    task = replace(next(iter(tasks.values())), residual_window=window)
    ranges = ranges or merged_ranges(tasks.values())
    judged = [
        judge_motion(
            name,
            plan,
            ranges,
            task,
            samples,
        )
        for name, plan in plans.items()
    ]
    for name in names:
        try:
            judged.append(judge_motion(name, baseline(name, task), ranges, task, samples))
        except (QuietarmError, ValueError) as error:
            judged.append(ComparedMotion(name, why=str(error)))
    return judged


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
    yield "energy [J]", motion.energy
    shown, scale = tip_scale(tip_unit)
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
        if figure.name not in RESIDUAL_AND_ENERGY:
            unit = figure.unit.of(joint, tip_unit)
            yield f"{figure.label.of(joint)} [{unit or '-'}]", motion.get(figure.name)
    yield "exceeds", ", ".join(judged.exceeded) or None
    yield "time [s]", judged.seconds


def shown(table: pd.DataFrame) -> pd.DataFrame:
    """What a page has room for; residuals in whole thousandths of a millimetre: 0 is rest."""
    lengths = [column for column in table if str(column).endswith("[mm]")]
    rounded = table.round(dict.fromkeys(lengths, 3))
    rounded.columns = [_shortened(str(column), rounded.columns) for column in rounded.columns]
    files_alone = ["parameters", "time [s]", _WHY, _WINDOW]
    return rounded.drop(columns=files_alone, errors="ignore")


def _shortened(heading: str, others: Iterable[str]) -> str:
    """The heading of a peak without that word, unless another figure has what is left."""
    peak_of = heading.removeprefix("peak ")
    if peak_of == heading or peak_of in others:
        return heading
    begin, *rest = peak_of.split(" ", 1)
    return " ".join(["accel." if begin == "acceleration" else begin, *rest])


def remarks(motions: Sequence[ComparedMotion], unit: str = "rad") -> list[str]:
    """Why a motion is missing, and which joints turn back."""
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
        *([f"The joint turns back on its way: {', '.join(back)}"] if back else []),
    ]


def plans_report(task: PointToPoint, motions: Sequence[ComparedMotion]) -> Report:
    """Motions as a table, what to know of them, and a picture."""
    joint = task.plant.joint
    table = motions_table(motions, joint, task.plant.tip_unit)
    robust = next((motion.robustness for motion in motions if motion.robustness), None)
    ranges = next((motion.worst.errors for motion in motions if motion.worst), {})
    return Report(
        "studies/compare/plans.md",
        {
            "title": title_of(task),
            "shown": shown(table),
            "remarks": [*remarks(motions, unit_of_way(task.plant)), *note_lines(task.plant)],
            "errors": list(ranges),
            "window": window_words(
                next((motion.window for motion in motions if motion.window), task.residual_window)
            ),
            "robust": robust,
            "tolerated": f"{100 * TOLERATED:g} %",
            "ruckig": any("ruckig" in motion.name for motion in motions),
            "toppra": any(motion.name == TOPPRA for motion in motions),
        },
        {"motions": table},
        {
            "motions.png": partial(
                pictures.motions_figure, motions, title_of_picture(task), task.plant.tip_unit
            )
        },
    )
