"""One axis at a time: limits, few candidates, noise, objectives, a million candidates."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from .comparing import Search, by_label, compare, count_with_runs, of_values, searches_in
from .experiment import DIFFERENCES, LIMITS
from .gaps import Results
from .runs import Problem
from .significance import median_or_nan


def limit_figures(results: Results) -> dict[str, dict[str, Any]]:
    """With limits, by kind and budget: all methods against the gradient, and searches by rival."""
    figures = dict[str, dict[str, Any]]()
    for limits in LIMITS:
        problems = results.problems(kind=f"absolute-{limits}")
        for budget in (200, 1_000, 10_000):
            methods = searches_in(results, ("limits",), budget, problems, 5)
            if not methods:
                continue
            searches = of_values(methods)
            rival = by_label(results, DIFFERENCES, budget)
            figures[f"{limits}, {budget}"] = {
                "limits": limits,
                "budget": budget,
                "methods": compare(results, problems, methods, "between"),
                "same time": compare(
                    results, problems, searches, "between", results.control_within
                ),
                "differences": compare(results, problems, searches, "between", rival),
            }
    return figures


def few_figures(results: Results) -> list[dict[str, Any]]:
    """With 200 and 1,000 candidates, without and with noise of 1 %."""
    figures = list[dict[str, Any]]()
    problems = sorted({run.problem for run in results.runs if run.axis == "few"})
    for budget in (200, 1_000):
        for is_noisy in (False, True):
            methods = methods_with_few(results, problems, budget, is_noisy)
            if not methods:
                continue
            rows = compare(results, problems, methods, "between")
            steps = [row for row in rows if row["method"].startswith(DIFFERENCES)]
            best_steps = min(steps, key=lambda row: row["missing"])
            rival = by_label(results, best_steps["method"], budget)
            against = compare(results, problems, of_values(methods), "between", rival)
            figures.append(
                {
                    "budget": budget,
                    "noise": 0.01 if is_noisy else 0.0,
                    "methods": rows,
                    "differences": against,
                }
            )
    return figures


def methods_with_few(
    results: Results, problems: Sequence[str], budget: int, is_noisy: bool
) -> list[Search]:
    """Methods that were run with few candidates on most of the problems, with noise or without."""
    labels = {
        run.label
        for run in results.runs
        if run.axis in ("few", "crossing")
        and run.budget == budget
        and run.problem in problems
        and ("noise=0.01" in run.settings) == is_noisy
    }
    methods = [(label, budget) for label in sorted(labels)]
    half = len(problems) / 2
    return [search for search in methods if count_with_runs(results, search, problems) > half]


def noise_figures(results: Results) -> dict[str, Any]:
    """By the share of the noise, on the moves that were run with noise, with motions between."""
    noisy = [run for run in results.runs if run.axis == "noise"]
    problems = sorted({run.problem for run in noisy})
    methods = sorted({run.method for run in noisy})
    figures = {"0": compare(results, problems, [(name, 10_000) for name in methods], "between")}
    for share in ("0.01", "0.05"):
        labels = sorted({run.label for run in noisy if run.label.endswith(f"noise={share}")})
        searches = [(label, 10_000) for label in labels]
        figures[share] = compare(results, problems, searches, "between") if searches else []
    return figures if noisy else {}


def objective_figures(results: Results) -> dict[str, Any]:
    """With three and four objectives, by points alone; and what the gradient's grid takes."""
    rows = {}
    seconds = {}
    for count in ("3", "4"):
        problems = results.problems(kind=f"absolute-{count}-objectives")
        searches = searches_in(results, ("objectives",), 10_000, problems, 5)
        grid = [("epsilon points=50", 0)] if searches else []
        rows[count] = compare(results, problems, [*searches, *grid], "points") if searches else []
        times = [run.seconds for name in problems for run in results.control(name)]
        seconds[count] = median_or_nan(np.array(times))
    return {"objectives": rows, "grid_seconds": seconds}


def million(results: Results) -> dict[str, list[dict[str, Any]]]:
    """What a million candidates leave, by coefficients, with motions between."""
    runs = [run for run in results.runs if run.axis == "million"]
    figures = {}
    for terms in sorted({Problem(run.problem).terms for run in runs}):
        of_terms = [run for run in runs if Problem(run.problem).terms == terms]
        problems = sorted({run.problem for run in of_terms})
        searches = sorted({(run.label, run.budget) for run in of_terms})
        figures[str(terms)] = compare(results, problems, searches, "between")
    return figures
