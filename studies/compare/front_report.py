"""Compared fronts as a report: a row a method, every run, how to read them, a picture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

import pandas as pd

from quietarm.metaheuristics.score import (
    GAP,
    HYPERVOLUME,
    Indicator,
    gap,
    known_indicators,
)
from quietarm.metaheuristics.spread import Spread
from quietarm.ocp import Front, task_difference
from quietarm.ocp.figures import Figure, further_figures
from quietarm.ocp.front.interpolated import BETWEEN
from quietarm.ocp.limits import FRONT
from quietarm.ocp.objectives import objectives_on
from quietarm.studies.compare.compare_sentences import answer_of_fronts
from quietarm.studies.compare.front_comparison import (
    Comparison,
    RunsOfMethod,
    compare_fronts,
    differ_in_window_alone,
)
from quietarm.views import pictures
from quietarm.views.pictures.comparison_figures import KnownPoint
from quietarm.views.report import Report
from quietarm.views.report.words import (
    objective_words,
    residual_place,
    spread_words,
    title_of,
    values_words,
    window_words,
)
from quietarm.views.tips import tip_scale, tip_words

_WINDOW = "residual window [s]"
"""Column of `methods.csv`."""


def compare_by_task(
    fronts: Mapping[str, Front], reference: Front | None, reference_name: str
) -> list[Comparison]:
    """Named fronts of several tasks, those of each compared; a reference is of a single task."""
    tasks = _by_task(fronts)
    if reference is not None and len(tasks) > 1:
        raise ValueError(
            "a reference is for fronts of one task; these are of several: leave it out"
        )
    compare = partial(
        compare_fronts,
        reference=reference,
        reference_name=reference_name,
    )
    return [compare(list(named.values()), list(named)) for named in tasks]


def _by_task(fronts: Mapping[str, Front]) -> list[dict[str, Front]]:
    tasks: list[dict[str, Front]] = []
    for name, front in fronts.items():
        for known in tasks:
            if not task_difference(front.task, next(iter(known.values())).task):
                known[name] = front
                break
        else:
            tasks.append({name: front})
    return tasks


def _apart_by_window(comparisons: Sequence[Comparison]) -> list[str]:
    """Residual windows of tasks that are one but for these; none where there are no such."""
    windows = {
        first.task.residual_window: window_words(first.task.residual_window)
        for first in comparisons
        for second in comparisons
        if differ_in_window_alone(first.task, second.task)
    }
    return [words for _, words in sorted(windows.items())]


def _in_words(comparison: Comparison, values: Sequence[float]) -> str:
    """A value of each objective of a comparison."""
    return values_words(objectives_on(comparison.task.plant, comparison.objectives), values)


def methods_table(comparison: Comparison) -> pd.DataFrame:
    """A row for each method: medians, with quartiles where there are several seeds."""
    return pd.DataFrame([_row(comparison, group) for group in comparison.groups])


def _row(comparison: Comparison, group: RunsOfMethod) -> dict[str, object]:
    tip_unit = comparison.task.plant.tip_unit
    energies = {
        f"energy [J] within {tip_words(level, tip_unit)}": spread_words(
            group.spread("energies", i), ".4g"
        )
        for i, level in enumerate(comparison.levels)
    }
    # as found, points of the gradient would lose by steps that its line has not
    hidden = group.by_gradient and not comparison.fill
    measures = {
        heading_of(indicator): None if hidden else spread_of_indicator(group, indicator)
        for indicator in known_indicators().values()
    }
    front = group.runs[0].front
    figures = {
        f"{figure.label_on(front.task.plant)} [{figure.unit_on(front.task.plant) or '-'}] "
        f"within {tip_words(level, tip_unit)}": _spread_of(group, figure, level)
        for level in comparison.levels
        for figure in further_figures(FRONT, front.task)
    }
    return {
        "method": group.label,
        "seeds": len(group.runs),
        **energies,
        **figures,
        **measures,
        _WINDOW: float(front.task.residual_window),
        "points": Spread.of([len(run.front.points) for run in group.runs]).median,
        "bound": front.record.bound,
        "candidates": group.spread("front.record.evaluations").median or None,
        "iterations": group.spread("front.record.iterations").median or None,
        "time [s]": group.spread("front.record.seconds").median,
    }


def heading_of(indicator: Indicator) -> str:
    """Return the heading of an indicator; of the hypervolume it is the gap that is shown."""
    return GAP if indicator is HYPERVOLUME else indicator.label


def spread_of_indicator(group: RunsOfMethod, indicator: Indicator) -> str:
    """Return the spread over runs of an indicator, of the hypervolume that of its gap."""
    if indicator is HYPERVOLUME:
        gaps = [gap(run.scores[HYPERVOLUME.name]) for run in group.runs]
        return spread_words(Spread.of(gaps), ".2g")
    return spread_words(group.spread("scores", indicator.name), indicator.form)


def _spread_of(group: RunsOfMethod, figure: Figure, level: float) -> str:
    """Return the spread over runs of a figure of their cheapest motions within a residual [m]."""
    column = figure.column_on(group.runs[0].front.task.plant)
    values = [run.front.figures_within(level, FRONT)[column] for run in group.runs]
    return spread_words(Spread.of(values), f".{figure.digits}g")


def _shown(table: pd.DataFrame) -> pd.DataFrame:
    """Return the columns that a page has room for: the window stands below the table."""
    return table.drop(columns=_WINDOW).dropna(axis=1, how="all")


def runs_table(comparison: Comparison) -> pd.DataFrame:
    """Every run with all of its figures."""
    rows: list[dict[str, object]] = []
    shown, scale = tip_scale(comparison.task.plant.tip_unit)
    for group in comparison.groups:
        for run in group.runs:
            front = run.front
            record = run.front.record
            row: dict[str, object] = {
                "move": title_of(front.task),
                "name": run.name,
                "label": group.label,
                "method": record.method,
                "seed": record.seed,
                "bound": record.bound,
                "coefficients": front.profile.size,
                "points": len(front.points),
                "residual_window_s": front.task.residual_window,
            }
            for name in known_indicators():
                if name in row:
                    raise ValueError(f"{name} is a column already; give the indicator another name")
                row |= {name: run.scores[name], f"{name}_found": run.scores_found[name]}
            for i, level in enumerate(comparison.levels):
                at = f"at_{scale * level:g}{shown}"
                row |= {
                    f"energy_J_{at}": run.energies[i],
                    f"gap_{at}": run.gaps[i],
                    f"gap_between_{at}": run.gaps_between[i],
                }
                figures = front.figures_within(level, FRONT)
                row |= {f"{column}_{at}": value for column, value in figures.items()}
            for name in ("evaluations", "iterations", "seconds"):
                row[name] = getattr(record, name)
            rows.append(row)
    return pd.DataFrame(rows)


def fronts_report(
    comparisons: Sequence[Comparison],
    known: Sequence[Sequence[KnownPoint]],
) -> Report:
    """Compared fronts of one task or several, with known points of each for its picture."""
    names = (
        ["fronts.png"]
        if len(comparisons) == 1
        else [f"fronts-{i}.png" for i in range(1, len(comparisons) + 1)]
    )
    tables = [methods_table(comparison) for comparison in comparisons]
    moves = zip(comparisons, tables)
    return Report(
        "studies/compare/fronts.md",
        {
            "parts": list(zip(comparisons, map(_shown, tables), names)),
            "title_of": title_of,
            "in_words": _in_words,
            "objective_words": objective_words,
            "residual_place": residual_place,
            "fill": BETWEEN if comparisons[0].fill else 0,
            "apart": _apart_by_window(comparisons),
            "indicators": known_indicators(),
            "heading_of": heading_of,
            "several": any(
                len(group.runs) > 1 for comparison in comparisons for group in comparison.groups
            ),
        },
        {
            "methods": pd.concat(
                [
                    table.assign(move=title_of(comparison.task)) if len(tables) > 1 else table
                    for comparison, table in moves
                ]
            ),
            "runs": pd.concat(map(runs_table, comparisons)),
        },
        {
            name: partial(pictures.comparison_figure, comparison, points)
            for name, comparison, points in zip(names, comparisons, known)
        },
        answer=_answer(comparisons),
    )


def _answer(comparisons: Sequence[Comparison]) -> str:
    """Return who takes least energy; of several moves a sentence each."""
    if len(comparisons) == 1:
        return answer_of_fronts(comparisons[0])
    sentences = (f"{title_of(one.task)}: {answer_of_fronts(one)}" for one in comparisons)
    return " ".join(sentences)
