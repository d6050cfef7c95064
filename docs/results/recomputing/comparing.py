"""Searches against the gradient, or another rival, on many problems: a row for each search."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from .experiment import takes_slopes
from .gaps import MEASURES, Results
from .runs import Array, Problem, Run
from .significance import add_holm, interval, median_or_nan, signed_ranks

Search = tuple[str, int]
"""A method with its settings, and its budget."""
Rival = Callable[[str, float], list[Run]]
"""Runs on a problem that a search is held against, by the processor time that it took."""
LEAST_GAP = 1e-3
"""Gaps below it [%] count as this in a ratio: what the files' digits can tell."""


def by_label(results: Results, label: str, budget: int) -> Rival:
    """A method with a budget as the rival of searches."""
    return lambda name, spent: results.of(label, budget, name)


def compare(
    results: Results,
    problems: Sequence[str],
    searches: Sequence[Search],
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
    rows = [
        compared(results, problems, search, measure, against, with_intervals) for search in searches
    ]
    add_holm(rows)
    return rows


def compared(
    results: Results,
    problems: Sequence[str],
    search: Search,
    measure: str,
    rival: Rival,
    with_intervals: bool,
) -> dict[str, Any]:
    """The row of a search, without Holm's p."""
    runs = [results.of(*search, name) for name in problems]
    lacks = results.median_gaps(runs, measure)
    excess = [np.median([results.excess(run) for run in of_problem]) for of_problem in runs]
    seconds = [float(np.median([run.seconds for run in of_problem])) for of_problem in runs]
    controls = [rival(name, spent) for name, spent in zip(problems, seconds, strict=True)]
    known = np.array([bool(control) for control in controls], dtype=bool)
    fronts = [control for control in controls if control]
    theirs = results.median_gaps(fronts, measure)
    label, budget = search
    row: dict[str, Any] = {
        "method": label,
        "budget": budget,
        "moves": len(problems),
        "seeds": min(map(len, runs), default=0),
        "missing": median_or_nan(lacks),
        "control": median_or_nan(theirs),
        "control_seconds": median_or_nan(
            np.array([np.median([run.seconds for run in front]) for front in fronts])
        ),
        "no_control": int((~known).sum()),
        "excess": median_or_nan(np.array(excess)),
        "seconds": median_or_nan(np.array(seconds)),
    }
    if fronts:
        plants = [Problem(name).plant for name, has in zip(problems, known, strict=True) if has]
        row |= differences_of(lacks[known], theirs, plants, with_intervals)
    return row


def differences_of(
    lacks: Array, theirs: Array, plants: Sequence[str], with_intervals: bool
) -> dict[str, Any]:
    """What a search lacks on moves of plants, beside what its rival lacks there."""
    ratios = np.log10(np.maximum(lacks, LEAST_GAP) / np.maximum(theirs, LEAST_GAP))
    by_plant = medians_by_plant(ratios, plants)
    return {
        "p": signed_ranks(lacks - theirs),
        "log_ratio": float(np.median(ratios)),
        "interval": interval(ratios, plants) if with_intervals else None,
        "moves_nearer": int((lacks < theirs).sum()),
        "plants_nearer": int(sum(value < 0 for value in by_plant)),
        "plants": len(by_plant),
    }


def medians_by_plant(values: Array, plants: Sequence[str]) -> list[float]:
    """The median over the moves of each plant."""
    of_plants = np.array(plants)
    return [float(np.median(values[of_plants == plant])) for plant in sorted(set(plants))]


def both_measures(
    results: Results, problems: Sequence[str], searches: Sequence[Search]
) -> dict[str, list[dict[str, Any]]]:
    """Comparisons by either measure."""
    return {measure: compare(results, problems, searches, measure) for measure in MEASURES}


def searches_in(
    results: Results, axes: Sequence[str], budget: int, problems: Sequence[str], least: int
) -> list[Search]:
    """Searches with runs of a budget on at least so many of the problems."""
    names = set(problems)
    problems_of = defaultdict[str, set[str]](set)
    for run in results.runs:
        if run.axis in axes and run.budget == budget and run.problem in names:
            problems_of[run.label].add(run.problem)
    return sorted((label, budget) for label, known in problems_of.items() if len(known) >= least)


def count_with_runs(results: Results, search: Search, problems: Sequence[str]) -> int:
    """On how many of the problems a search has runs, of whichever table."""
    return sum(bool(results.of(*search, name)) for name in problems)


def of_values(searches: Sequence[Search]) -> list[Search]:
    """Those of the methods that see values alone."""
    return [(label, budget) for label, budget in searches if not takes_slopes(label)]


def gradient_labels(results: Results, problems: Sequence[str]) -> list[Search]:
    """Methods without a budget that were run on most of the problems."""
    labels = {run.label for run in results.runs if run.axis == "centre" and not run.budget}
    return [
        (label, 0)
        for label in sorted(labels)
        if 2 * count_with_runs(results, (label, 0), problems) > len(problems)
    ]
