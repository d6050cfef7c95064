"""The first table of the report: searches chosen on the first seeds, judged on fresh ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .comparing import searches_in
from .experiment import CONTROL, DIFFERENCES, LIMITS, takes_slopes
from .gaps import INDICATORS, Results
from .runs import Array, Problem, Run
from .significance import holm, interval, signed_ranks

FIRST_SEEDS = 3
EQUAL = 0.5
"""Two gaps that differ by less [percentage points] are equal for practice; set beforehand."""
OF_LIMITS = tuple(f"absolute-{limits}" for limits in LIMITS)


@dataclass(frozen=True)
class Row:
    """A row of the report's first table: a search against one rival, on one or more kinds.

    The search, and the settings of SLSQP, are those of the least median gap on the first seeds; of
    several kinds of problem, those whose largest median is least. Fresh seeds judge them.
    """

    name: str
    axes: tuple[str, ...]
    budget: int
    kinds: tuple[str, ...] = ("absolute",)
    noise: str = ""
    rival: str = DIFFERENCES
    measure: str = "between"


ROWS = (
    Row("model", ("centre",), 10_000, rival=CONTROL),
    Row("smooth", ("centre",), 10_000),
    Row("limits", ("limits",), 10_000, OF_LIMITS),
    Row("limits-1000", ("limits",), 1_000, OF_LIMITS),
    Row("limits-200", ("limits",), 200, OF_LIMITS),
    Row("jumps", ("energy",), 10_000, ("motor-map",)),
    Row("noise", ("noise",), 10_000, noise="noise=0.01"),
    Row("few-200", ("few",), 200),
    Row("few-200-noise", ("few",), 200, noise="noise=0.01"),
    Row("few-1000", ("few", "crossing"), 1_000),
    Row("few-1000-noise", ("few",), 1_000, noise="noise=0.01"),
    Row("three", ("objectives",), 10_000, ("absolute-3-objectives",), "", CONTROL, "points"),
    Row("four", ("objectives",), 10_000, ("absolute-4-objectives",), "", CONTROL, "points"),
)


def judged_rows(results: Results) -> list[dict[str, Any]]:
    """The first table: every row's search, chosen on the first seeds and judged on fresh ones.

    Holm's p is over all comparisons of the table, each by the indicator of its row. By any other
    indicator it is over all comparisons by that one.
    """
    rows = [judged(results, row) for row in ROWS]
    comparisons = [(row, comparison) for row in rows for comparison in row["comparisons"]]
    of_indicators = [
        [comparison["by"][name] for _, comparison in comparisons if name in comparison["by"]]
        for name in INDICATORS
    ]
    of_table = [comparison["by"][row["measure"]] for row, comparison in comparisons]
    for tests in (*of_indicators, of_table):
        for test, p in zip(tests, holm([test["p"] for test in tests]), strict=True):
            test["holm"] = p
    return rows


def judged(results: Results, row: Row) -> dict[str, Any]:
    """A row with its search, the rival's settings and a comparison for each kind of problem."""
    problems_of = {kind: results.problems(kind=kind) for kind in row.kinds}
    every = [name for problems in problems_of.values() for name in problems]
    labels = [
        label
        for label, _ in searches_in(results, row.axes, row.budget, every, 5)
        if (f" {label}".partition(" noise=")[1] != "") == bool(row.noise)
        and "continuation" not in label
        and (not row.noise or label.endswith(row.noise))
    ]
    searches = [label for label in labels if not takes_slopes(label)]
    steps = [label for label in labels if label.partition(" ")[0] == DIFFERENCES]
    search = chosen_on_first(results, row, searches, problems_of)
    rival = CONTROL if row.rival == CONTROL else chosen_on_first(results, row, steps, problems_of)
    return {
        "row": row.name,
        "budget": row.budget,
        "measure": row.measure,
        "search": search,
        "rival": rival,
        "comparisons": [
            comparison
            for kind, problems in problems_of.items()
            if (comparison := judged_on(results, row, (search, rival), kind, problems))
        ],
    }


def seeds_of(results: Results, row: Row, label: str, name: str, fresh: bool) -> list[Run]:
    """The runs of a method on a problem, of the first seeds or of fresh ones."""
    runs = results.of(label, row.budget, name)
    return [run for run in runs if (run.seed >= FIRST_SEEDS) == fresh]


def chosen_on_first(
    results: Results, row: Row, labels: Sequence[str], problems_of: Mapping[str, Sequence[str]]
) -> str:
    """The method of the least median gap on the first seeds, on problems that all have.

    Of those alone that were run on most problems of every kind that any was run on.
    """

    def known(label: str, problems: Sequence[str]) -> set[str]:
        return {name for name in problems if seeds_of(results, row, label, name, False)}

    def is_on_most(label: str, problems: Sequence[str]) -> bool:
        most = max(len(known(other, problems)) for other in labels)
        return 2 * len(known(label, problems)) > max(most, 1)

    of_all = [
        label
        for label in labels
        if all(is_on_most(label, problems) for problems in problems_of.values())
    ]
    worst = dict[str, float]()
    for label in of_all:
        medians = list[float]()
        for problems in problems_of.values():
            shared = set.intersection(*(known(other, problems) for other in of_all))
            runs = [seeds_of(results, row, label, name, False) for name in sorted(shared)]
            gaps = [results.median(of_name, results.gap, row.measure) for of_name in runs]
            medians.append(float(np.median(gaps)))
        worst[label] = max(medians)
    return min(worst, key=lambda label: worst[label], default="")


def judged_on(
    results: Results, row: Row, pair: tuple[str, str], kind: str, problems: Sequence[str]
) -> dict[str, Any]:
    """A search and its rival on fresh seeds, by every indicator; nothing where there are none."""
    search, rival = pair
    ours = dict[str, list[Run]]()
    theirs = dict[str, list[Run]]()
    for name in problems:
        of_search = seeds_of(results, row, search, name, True)
        of_rival = seeds_of(results, row, rival, name, True)
        of_rival = results.control(name) if rival == CONTROL else of_rival
        if of_search and of_rival and results.control(name):
            ours[name], theirs[name] = of_search, of_rival
    if len(ours) < 5:
        return {}
    seeds = [len(runs) for runs in ours.values()]
    if rival != CONTROL:
        seeds = [min(pair) for pair in zip(seeds, map(len, theirs.values()), strict=True)]
    controls = {name: results.control(name) for name in ours}
    plants = [Problem(name).plant for name in ours]

    def gaps(runs_of: Mapping[str, list[Run]], indicator: str) -> Array:
        runs = runs_of.values()
        return np.array([results.median(of_name, results.gap, indicator) for of_name in runs])

    by = dict[str, dict[str, Any]]()
    for indicator in INDICATORS:
        if indicator == "between" and row.measure == "points":
            continue  # of three and four objectives there are no motions between
        difference = gaps(ours, indicator) - gaps(theirs, indicator)
        by[indicator] = {
            "better": int((difference < 0).sum()),
            "difference": float(np.median(difference)),
            "p": signed_ranks(difference),
        }
    difference = gaps(ours, row.measure) - gaps(theirs, row.measure)
    by_plant = [np.median(difference[np.array(plants) == plant]) for plant in sorted(set(plants))]
    return {
        "kind": kind.removeprefix("absolute").removeprefix("-"),
        "moves": len(ours),
        "seeds": min(seeds),
        "missing": float(np.median(gaps(ours, row.measure))),
        "control": float(np.median(gaps(theirs, row.measure))),
        "gradient": float(np.median(gaps(controls, row.measure))),
        "equal": int((np.abs(difference) < EQUAL).sum()),
        "interval": interval(difference, plants),
        "plants": len(by_plant),
        "plants_better": int(sum(value < 0 for value in by_plant)),
        "by": by,
    }
