"""Searches against the gradient, or another rival, on many problems: a row for each search."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from .gaps import MEASURES, Results
from .runs import Array, Problem, Run
from .significance import holm, interval, signed_ranks

Rival = Callable[[str, float], list[Run]]
"""Runs on a problem that a search is held against, by the processor time that it took."""


def by_label(results: Results, label: str, budget: int) -> Rival:
    """A method with a budget as the rival of searches."""
    return lambda name, spent: results.of(label, budget, name)


def compare(
    results: Results,
    problems: Sequence[str],
    searches: Sequence[tuple[str, int]],
    measure: str,
    rival: Rival | None = None,
    with_intervals: bool = True,
) -> list[dict[str, Any]]:
    """Every search against the gradient, or another rival, over the problems that all have.

    Its row has medians over problems, Wilcoxon's p and Holm's, in how many plants and moves the
    search is nearer, and the decimal logarithm of the ratio of what both lack, with its interval.
    These are of the problems alone on which the rival has a front.
    """
    against: Rival = rival or (lambda name, spent: results.control(name))
    problems = [
        name
        for name in problems
        if results.control(name) and all(results.of(*search, name) for search in searches)
    ]
    plants = [Problem(name).plant for name in problems]
    rows = list[dict[str, Any]]()
    for label, budget in searches:
        runs = [results.of(label, budget, name) for name in problems]
        lacks = np.array([results.median(r, results.gap, measure) for r in runs])
        excess = np.array([results.median(r, results.excess, measure) for r in runs])
        seconds = np.array([np.median([run.seconds for run in r]) for r in runs])
        controls = [against(name, spent) for name, spent in zip(problems, seconds, strict=True)]
        known = np.array([bool(control) for control in controls], dtype=bool)
        theirs = np.array(
            [results.median(control, results.gap, measure) for control in controls if control]
        )
        row: dict[str, Any] = {
            "method": label,
            "budget": budget,
            "moves": len(problems),
            "seeds": min((len(r) for r in runs), default=0),
            "missing": _median(lacks),
            "control": _median(theirs),
            "control_seconds": _median(
                np.array([np.median([r.seconds for r in runs]) for runs in controls if runs])
            ),
            "no_control": int((~known).sum()),
            "excess": _median(excess),
            "seconds": _median(seconds),
        }
        if known.any():
            floor = 1e-3  # per cent: what the files' digits can tell
            lacks = lacks[known]
            of_known = [plant for plant, has in zip(plants, known, strict=True) if has]
            ratios = np.log10(np.maximum(lacks, floor) / np.maximum(theirs, floor))
            by_plant = [np.median(ratios[np.array(of_known) == plant]) for plant in set(of_known)]
            row |= {
                "p": signed_ranks(lacks - theirs),
                "log_ratio": float(np.median(ratios)),
                "interval": interval(ratios, of_known) if with_intervals else None,
                "moves_nearer": int((lacks < theirs).sum()),
                "plants_nearer": int(sum(value < 0 for value in by_plant)),
                "plants": len(by_plant),
            }
        rows.append(row)
    for row, p in zip(rows, holm([row.get("p", np.nan) for row in rows]), strict=True):
        row["holm"] = p
    return rows


def _median(values: Array) -> float:
    return float(np.median(values)) if len(values) else float("nan")


def both_measures(
    results: Results, problems: Sequence[str], searches: Sequence[tuple[str, int]]
) -> dict[str, list[dict[str, Any]]]:
    """Comparisons by either measure."""
    return {measure: compare(results, problems, searches, measure) for measure in MEASURES}


def searches_in(results: Results, axes: Sequence[str], budget: int, problems: Sequence[str],
                least: int) -> list[tuple[str, int]]:  # fmt: skip
    """Searches with runs of a budget on at least so many of the problems."""
    names = set(problems)
    count = defaultdict[str, set[str]](set)
    for run in results.runs:
        if run.axis in axes and run.budget == budget and run.problem in names:
            count[run.label].add(run.problem)
    return sorted((label, budget) for label, known in count.items() if len(known) >= least)


def gradient_labels(results: Results, problems: Sequence[str]) -> list[tuple[str, int]]:
    """Methods without a budget that were run on most of the problems."""
    labels = {run.label for run in results.runs if run.axis == "centre" and not run.budget}
    return [
        (label, 0)
        for label in sorted(labels)
        if 2 * sum(bool(results.of(label, 0, name)) for name in problems) > len(problems)
    ]
