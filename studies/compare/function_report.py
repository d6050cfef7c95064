"""Compared fronts of one function as a report: a row a method, every run, a picture."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import pandas as pd

from quietarm.metaheuristics.score import known_indicators
from quietarm.metaheuristics.spread import Spread
from quietarm.ocp import Front
from quietarm.studies.compare.front_comparison import Comparison, RunsOfMethod, compare_fronts
from quietarm.studies.compare.front_report import heading_of, spread_of_indicator
from quietarm.views import pictures
from quietarm.views.report import Report


def functions_report(
    fronts: Mapping[str, Front], reference: Front | None, reference_name: str
) -> Report:
    """Fronts of one function, by the names of their files; ValueError where they are of several."""
    comparison = compare_fronts(
        list(fronts.values()),
        list(fronts),
        reference=reference,
        reference_name=reference_name,
        fill=False,
    )
    methods = pd.DataFrame([_row(comparison, group) for group in comparison.groups])
    return Report(
        "studies/compare/function_fronts.md",
        {
            "function": next(iter(fronts.values())).task,
            "reference": comparison.reference,
            "indicators": known_indicators(),
            "heading_of": heading_of,
        },
        {"methods": methods, "runs": _runs(comparison)},
        {"fronts.png": partial(pictures.function_comparison_figure, comparison)},
    )


def _row(comparison: Comparison, group: RunsOfMethod) -> dict[str, Any]:
    """Medians of a method, with quartiles where there are several seeds."""
    scores = {
        heading_of(indicator): spread_of_indicator(group, indicator)
        for indicator in known_indicators().values()
    }
    return {
        "method": group.label,
        "seeds": len(group.runs),
        **scores,
        "points": Spread.of([len(run.front.points) for run in group.runs]).median,
        "candidates": group.spread("front.record.evaluations").median,
        "time [s]": group.spread("front.record.seconds").median,
    }


def _runs(comparison: Comparison) -> pd.DataFrame:
    """Every run, with its indicators and its least objectives."""
    rows = list[dict[str, Any]]()
    for run in comparison.runs:
        front: Any = run.front
        least = dict(
            zip(
                (f"least_{entry.column}" for entry in front.outputs),
                front.objective_values.min(axis=0).tolist(),
            )
        )
        record = front.record
        rows.append(
            {
                "name": run.name, "method": record.method, "seed": record.seed, **least,
                **run.scores, "evaluations": record.evaluations, "seconds": record.seconds,
            }
        )  # fmt: skip
    return pd.DataFrame(rows)
