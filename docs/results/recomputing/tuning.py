"""Tuned settings beside those by default, on the moves of testing."""

from __future__ import annotations

import csv
import json
from typing import Any

import numpy as np

from .comparing import searches_in
from .experiment import DIFFERENCES
from .first_table import ROWS, Row, chosen_on_first, judged
from .gaps import MEASURES, Results
from .runs import Problem
from .significance import holm, signed_ranks


def tuned(results: Results) -> list[dict[str, Any]]:
    """Default and tuned settings by cell and method on the moves of testing, and what was tried."""
    path = results.folder / "tuning.csv"
    if not path.exists():
        return []
    with path.open(newline="") as file:
        trials = list(csv.DictReader(file))
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
        rows = [row[measure] for row in figures if measure in row]
        for row, p in zip(rows, holm([row["p"] for row in rows]), strict=True):
            row["holm"] = p
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
    problems_of = {kind: results.problems(kind=kind) for kind in row.kinds}
    problems = sorted({run.problem for run in runs if run.label == label})
    labels = [
        other
        for other, _ in searches_in(results, row.axes, row.budget, problems, 5)
        if other.partition(" ")[0] == method
        and "continuation" not in other
        and ("noise=" in other) == bool(row.noise)
        and other.endswith(row.noise)
    ]
    usual = chosen_on_first(results, row, labels, problems_of)
    of_row = judged(results, row)
    other = of_row["search"] if method == DIFFERENCES else of_row["rival"]
    problems = [
        name
        for name in problems
        if results.of(usual, row.budget, name) and results.of(other, row.budget, name)
    ]
    figures: dict[str, Any] = {"usual": usual, "other": other}
    for measure in MEASURES:
        default, better, against = (
            np.array(
                [
                    results.median(results.of(name, row.budget, problem), results.gap, measure)
                    for problem in problems
                ]
            )
            for name in (usual, label, other)
        )
        figures[measure] = {
            "moves": len(problems),
            "default": float(np.median(default)),
            "tuned": float(np.median(better)),
            "nearer": int((better < default).sum()),
            "p": signed_ranks(better - default),
            "other": float(np.median(against)),
            "nearer_than_other": int((better < against).sum()),
            "p_other": signed_ranks(better - against),
        }
    return figures
