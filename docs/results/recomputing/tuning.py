"""Tuned settings beside those by default, on the moves of testing."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .comparing import searches_in
from .experiment import DIFFERENCES
from .first_table import ROWS, Row, chosen_on_first, judged, problems_of
from .gaps import MEASURES, Results
from .runs import Array, Problem, rows_of
from .significance import add_holm, signed_ranks


def tuned(results: Results, folder: Path) -> list[dict[str, Any]]:
    """Default and tuned settings by cell and method on the moves of testing, and what was tried."""
    trials = rows_of(folder / "tuning.csv")
    figures = list[dict[str, Any]]()
    for cell, method in dict.fromkeys((trial["cell"], trial["method"]) for trial in trials):
        tried = [trial for trial in trials if (trial["cell"], trial["method"]) == (cell, method)]
        best = min(tried, key=lambda trial: float(trial["score"]))
        row = next(row for row in ROWS if row.name == ("smooth" if cell == "centre" else cell))
        figures.append(
            {
                "cell": cell,
                "method": method,
                "trials": len(tried),
                "budget": int(best["budget"]),
                "default_score": 10 ** float(tried[0]["score"]),
                "best_score": 10 ** float(best["score"]),
                "settings": json.loads(best["settings"]),
                **on_testing(results, row, method),
            }
        )
    for measure in MEASURES:
        add_holm([row[measure] for row in figures if measure in row])
    return figures


def on_testing(results: Results, row: Row, method: str) -> dict[str, Any]:
    """Default and tuned settings on the moves of testing, by measure; nothing where not run.

    Beside them the method that the row holds against this one, with the settings of the row.
    """
    runs = [
        run
        for run in results.runs
        if (run.axis, run.method, run.budget) == ("tuned", method, row.budget)
        and ("noise=" in run.settings) == bool(row.noise)
        and Problem(run.problem).kind in row.kinds
    ]
    if not runs:
        return {}
    label = runs[-1].label
    problems = sorted({run.problem for run in runs if run.label == label})
    usual = usual_settings(results, row, method, problems)
    of_row = judged(results, row)
    other = of_row["search"] if method == DIFFERENCES else of_row["rival"]
    problems = [
        name
        for name in problems
        if results.of(usual, row.budget, name) and results.of(other, row.budget, name)
    ]
    return {
        "usual": usual,
        "other": other,
        **{
            measure: gains_of_tuning(
                *(gaps_on(results, row, name, problems, measure) for name in (usual, label, other))
            )
            for measure in MEASURES
        },
    }


def usual_settings(results: Results, row: Row, method: str, problems: Sequence[str]) -> str:
    """The settings of a method, none of them tuned, that are nearest on the row's first seeds."""
    labels = [
        label
        for label, _ in searches_in(results, row.axes, row.budget, problems, 5)
        if label.partition(" ")[0] == method
        and "continuation" not in label
        and ("noise=" in label) == bool(row.noise)
        and label.endswith(row.noise)
    ]
    return chosen_on_first(results, row, labels, problems_of(results, row))


def gaps_on(results: Results, row: Row, label: str, problems: Sequence[str], measure: str) -> Array:
    """Gaps of a method on problems, medians over seeds."""
    runs = [results.of(label, row.budget, problem) for problem in problems]
    return results.median_gaps(runs, measure)


def gains_of_tuning(default: Array, better: Array, against: Array) -> dict[str, Any]:
    """Tuned settings beside those by default, and beside another method, on the same moves."""
    return {
        "moves": len(default),
        "default": float(np.median(default)),
        "tuned": float(np.median(better)),
        "nearer": int((better < default).sum()),
        "p": signed_ranks(better - default),
        "other": float(np.median(against)),
        "nearer_than_other": int((better < against).sum()),
        "p_other": signed_ranks(better - against),
    }
